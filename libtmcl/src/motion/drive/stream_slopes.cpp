// A stream by segments: which speeds and accelerations lead an axis where it is to be.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "motion/drive/ramp_legs.hpp"
#include "motion/drive/segment_runner.hpp"
#include "tmcl/plain_number.hpp"

namespace tmcl::plan {
namespace {

// A ramp that takes no more of its segment than this may be replaced by a steeper one.
constexpr double most_of_segment = 2. / 3;
// How far a speed may be beyond those at the begin and the end, in parts of the greatest one.
constexpr double catching_up = 0.1;
// A generator brakes a little earlier for its target than it would have to.
constexpr double spare_braking = 1.1;
// How much steeper than by its own acceleration an axis may get to where it should be.
constexpr double spare_slope = 1.1;
// A stop takes so much longer than by the axis' own acceleration, at most.
constexpr double most_stop_ramps = 2;

}  // namespace

double SegmentRunner::own_slope(std::size_t axis) const {
  double own = std::numeric_limits<double>::infinity();
  for (const auto parameter : guidance_of(axes_[axis].family).accelerations)
    own = std::min(own, acceleration_of(axis, settings_[axis].before(parameter)));
  return own;
}

// Where the course is smooth it would stay behind on each ramp, and brake as slowly.
SegmentRunner::Fault SegmentRunner::objection_to_slope(std::size_t axis) const {
  const double own = own_slope(axis) / std::abs(axes_[axis].microsteps_per_unit);
  const double planned = course_.limits().axis[axis].acceleration;
  if (planned <= spare_slope * own) return std::nullopt;
  return fault(DriveFault::Kind::unsuited, axis,
               fmt::format("has an acceleration of {}, and the path was planned with {}",
                           plain_number(own, 4), plain_number(planned, 4)));
}

double SegmentRunner::greatest_slope(std::size_t axis, bool smooth) const {
  const auto& info = axes_[axis];
  if (smooth) return spare_slope * own_slope(axis);
  return std::max(own_slope(axis), acceleration_of(axis, greatest_acceleration_of(info)));
}

// A stop brakes an axis by the acceleration that it has then. What is no ramp of the
// course, or of a pause, does not leave it with one that would take long.
double SegmentRunner::least_slope(std::size_t axis, const SegmentSpan& span, double speed) const {
  if (!span.steady) return 0;
  const double scale = std::abs(axes_[axis].microsteps_per_unit);
  const double top = std::max(course_.top_speed(axis) * scale, 1.0);
  const double least = own_slope(axis) * std::min(std::abs(speed) / top, 1.0) / most_stop_ramps;
  const double time = seconds(span.end - span.begin);
  const double begin = span.course_end - span.rate * time + instant;
  const double before = span.rate * course_.at(begin).velocity[axis];
  const double planned = std::abs(span.at_end.velocity[axis] - before) * scale;
  return planned > jump_part * top ? std::min(least, planned / time) : least;
}

// Without it the axis would go beyond its target, where it turns round there, or brake for it while
// the course still goes on.
double SegmentRunner::braking_needed(std::size_t axis, const SegmentSpan& span,
                                     double speed) const {
  const auto& here = guided_[axis];
  const auto& guidance = guidance_of(axes_[axis].family);
  const auto begin = told_at(axis, span);
  const double before = expected_speed(axis, begin);
  if (!guidance.by_targets) return 0;
  const auto needed = [&](double fast, double from, double spare) {
    return fast * fast / (2 * std::max(std::abs(here.target - from) - spare, 1.0));
  };
  const double stands_at = expected(axis, begin);
  // Others brake for their target with an acceleration of its own, but not for a speed of 0.
  const bool stops = before * speed < 0 || std::abs(speed) < axes_[axis].units.velocity.value;
  if (guidance.slowing != guidance.accelerations.back())
    return stops ? needed(before, stands_at, 1) : 0;
  // It may be a little farther than expected, and the next command comes after this segment's end.
  const double spare = options_.even_within * std::abs(axes_[axis].microsteps_per_unit);
  const double late_s = seconds(report_.round_trip) * static_cast<double>(axes_.size() + 1);
  const double end = span.at_end.position[axis] * axes_[axis].microsteps_per_unit;
  return std::max(spare_braking * needed(speed, end, spare + std::abs(speed) * late_s),
                  needed(before, stands_at, spare));
}

// By the slope that there is, and not farther beyond the speeds of the course than a correction
// brings it back: the next segment makes up for what is missing. If the ramp takes most of the
// time, each difference would cost too much.
double SegmentRunner::speed_for(std::size_t axis, const SegmentSpan& span, const SegmentTask& task,
                                const Segment& wanted) const {
  const double slope = slope_now(axis, wanted.speed);
  const double top = course_.top_speed(axis) * std::abs(axes_[axis].microsteps_per_unit);
  const double change = std::abs(wanted.speed - task.speed);
  auto speed = speed_by(slope, task).value_or(wanted.speed);
  if (change > most_of_segment * slope * task.time_s) speed = wanted.speed;
  const double begin = clock_.passed_at(span.begin) + instant;
  const double planned =
      clock_.rate() * course_.at(begin).velocity[axis] * axes_[axis].microsteps_per_unit;
  const auto [least, most] = std::minmax(planned, task.end_speed);
  const double undone =
      greatest_slope(axis, true) * updates_of_a_correction * seconds(report_.period);
  const double beyond = std::min(catching_up * top, undone);
  return without_overtaking(axis, task, std::clamp(speed, least - beyond, most + beyond));
}

// If an axis makes up for what it is behind, it is faster than the course at the end: by no more
// than what the acceleration that the course leaves takes away again on the way that is missing.
double SegmentRunner::without_overtaking(std::size_t axis, const SegmentTask& task,
                                         double speed) const {
  const double slope = slope_now(axis, speed);
  const double within = options_.even_within * std::abs(axes_[axis].microsteps_per_unit);
  const double left = left_by_course(axis, greatest_slope(axis, false));
  const auto overtakes = [&](double told) {
    const double ramp = slope > 0 ? std::min(std::abs(told - task.speed) / slope, task.time_s) : 0;
    const double way = told * task.time_s + (task.speed - told) * ramp / 2;
    const double beyond = told - task.end_speed;
    const double missing = std::max(0.0, std::copysign(task.way - way, (task.way - way) * beyond));
    return beyond * beyond > 2 * left * (missing + within);
  };
  if (!overtakes(speed)) return speed;
  auto [allowed, refused] = std::pair(0.0, 1.0);
  while (refused - allowed > 1e-3) {
    const double part = (allowed + refused) / 2;
    (overtakes(std::lerp(task.end_speed, speed, part)) ? refused : allowed) = part;
  }
  return std::lerp(task.end_speed, speed, allowed);
}

// Also if it was told to stop, and has not come to rest.
bool SegmentRunner::turns(std::size_t axis, double speed) const {
  return guided_[axis].motion.end_speed * speed < 0 || expected_speed(axis, now_) * speed < 0;
}

double SegmentRunner::slope_now(std::size_t axis, double speed) const {
  const auto& guidance = guidance_of(axes_[axis].family);
  const double faster = acceleration_now(axis, guidance.accelerations.front());
  const double slower = acceleration_now(axis, guidance.slowing);
  if (turns(axis, speed)) return std::min(faster, slower);
  return std::abs(speed) < std::abs(guided_[axis].motion.end_speed) ? slower : faster;
}

StreamScript SegmentRunner::set_slopes(std::size_t axis, double speed, double slope,
                                       double braking) {
  const auto& guidance = guidance_of(axes_[axis].family);
  const auto faster = guidance.accelerations.front();
  const double before = guided_[axis].motion.end_speed;
  const bool is_turn = turns(axis, speed);
  Fault refused;
  if (faster == guidance.slowing || is_turn || std::abs(speed) > std::abs(before))
    refused = co_await set_slope(axis, faster, slope);
  if (refused || faster == guidance.slowing) co_return refused;
  if (is_turn || std::abs(speed) < std::abs(before)) {
    refused = co_await set_slope(axis, guidance.slowing, slope);
  } else if (slope_now(axis, 0) < braking) {
    refused = co_await set_slope(axis, guidance.slowing, braking);
  }
  co_return refused;
}

StreamScript SegmentRunner::set_slope(std::size_t axis, std::uint8_t parameter, double slope) {
  auto& here = guided_[axis];
  const double scale = std::abs(axes_[axis].microsteps_per_unit);
  const auto most =
      std::max(settings_[axis].before(parameter), greatest_acceleration_of(axes_[axis]));
  const auto value = acceleration_in(axes_[axis], slope / scale, most);
  auto refused = co_await set(axis, {parameter, value});
  if (refused) co_return refused;
  here.motion = motion_at(axis, middle());
  here.motion.slope = acceleration_of(axis, value);
  co_return std::nullopt;
}

SegmentTask SegmentRunner::task_of(std::size_t axis, const SegmentSpan& span) const {
  const double scale = axes_[axis].microsteps_per_unit;
  const auto begin = told_at(axis, span);
  const double least_s = shortest_segment_ramp * seconds(report_.period);
  return {expected_speed(axis, begin), span.at_end.velocity[axis] * scale,
          span.at_end.position[axis] * scale - expected(axis, begin),
          std::max(seconds(span.end - begin), least_s), least_s};
}

}  // namespace tmcl::plan
