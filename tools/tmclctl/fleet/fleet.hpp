/// What a verb works with that is for many gateways.
#pragma once

#include <functional>
#include <vector>

#include "fleet/call_round.hpp"
#include "fleet/fleet_link.hpp"
#include "fleet/gateways.hpp"
#include "output/screen.hpp"

namespace tmclctl {

struct Fleet {
  Fleet(FleetLink& to, const FleetPlace& place, Output& its_output, Host& its_host);

  /// Waits until the births that the broker keeps are known. `on_other` is given what else comes,
  /// `meanwhile` is called often; both may be empty. Errors: broker_lost, cancelled.
  Result<void> learn(const std::function<void(const tmclmqtt::Message&)>& on_other,
                     const std::function<void()>& meanwhile);
  /// And whether all gateways are there that were named. Errors: as well unknown_gateway.
  Result<void> find();
  /// Makes the calls; on the gateways that are away not. Errors: broker_lost, cancelled.
  Result<void> call(const std::string& role, std::vector<FleetCall> calls,
                    CallRound::OnAnswer on_answer,
                    tmcl::Duration patience = CallRound::usual_patience);
  /// Lets time pass; what comes is told, births as well. Errors: broker_lost, cancelled.
  Result<void> listen(tmcl::Duration at_most);

  FleetLink& link;
  Output& output;
  Host& host;
  Gateways gateways;
  std::function<void(const tmclmqtt::Message&)> on_message{};
};

}  // namespace tmclctl
