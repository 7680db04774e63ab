/// Positions and speeds as people read them: in the unit of the axis if it has one.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace tmclctl {

struct InUnit {
  double value = 0;
  std::string unit;  ///< "mm" or "mm/s".
  bool operator==(const InUnit&) const = default;
};

/// As a gateway tells a quantity; nothing where that has no unit.
std::optional<InUnit> in_unit(const std::optional<double>& number,
                              const std::optional<std::string>& unit);
/// The same of a speed, of which the unit of length is told.
std::optional<InUnit> in_unit_a_second(const std::optional<double>& number,
                                       const std::optional<std::string>& unit);

/// "10.25". `counted` is the same as the module counts it: one of those is what the last digit
/// stands for. Zeros at the end are left out.
std::string shown_number(double value, double counted);
/// "10.25 mm"
std::string shown(const InUnit& value, double counted);
/// What the module counts, without a unit.
std::string shown(const std::optional<InUnit>& value, std::int64_t counted);

}  // namespace tmclctl
