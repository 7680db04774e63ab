/// Positions, velocities and accelerations with their units: "12.5mm", "300 rpm", "100um/s^2".
///
/// Every axis has microsteps and rev, turns of its motor; pps, rps and rpm are these per second and
/// per minute. A unit of its own comes from its configuration: lengths (um, mm, cm, m, in) convert
/// into each other, and so do angles (deg, rad); any other unit only into itself. Behind a unit,
/// "/s" is per second, and "/s^2", "/s/s" or "/s2" per second squared.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "tmcl/conversion.hpp"
#include "tmcl/error.hpp"
#include "tmcl/mechanics.hpp"
#include "tmcl/model.hpp"
#include "tmcl/parameter.hpp"

namespace tmcl {

struct Quantity {
  double number = 0;
  std::string unit;  ///< Such as "mm", "mm/s" or "pps"; empty: what the module counts in.
  bool operator==(const Quantity&) const = default;
};
/// "12.5mm": parse_quantity() makes the same quantity of it.
std::string to_string(const Quantity& quantity);
/// What its unit measures; other if it has none.
Dimension dimension_of(const Quantity& quantity);
/// Whether a turn of the motor means nothing to it: microsteps, pps, and what has no unit.
bool is_in_microsteps(const Quantity& quantity);

/// The unit of a velocity or an acceleration where positions are in `unit`: "mm/s", "mm/s^2".
std::string unit_of(Dimension dimension, const std::string& unit);
/// The same for what a parameter holds. Empty for one that is neither a position nor a velocity nor
/// an acceleration.
std::string unit_of(const ParameterInfo& row, const std::string& unit);

/// What to try where a wish is beyond what a register holds in microsteps: the finest resolution
/// below `present` (as parameter 140 has it) with which it `fits`, asked with the share of the
/// microsteps that there are then. Empty where none does.
std::string hint_of_resolution(std::int32_t present, const std::function<bool(double share)>& fits);

/// A finite decimal number, then perhaps blanks, then perhaps a unit. Whether an axis has that unit
/// is not known here. Errors: bad_quantity, decimal_comma, not_finite, two_units.
Result<Quantity> parse_quantity(std::string_view text);

/// What an axis is measured in, and what its module counts in.
struct AxisUnits {
  std::string axis;                     ///< What it is called.
  const Model* model = nullptr;         ///< Null for a model that is not known.
  std::optional<ModuleUnits> module{};  ///< Nothing where they are not known.
  /// Nothing where the microsteps of a turn are not known. Its unit is empty if the axis has none.
  std::optional<UserScale> scale{};
  /// In its unit, in microsteps for an axis without one.
  std::optional<SoftLimits> limits{};
  /// Nothing where what the encoder reads is in microsteps.
  std::optional<double> encoder_counts_per_unit{};

  bool has_unit() const { return scale && !scale->unit.empty(); }
  /// What the limits are in.
  UserScale limits_scale() const { return has_unit() ? *scale : microsteps_scale(); }
  /// The parameters of the model; empty for one that is not known.
  std::span<const ParameterInfo> parameters() const;
  /// The same for what holds in both directions, such as a limit.
  AxisUnits undirected() const;
};

/// bare_number: a quantity without a unit, where the axis measures in `unit`. Zero is the same in
/// every unit, so that is not repeated.
Error bare_number(const Quantity& quantity, Dimension dimension, const std::string& unit);

/// The number in the unit of the axis; nothing for units that do not convert into that.
std::optional<double> in_own_unit(const Quantity& quantity, const AxisUnits& units);

// Each gives the value that comes nearest. Where the axis has no unit of its own, a whole number
// without a unit is what the module counts. Errors: bare_number; bad_quantity for a fraction of
// what the module counts; unknown_unit, also where a conversion is not known; wrong_unit for one
// that measures something else; out_of_range, with the nearest value that is possible.

Result<Microsteps> to_microsteps(const Quantity& quantity, const AxisUnits& units,
                                 ValueRange range = {});
Result<PulsesPerSecond> to_pps(const Quantity& quantity, const AxisUnits& units);
Result<PulsesPerSecond2> to_pps2(const Quantity& quantity, const AxisUnits& units);
/// For a parameter of the axis' model: what the module is to hold. Parameters that are never
/// negative have no direction.
Result<std::int32_t> to_parameter(const Quantity& quantity, const AxisUnits& units,
                                  const ParameterInfo& row);

/// And back: in the unit of the axis, or in turns if it has none. Errors: wrong_unit for a
/// parameter that is neither a position nor a velocity nor an acceleration; unknown_unit.
Result<Quantity> from_parameter(std::int32_t value, const AxisUnits& units,
                                const ParameterInfo& row);

/// What the library says of this velocity or acceleration, told in the unit that it was said in.
Error out_of_reach(const Quantity& quantity, const AxisUnits& units, OutOfReach error);

}  // namespace tmcl
