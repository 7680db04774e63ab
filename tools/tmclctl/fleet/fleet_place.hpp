/// The broker of a fleet, as the command line says it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "output/errors.hpp"

namespace tmclctl {

/// What was typed.
struct FleetPlace {
  std::string url;  ///< mqtts://[USER@]HOST[:PORT] or mqtt://...; empty: no fleet is meant.
  std::vector<std::string> gateways{};  ///< Names and patterns; empty: all there are.
  std::string ca_file{};
  std::string certificate_file{};
  std::string key_file{};
  std::string password_file{};
};

/// What it comes to.
struct BrokerPlace {
  bool tls = false;
  std::string host{};
  std::uint16_t port = 0;
  std::string user{};      ///< The name in the certificate if the URL has none: a level of topics.
  bool says_user = false;  ///< To the broker: there is none in a certificate.
  std::string password{};
};

/// Reads the files that it needs. Errors: bad_url, bad_certificate, no_user, cannot_read.
Result<BrokerPlace> find_broker(const FleetPlace& place);

}  // namespace tmclctl
