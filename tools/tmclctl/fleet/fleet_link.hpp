/// A connection to the broker of a fleet, for a program that waits.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "broker/message.hpp"
#include "connection/host.hpp"
#include "fleet/fleet_place.hpp"

namespace tmclctl {

class FleetLink {
 public:
  using OnMessage = std::function<void(const tmclmqtt::Message&)>;

  virtual ~FleetLink() = default;
  /// What topics call the holder of this connection.
  virtual const std::string& user() const = 0;
  /// A level of topics that no other process of this user has.
  virtual const std::string& id() const = 0;
  /// Also what is published over this connection itself.
  virtual void subscribe(const std::string& filter) = 0;
  virtual void publish(const tmclmqtt::Publication& publication) = 0;
  /// Hands out what comes until the time has passed, or at once after the first messages.
  /// Errors: broker_lost.
  virtual Result<void> listen(tmcl::Duration at_most) = 0;
  virtual void on_message(OnMessage on_message) = 0;
};

/// Errors: those of find_broker, broker_unreachable, cancelled.
Result<std::unique_ptr<FleetLink>> open_fleet(const FleetPlace& place, Host& host);

}  // namespace tmclctl
