/// A path file as a function of time: where each axis is to be when.
///
/// Lines are passed by path.hpp's plans, from rest to rest between dwells. A table with times is
/// passed as it says: between its rows each axis follows a cubic that meets the rows with a common
/// velocity, stands at both ends, and never leaves the range between two rows (Fritsch and Carlson,
/// "Monotone piecewise cubic interpolation", 1980).
///
/// A shaped course (shaping.hpp) is the mean of that at several times: no faster and no steeper,
/// but later, and it cuts corners.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <tl/expected.hpp>

#include "tmcl/plan/path.hpp"
#include "tmcl/plan/path_file.hpp"
#include "tmcl/plan/shaping.hpp"

namespace tmcl::plan {

/// How much faster than its limits an axis may be in a table with times: rounding of what was
/// typed.
constexpr double timetable_slack = 1e-6;

/// One leg of a course, in the values of ramp generators.
struct CourseLeg {
  double begin = 0;
  double end = 0;
  double up = 0;         ///< How long it speeds up from its begin.
  double down = 0;       ///< How long before its end it begins to slow down.
  std::size_t line = 0;  ///< Of the file.
  bool speeds_up = false;
  bool slows_down = false;
  double start_speed = 0;  ///< Along the path, as the other speeds.
  double peak_speed = 0;
  double end_speed = 0;
  double mean_speed = 0;
  double acceleration = 0;
  std::array<AxisRamp, most_path_axes> axis{};
};

/// Where two legs meet.
struct Corner {
  double time = 0;
  double speed = 0;      ///< Along the axes that make the path's length.
  std::size_t line = 0;  ///< Of the leg that ends here.
  AxisValues position{};
};

/// Where an axis turns round, or has come to its end.
struct Turn {
  double time = 0;
  double position = 0;
};

/// Where a course waits, from when until when.
struct CourseRest {
  double begin = 0;
  double end = 0;
};

/// Where the time of a course stands until something has been done.
struct CourseHalt {
  double time = 0;
  std::size_t line = 0;   ///< Of the file.
  std::uint8_t word = 0;  ///< The number of the M word: see path_file::Dwell.
  bool waits() const { return word == 0; }
};

class Course {
 public:
  /// `path` has no arcs. No line is passed faster than `feed`, by the axes that make its length.
  /// Where the path dwells, a shaped course stands as long. Errors: a sentence that names the line.
  static tl::expected<Course, std::string> of(const path_file::Path& path, const PathLimits& limits,
                                              double feed = std::numeric_limits<double>::infinity(),
                                              const std::optional<Shaping>& shaping = std::nullopt);

  std::size_t axes() const { return axes_; }
  double duration() const;
  /// What it holds of memory.
  std::size_t bytes() const;
  /// Of the axes that make it: of the others where none of those moves is not counted.
  double length() const { return length_; }
  /// What its axes keep to.
  const PathLimits& limits() const { return limits_; }
  /// Before 0 the start, after the duration the end; both at rest.
  PathState at(double t) const;
  PathMotion motion_at(double t) const;
  /// The same without its shaping, when that comes to about the same place.
  PathState unshaped_at(double t) const;
  /// Without the shaping: PathPlan::bend_not_before().
  double plain_bend_not_before(double t) const;
  /// None if it is not shaped.
  const std::vector<Impulse>& impulses() const { return impulses_; }
  /// The greatest magnitude of an axis' velocity.
  double top_speed(std::size_t axis) const { return top_speed_[axis]; }
  AxisValues least() const { return least_; }
  AxisValues greatest() const { return greatest_; }
  /// The ends of the stretches on which the axis goes one way; the last is that of the course.
  std::span<const Turn> turns(std::size_t axis) const { return turns_[axis]; }

  /// Of a table with times there are none.
  bool has_legs() const { return !timed_; }
  std::size_t legs() const { return legs_.size(); }
  /// Without the shaping.
  CourseLeg leg(std::size_t index) const;
  /// The last leg that has begun by then; nothing before the first one.
  std::optional<std::size_t> leg_at(double t) const;
  /// Of the file, then or before; nothing in a table with times.
  std::optional<std::size_t> line_at(double t) const;
  /// Along the path, by the axes that make its length; in a table with times by all.
  double speed_at(double t) const;
  /// The first dwell that has not ended by then.
  std::optional<CourseRest> rest_after(double t) const;
  /// In the order in which they come; several may be at one time. The course is at rest there.
  std::span<const CourseHalt> halts() const { return halts_; }
  /// How long it dwells from then on, all in all.
  double resting_after(double t) const;
  /// The slowest corners between two legs, at most so many, ascending by speed.
  std::vector<Corner> slowest_corners(std::size_t most) const;

 private:
  struct Rest {
    AxisValues position{};
    double duration = 0;
  };
  struct Row {
    double time = 0;
    AxisValues position{};
    AxisValues velocity{};
  };
  using Timetable = std::vector<Row>;
  struct Piece {
    double begin = 0;
    double rested = 0;  // in the pieces before it
    std::variant<PathPlan, Rest, Timetable> what;
  };
  struct LegPlace {
    std::size_t piece = 0;
    std::size_t leg = 0;
    std::size_t line = 0;
    double stretch = 1;  // the way of all axes, in ways of those that make the path's length
  };
  class Maker;
  class Shaped;

  static double duration_of(const Piece& piece);
  static PathMotion motion_at(const Timetable& rows, double t);
  const Piece& piece_at(double t) const;
  double plain_duration() const;
  PathState plain_at(double t) const;
  PathMotion plain_motion_at(double t) const;
  /// The times at which a speed may bend, ascending; each once or more.
  std::vector<double> plain_bends() const;
  void shape(const Shaping& shaping);
  double begin_of(const LegPlace& place) const;

  std::size_t axes_ = 0;
  PathLimits limits_;
  bool timed_ = false;
  double length_ = 0;
  AxisValues top_speed_{};
  AxisValues least_{};
  AxisValues greatest_{};
  std::array<std::vector<Turn>, most_path_axes> turns_;
  std::vector<Piece> pieces_;
  std::vector<LegPlace> legs_;
  std::vector<CourseHalt> halts_;
  std::vector<Impulse> impulses_;
};

}  // namespace tmcl::plan
