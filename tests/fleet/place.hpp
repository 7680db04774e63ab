/// Where a fleet is.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "broker/broker.hpp"

namespace tmclfleet {

/// What all gateways of a program, and their client, have in common.
struct FleetPlace {
  std::string folder;  ///< For sockets and audit files.
  std::string host;
  std::uint16_t port = 0;
  std::string certificates{};  ///< A folder; empty: without TLS.

  std::string authority() const { return certificates.empty() ? "" : certificates + "/ca.crt"; }
  std::string file_of(const std::string& name, const char* suffix) const {
    return certificates.empty() ? "" : certificates + '/' + name + suffix;
  }
  /// For a connection of a client or a gateway of that name.
  tmclmqtt::BrokerOptions connection_of(const std::string& name, const std::string& id) const {
    tmclmqtt::BrokerOptions options;
    options.host = host;
    options.port = port;
    options.client_id = id;
    options.ca = authority();
    options.certificate = file_of(name, ".crt");
    options.key = file_of(name, ".key");
    options.time_to_be_let_in = std::chrono::seconds(30);
    return options;
  }
};

}  // namespace tmclfleet
