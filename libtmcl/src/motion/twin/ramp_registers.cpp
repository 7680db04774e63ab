#include "tmcl/plan/ramp_registers.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <string>
#include <type_traits>

#include "tmcl/ramp/sixpoint.hpp"
#include "tmcl/ramp/tmc429.hpp"
#include "tmcl/ramp/tmc4361.hpp"
#include "tmcl/ramp/tmc457.hpp"

namespace tmcl::plan {
namespace {

namespace ap = axis_parameter;

// Registers 24.8 and 22.2 of the TMC4361.
constexpr RegisterUnit tmc4361_velocity_unit{1, 256};
constexpr RegisterUnit tmc4361_acceleration_unit{1, 4};

/// Data sheets and tables differ in case and '_': X_TARGET, xtarget.
std::string bare_name(std::string_view text) {
  std::string bare;
  for (const char c : text)
    if (c != '_') bare += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return bare;
}

double ratio(RegisterUnit unit) {
  return static_cast<double>(unit.numerator) / static_cast<double>(unit.denominator);
}

bool is_shown_only(const ParameterInfo& row) {
  return row.access == Access::read || row.number == ap::target_position ||
         row.number == ap::actual_position || row.number == ap::target_velocity ||
         row.number == ap::actual_velocity;
}

}  // namespace

std::optional<RampRegisters> RampRegisters::of(const Model& model) {
  const auto* mode = find_parameter(axis_parameters(model), ap::unit_mode);
  const bool pps = mode == nullptr || mode->initial == 1;
  const auto made = [&]<class G>(std::type_identity<G>, UnitMode unit_mode) {
    return RampRegisters(model, G::chip, G::registers(), unit_mode);
  };
  switch (model.family) {
    case Family::tmc429: return made(std::type_identity<ramp::Tmc429>(), {});
    case Family::tmc457:
      return made(std::type_identity<ramp::Tmc457>(),
                  {tmc457_velocity_unit, tmc457_acceleration_unit, pps});
    case Family::sixpoint:
      return made(std::type_identity<ramp::SixPoint>(),
                  {sixpoint_velocity_unit, sixpoint_acceleration_unit, pps});
    case Family::tmc4361:
      return made(std::type_identity<ramp::Tmc4361>(),
                  {tmc4361_velocity_unit, tmc4361_acceleration_unit, true});
    case Family::firmware: break;
  }
  return std::nullopt;
}

std::optional<std::size_t> RampRegisters::index_of(const ParameterInfo& row) const {
  const auto name = bare_name(row.chip_register);
  // What a module calls so chooses something else.
  if (name == "rampmode" || name == "mode") return std::nullopt;
  const auto found = std::ranges::find_if(
      registers_, [&](const ramp::RegisterInfo& info) { return bare_name(info.name) == name; });
  if (found == registers_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - registers_.begin());
}

double RampRegisters::in_microsteps(const ParameterInfo& row, std::int64_t value,
                                    const ModuleUnits& units) const {
  const bool is_velocity = dimension_of(row) == Dimension::velocity;
  const auto number = static_cast<double>(value);
  switch (model_->family) {
    case Family::tmc457:
      return number * ratio(is_velocity ? tmc457_velocity_unit : tmc457_acceleration_unit);
    case Family::sixpoint:
      return number * ratio(is_velocity ? sixpoint_velocity_unit : sixpoint_acceleration_unit);
    case Family::tmc4361:
      return number * ratio(is_velocity ? tmc4361_velocity_unit : tmc4361_acceleration_unit);
    default: return number * (is_velocity ? units.velocity.value : units.acceleration.value);
  }
}

RegisterWrite RampRegisters::named(std::string_view name, std::int64_t value) const {
  return {ramp::find_register(registers_, name).value_or(0), value};
}

std::vector<RegisterWrite> RampRegisters::turning(std::int64_t velocity) const {
  using ramp::SixPoint;
  switch (model_->family) {
    case Family::tmc429:
      // The firmware opens the limit.
      return {named("mode", 2), named("v_max", 2047), named("v_target", velocity)};
    case Family::tmc457: return {named("mode", 2), named("v_target", velocity)};
    case Family::tmc4361: return {named("rampmode", 2), named("vmax", velocity)};
    default:
      return {named("rampmode",
                    static_cast<std::int64_t>(velocity < 0 ? SixPoint::Mode::velocity_negative
                                                           : SixPoint::Mode::velocity_positive)),
              named("vmax", std::abs(velocity))};
  }
}

std::vector<RegisterWrite> RampRegisters::writes_of(const ParameterInfo& row,
                                                    std::int32_t value) const {
  if (!unit_mode_.accepts(row, value)) return {};
  if (row.number == ap::target_velocity)
    return turning(unit_mode_.in_register(Scale::velocity, value));
  const auto index = index_of(row);
  if (!index) return {};
  const auto number = unit_mode_.write(row.scale, value, registers_[*index]);
  if (!number) return {};
  if (row.number != ap::target_position) return {{*index, *number}};
  const bool is_tmc4361 = model_->family == Family::tmc4361;
  const bool has_short_names = is_tmc4361 || model_->family == Family::sixpoint;
  return {named(has_short_names ? "rampmode" : "mode", is_tmc4361 ? 6 : 0), {*index, *number}};
}

std::vector<RegisterWrite> RampRegisters::initial_writes() const {
  std::vector<RegisterWrite> writes;
  for (const auto& row : axis_parameters(*model_)) {
    if (is_shown_only(row)) continue;
    for (const auto& write : writes_of(row, row.initial)) writes.push_back(write);
  }
  return writes;
}

const ParameterInfo* RampRegisters::row_of(std::size_t index) const {
  const auto table = axis_parameters(*model_);
  const auto row = std::ranges::find_if(table, [&](const ParameterInfo& one) {
    return !is_shown_only(one) && index_of(one) == index;
  });
  return row == table.end() ? nullptr : &*row;
}

}  // namespace tmcl::plan
