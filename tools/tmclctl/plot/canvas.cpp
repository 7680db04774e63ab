#include "plot/canvas.hpp"

#include <algorithm>
#include <cstdlib>

namespace tmclctl::plot {
namespace {

// U+2800 and up: each dot of a character has a bit, and the lowest row came later than the others.
constexpr unsigned braille_bits[4][2] = {{0x01, 0x08}, {0x02, 0x10}, {0x04, 0x20}, {0x40, 0x80}};

std::string braille(unsigned bits) {
  return {static_cast<char>(0xE2), static_cast<char>(0xA0U | bits >> 6U),
          static_cast<char>(0x80U | (bits & 0x3FU))};
}

char ascii(bool upper, bool lower) {
  if (upper && lower) return ':';
  if (upper) return '\'';
  return lower ? '.' : ' ';
}

}  // namespace

Canvas::Canvas(int columns, int rows, bool utf8)
    : columns_(columns),
      rows_(rows),
      utf8_(utf8),
      dots_across_(utf8 ? 2 : 1),
      dots_down_(utf8 ? 4 : 2) {
  dots_.resize(static_cast<std::size_t>(width()) * static_cast<std::size_t>(height()));
}

std::size_t Canvas::index(int x, int y) const {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(width()) +
         static_cast<std::size_t>(x);
}

bool Canvas::dot(int x, int y) const {
  return x >= 0 && x < width() && y >= 0 && y < height() && dots_[index(x, y)];
}

void Canvas::set(int x, int y) {
  if (x >= 0 && x < width() && y >= 0 && y < height()) dots_[index(x, y)] = true;
}

void Canvas::line(int x0, int y0, int x1, int y1) {
  const int steps = std::max({std::abs(x1 - x0), std::abs(y1 - y0), 1});
  // Half a step is added so that dividing rounds to the nearest dot.
  const auto between = [steps](int from, int to, int i) {
    const int doubled = 2 * (to - from) * i;
    return from + (doubled + (doubled >= 0 ? steps : -steps)) / (2 * steps);
  };
  for (int i = 0; i <= steps; ++i) set(between(x0, x1, i), between(y0, y1, i));
}

std::string Canvas::row(int index) const {
  std::string text;
  std::size_t used = 0;
  for (int column = 0; column < columns_; ++column) {
    unsigned bits = 0;
    for (int down = 0; down < dots_down_; ++down) {
      for (int across = 0; across < dots_across_; ++across) {
        if (dot(column * dots_across_ + across, index * dots_down_ + down))
          bits |= braille_bits[down][across];
      }
    }
    if (bits == 0) {
      text += ' ';
      continue;
    }
    text += utf8_ ? braille(bits) : std::string(1, ascii((bits & 1U) != 0, (bits & 2U) != 0));
    used = text.size();
  }
  return text.substr(0, used);
}

}  // namespace tmclctl::plot
