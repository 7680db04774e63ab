/// Axes one below the other, each in one line that says all about it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "readings.hpp"

namespace tmclctl {

struct AxisLine {
  std::string name;
  std::string state;  ///< Of its module, as axis.list has it; empty: unknown.
  std::optional<AxisReading> reading{};
  /// In its unit, or in microsteps if it has none.
  std::optional<tmcl::SoftLimits> limits{};
};

/// With a line of headings above. `internal`: as modules count.
std::vector<std::string> lines_of(const std::vector<AxisLine>& axes, int width, bool internal);

/// What holds of an axis beside its motion: "FAULT: short_a, lease 7"; empty if nothing does.
std::string flags_text(const AxisReading& reading);

/// "[....#.....]", `width` columns wide; '<' or '>' at its end for what is beyond that.
std::string place_between(double least, double greatest, double value, int width);

}  // namespace tmclctl
