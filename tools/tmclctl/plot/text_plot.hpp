/// Curves drawn with characters, one above the other, over the same time.
#pragma once

#include <string>

#include "output/screen.hpp"
#include "plot/picture.hpp"

namespace tmclctl::plot {

/// As wide as the screen, but at most widest_plot columns. Colours only where the screen has them;
/// no other control codes at all.
std::string to_text(const Picture& picture, const Screen& screen);
/// Position above velocity.
std::string to_text(const Recording& recording, const Screen& screen);

constexpr int widest_plot = 120;

}  // namespace tmclctl::plot
