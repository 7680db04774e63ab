#include "motion/drive/course_watch.hpp"

#include <algorithm>
#include <cmath>

namespace tmcl::plan {

CourseWatch::CourseWatch(const Course& course, CourseSight& sight, std::size_t axes,
                         std::size_t most_seen)
    : course_(course), places_(course), sight_(sight), most_seen_(most_seen) {
  sight_.axes.resize(axes);
  sight_.seen.reserve(most_seen);
}

void CourseWatch::note(std::size_t axis, double off) {
  auto& tracking = sight_.axes[axis];
  ++tracking.readings;
  tracking.largest = std::max(tracking.largest, std::abs(off));
  tracking.squares += off * off;
  off_plan_[axis] = off;
}

// What the axes are off their plan in time is a distance from the path and a delay on it.
void CourseWatch::look(double time, const AxisValues& planned) {
  auto place = planned;
  for (std::size_t axis = 0; axis < sight_.axes.size(); ++axis) place[axis] += off_plan_[axis];
  const auto [off, lag] = places_.nearest(time, place, sight_.largest_off);
  const double passed = std::min(time, course_.duration());
  sight_.largest_lag_s = std::max(sight_.largest_lag_s, lag);
  keep({passed, place, course_.unshaped_at(time - lag).position});
  if (off <= sight_.largest_off) return;
  sight_.largest_off = off;
  sight_.largest_off_at_s = passed;
  sight_.largest_off_at = place;
}

void CourseWatch::keep(const SeenPlace& place) {
  if (most_seen_ == 0 || ++readings_since_kept_ < readings_for_each_kept_) return;
  readings_since_kept_ = 0;
  auto& seen = sight_.seen;
  if (seen.size() == most_seen_) {
    for (std::size_t i = 0; i < seen.size() / 2; ++i) seen[i] = seen[2 * i];
    seen.resize(seen.size() / 2);
    readings_for_each_kept_ *= 2;
  }
  seen.push_back(place);
}

}  // namespace tmcl::plan
