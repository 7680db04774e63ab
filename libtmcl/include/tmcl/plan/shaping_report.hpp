/// What input shaping, or a jerk, makes of a course, and of a load that swings.
#pragma once

#include <optional>

#include "tmcl/plan/course.hpp"

namespace tmcl::plan {

struct ShapingReport {
  double longer_s = 0;    ///< Than the course takes without it.
  double farthest = 0;    ///< From the path, in units: corners are cut.
  double at_s = 0;        ///< When that is.
  AxisValues swing{};     ///< Of the load of each axis after the course, to either side, in units.
  AxisValues unshaped{};  ///< The same without the shaping.
};

/// `course` was made with a shaping; `resonance`: of the load behind each of its axes.
ShapingReport report_on_shaping(const Course& course, const ramp::Resonance& resonance);

struct JerkReport {
  double longer_s = 0;     ///< Than the course takes without it.
  AxisValues swing{};      ///< Of the load of each axis after the course, to either side, in units.
  AxisValues unlimited{};  ///< The same without the jerk.
};

/// `unlimited` is the same without a jerk. Without a resonance nothing is said of swings.
JerkReport report_on_jerk(const Course& course, const Course& unlimited,
                          const std::optional<ramp::Resonance>& resonance);

}  // namespace tmcl::plan
