#include "motion/drive/place_on_path.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tmcl::plan {
namespace {

constexpr int steps_near = 20;
constexpr int steps_far = 200;
constexpr double path_step_s = 0.005;
// Distances that differ by less are the same, in units.
constexpr double same_distance = 1e-9;

PlaceOnPath nearest_within(int steps, const Course& course, double time, const AxisValues& place) {
  PlaceOnPath nearest{std::numeric_limits<double>::infinity(), 0};
  auto begin = course.unshaped_at(time - steps * path_step_s).position;
  for (int step = -steps; step < steps; ++step) {
    const auto end = course.unshaped_at(time + (step + 1) * path_step_s).position;
    double squares = 0, along = 0, off = 0;
    for (std::size_t axis = 0; axis < course.axes(); ++axis) {
      const double way = end[axis] - begin[axis];
      squares += way * way;
      along += (place[axis] - begin[axis]) * way;
    }
    const double part = squares > 0 ? std::clamp(along / squares, 0.0, 1.0) : 0;
    for (std::size_t axis = 0; axis < course.axes(); ++axis)
      off = std::hypot(off, place[axis] - std::lerp(begin[axis], end[axis], part));
    // Where the path stands, all times are as near: the one that was planned is meant.
    const double lag = -(step + part) * path_step_s;
    const bool sooner = std::abs(lag) < std::abs(nearest.lag_s);
    if (off < nearest.off - same_distance || (off < nearest.off + same_distance && sooner))
      nearest.lag_s = lag;
    nearest.off = std::min(nearest.off, off);
    begin = end;
  }
  return nearest;
}

}  // namespace

PlaceOnPath place_on_path(const Course& course, double time, const AxisValues& place,
                          double known) {
  const auto nearest = nearest_within(steps_near, course, time, place);
  return nearest.off <= known ? nearest : nearest_within(steps_far, course, time, place);
}

}  // namespace tmcl::plan
