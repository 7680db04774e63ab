#include "tmcl/plan/ramp_limits.hpp"

#include <algorithm>

#include "tmcl/parameter_number.hpp"

namespace tmcl::plan {
namespace {

namespace ap = axis_parameter;

constexpr auto deceleration = number_of("max_deceleration");
constexpr auto v1 = number_of("velocity_v1");
constexpr auto a1 = number_of("acceleration_a1");
constexpr auto d1 = number_of("deceleration_d1");

std::int32_t value_of(std::span<const Setting> settings, std::uint8_t parameter) {
  const auto found = std::ranges::find(settings, parameter, &Setting::parameter);
  return found == settings.end() ? 0 : found->value;
}

}  // namespace

std::uint8_t acceleration_parameter(const Model& model) {
  return model.family == Family::tmc457 ? number_of("acceleration") : ap::max_acceleration;
}

std::vector<std::uint8_t> ramp_limit_parameters(const Model& model) {
  std::vector<std::uint8_t> parameters{ap::max_velocity, acceleration_parameter(model)};
  switch (model.family) {
    case Family::sixpoint: parameters.insert(parameters.end(), {deceleration, v1, a1, d1}); break;
    case Family::tmc457:
    case Family::tmc4361: parameters.push_back(deceleration); break;
    case Family::tmc429:
    case Family::firmware: break;
  }
  const auto is_missing = [&](std::uint8_t parameter) {
    return find_parameter(axis_parameters(model), parameter) == nullptr;
  };
  std::erase_if(parameters, is_missing);
  return parameters;
}

// A generator that does not use one of them has 0 there.
RampLimits ramp_limits(const Model& model, std::span<const Setting> settings) {
  RampLimits limits{value_of(settings, ap::max_velocity),
                    value_of(settings, acceleration_parameter(model))};
  const auto heed = [&](std::uint8_t parameter) {
    const auto value = value_of(settings, parameter);
    if (value > 0) limits.acceleration = std::min(limits.acceleration, value);
  };
  const auto family = model.family;
  if (family == Family::tmc457 || family == Family::sixpoint || family == Family::tmc4361)
    heed(deceleration);
  if (family != Family::sixpoint || value_of(settings, v1) == 0) return limits;
  heed(a1);
  heed(d1);
  return limits;
}

}  // namespace tmcl::plan
