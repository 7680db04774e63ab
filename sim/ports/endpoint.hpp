/// "127.0.0.1:4001", "localhost:0", "[::1]:4001"
#pragma once

#include <optional>
#include <string>

namespace tmcl::sim {

struct Endpoint {
  std::string host;  ///< A name or an address, without brackets; not yet looked up.
  std::string port;  ///< Decimal, 0..65535.
};

/// Nothing if the text has another form than HOST:PORT.
std::optional<Endpoint> parse_endpoint(const std::string& text);

}  // namespace tmcl::sim
