/// A WebSocket to a tmcld on another computer: http://HOST:PORT or https://HOST:PORT.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "tmcl/client.hpp"

namespace tmclctl {

/// Where a tmcld is in the network, as the command line says it.
struct WebPlace {
  std::string url;
  std::string token_file;  ///< Its first line is a token; empty: no token.
  std::string ca_file;     ///< Who vouches for the certificate; empty: whom the system trusts.
};

/// `cancelled`: see tmcl::client::Options. Errors: "usage" for a URL or a file that is wrong;
/// tmcl::client::error_name::unreachable, which says what is wrong with a certificate or a token.
tmcl::client::Result<std::unique_ptr<tmcl::client::LineChannel>> open_web_socket(
    const WebPlace& place, tmcl::Duration at_most, std::function<bool()> cancelled);

}  // namespace tmclctl
