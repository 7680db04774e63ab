#include "tmcl/plan/ramp_limits.hpp"

#include <algorithm>

#include "tmcl/parameter_number.hpp"

namespace tmcl::plan {
namespace {

namespace ap = axis_parameter;

std::int32_t value_of(std::span<const Setting> settings, std::uint8_t parameter) {
  const auto found = std::ranges::find(settings, parameter, &Setting::parameter);
  return found == settings.end() ? 0 : found->value;
}

// By its name: the firmware of a TMCM-1311 has something else under that number.
const ParameterInfo* deceleration_of(const Model& model) {
  return find_parameter(axis_parameters(model), "max_deceleration");
}

}  // namespace

std::uint8_t acceleration_parameter(const Model& model) {
  return model.family == Family::tmc457 ? number_of("acceleration") : ap::max_acceleration;
}

std::vector<std::uint8_t> ramp_limit_parameters(const Model& model) {
  std::vector<std::uint8_t> parameters{ap::max_velocity, acceleration_parameter(model)};
  if (const auto* row = deceleration_of(model)) parameters.push_back(row->number);
  return parameters;
}

// A generator that does not use it has 0 there.
RampLimits ramp_limits(const Model& model, std::span<const Setting> settings) {
  RampLimits limits{value_of(settings, ap::max_velocity),
                    value_of(settings, acceleration_parameter(model))};
  const auto* row = deceleration_of(model);
  const auto braking = row != nullptr ? value_of(settings, row->number) : 0;
  if (braking > 0) limits.acceleration = std::min(limits.acceleration, braking);
  return limits;
}

}  // namespace tmcl::plan
