/// A recording as a picture that stands alone: position above velocity, over the same time.
#pragma once

#include <string>

#include "plot/recording.hpp"

namespace tmclctl::plot {

/// One SVG document without anything from outside. Its colours can be read on white and on black.
std::string to_svg(const Recording& recording);

/// With &, <, >, " and ' replaced, and without what XML does not allow at all.
std::string escape_xml(const std::string& text);

}  // namespace tmclctl::plot
