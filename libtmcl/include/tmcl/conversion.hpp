/// From what a module counts in to what people measure in, and back.
///
/// Reading a module's value as microsteps and seconds is exact. What is written is rounded once, to
/// the nearest value that can be written, ties away from zero. Nothing accumulates: convert the
/// absolute position each time, and never add up converted distances.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "tmcl/model.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/units.hpp"

namespace tmcl {

class Correction;

/// A wish that cannot be met.
struct OutOfReach {
  double wished = 0;       ///< In `unit`.
  double nearest = 0;      ///< The nearest value that is possible, in `unit`.
  std::string unit;        ///< Such as "microsteps/s".
  std::string_view fault;  ///< Such as "too fast".

  /// Otherwise a position, or an acceleration.
  bool is_velocity() const { return unit.ends_with("/s"); }
};
/// "1e6 microsteps/s is too fast; the nearest possible value is 499755.859375 microsteps/s"
std::string describe(const OutOfReach& error);

template <class T>
using Reached = tl::expected<T, OutOfReach>;

// ---- the module's own units ----

/// What one unit of a module's velocities and accelerations is; exact.
struct ModuleUnits {
  PulsesPerSecond velocity{1};
  PulsesPerSecond2 acceleration{1};
  bool operator==(const ModuleUnits&) const = default;
};

/// The units of the parameters of a TMC429; dividers 0..13.
ModuleUnits module_units(Tmc429Dividers dividers);
/// The axis parameters that say what a module counts in: 154 and 153 on a TMC429, the unit mode
/// 255 on modules that have one, none where that is always microsteps per second.
std::vector<std::uint8_t> unit_parameters(const Model& model);
/// The units of a module whose unit_parameters() have these values, in that order. Nothing for a
/// value that they cannot have, and for another number of values.
std::optional<ModuleUnits> module_units(const Model& model, std::span<const std::int32_t> values);

/// Exact.
PulsesPerSecond to_pps(InternalVelocity velocity, const ModuleUnits& units);
/// Exact for every value up to 2^25; beyond, to the nearest double.
PulsesPerSecond2 to_pps2(InternalAcceleration acceleration, const ModuleUnits& units);

/// What a parameter may hold.
struct ValueRange {
  std::int32_t least = INT32_MIN;
  std::int32_t greatest = INT32_MAX;
  bool operator==(const ValueRange&) const = default;
};
/// The range of a parameter while the module counts in `now`. `start` is what it counts in after
/// power-up, which the table's ranges are in.
ValueRange range_of(const ParameterInfo& row, const ModuleUnits& start, const ModuleUnits& now);
/// What a module counts in until that is changed.
ModuleUnits initial_units(const Model& model);

/// To the nearest. Errors: a rounded value outside the range; what is no number.
Reached<InternalVelocity> to_internal(PulsesPerSecond velocity, const ModuleUnits& units,
                                      ValueRange range = {});
Reached<InternalAcceleration> to_internal(PulsesPerSecond2 acceleration, const ModuleUnits& units,
                                          ValueRange range = {});

/// What kind of quantity a parameter holds.
enum class Dimension : std::uint8_t { other, position, velocity, acceleration };
/// Positions are those in microsteps.
Dimension dimension_of(const ParameterInfo& row);

// ---- the user's units ----

/// The most full steps that a turn can have, and the finest microstep resolution.
constexpr std::int32_t max_full_steps = 100'000;
constexpr std::int32_t max_microstep_resolution = 8;

/// How many microsteps a turn of the motor has.
struct MotorSteps {
  std::int32_t full_steps = 200;                       ///< Of a turn: 1..max_full_steps.
  std::int32_t resolution = max_microstep_resolution;  ///< Axis parameter 140: 2^n microsteps.

  constexpr std::int32_t per_revolution() const { return full_steps << resolution; }
  bool operator==(const MotorSteps&) const = default;
};

struct UserPosition {
  double value = 0;
  auto operator<=>(const UserPosition&) const = default;
};
/// User units per second.
struct UserVelocity {
  double value = 0;
  auto operator<=>(const UserVelocity&) const = default;
};
/// User units per second squared.
struct UserAcceleration {
  double value = 0;
  auto operator<=>(const UserAcceleration&) const = default;
};

/// How the units of a user lie along an axis.
struct UserScale {
  std::string unit = "rev";         ///< What people call it.
  double units_per_revolution = 1;  ///< Of what the motor drives, behind the gear; greater than 0.
  bool reverse = false;             ///< Positive positions lie in the motor's negative direction.
  MotorSteps steps;
  double gear_ratio = 1;  ///< Turns of the motor for one of what it drives; greater than 0.
  /// Of positions, in the unit; null: they are where the steps say. Speeds are not corrected.
  std::shared_ptr<const Correction> correction{};

  double units_per_motor_revolution() const { return units_per_revolution / gear_ratio; }

  bool operator==(const UserScale&) const = default;
};
/// The same motor and direction, measured in revolutions of the motor.
UserScale revolutions(const UserScale& scale);
/// Microsteps as units, in the motor's own direction.
UserScale microsteps_scale();
/// The same for what holds in both directions and anywhere, such as a length or a limit.
UserScale of_lengths(const UserScale& scale);
/// Why a unit of a user cannot be called this, such as "is too long"; empty if it can. A name has 1
/// to 16 bytes, letters, '%', '_' and whatever is not ASCII, and is none of the units that there
/// are already, such as "rev" or "pps".
std::string fault_of_unit_name(std::string_view name);
/// The units that every axis has: microstep, microsteps, rev, pps, rps and rpm.
std::span<const std::string_view> reserved_unit_names();

UserPosition to_user(Microsteps position, const UserScale& scale);
UserVelocity to_user(PulsesPerSecond velocity, const UserScale& scale);
/// An acceleration has no direction, here and below: `reverse` means nothing to it.
UserAcceleration to_user(PulsesPerSecond2 acceleration, const UserScale& scale);

/// To the nearest microstep. Errors: outside the range.
Reached<Microsteps> to_microsteps(UserPosition position, const UserScale& scale,
                                  ValueRange range = {});
PulsesPerSecond to_pps(UserVelocity velocity, const UserScale& scale);
/// An error in microsteps per second as one in the user's units per second.
OutOfReach in_velocity_units(const OutOfReach& error, const UserScale& scale);
PulsesPerSecond2 to_pps2(UserAcceleration acceleration, const UserScale& scale);
/// The same per second squared.
OutOfReach in_acceleration_units(const OutOfReach& error, const UserScale& scale);

// ---- ramps of a TMC429 ----

/// The values of a_max with which a motor stops on its target without oscillating: from
/// 2^(ramp_div - pulse_div - 1) to 2^(ramp_div - pulse_div + 12) - 1, within 1..2047; TMC429 data
/// sheet. With some dividers there is none: then the least is greater than the greatest.
ValueRange tmc429_acceleration_range(Tmc429Dividers dividers);

/// Register values of a TMC429, and what they give.
struct Tmc429Ramp {
  Tmc429Dividers dividers;
  InternalVelocity v_max;      ///< 1..2047
  InternalAcceleration a_max;  ///< Within tmc429_acceleration_range(dividers).

  PulsesPerSecond velocity() const { return to_pps(v_max, dividers); }
  PulsesPerSecond2 acceleration() const { return to_pps2(a_max, dividers); }
  bool operator==(const Tmc429Ramp&) const = default;
};

/// The dividers and register values that come nearest to a wish: to the velocity first, to the
/// acceleration among those. Where several are as near, the greatest pulse_div, because speeds have
/// the most steps then, and the least ramp_div, because the ramp has the shortest ticks then.
/// Errors: a velocity that no dividers give, rounded to a register value; an acceleration that none
/// of the dividers that give the velocity can, and the nearest that one of them can.
Reached<Tmc429Ramp> choose_tmc429_ramp(PulsesPerSecond velocity, PulsesPerSecond2 acceleration);

}  // namespace tmcl
