#include "asked.hpp"

#include <utility>

#include <fmt/format.h>

#include "names.hpp"

namespace tmclctl {
namespace {

namespace ap = tmcl::axis_parameter;

Failure unknown_parameter(const Quantity& quantity, const AxisUnits& units, std::uint8_t number) {
  return usage_failure("unknown_unit",
                       fmt::format("'{}': what parameter {} of axis {} counts in is not known",
                                   to_string(quantity), number, units.axis),
                       "Give a bare number, in the module's own unit");
}

Attempt<std::int32_t> in_parameter(const Quantity& quantity, const AxisUnits& units,
                                   std::uint8_t number) {
  const auto* row = find_parameter(units.parameters(), number);
  if (row != nullptr) return to_parameter(quantity, units, *row);
  return tl::unexpected(unknown_parameter(quantity, units, number));
}

Attempt<std::int32_t> asked(const Quantity& quantity, const std::string& axis, std::uint8_t number,
                            Target& target) {
  if (quantity.unit.empty()) return static_cast<std::int32_t>(quantity.number);
  return target.units(axis).and_then(
      [&](const AxisUnits& units) { return in_parameter(quantity, units, number); });
}

Length bare(const Quantity& length) { return {{static_cast<std::int32_t>(length.number)}}; }

std::optional<double> in_own_unit(const Quantity& length, const AxisUnits& units) {
  const bool own = units.scale && units.scale->unit == length.unit;
  return own ? std::optional(length.number) : std::nullopt;
}

}  // namespace

Attempt<Length> asked_position(const Quantity& position, const std::string& axis, Target& target) {
  if (position.unit.empty()) return bare(position);
  return target.units(axis).and_then([&](const AxisUnits& units) {
    return in_parameter(position, units, ap::target_position).map([&](std::int32_t value) {
      return Length{{value}, in_own_unit(position, units)};
    });
  });
}

Attempt<Length> asked_distance(const Quantity& distance, const std::string& axis, Target& target) {
  if (distance.unit.empty()) return bare(distance);
  return target.units(axis).and_then([&](const AxisUnits& units) {
    return to_microsteps(distance, units, {}).map([&](tmcl::Microsteps value) {
      return Length{value, in_own_unit(distance, units)};
    });
  });
}

Attempt<tmcl::InternalVelocity> asked_velocity(const Quantity& velocity, const std::string& axis,
                                               Target& target) {
  return asked(velocity, axis, ap::target_velocity, target).map([](std::int32_t value) {
    return tmcl::InternalVelocity{value};
  });
}

Attempt<Quantity> shown_value(const ParameterValue& value, const std::string& axis,
                              Target& target) {
  return target.units(axis).and_then([&](const AxisUnits& units) -> Attempt<Quantity> {
    const auto* row = find_parameter(units.parameters(), value.number);
    if (row != nullptr) return from_parameter(value.value, units, *row);
    const Quantity bare{static_cast<double>(value.value), {}};
    return tl::unexpected(unknown_parameter(bare, units, value.number));
  });
}

Attempt<std::int32_t> asked_value(const Quantity& value, const std::string& axis,
                                  const std::string& parameter, Target& target) {
  if (value.unit.empty()) return static_cast<std::int32_t>(value.number);
  const auto units = target.units(axis);
  if (!units) return tl::unexpected(units.error());
  const auto name = parse_parameter(units->parameters(), parameter);
  if (!name) return tl::unexpected(name.error());
  return in_parameter(value, *units, name->number);
}

}  // namespace tmclctl
