/// Two axes in their plane: y over x, both on the same scale.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "plot/picture.hpp"

namespace tmclctl::plot {

/// Points in the order in which they are passed; as many x as y.
struct Way {
  std::vector<double> x;
  std::vector<double> y;
};

struct MarkedPlace {
  double x = 0;
  double y = 0;
  std::string label;
};

/// At least one of the two ways has points.
struct Plane {
  std::string title;
  std::string x_name;  ///< With its unit: "x [mm]".
  std::string y_name;
  Way planned;                          ///< Drawn as a line, a dashed one if something was seen.
  Way seen;                             ///< Drawn as dots; one that would hide another is left out.
  std::optional<MarkedPlace> marked{};  ///< Where it was farthest off; drawn as a ring.
  Way enlarged{};                       ///< How far it was off, enlarged; a line.
  std::string enlarged_name{};          ///< "ten times off"
};

std::string to_svg(const Plane& plane);
/// The plane above the picture, under the plane's title.
std::string to_svg(const Plane& plane, const Picture& picture);

}  // namespace tmclctl::plot
