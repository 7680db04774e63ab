/// What axis parameters are in the unit of their axis.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "tmcl/conversion.hpp"
#include "tmcl/mechanics.hpp"
#include "tmcl/model.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/quantity.hpp"

namespace tmcl {

/// What an axis is measured in, and what its module counts in.
struct AxisScale {
  const Model* model = nullptr;       ///< Not null.
  UserScale scale;                    ///< With a unit.
  std::optional<ModuleUnits> module;  ///< Nothing where that is not known.
  /// Nothing where what the encoder reads is in microsteps.
  std::optional<double> encoder_counts_per_unit{};
};

struct UserValue {
  double value = 0;
  std::string unit;  ///< "mm", "mm/s" or "mm/s^2".
};

/// Parameters that are never negative hold in both directions: `reverse` means nothing to them.
/// Nothing for a parameter without a unit, and where what the module counts in is not known.
std::optional<UserValue> to_user(std::int32_t value, const ParameterInfo& row,
                                 const AxisScale& axis);

/// And back, to the nearest value that the module can hold; only for what to_user() knows. Errors:
/// a rounded value outside the range, in the unit.
Reached<std::int32_t> to_parameter(double value, const ParameterInfo& row, const AxisScale& axis);

}  // namespace tmcl
