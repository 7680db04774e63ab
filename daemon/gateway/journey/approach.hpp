/// A move of an axis that comes to its targets from one side: see tmcl/plan/approach_drive.hpp.
#pragma once

#include <boost/asio/awaitable.hpp>

#include "gateway/axis/axis.hpp"

namespace tmcld {

struct ApproachOrder {
  std::shared_ptr<GatewayAxis> axis;
  RunOptions movement;  ///< Of the call.
  Length target;
  bool predict = false;
};

/// For an axis whose configuration says so. Returns when its module has taken the first of its
/// moves; no other client moves the axis until it is at its target, and a further order of this one
/// goes on from there.
/// Errors: those of GatewayAxis::move_to().
boost::asio::awaitable<tmcl::Result<StartedMove>> approach(ApproachOrder order);

}  // namespace tmcld
