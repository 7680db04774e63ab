/// What an axis' own settings allow a plan.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tmcl/model.hpp"
#include "tmcl/plan/axis_twin.hpp"

namespace tmcl::plan {

/// In the module's units.
struct RampLimits {
  std::int32_t velocity = 0;
  /// For ramps that go up as they go down: the smaller one of acceleration and deceleration.
  std::int32_t acceleration = 0;
  bool operator==(const RampLimits&) const = default;
};

/// The axis parameter that says how fast this model speeds up.
std::uint8_t acceleration_parameter(const Model& model);

/// The axis parameters that have them. The accelerations of a TMC457 are 16 and 17, for 5 reads as
/// 16. The stages of a sixPoint generator below `velocity_v1` do not count: lines and paths have
/// none, and with accelerations as low as the modules start with there, a stop would take long.
std::vector<std::uint8_t> ramp_limit_parameters(const Model& model);

/// `settings`: these, in any order; others make no difference.
RampLimits ramp_limits(const Model& model, std::span<const Setting> settings);

}  // namespace tmcl::plan
