/// Who is served by HTTP: plain values, already checked.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

namespace tmcld {

/// An address of this computer, in numbers, at which clients are served.
struct HttpAddress {
  std::string host{};      ///< Without brackets.
  std::uint16_t port = 0;  ///< 0: any that is free.
  bool is_loopback = false;
};

struct HttpConfig {
  std::vector<HttpAddress> listen{};
  std::string certificate{};  ///< File of the chain; empty: there is no TLS.
  std::string key{};
  std::string client_ca{};             ///< File; empty: clients need no certificate.
  std::vector<std::string> origins{};  ///< Of pages beside the daemon's own.
  bool loopback_without_token = false;
  std::string page{};  ///< Folder; empty: where the page is usually.
};

/// The section [http] of the file and those beside it; nothing if there is none.
/// Errors: as load_config(), which has found them already.
tl::expected<std::optional<HttpConfig>, std::vector<std::string>> load_http_config(
    const std::string& path);

}  // namespace tmcld
