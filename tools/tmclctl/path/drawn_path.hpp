/// Where what the file draws is nearest to a point of a course, and how far that is.
#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include "tmcl/plan/course.hpp"
#include "tmcl/plan/path_file.hpp"

namespace tmclctl::path {

/// Lines and arcs as they are in the file. A course passes an arc in chords, and the rows of a
/// table with times in cubics.
class DrawnPath {
 public:
  /// Of the course that was planned from it.
  DrawnPath(tmcl::plan::path_file::Path path, const tmcl::plan::Course& course);

  using Point = tmcl::plan::path_file::Point;
  /// Chords and cubics are computed: nearer than this they are on the line.
  static constexpr double rounding = 1e-9;
  struct Nearest {
    Point point{};  ///< Axes that do not make the length of the path are as in the position.
    double distance = 0;
  };
  /// To a position that the course has at this time, on the line or the arc that it passes then.
  /// Times ascend. On an arc it is the point at the angle of the position.
  Nearest nearest(double time, const tmcl::plan::AxisValues& position);

 private:
  struct Part {
    Point from{};
    tmcl::plan::path_file::Element element;
    double end = 0;        ///< Of the line of a table with times, in seconds.
    std::size_t line = 0;  ///< Of the file.
  };

  void find_part(double time);
  Nearest on_part(const Part& part, const Point& position) const;
  Nearest on_line(const Part& part, const Point& target, const Point& position) const;
  Nearest on_arc(const Part& part, const tmcl::plan::path_file::ArcTo& arc,
                 const Point& position) const;

  const tmcl::plan::Course& course_;
  std::size_t axes_;
  std::vector<Part> parts_;
  std::map<std::size_t, std::size_t> part_of_line_;
  std::size_t leg_ = 0;
  std::size_t part_ = 0;
};

}  // namespace tmclctl::path
