#include "tmcl/conversion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

#include "tmcl/correction.hpp"
#include "tmcl/parameter_number.hpp"
#include "tmcl/plain_number.hpp"

namespace tmcl {
namespace {

constexpr std::int32_t tmc429_max_value = 2047;  // of v_max and a_max

constexpr std::size_t longest_unit_name = 16;
constexpr std::string_view pps_name = "microsteps/s";
constexpr std::string_view pps2_name = "microsteps/s^2";

double ratio(RegisterUnit unit) {
  return static_cast<double>(unit.numerator) / static_cast<double>(unit.denominator);
}

ModuleUnits units_of(RegisterUnit velocity, RegisterUnit acceleration) {
  return {{ratio(velocity)}, {ratio(acceleration)}};
}

// Nothing where a rounded value is outside the range or no number.
std::optional<std::int32_t> rounded_within(double value, ValueRange range) {
  const auto whole = std::round(value);
  if (!(whole >= range.least && whole <= range.greatest)) return std::nullopt;
  return static_cast<std::int32_t>(whole);
}

// What is no number is as far from one end as from the other.
std::int32_t nearest_within(double value, ValueRange range) {
  if (!(value > range.least)) return range.least;
  if (value >= range.greatest) return range.greatest;
  return static_cast<std::int32_t>(std::round(value));
}

// `in_unit` brings a whole value back into the unit of the wish.
template <class InUnit>
Reached<std::int32_t> reach(double wished, double value, ValueRange range, std::string_view unit,
                            std::string_view below, std::string_view above, InUnit in_unit) {
  if (const auto whole = rounded_within(value, range)) return *whole;
  const auto nearest = nearest_within(value, range);
  return tl::unexpected(
      OutOfReach{wished, in_unit(nearest), std::string(unit), value > nearest ? above : below});
}

bool is_acceleration(std::string_view name) {
  return name.find("acceleration") != std::string_view::npos ||
         name.find("deceleration") != std::string_view::npos;
}

double microsteps_per_turn(const UserScale& scale) {
  return scale.steps.per_revolution() * scale.gear_ratio;
}

double in_user_units(double microsteps, const UserScale& scale) {
  return microsteps * scale.units_per_revolution / microsteps_per_turn(scale);
}

double in_microsteps(double user_units, const UserScale& scale) {
  return user_units * microsteps_per_turn(scale) / scale.units_per_revolution;
}

bool may_be_in_unit(char c) {
  const bool ascii = static_cast<unsigned char>(c) < 0x80;
  return !ascii || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '%' || c == '_';
}

// Never the negative zero, which people would see.
double directed(double value, const UserScale& scale) {
  return scale.reverse ? 0.0 - value : value;
}

}  // namespace

namespace {

/// In seven digits, if it is no whole number; away from what was wished, so that it is possible.
double shortened(double nearest, double wished) {
  constexpr int digits = 7;
  if (nearest == 0 || !std::isfinite(nearest) || nearest == std::trunc(nearest)) return nearest;
  const double step = std::pow(10, digits - 1 - std::floor(std::log10(std::abs(nearest))));
  const double scaled = nearest * step;
  return (wished > nearest ? std::floor(scaled) : std::ceil(scaled)) / step;
}

}  // namespace

std::string describe(const OutOfReach& error) {
  const auto unit = error.unit.empty() ? "" : ' ' + error.unit;
  return plain_number(error.wished) + unit + " is " + std::string(error.fault) +
         "; the nearest possible value is " + plain_number(shortened(error.nearest, error.wished)) +
         unit;
}

// ---- the module's own units ----

ModuleUnits module_units(Tmc429Dividers dividers) {
  return {to_pps(InternalVelocity{1}, dividers), to_pps2(InternalAcceleration{1}, dividers)};
}

std::vector<std::uint8_t> unit_parameters(const Model& model) {
  if (model.family == Family::tmc429)
    return {number_of("pulse_divisor"), number_of("ramp_divisor")};
  if (find_parameter(axis_parameters(model), axis_parameter::unit_mode) != nullptr)
    return {axis_parameter::unit_mode};
  return {};
}

std::optional<ModuleUnits> module_units(const Model& model, std::span<const std::int32_t> values) {
  const auto numbers = unit_parameters(model);
  if (values.size() != numbers.size()) return std::nullopt;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const auto* row = find_parameter(axis_parameters(model), numbers[i]);
    if (row == nullptr || values[i] < row->minimum || values[i] > row->maximum) return std::nullopt;
  }
  constexpr ModuleUnits in_pps{};
  switch (model.family) {
    case Family::tmc429:
      return module_units(
          {static_cast<std::uint8_t>(values[0]), static_cast<std::uint8_t>(values[1])});
    case Family::tmc457:
      return values.empty() || values[0] == 1
                 ? in_pps
                 : units_of(tmc457_velocity_unit, tmc457_acceleration_unit);
    case Family::sixpoint:
      return values.empty() || values[0] == 1
                 ? in_pps
                 : units_of(sixpoint_velocity_unit, sixpoint_acceleration_unit);
    case Family::tmc4361:
    case Family::firmware: return in_pps;
  }
  return std::nullopt;
}

PulsesPerSecond to_pps(InternalVelocity velocity, const ModuleUnits& units) {
  return {velocity.value * units.velocity.value};
}

PulsesPerSecond2 to_pps2(InternalAcceleration acceleration, const ModuleUnits& units) {
  return {acceleration.value * units.acceleration.value};
}

ModuleUnits initial_units(const Model& model) {
  std::vector<std::int32_t> values;
  for (const auto number : unit_parameters(model)) {
    const auto* row = find_parameter(axis_parameters(model), number);
    if (row != nullptr) values.push_back(row->initial);
  }
  return module_units(model, values).value_or(ModuleUnits{});
}

ValueRange range_of(const ParameterInfo& row, const ModuleUnits& start, const ModuleUnits& now) {
  if (row.scale == Scale::fixed) return {row.minimum, row.maximum};
  const bool is_velocity = row.scale == Scale::velocity;
  const auto factor = is_velocity ? start.velocity.value / now.velocity.value
                                  : start.acceleration.value / now.acceleration.value;
  return {nearest_within(row.minimum * factor, {}), nearest_within(row.maximum * factor, {})};
}

Reached<InternalVelocity> to_internal(PulsesPerSecond velocity, const ModuleUnits& units,
                                      ValueRange range) {
  const auto unit = units.velocity.value;
  return reach(velocity.value, velocity.value / unit, range, pps_name,
               range.least < 0 ? "too fast" : "too slow", "too fast",
               [&](std::int32_t value) { return value * unit; })
      .map([](std::int32_t value) { return InternalVelocity{value}; });
}

Reached<InternalAcceleration> to_internal(PulsesPerSecond2 acceleration, const ModuleUnits& units,
                                          ValueRange range) {
  const auto unit = units.acceleration.value;
  return reach(acceleration.value, acceleration.value / unit, range, pps2_name, "too small",
               "too large", [&](std::int32_t value) { return value * unit; })
      .map([](std::int32_t value) { return InternalAcceleration{value}; });
}

Dimension dimension_of(const ParameterInfo& row) {
  if (row.scale == Scale::velocity || row.unit == "pps") return Dimension::velocity;
  if (row.scale == Scale::acceleration || row.unit == "pps/s") return Dimension::acceleration;
  if (row.unit == "microstep") return Dimension::position;
  if (row.unit != "internal") return Dimension::other;
  return is_acceleration(row.name) ? Dimension::acceleration : Dimension::velocity;
}

// ---- the user's units ----

UserScale revolutions(const UserScale& scale) { return {"rev", 1, scale.reverse, scale.steps}; }

UserScale of_lengths(const UserScale& scale) {
  auto lengths = scale;
  lengths.reverse = false;
  lengths.correction = nullptr;
  return lengths;
}

UserScale microsteps_scale() { return {"microsteps", 1, false, {1, 0}}; }

std::span<const std::string_view> reserved_unit_names() {
  static constexpr std::array<std::string_view, 6> names{"microstep", "microsteps", "rev",
                                                         "pps",       "rps",        "rpm"};
  return names;
}

std::string fault_of_unit_name(std::string_view name) {
  if (name.empty()) return "is empty";
  if (name.size() > longest_unit_name)
    return "has more than " + std::to_string(longest_unit_name) + " bytes";
  if (!std::ranges::all_of(name, may_be_in_unit))
    return "must have letters, '%' and '_' only: neither digits nor '/'";
  const bool taken = std::ranges::count(reserved_unit_names(), name) != 0;
  return taken ? "is one that every axis has already" : "";
}

UserPosition to_user(Microsteps position, const UserScale& scale) {
  const double counted = directed(in_user_units(position.value, scale), scale);
  return {scale.correction ? scale.correction->actual(counted) : counted};
}

UserVelocity to_user(PulsesPerSecond velocity, const UserScale& scale) {
  return {directed(in_user_units(velocity.value, scale), scale)};
}

UserAcceleration to_user(PulsesPerSecond2 acceleration, const UserScale& scale) {
  return {in_user_units(acceleration.value, scale)};
}

Reached<Microsteps> to_microsteps(UserPosition position, const UserScale& scale, ValueRange range) {
  const double counted =
      scale.correction ? scale.correction->counted(position.value) : position.value;
  const auto microsteps = directed(in_microsteps(counted, scale), scale);
  const auto in_unit = [&](std::int32_t value) { return to_user(Microsteps{value}, scale).value; };
  return reach(position.value, microsteps, range, scale.unit, "too far", "too far", in_unit)
      .map([](std::int32_t value) { return Microsteps{value}; });
}

PulsesPerSecond to_pps(UserVelocity velocity, const UserScale& scale) {
  return {directed(in_microsteps(velocity.value, scale), scale)};
}

OutOfReach in_velocity_units(const OutOfReach& error, const UserScale& scale) {
  return {to_user(PulsesPerSecond{error.wished}, scale).value,
          to_user(PulsesPerSecond{error.nearest}, scale).value, scale.unit + "/s", error.fault};
}

OutOfReach in_acceleration_units(const OutOfReach& error, const UserScale& scale) {
  return {to_user(PulsesPerSecond2{error.wished}, scale).value,
          to_user(PulsesPerSecond2{error.nearest}, scale).value, scale.unit + "/s^2", error.fault};
}

PulsesPerSecond2 to_pps2(UserAcceleration acceleration, const UserScale& scale) {
  return {in_microsteps(acceleration.value, scale)};
}

// ---- ramps of a TMC429 ----

ValueRange tmc429_acceleration_range(Tmc429Dividers dividers) {
  const auto exponent = dividers.ramp - dividers.pulse;
  // 2^(exponent - 1), rounded up, and 2^(exponent + 12) - 1.
  const auto lower = exponent <= 1 ? 1 : 1 << (exponent - 1);
  const auto upper = exponent < -12 ? 0 : (1 << (exponent + 12)) - 1;
  return {lower, std::min(upper, tmc429_max_value)};
}

namespace {

template <class Visit>
void for_each_dividers(Visit visit) {
  for (std::uint8_t pulse = 0; pulse <= tmc429_max_divider; ++pulse) {
    for (std::uint8_t ramp = 0; ramp <= tmc429_max_divider; ++ramp) {
      visit(Tmc429Dividers{pulse, ramp});
    }
  }
}

std::optional<InternalVelocity> velocity_with(PulsesPerSecond wish, Tmc429Dividers dividers) {
  const auto value = rounded_within(wish.value / to_pps(InternalVelocity{1}, dividers).value,
                                    {1, tmc429_max_value});
  return value ? std::optional(InternalVelocity{*value}) : std::nullopt;
}

struct Candidate {
  Tmc429Ramp ramp;
  bool fits = false;  // the acceleration is the wish, rounded
};

// With the acceleration that comes nearest. Nothing where the dividers do not give the velocity, or
// have no valid acceleration at all.
std::optional<Candidate> candidate(PulsesPerSecond velocity, PulsesPerSecond2 acceleration,
                                   Tmc429Dividers dividers) {
  const auto v_max = velocity_with(velocity, dividers);
  const auto range = tmc429_acceleration_range(dividers);
  if (!v_max || range.least > range.greatest) return std::nullopt;
  const auto value = acceleration.value / to_pps2(InternalAcceleration{1}, dividers).value;
  return Candidate{{dividers, *v_max, {nearest_within(value, range)}},
                   rounded_within(value, range).has_value()};
}

OutOfReach wrong_velocity(PulsesPerSecond wish) {
  const auto least = to_pps(InternalVelocity{1}, Tmc429Dividers{.pulse = tmc429_max_divider});
  const auto greatest = to_pps(InternalVelocity{tmc429_max_value}, Tmc429Dividers{});
  const bool is_fast = wish > least;
  return {wish.value, is_fast ? greatest.value : least.value, std::string(pps_name),
          is_fast ? "too fast for a TMC429" : "too slow for a TMC429"};
}

OutOfReach wrong_acceleration(PulsesPerSecond2 wish, PulsesPerSecond2 nearest) {
  return {wish.value, nearest.value, std::string(pps2_name),
          wish > nearest ? "too large an acceleration for the velocity"
                         : "too small an acceleration for the velocity"};
}

}  // namespace

Reached<Tmc429Ramp> choose_tmc429_ramp(PulsesPerSecond velocity, PulsesPerSecond2 acceleration) {
  const auto quality = [&](const Candidate& it) {
    const auto v_error = std::abs(it.ramp.velocity().value - velocity.value);
    const auto a_error = std::abs(it.ramp.acceleration().value - acceleration.value);
    const auto [pulse, ramp] = it.ramp.dividers;
    // What misses the acceleration only counts for how far it misses it.
    return std::tuple(!it.fits, it.fits ? v_error : a_error, it.fits ? a_error : v_error, -pulse,
                      +ramp);
  };
  std::optional<Candidate> best;
  for_each_dividers([&](Tmc429Dividers dividers) {
    const auto next = candidate(velocity, acceleration, dividers);
    if (next && (!best || quality(*next) < quality(*best))) best = next;
  });
  if (!best) return tl::unexpected(wrong_velocity(velocity));
  if (best->fits) return best->ramp;
  return tl::unexpected(wrong_acceleration(acceleration, best->ramp.acceleration()));
}

}  // namespace tmcl
