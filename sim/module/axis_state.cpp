#include "sim/module/axis_state.hpp"

#include <algorithm>
#include <cstdlib>

namespace tmcl::sim {

AxisState::AxisState(const Model& model, Stage& stage, TimePoint begin,
                     const ModuleTraits& variants)
    : family(model.family),
      traits(variants),
      wraps(concerns(Trait::range_check, model) &&
            variants.get<RangeCheck>(Trait::range_check, model) == RangeCheck::wrap),
      table(axis_parameters(model)),
      motor(make_motor(model, begin, variants)),
      coupling(*motor, stage),
      power_on(begin),
      now(begin),
      rest(begin) {}

std::int32_t AxisState::kept(const ParameterInfo& row) const {
  return (wraps && is_remembered(row)) || overruled(row) ? values[row.number] : in_force(row);
}

std::uint32_t AxisState::speed() const {
  const auto* row = find_parameter(table, axis_parameter::actual_velocity);
  return row == nullptr ? 0 : static_cast<std::uint32_t>(std::abs(kept(*row)));
}

std::int32_t AxisState::in_force(const ParameterInfo& row) const {
  return motor->read(row).value_or(values[row.number]);
}

std::optional<Wrapped> AxisState::accepted(const ParameterInfo& row, std::int32_t value) const {
  if (row.scale != Scale::fixed || is_in_range(row, value)) return Wrapped{value, value};
  return wraps ? wrapped(row, value) : std::nullopt;
}

// The firmware keeps what was set, whatever its motors do.
std::optional<std::int32_t> AxisState::overruled(const ParameterInfo& row) const {
  const auto stop = traits.find(Trait::limit_stop);
  if (!stop || stop == index_of(LimitStop::as_set) || row.name != "soft_stop") return std::nullopt;
  return stop == index_of(LimitStop::soft) ? 1 : 0;
}

std::int32_t AxisState::in_motor(const ParameterInfo& row, std::int32_t value) const {
  return overruled(row).value_or(value);
}

// A motor that stood and goes on standing has done so for as long as it has.
void AxisState::look_ahead() {
  outlook = motor->outlook();
  if (outlook.rest > now || rest > now) rest = outlook.rest;
}

// A model that does not tell its mode is in no other one of which it matters.
bool AxisState::goes_to_new_target() const {
  if (traits.find(Trait::velocity_target) != index_of(VelocityTarget::goes_there)) return false;
  constexpr std::int32_t velocity_mode = 2;
  const auto row = std::ranges::find(table, "ramp_mode", &ParameterInfo::name);
  return row == table.end() || kept(*row) == velocity_mode;
}

std::int32_t AxisState::relative_origin() const {
  const auto from = traits.find(Trait::relative_from);
  if (!from) return motor->relative_origin();
  return from == index_of(RelativeFrom::actual)
             ? motor->position()
             : kept(*find_parameter(table, axis_parameter::target_position));
}

}  // namespace tmcl::sim
