/// Curves and recordings as pictures that stand alone.
#pragma once

#include <string>

#include "plot/picture.hpp"

namespace tmclctl::plot {

/// One SVG document without anything from outside. Its colours can be read on white and on black.
std::string to_svg(const Picture& picture);
/// How high it becomes.
double svg_height(const Picture& picture);
/// Position above velocity.
std::string to_svg(const Recording& recording);

}  // namespace tmclctl::plot
