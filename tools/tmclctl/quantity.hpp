/// Positions, velocities and accelerations as a person types them: a number and perhaps a unit.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "failure.hpp"
#include "tmcl/mechanics.hpp"
#include "tmcl/model.hpp"

namespace tmclctl {

struct Quantity {
  double number = 0;
  std::string unit;  ///< Such as "mm", "rev" or "pps"; empty: what the module counts in.

  bool operator==(const Quantity&) const = default;
};

/// What it was typed as, or might have been: "10mm".
std::string to_string(const Quantity& quantity);
/// Without a unit the number is whole and has 32 bits. Otherwise a sentence on what is wrong.
tl::expected<Quantity, std::string> parse_quantity(std::string_view text);
/// What its unit measures; other if it has none.
tmcl::Dimension dimension_of(const Quantity& quantity);

/// What an axis counts in.
struct AxisUnits {
  std::string axis;
  const tmcl::Model* model = nullptr;       ///< Null for a model that is not known.
  std::optional<tmcl::ModuleUnits> module;  ///< Nothing where they are not known.
  /// Nothing where the microsteps of a turn are not known. Its unit is empty if the axis has none.
  std::optional<tmcl::UserScale> scale;
  /// Only tmcld's configuration has them; in its unit, in microsteps for an axis without one.
  std::optional<tmcl::SoftLimits> limits{};
  /// Nothing where what the encoder reads is in microsteps.
  std::optional<double> encoder_counts_per_unit{};

  /// What the limits are in.
  tmcl::UserScale limits_scale() const;
  /// The parameters of the model; empty for one that is not known.
  std::span<const tmcl::ParameterInfo> parameters() const;
};

/// Each gives the value that comes nearest. Errors: a unit that the axis does not have, or that
/// measures something else; a value that does not fit, with the nearest that does.
Attempt<tmcl::Microsteps> to_microsteps(const Quantity& quantity, const AxisUnits& units,
                                        tmcl::ValueRange range);
Attempt<tmcl::PulsesPerSecond> to_pps(const Quantity& quantity, const AxisUnits& units);
Attempt<tmcl::PulsesPerSecond2> to_pps2(const Quantity& quantity, const AxisUnits& units);

/// For a parameter of the axis' model: its number as the module wants it. Parameters that are never
/// negative have no direction.
Attempt<std::int32_t> to_parameter(const Quantity& quantity, const AxisUnits& units,
                                   const tmcl::ParameterInfo& row);

/// And back: in the unit of the axis, or in turns if it has none. Errors: a parameter that is
/// neither a position nor a velocity nor an acceleration; units that are not known.
Attempt<Quantity> from_parameter(std::int32_t value, const AxisUnits& units,
                                 const tmcl::ParameterInfo& row);

/// What the library says of this velocity or acceleration, told in the unit that it was typed in.
Failure out_of_reach(const Quantity& quantity, const AxisUnits& units, tmcl::OutOfReach error);

}  // namespace tmclctl
