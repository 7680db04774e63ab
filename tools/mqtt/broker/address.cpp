#include "broker/address.hpp"

#include <algorithm>
#include <charconv>

namespace tmclmqtt {
namespace {

/// No space, no control character, and none that an URL or a topic has around a host.
bool may_be_in_host(unsigned char c) {
  constexpr std::string_view others = "/@#?[]";
  return c > ' ' && c != '\x7f' && others.find(static_cast<char>(c)) == others.npos;
}

std::optional<std::uint16_t> port_in(std::string_view text) {
  std::uint16_t port = 0;
  const auto* end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, port);
  if (read.ec != std::errc() || read.ptr != end || port == 0) return std::nullopt;
  return port;
}

}  // namespace

std::optional<BrokerAddress> read_address(std::string_view text, std::uint16_t usual_port) {
  const bool has_brackets = text.starts_with('[');
  const auto end = text.find(has_brackets ? ']' : ':');
  if (has_brackets && end == text.npos) return std::nullopt;
  const auto host = has_brackets ? text.substr(1, end - 1) : text.substr(0, end);
  const auto rest = text.substr(std::min(text.size(), has_brackets ? end + 1 : end));
  // Without brackets it would not be clear which colon of an IPv6 address begins the port.
  const bool is_host = !host.empty() && std::ranges::all_of(host, may_be_in_host) &&
                       has_brackets == (host.find(':') != host.npos);
  if (!is_host) return std::nullopt;
  if (rest.empty()) return BrokerAddress{std::string(host), usual_port};
  if (rest.front() != ':') return std::nullopt;
  const auto port = port_in(rest.substr(1));
  if (!port) return std::nullopt;
  return BrokerAddress{std::string(host), *port};
}

}  // namespace tmclmqtt
