/// Curves that are drawn together, whether with characters or as SVG.
#pragma once

#include <string>
#include <vector>

#include "plot/recording.hpp"

namespace tmclctl::plot {

/// A time that is pointed out.
struct Mark {
  double time;
  std::string label;
};

/// Curves over the same time, one above the other.
struct Picture {
  std::string title;
  std::string time_unit;
  std::vector<Curve> curves;  ///< At least one; named or coloured position, velocity,
                              ///< acceleration, jerk or difference.
  std::vector<Mark> marks;    ///< Ascending by time.
};

/// Position above velocity.
Picture picture_of(const Recording& recording);

}  // namespace tmclctl::plot
