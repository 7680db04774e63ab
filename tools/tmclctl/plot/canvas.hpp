/// A drawing made of characters: braille has eight dots in each, ASCII two.
#pragma once

#include <string>
#include <vector>

namespace tmclctl::plot {

class Canvas {
 public:
  Canvas(int columns, int rows, bool utf8);

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  /// In dots.
  int width() const { return columns_ * dots_across_; }
  int height() const { return rows_ * dots_down_; }

  /// A straight line between two dots, both included; (0, 0) is at the top left. What lies outside
  /// is left out.
  void line(int x0, int y0, int x1, int y1);
  bool dot(int x, int y) const;

  /// One row of characters, without the blanks at its end.
  std::string row(int index) const;

 private:
  void set(int x, int y);
  std::size_t index(int x, int y) const;

  int columns_;
  int rows_;
  bool utf8_;
  int dots_across_;
  int dots_down_;
  std::vector<bool> dots_;
};

}  // namespace tmclctl::plot
