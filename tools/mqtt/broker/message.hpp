/// What goes to a broker and what comes from it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace tmclmqtt {

/// Of a whole packet from the broker, which a topic and its properties are part of. Longer ones it
/// does not send.
constexpr std::uint32_t max_packet_bytes = 72U * 1024U;
/// Of the text of a call, and so of a line to tmcld.
constexpr std::size_t max_payload_bytes = 60U * 1024U;

struct Message {
  std::string topic;
  std::string payload{};
  bool retained = false;
  std::optional<std::uint32_t> expiry_s{};
  std::string response_topic{};
  std::string correlation{};
};

struct Publication {
  std::string topic;
  std::string payload{};
  bool retained = false;
  int qos = 0;
  std::optional<std::uint32_t> expiry_s{};
  std::string response_topic{};
  std::string correlation{};

  bool operator==(const Publication&) const = default;
};

}  // namespace tmclmqtt
