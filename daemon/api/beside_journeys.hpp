/// What a module records does not run away: reading it leaves the bus to axes that are led.
#pragma once

#include "api/call.hpp"

namespace tmcld {

/// Of what a call runs on the bus of an axis: refused while axes of that bus are led along a line
/// or path, which needs the bus.
RunOptions beside_journeys(const Call& call, const GatewayAxis& axis);

}  // namespace tmcld
