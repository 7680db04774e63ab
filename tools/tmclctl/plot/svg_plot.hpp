/// Curves and recordings as pictures that stand alone.
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
  std::vector<Curve> curves;  ///< At least one; named position, velocity, acceleration or jerk.
  std::vector<Mark> marks;    ///< Ascending by time.
};

/// One SVG document without anything from outside. Its colours can be read on white and on black.
std::string to_svg(const Picture& picture);
/// Position above velocity.
std::string to_svg(const Recording& recording);

/// With &, <, >, " and ' replaced, and without what XML does not allow at all.
std::string escape_xml(const std::string& text);

}  // namespace tmclctl::plot
