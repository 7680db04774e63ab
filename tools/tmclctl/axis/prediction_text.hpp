/// The twin of an axis, whichever way the axis is reached.
#pragma once

#include <string>

#include "connection/gateway.hpp"
#include "tmcl/plan/axis_twin.hpp"

namespace tmclctl {

/// Set as the module is, where the axis stands. Errors: also for an axis that moves, for a model
/// that is not known, and for one whose ramp generator is not described.
Result<tmcl::plan::AxisTwin> twin_of(const std::string& axis, Context& context);

}  // namespace tmclctl
