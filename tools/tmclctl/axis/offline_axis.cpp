#include "offline_axis.hpp"

#include <bit>

#include <fmt/format.h>

#include "axis_names.hpp"
#include "tmcl/spelling.hpp"

namespace tmclctl {
namespace {

namespace ap = tmcl::axis_parameter;

std::int32_t resolution_of(const verb::OfflineAxis& axis, const tmcl::AxisUnits& units) {
  if (axis.microsteps) return std::countr_zero(static_cast<std::uint32_t>(*axis.microsteps));
  const auto* row = find_parameter(units.parameters(), ap::microstep_resolution);
  return row == nullptr ? tmcl::max_microstep_resolution : row->initial;
}

}  // namespace

Result<tmcl::AxisUnits> axis_units_of(const verb::OfflineAxis& axis) {
  const auto model = parse_model(axis.model);
  if (!model) return tl::unexpected(model.error());
  tmcl::AxisUnits units{"of a " + std::string((*model)->name), *model, initial_units(**model)};
  tmcl::UserScale scale;
  scale.unit.clear();
  scale.steps = {axis.full_steps, resolution_of(axis, units)};
  scale.gear_ratio = axis.gear_ratio;
  if (axis.has_scale()) {
    scale.unit = axis.unit.empty() ? "mm" : axis.unit;
    scale.units_per_revolution = axis.screw_pitch.value_or(axis.units_per_revolution.value_or(1));
    if (const auto fault = tmcl::fault_of_unit_name(scale.unit); !fault.empty()) {
      return tl::unexpected(
          usage_error("usage", fmt::format("--unit {} {}", tmcl::quoted(scale.unit), fault)));
    }
  }
  units.scale = scale;
  return units;
}

Result<TypedQuantity> typed_quantity(const std::string& text, const tmcl::AxisUnits& units) {
  return attempt(tmcl::parse_quantity(text)).map([&](tmcl::Quantity quantity) {
    TypedQuantity typed{std::move(quantity), units};
    if (typed.quantity.unit.empty()) typed.units.scale.reset();
    return typed;
  });
}

}  // namespace tmclctl
