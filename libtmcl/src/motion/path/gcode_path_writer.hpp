/// The path that a program of G-code makes, as it grows.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "tmcl/plan/path_file.hpp"

namespace tmcl::plan::path_file::gcode {

/// Puts a stop between two movements where G61 or G61.1 holds. Positions are of all axes, in mm and
/// degrees, until the end.
class PathWriter {
 public:
  explicit PathWriter(const Point& start) : at_(start) { path_.start = start; }

  void begin_line(std::size_t number) { line_ = number; }
  /// G61, G61.1 or G64, in tenths.
  void set_corners(int code) { corners_ = code; }
  /// The path has this axis, whether it moves or not.
  void use(std::size_t axis) { used_[axis] = true; }
  const Point& at() const { return at_; }
  /// Where the next movement begins, although nothing leads there.
  void go_on_from(const Point& at) { at_ = at; }
  void dwell(double seconds, std::optional<std::uint8_t> word = {});
  /// Nothing if it is there.
  void line_to(const Point& target, std::optional<double> feed = {});
  void arc_to(ArcTo arc);
  bool is_too_long() const { return path_.elements.size() > most_elements; }

  /// Of the axes in use alone.
  Path finish();

 private:
  void add(Element element);
  Point packed(const Point& all) const;

  Path path_;
  Point at_;
  std::optional<Point> line_from_{};  ///< Where the line that ends here began.
  std::array<bool, most_axes> used_{};
  int corners_ = 640;
  std::size_t line_ = 0;
};

}  // namespace tmcl::plan::path_file::gcode
