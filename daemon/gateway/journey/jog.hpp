/// An axis that goes one way for as long as its client says so: see tmcl/plan/jog_drive.hpp.
///
/// Its module never has a target farther ahead than the axis may go without a further call, so it
/// stops by itself when the client, the gateway or the cable is gone.
#pragma once

#include <memory>
#include <string>

#include <boost/asio/awaitable.hpp>

#include "gateway/axis/axis.hpp"
#include "tmcl/plan/jog_drive.hpp"

namespace tmcld {

struct JogOrder {
  std::shared_ptr<GatewayAxis> axis;
  RunOptions movement;  ///< Of the call.
  tmcl::plan::JogWish wish;
};

struct StartedJog {
  tmcl::plan::JogGoal goal;
  std::string journal_failure{};  ///< See DriveRun.
};

/// Begins a jog, or goes on with the one of the same client. Only for a client that has a lease of
/// the axis. Returns when its module has its target; with a velocity of 0 when the axis stands.
/// Errors: also Errc::axis_claimed if another call moves it, Errc::bad_argument if it is faster
/// than max_velocity; what ends the jog otherwise.
boost::asio::awaitable<tmcl::Result<StartedJog>> jog(JogOrder order);

}  // namespace tmcld
