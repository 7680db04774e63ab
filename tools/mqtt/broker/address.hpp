/// Where a broker is, in the words of a configuration file or a command line. Does no I/O.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace tmclmqtt {

constexpr std::uint16_t plain_port = 1883;
constexpr std::uint16_t tls_port = 8883;

struct BrokerAddress {
  std::string host;  ///< An IPv6 address without its brackets.
  std::uint16_t port = 0;

  bool operator==(const BrokerAddress&) const = default;
};

/// HOST, HOST:PORT, [ADDRESS] or [ADDRESS]:PORT; nothing if it is none of them.
std::optional<BrokerAddress> read_address(std::string_view text, std::uint16_t usual_port);

}  // namespace tmclmqtt
