#include "motion/drive/course_segments.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tmcl::plan {
namespace {

// While the rate of the course changes, an axis is told a speed so often, in updates.
constexpr int updates_of_a_change = 2;

}  // namespace

bool CourseBends::jumps_at(double time) const {
  const auto before = course_->at(time - instant).velocity;
  const auto after = course_->at(time + instant).velocity;
  for (std::size_t axis = 0; axis < course_->axes(); ++axis) {
    if (std::abs(after[axis] - before[axis]) > jump_part * course_->top_speed(axis)) return true;
  }
  return false;
}

CourseBends::CourseBends(const Course& course, double joint_s)
    : course_(&course),
      joint_s_(joint_s),
      parts_(std::max<std::size_t>(course.impulses().size(), 1)) {
  for (std::size_t i = 0; i < course.impulses().size(); ++i)
    parts_[i].delay = course.impulses()[i].delay;
}

double CourseBends::not_before(double time) {
  double first = course_->duration();
  for (auto& part : parts_)
    first = std::min(first, part.delay + not_before(time - part.delay, part));
  return first;
}

double CourseBends::not_before(double time, Part& part) const {
  return std::min(leg_not_before(time, part), course_->plain_bend_not_before(time));
}

double CourseBends::leg_not_before(double time, Part& part) const {
  for (; part.leg < course_->legs(); ++part.leg) {
    const auto leg = course_->leg(part.leg);
    if (time <= leg.begin) return leg.begin;
    const double joint = leg.begin + joint_s_;
    if (time <= joint && leg.up > 2 * joint_s_ && jumps_at(leg.begin + part.delay)) return joint;
    const double slows_down = leg.end - leg.down;
    if (time <= slows_down && leg.down > 0) return slows_down;
    if (time <= leg.end) return leg.end;
  }
  return std::numeric_limits<double>::infinity();
}

PathState at_rate(double rate, PathState state) {
  for (auto& velocity : state.velocity) velocity *= rate;
  return state;
}

SegmentSpan CourseSegments::from(TimePoint begin) {
  const bool goes_on = clock_.is_steady() && !clock_.is_at_halt_at(begin);
  return goes_on ? of_course(begin) : of_change(begin);
}

SegmentSpan CourseSegments::of_course(TimePoint begin) {
  const double passed = clock_.passed_at(begin);
  const double rate = clock_.rate();
  const double period = rate * seconds(period_);
  SegmentSpan span{};
  span.begin = begin;
  span.steady = true;
  span.rate = rate;
  const double first = bends_.not_before(passed + instant);
  span.course_end = first;
  if (first < passed + period) {
    const double next = bends_.not_before(passed + period);
    span.course_end = next < passed + 2 * period ? next : passed + period;
  }
  if (const auto* halt = clock_.next_halt())
    span.course_end = std::min(span.course_end, halt->time);
  span.end = begin + duration(clock_.time_between(passed, span.course_end));
  span.at_end = at_rate(rate, course_.at(span.course_end - instant));
  span.at_end.position = course_.at(span.course_end).position;
  const bool jumps = bends_.jumps_at(passed);
  span.smooth = first == span.course_end && !jumps;
  if (jumps) span.early = duration(shortest_segment_ramp * seconds(period_) / 2);
  return span;
}

SegmentSpan CourseSegments::of_change(TimePoint begin) const {
  SegmentSpan span{};
  span.begin = begin;
  span.end = begin + updates_of_a_change * period_;
  span.course_end = clock_.passed_at(span.end);
  span.at_end.position = course_.at(span.course_end).position;
  const auto before = course_.at(clock_.passed_at(span.end - period_)).position;
  for (std::size_t axis = 0; axis < course_.axes(); ++axis)
    span.at_end.velocity[axis] = (span.at_end.position[axis] - before[axis]) / seconds(period_);
  return span;
}

}  // namespace tmcl::plan
