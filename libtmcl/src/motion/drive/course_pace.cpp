#include "motion/drive/course_pace.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tmcl::plan {
namespace {

constexpr double unbounded = std::numeric_limits<double>::infinity();
// Where a course has more legs in the time that it takes to get slower, it is not passed faster.
constexpr std::size_t most_legs_ahead = 1000;

AxisValues way_of(const Course& course, const CourseLeg& leg) {
  const auto from = course.at(leg.begin).position;
  AxisValues way{};
  for (std::size_t axis = 0; axis < course.axes(); ++axis)
    way[axis] = leg.axis[axis].target - from[axis];
  return way;
}

double length_of(const AxisValues& way, std::size_t axes) {
  double length = 0;
  for (std::size_t axis = 0; axis < axes; ++axis) length = std::hypot(length, way[axis]);
  return length;
}

}  // namespace

double CoursePace::most_on_leg(const CourseLeg& leg) const {
  double most = unbounded;
  for (std::size_t axis = 0; axis < course_->axes(); ++axis) {
    if (leg.axis[axis].vmax > 0)
      most = std::min(most, course_->limits().axis[axis].velocity / leg.axis[axis].vmax);
  }
  return std::max(most, 1.0);
}

// Where the leg begins. The plan may have been slower there than the corner is.
double CoursePace::most_in_corner(std::size_t index) const {
  const auto leg = course_->leg(index);
  if (index == 0 || leg.start_speed == 0) return 1;
  auto from = way_of(*course_, course_->leg(index - 1)), to = way_of(*course_, leg);
  const double before = length_of(from, course_->axes()), after = length_of(to, course_->axes());
  for (std::size_t axis = 0; axis < course_->axes(); ++axis)
    from[axis] /= before, to[axis] /= after;
  const double speed = corner_speed(from, to, std::min(before, after), course_->limits());
  return std::max(speed / leg.start_speed, 1.0);
}

double CoursePace::most_rate(double passed, double slope, double most) const {
  const auto first = course_->leg_at(passed);
  // A jerk would be greater by the cube of the rate.
  const bool is_smooth = std::isfinite(course_->limits().jerk);
  if (most <= 1 || is_smooth || !course_->has_legs() || !first) return std::min(most, 1.0);
  // The square of the rate, for that changes evenly on the way.
  double square = most * most;
  const auto keep = [&](double rate, double at) {
    square = std::min(square, rate * rate + 2 * slope * (std::max(at, passed) - passed));
  };
  const double farthest = passed + (most * most - 1) / (2 * slope);
  for (std::size_t index = *first; index < course_->legs(); ++index) {
    const auto leg = course_->leg(index);
    if (leg.begin > farthest) break;
    if (index - *first >= most_legs_ahead) keep(1, leg.begin);
    if (index - *first >= most_legs_ahead) break;
    if (leg.begin >= passed) keep(most_in_corner(index), leg.begin);
    if (leg.up > 0 && passed < leg.begin + leg.up) keep(1, leg.begin);
    if (passed < leg.end - leg.down) keep(most_on_leg(leg), leg.begin + leg.up);
    if (leg.down > 0) keep(1, leg.end - leg.down);
  }
  return std::sqrt(std::max(square, 1.0));
}

CoursePace::Changes CoursePace::changes(double passed, double rate) const {
  const auto motion = course_->motion_at(passed);
  Changes bounds{-unbounded, unbounded};
  for (std::size_t axis = 0; axis < course_->axes(); ++axis) {
    const double velocity = std::abs(motion.velocity[axis]);
    const double planned =
        std::copysign(1.0, motion.velocity[axis]) * motion.acceleration[axis] * rate * rate;
    const double most = course_->limits().axis[axis].acceleration;
    if (velocity == 0) continue;
    bounds.least = std::max(bounds.least, std::min(0.0, (-most - planned) / velocity));
    bounds.most = std::min(bounds.most, std::max(0.0, (most - planned) / velocity));
  }
  return bounds;
}

}  // namespace tmcl::plan
