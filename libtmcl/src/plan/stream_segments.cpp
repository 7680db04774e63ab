// A stream of velocities that tells an axis as little as a course has segments: at the begin of
// each, the speed that it is to have from then on, and the acceleration with which it gets there.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "plan/stream_runner.hpp"

namespace tmcl::plan {
namespace {

namespace ap = axis_parameter;

// The least part of an update that a change of speed takes, where the course has a joint.
constexpr double shortest_segment_ramp = 0.5;
// A joint is where a speed jumps by more than this part of the greatest one.
constexpr double jump_part = 0.02;
// An axis is checked, and told a velocity.
constexpr std::size_t segment_commands_of_an_axis = 2;
// A ramp that takes no more of its segment than this may be replaced by a steeper one.
constexpr double most_of_segment = 2. / 3;
// How far a speed may be beyond those at the begin and the end, in parts of the greatest one.
constexpr double catching_up = 0.1;
// A generator brakes a little earlier for its target than it would have to.
constexpr double spare_braking = 1.1;
// In so many updates an axis is back where it should be.
constexpr int updates_of_a_correction = 6;
// How much steeper than by its own acceleration an axis may get to where it should be.
constexpr double spare_slope = 1.1;
// A stop takes so much longer than by the axis' own acceleration, at most.
constexpr double most_stop_ramps = 2;
// During a pause an axis is told a speed so often, in updates.
constexpr int updates_of_a_pause = 2;
constexpr Duration longest_way_to_target = std::chrono::milliseconds(200);
// Before and after a joint, in seconds.
constexpr double instant = 1e-9;
// By then a course that has been passed is so in the numbers of the clock, too.
constexpr Duration at_the_end = std::chrono::microseconds(1);

}  // namespace

// ---- the segments of a course ----

bool CourseBends::jumps_at(double time) const {
  const auto before = course_->at(time - instant).velocity;
  const auto after = course_->at(time + instant).velocity;
  for (std::size_t axis = 0; axis < course_->axes(); ++axis) {
    if (std::abs(after[axis] - before[axis]) > jump_part * course_->top_speed(axis)) return true;
  }
  return false;
}

double CourseBends::not_before(double time) {
  for (; leg_ < course_->legs(); ++leg_) {
    const auto leg = course_->leg(leg_);
    if (time <= leg.begin) return leg.begin;
    const double joint = leg.begin + joint_s_;
    if (time <= joint && leg.up > 2 * joint_s_ && jumps_at(leg.begin)) return joint;
    const double slows_down = leg.end - leg.down;
    if (time <= slows_down && leg.down > 0) return slows_down;
    if (time <= leg.end) return leg.end;
  }
  return course_->duration();
}

PathStream::Runner::SegmentSpan PathStream::Runner::span_from(TimePoint begin) {
  return clock_.is_at_full_rate() ? span_of_course(begin) : span_of_pause(begin);
}

PathStream::Runner::SegmentSpan PathStream::Runner::span_of_course(TimePoint begin) {
  const double passed = clock_.passed_at(begin);
  const double period = seconds(report_.period);
  SegmentSpan span{};
  span.begin = begin;
  span.full_rate = true;
  const double first = bends_.not_before(passed + instant);
  span.course_end = first;
  if (first < passed + period) {
    const double next = bends_.not_before(passed + period);
    span.course_end = next < passed + 2 * period ? next : passed + period;
  }
  span.end = begin + duration(span.course_end - passed);
  span.at_end = course_.at(span.course_end - instant);
  span.at_end.position = course_.at(span.course_end).position;
  const bool jumps = bends_.jumps_at(passed);
  span.smooth = first == span.course_end && !jumps;
  if (jumps) span.early = duration(shortest_segment_ramp * period / 2);
  return span;
}

PathStream::Runner::SegmentSpan PathStream::Runner::span_of_pause(TimePoint begin) const {
  SegmentSpan span{};
  span.begin = begin;
  span.end = begin + updates_of_a_pause * report_.period;
  span.course_end = clock_.passed_at(span.end);
  span.at_end.position = course_.at(span.course_end).position;
  const auto before = course_.at(clock_.passed_at(span.end - report_.period)).position;
  for (std::size_t axis = 0; axis < axes_.size(); ++axis)
    span.at_end.velocity[axis] =
        (span.at_end.position[axis] - before[axis]) / seconds(report_.period);
  return span;
}

// ---- before anything moves ----

Script<DriveRunner::Fault> PathStream::Runner::prepare_segments() {
  if (!course_.has_legs()) {
    co_return fault(DriveFault::Kind::unsuited, {},
                    "segments need a path without times; use velocity mode");
  }
  std::size_t slopes = 0;
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    const auto& guidance = guidance_of(axes_[axis].info.family);
    slopes += guidance.slowing == guidance.accelerations.front() ? 1U : 2U;
    for (const auto parameter : guidance.accelerations) {
      auto unknown = co_await know(axis, parameter);
      if (unknown) co_return unknown;
    }
    auto refused = co_await prepare_ramp(axis);
    if (refused) co_return refused;
  }
  const auto commands = segment_commands_of_an_axis * axes_.size() + slopes + 1;
  report_.period = std::max(options_.period_min, duration(time_to_send(commands)));
  bends_ = CourseBends(course_, seconds(report_.period));
  set_pause_ramp();
  // Where the generator has an acceleration of its own for the way to the target, that must not
  // make it brake before the course does.
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    const auto& guidance = guidance_of(axes_[axis].info.family);
    const auto braking = guidance.accelerations.back();
    if (braking == guidance.slowing) continue;
    auto refused = co_await set(axis, {braking, axes_[axis].info.greatest_acceleration});
    if (refused) co_return refused;
  }
  co_return std::nullopt;
}

// ---- on the way ----

Script<DriveRunner::Fault> PathStream::Runner::by_segments() {
  auto wrong = co_await set_out();
  if (wrong) co_return wrong;
  // The clock starts when the first velocity is told.
  const auto lead = report_.period;
  clock_.start(now_ + lead, clock_.paused());
  auto span = span_from(now_ + lead);
  while (true) {
    wrong = co_await pass_segment(span);
    if (wrong) co_return wrong;
    ++report_.updates;
    if (clock_.passed() >= course_.duration()) break;
    const bool is_last = span.full_rate && span.course_end >= course_.duration();
    wrong = co_await watch_segment(span, is_last ? span.end + at_the_end : span.end - lead);
    if (wrong) co_return wrong;
    if (clock_.passed() >= course_.duration()) break;
    const bool on_time = span.full_rate == clock_.is_at_full_rate();
    const auto planned = on_time ? span.end : now_ + lead;
    wrong = note_delay(now_ + lead - planned, report_.period);
    if (wrong) co_return wrong;
    const auto begin = std::max(planned, now_ + report_.round_trip);
    span = span_from(begin);
  }
  wrong = co_await end_by_targets();
  co_return wrong;
}

// A stop could lead beyond them. An axis that creeps is stopped all the same.
Script<DriveRunner::Fault> PathStream::Runner::end_by_targets() {
  const auto limit = now_ + longest_way_to_target;
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    while (has_targets(axis) && now_ < limit) {
      co_await command({Kind::get, axis, ap::actual_velocity, 0});
      if (!answer_) co_return refusal(axis);
      if (*answer_ == 0) break;
      co_await until(now_ + report_.period);
    }
  }
  co_return std::nullopt;
}

// When its velocity takes effect: the axes share the time around the begin.
TimePoint PathStream::Runner::told_at(std::size_t axis, const SegmentSpan& span) const {
  const auto others = 2 * axes_[axis].place - static_cast<int>(axes_.size()) + 1;
  const auto planned = span.begin - span.early + others * report_.round_trip;
  return std::max(planned, now_ + report_.round_trip / 2);
}

SegmentTask PathStream::Runner::task_of(std::size_t axis, const SegmentSpan& span) const {
  const auto& here = axes_[axis];
  const double scale = here.info.microsteps_per_unit;
  const auto begin = told_at(axis, span);
  const double least_s = shortest_segment_ramp * seconds(report_.period);
  return {here.motion.speed_at(begin), span.at_end.velocity[axis] * scale,
          span.at_end.position[axis] * scale - expected(axis, begin),
          std::max(seconds(span.end - begin), least_s), least_s};
}

double PathStream::Runner::own_slope(std::size_t axis) const {
  double own = std::numeric_limits<double>::infinity();
  for (const auto parameter : guidance_of(axes_[axis].info.family).accelerations)
    own = std::min(own, acceleration_of(axis, settings_[axis].before(parameter)));
  return own;
}

double PathStream::Runner::greatest_slope(std::size_t axis, bool smooth) const {
  const auto& info = axes_[axis].info;
  if (smooth) return spare_slope * own_slope(axis);
  return std::max(own_slope(axis), acceleration_of(axis, greatest_acceleration_of(info)));
}

// A stop brakes an axis by the acceleration that it has then. What is no ramp of the
// course, or of a pause, does not leave it with one that would take long.
double PathStream::Runner::least_slope(std::size_t axis, const SegmentSpan& span,
                                       double speed) const {
  if (!span.full_rate) return 0;
  const double scale = std::abs(axes_[axis].info.microsteps_per_unit);
  const double top = std::max(course_.top_speed(axis) * scale, 1.0);
  const double least = own_slope(axis) * std::min(std::abs(speed) / top, 1.0) / most_stop_ramps;
  const double time = seconds(span.end - span.begin);
  const double before = course_.at(span.course_end - time + instant).velocity[axis];
  const double planned = std::abs(span.at_end.velocity[axis] - before) * scale;
  return planned > jump_part * top ? std::min(least, planned / time) : least;
}

// Without it the axis would go beyond its target, where it turns round there, or brake for it while
// the course still goes on.
double PathStream::Runner::braking_needed(std::size_t axis, const SegmentSpan& span,
                                          double speed) const {
  const auto& here = axes_[axis];
  const auto& guidance = guidance_of(here.info.family);
  const auto begin = told_at(axis, span);
  const double before = here.motion.speed_at(begin);
  if (!guidance.by_targets) return 0;
  const auto needed = [&](double fast, double from, double spare) {
    return fast * fast / (2 * std::max(std::abs(here.target - from) - spare, 1.0));
  };
  const double stands_at = expected(axis, begin);
  // Others brake for their target with an acceleration of its own, but not for a speed of 0.
  const bool stops = before * speed < 0 || std::abs(speed) < here.info.units.velocity.value;
  if (guidance.slowing != guidance.accelerations.back())
    return stops ? needed(before, stands_at, 1) : 0;
  // It may be a little farther than expected, and the next command comes after this segment's end.
  const double spare = options_.even_within * std::abs(here.info.microsteps_per_unit);
  const double late_s = seconds(report_.round_trip) * static_cast<double>(axes_.size() + 1);
  const double end = span.at_end.position[axis] * here.info.microsteps_per_unit;
  return std::max(spare_braking * needed(speed, end, spare + std::abs(speed) * late_s),
                  needed(before, stands_at, spare));
}

// An acceleration that is steeper than needed is kept if the axis is off the course by little for
// it: that saves a command.
Script<DriveRunner::Fault> PathStream::Runner::tell_segment(std::size_t axis,
                                                            const SegmentSpan& span) {
  auto& here = axes_[axis];
  const auto task = task_of(axis, span);
  const auto wanted = segment_for(task);
  const double change = std::abs(wanted.speed - task.speed);
  const double unit = here.info.units.velocity.value;
  const double braking = braking_needed(axis, span, wanted.speed);
  const bool brakes = slope_now(axis, 0) >= braking;
  const bool keeps_speed = change < unit / 2 && here.motion.speed_at(now_) == here.motion.end_speed;
  if (keeps_speed && brakes) co_return std::nullopt;
  const double slope = std::max(
      {braking, least_slope(axis, span, std::max(std::abs(task.speed), std::abs(wanted.speed))),
       std::min(change / wanted.ramp_s, greatest_slope(axis, span.smooth && span.full_rate))});
  const double within = options_.even_within * std::abs(here.info.microsteps_per_unit);
  const double own = slope_now(axis, wanted.speed);
  const double off = change * (wanted.ramp_s - change / own) / 4;
  if (own < slope || !brakes || off > within) {
    auto refused = co_await set_slopes(axis, wanted.speed, slope, braking);
    if (refused) co_return refused;
  }
  co_await until(told_at(axis, span) - report_.round_trip / 2);
  if (auto asked = asked_to_stop()) co_return asked;
  clock_.advance(now_);
  const double speed = speed_for(axis, task, wanted);
  const auto most = here.info.greatest_velocity;
  const auto value = std::clamp<long>(std::lround(speed / unit), -most, most);
  auto wrong =
      co_await tell_velocity(axis, static_cast<std::int32_t>(value), span.course_end - instant);
  if (!wrong && has_targets(axis) &&
      turn_is_due(axis, static_cast<std::int32_t>(value), span.course_end - instant))
    here.brought_back = now_ + report_.period;
  co_return wrong;
}

// By the slope that there is, and not farther beyond the speed at the end than a correction brings
// it back: the next segment makes up for what is missing. If the ramp takes most of the time, each
// difference would cost too much.
double PathStream::Runner::speed_for(std::size_t axis, const SegmentTask& task,
                                     const Segment& wanted) const {
  const double slope = slope_now(axis, wanted.speed);
  const double top = course_.top_speed(axis) * std::abs(axes_[axis].info.microsteps_per_unit);
  const double change = std::abs(wanted.speed - task.speed);
  auto speed = speed_by(slope, task).value_or(wanted.speed);
  if (change > most_of_segment * slope * task.time_s) speed = wanted.speed;
  const auto [least, most] = std::minmax(task.speed, task.end_speed);
  const double undone =
      greatest_slope(axis, true) * updates_of_a_correction * seconds(report_.period);
  const double beyond = std::min(catching_up * top, undone);
  return std::clamp(speed, least - beyond, most + beyond);
}

double PathStream::Runner::slope_now(std::size_t axis, double speed) const {
  const auto& here = axes_[axis];
  const auto& guidance = guidance_of(here.info.family);
  const bool slower = std::abs(speed) < std::abs(here.motion.end_speed);
  const auto parameter = slower ? guidance.slowing : guidance.accelerations.front();
  return acceleration_of(axis, settings_[axis].now(parameter).value_or(0));
}

Script<DriveRunner::Fault> PathStream::Runner::set_slopes(std::size_t axis, double speed,
                                                          double slope, double braking) {
  const auto& guidance = guidance_of(axes_[axis].info.family);
  const auto faster = guidance.accelerations.front();
  const double before = axes_[axis].motion.end_speed;
  const bool turns = before * speed < 0;
  Fault refused;
  if (faster == guidance.slowing || turns || std::abs(speed) > std::abs(before))
    refused = co_await set_slope(axis, faster, slope);
  if (refused || faster == guidance.slowing) co_return refused;
  if (turns || std::abs(speed) < std::abs(before)) {
    refused = co_await set_slope(axis, guidance.slowing, slope);
  } else if (slope_now(axis, 0) < braking) {
    refused = co_await set_slope(axis, guidance.slowing, braking);
  }
  co_return refused;
}

Script<DriveRunner::Fault> PathStream::Runner::set_slope(std::size_t axis, std::uint8_t parameter,
                                                         double slope) {
  auto& here = axes_[axis];
  const double scale = std::abs(here.info.microsteps_per_unit);
  const auto most =
      std::max(settings_[axis].before(parameter), greatest_acceleration_of(here.info));
  const auto value = acceleration_in(axis, slope / scale, most);
  auto refused = co_await set(axis, {parameter, value});
  if (refused) co_return refused;
  here.motion = here.motion.from(middle());
  here.motion.slope = acceleration_of(axis, value);
  co_return std::nullopt;
}

// Those that turn round first: late, they would go too far.
std::vector<std::size_t> PathStream::Runner::order_of(const SegmentSpan& span) {
  std::vector<std::size_t> order(axes_.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_partition(order.begin(), order.end(), [&](std::size_t axis) {
    const auto turns = course_.turns(axis);
    const auto stretch = axes_[axis].stretch;
    return stretch + 1 < turns.size() && turns[stretch].time < span.course_end - instant;
  });
  int place = 0;
  for (const auto axis : order) axes_[axis].place = place++;
  return order;
}

Script<DriveRunner::Fault> PathStream::Runner::pass_segment(const SegmentSpan& span) {
  Fault wrong;
  for (std::size_t axis = 0; axis < axes_.size() && !wrong; ++axis) wrong = co_await check(axis);
  if (wrong) co_return wrong;
  const auto order = order_of(span);
  co_await until(told_at(order.front(), span) - 3 * report_.round_trip / 2);
  for (const auto axis : order) {
    if (auto asked = asked_to_stop()) co_return asked;
    wrong = co_await tell_segment(axis, span);
    if (wrong) co_return wrong;
  }
  wrong = co_await turn_late_ones(span);
  if (wrong) co_return wrong;
  const auto read = report_.updates % axes_.size();
  wrong = co_await read_position(read);
  if (wrong) co_return wrong;
  correct(read);
  co_return std::nullopt;
}

// As soon as they have come to rest where they turn.
Script<DriveRunner::Fault> PathStream::Runner::turn_late_ones(const SegmentSpan& span) {
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    auto& here = axes_[axis];
    if (!here.brought_back) continue;
    here.brought_back.reset();
    const double way = here.target - expected(axis, now_);
    const double speed = std::max(std::abs(here.motion.speed_at(now_)), 1.0);
    co_await until(now_ + std::min(report_.period, duration(2 * std::abs(way) / speed)));
    if (auto asked = asked_to_stop()) co_return asked;
    auto wrong = co_await tell_segment(axis, span);
    if (wrong) co_return wrong;
  }
  co_return std::nullopt;
}

// Until it is time for the next one, or for a pause.
Script<DriveRunner::Fault> PathStream::Runner::watch_segment(const SegmentSpan& span,
                                                             TimePoint until_time) {
  while (now_ < until_time && span.full_rate == clock_.is_at_full_rate()) {
    const bool has_time = until_time - now_ > watch_interval + report_.period;
    co_await until(std::min(until_time, now_ + watch_interval));
    if (auto asked = asked_to_stop()) co_return asked;
    if (!has_time) continue;
    clock_.advance(now_);
    auto wrong = co_await end_corrections(span);
    watched_ = (watched_ + 1) % axes_.size();
    if (!wrong) wrong = co_await check(watched_);
    if (!wrong) wrong = co_await read_position(watched_);
    if (!wrong) correct(watched_);
    if (!wrong) wrong = co_await bring_back(watched_, span);
    if (wrong) co_return wrong;
  }
  clock_.advance(now_);
  for (auto& axis : axes_) axis.brought_back.reset();
  co_return std::nullopt;
}

// An axis that keeps its speed, and is not where it should be, is told a better one for a while. On
// a ramp it would get no nearer, for its acceleration is all that it has.
Script<DriveRunner::Fault> PathStream::Runner::bring_back(std::size_t axis,
                                                          const SegmentSpan& span) {
  auto& here = axes_[axis];
  const auto takes = updates_of_a_correction * report_.period;
  const bool is_even = here.motion.speed_at(now_) == here.motion.end_speed;
  if (here.brought_back || !is_even || now_ + 2 * takes > span.end) co_return std::nullopt;
  const double off = planned_position(axis) - expected(axis, now_) / here.info.microsteps_per_unit;
  if (std::abs(off) <= options_.even_within) co_return std::nullopt;
  here.brought_back = now_ + takes;
  auto wrong = co_await tell_rest(axis, span);
  co_return wrong;
}

Script<DriveRunner::Fault> PathStream::Runner::end_corrections(const SegmentSpan& span) {
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    auto& until = axes_[axis].brought_back;
    if (!until || now_ + 2 * report_.round_trip < *until) continue;
    until.reset();
    auto wrong = co_await tell_rest(axis, span);
    if (wrong) co_return wrong;
  }
  co_return std::nullopt;
}

Script<DriveRunner::Fault> PathStream::Runner::tell_rest(std::size_t axis,
                                                         const SegmentSpan& span) {
  auto rest = span;
  rest.begin = now_ + 2 * report_.round_trip;
  rest.early = {};
  if (const auto until = axes_[axis].brought_back) {
    rest.end = *until;
    rest.at_end = course_.at(clock_.passed_at(*until));
  }
  auto wrong = co_await tell_segment(axis, rest);
  co_return wrong;
}

}  // namespace tmcl::plan
