/// A stop of many gateways, published again and again until each axis is acknowledged or its
/// gateway is declared away. It needs no lease, no nonce and no knowledge of gateways to begin.
/// Does no I/O, reads no clock.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "broker/message.hpp"
#include "fleet/gateways.hpp"
#include "output/errors.hpp"
#include "tmcl/clock.hpp"

namespace tmclctl {

class StopRound {
 public:
  static constexpr tmcl::Duration interval = std::chrono::milliseconds(100);

  struct Missing {
    std::string gateway;
    std::string axis;  ///< Empty: nothing has come from the gateway.
    std::string why;
  };

  /// `gateways` outlives it, and goes on hearing births.
  StopRound(const Gateways& gateways, std::string user, std::string id)
      : gateways_(gateways), user_(std::move(user)), id_(std::move(id)) {}

  std::string filter() const;
  /// All births that the broker keeps are known.
  void know_gateways() { knows_gateways_ = true; }
  std::vector<tmclmqtt::Publication> due(tmcl::TimePoint now);
  /// The gateway that has acknowledged axes by it; empty if none has.
  std::string hear(const tmclmqtt::Message& message);
  /// Of a gateway: the axes, each with the milliseconds until its module had confirmed.
  const std::map<std::string, double>& stopped(const std::string& gateway) const;
  /// Axes without an acknowledgement of gateways that are there, and gateways that are away.
  std::vector<Missing> missing() const;
  std::vector<std::string> away() const;
  /// Names of gateways that the broker does not know.
  std::vector<std::string> unknown() const;
  /// Nothing is missing but on gateways that are away, or not known.
  bool is_done() const { return knows_gateways_ && missing().empty(); }

 private:
  struct Heard {
    std::map<std::string, double> stopped{};
    std::map<std::string, std::string> failed{};
    std::string error{};
  };

  bool is_missing(const std::string& name, const FleetGateway& gateway) const;
  tmclmqtt::Publication stop_on(const std::string& level) const;

  const Gateways& gateways_;
  std::string user_;
  std::string id_;
  bool knows_gateways_ = false;
  std::map<std::string, Heard> heard_;
  std::optional<tmcl::TimePoint> published_{};
};

}  // namespace tmclctl
