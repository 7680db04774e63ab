/// A way in a plane, as SVG.
#pragma once

#include <string>
#include <vector>

#include "plot/picture.hpp"

namespace tmclctl::plot {

struct Drawing {
  std::string title;
  std::string across;  ///< What the axes of the drawing are called.
  std::string upward;
  std::vector<double> x;  ///< At least one; as many as of y.
  std::vector<double> y;
};

/// The drawing, in which a unit is as long across as upward, above the picture.
std::string to_svg(const Drawing& drawing, const Picture& picture);

}  // namespace tmclctl::plot
