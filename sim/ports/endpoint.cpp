#include "sim/ports/endpoint.hpp"

#include <charconv>
#include <string_view>

namespace tmcl::sim {
namespace {

bool is_port(std::string_view text) {
  unsigned port = 0;
  const auto* end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, port);
  return parsed.ec == std::errc{} && parsed.ptr == end && port <= 65535;
}

}  // namespace

std::optional<Endpoint> parse_endpoint(const std::string& text) {
  const auto colon = text.rfind(':');
  if (colon == std::string::npos || colon == 0) return std::nullopt;
  Endpoint result{text.substr(0, colon), text.substr(colon + 1)};
  if (!is_port(result.port)) return std::nullopt;
  const bool bracketed = result.host.front() == '[' && result.host.back() == ']';
  if (bracketed) result.host = result.host.substr(1, result.host.size() - 2);
  // Without brackets the end of an IPv6 address is ambiguous.
  if (result.host.empty() || (!bracketed && result.host.find(':') != std::string::npos)) {
    return std::nullopt;
  }
  return result;
}

}  // namespace tmcl::sim
