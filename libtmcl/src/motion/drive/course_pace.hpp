/// How fast the time of a course may go, and how fast that may change, so that no axis is faster or
/// steeper than its limits.
///
/// At the rate r an axis has r times the planned velocity v, and r^2 a + r' v instead of the
/// planned acceleration a. A course needs all that an axis has where it speeds up or slows down:
/// there it goes no faster than planned, and by then it has become as slow.
#pragma once

#include "tmcl/plan/course.hpp"

namespace tmcl::plan {

class CoursePace {
 public:
  /// `course` must outlive it.
  explicit CoursePace(const Course& course) : course_(&course) {}

  /// The greatest rate there, at least 1, and `most` at most, from which it gets slower in time if
  /// the rate changes by `slope` in a second.
  double most_rate(double passed, double slope, double most) const;
  /// By how much a rate may change in a second.
  struct Changes {
    double least;
    double most;
  };
  Changes changes(double passed, double rate) const;

 private:
  double most_on_leg(const CourseLeg& leg) const;
  double most_in_corner(std::size_t leg) const;

  const Course* course_;
};

}  // namespace tmcl::plan
