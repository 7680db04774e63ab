/// Where the axes of a course are seen, by one of the ways to see them.
#pragma once

#include "motion/drive/place_on_path.hpp"
#include "tmcl/plan/stream.hpp"

namespace tmcl::plan {

class CourseWatch {
 public:
  /// Both must outlive it; `most_seen` as in StreamOptions.
  CourseWatch(const Course& course, CourseSight& sight, std::size_t axes, std::size_t most_seen);

  /// An axis is seen so far off its plan, in units.
  void note(std::size_t axis, double off);
  /// Takes it as it was noted last: for an axis that this way does not see.
  void assume(std::size_t axis, double off) { off_plan_[axis] = off; }
  /// With all axes as they were noted last, `planned` where they were to be then, at this time of
  /// the course.
  void look(double time, const AxisValues& planned);

 private:
  void keep(const SeenPlace& seen);

  const Course& course_;
  PlaceFinder places_;
  CourseSight& sight_;
  std::size_t most_seen_;
  AxisValues off_plan_{};
  std::size_t readings_for_each_kept_ = 1;
  std::size_t readings_since_kept_ = 0;
};

}  // namespace tmcl::plan
