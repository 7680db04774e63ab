/// Curves that are drawn together, whether with characters or as SVG.
#pragma once

#include <string>
#include <vector>

#include "plot/curve.hpp"
#include "plot/recording.hpp"
#include "plot/shown.hpp"

namespace tmclctl::plot {

/// Curves over the same time, one above the other.
struct Picture {
  std::string title;
  std::string time_unit;
  std::vector<Curve> curves;  ///< At least one; named or coloured position, velocity,
                              ///< acceleration, jerk or difference.
  std::vector<Mark> marks;    ///< Ascending by time.
};

/// From top to bottom; as usual if nothing is asked for. Further parameters are below.
Picture picture_of(const Recording& recording, const Shown& shown = {});
/// Draws another axis below.
void add(const Recording& recording, const Shown& shown, Picture& picture);
/// From now on curves are called "x position", after their axis.
void name_after(const std::string& axis, Picture& picture);

}  // namespace tmclctl::plot
