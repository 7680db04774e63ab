#include "tmcl/parameter_units.hpp"

namespace tmcl {
namespace {

/// The scale that holds for this parameter.
UserScale scale_of(const ParameterInfo& row, const AxisScale& axis) {
  auto scale = axis.scale;
  if (row.minimum >= 0) scale.reverse = false;
  if (axis.encoder_counts_per_unit && is_encoder_position(row))
    return encoder_scale(*axis.encoder_counts_per_unit, scale);
  return scale;
}

template <class T>
std::int32_t number(T value) {
  return value.value;
}

}  // namespace

std::optional<UserValue> to_user(std::int32_t value, const ParameterInfo& row,
                                 const AxisScale& axis) {
  const auto dimension = dimension_of(row);
  const auto scale = scale_of(row, axis);
  const auto in_unit = [&](double number) { return UserValue{number, unit_of(row, scale.unit)}; };
  if (dimension == Dimension::position) return in_unit(to_user(Microsteps{value}, scale).value);
  if (dimension == Dimension::other || !axis.module) return std::nullopt;
  if (dimension == Dimension::velocity)
    return in_unit(to_user(to_pps(InternalVelocity{value}, *axis.module), scale).value);
  return in_unit(to_user(to_pps2(InternalAcceleration{value}, *axis.module), scale).value);
}

Reached<std::int32_t> to_parameter(double value, const ParameterInfo& row, const AxisScale& axis) {
  const auto scale = scale_of(row, axis);
  const auto dimension = dimension_of(row);
  if (dimension == Dimension::position) {
    return to_microsteps(UserPosition{value}, scale, {row.minimum, row.maximum})
        .map(number<Microsteps>);
  }
  const auto range = range_of(row, initial_units(*axis.model), *axis.module);
  if (dimension == Dimension::velocity) {
    return to_internal(to_pps(UserVelocity{value}, scale), *axis.module, range)
        .map(number<InternalVelocity>)
        .map_error([&](const OutOfReach& error) { return in_velocity_units(error, scale); });
  }
  return to_internal(to_pps2(UserAcceleration{value}, scale), *axis.module, range)
      .map(number<InternalAcceleration>)
      .map_error([&](const OutOfReach& error) { return in_acceleration_units(error, scale); });
}

}  // namespace tmcl
