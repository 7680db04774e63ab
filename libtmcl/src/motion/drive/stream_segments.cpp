// A stream of velocities that tells an axis as little as a course has segments: at the begin of
// each, the speed that it is to have from then on, and the acceleration with which it gets there.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "motion/drive/segment_runner.hpp"

namespace tmcl::plan {
namespace {

namespace ap = axis_parameter;

// An axis is checked, and told a velocity.
constexpr std::size_t segment_commands_of_an_axis = 2;
constexpr Duration longest_way_to_target = std::chrono::milliseconds(200);
// By then a course that has been passed is so in the numbers of the clock, too.
constexpr Duration at_the_end = std::chrono::microseconds(1);

}  // namespace

StreamScript SegmentRunner::prepare() {
  if (!course_.has_legs()) {
    co_return fault(DriveFault::Kind::unsuited, {},
                    "segments need a path without times; use velocity mode");
  }
  std::size_t slopes = 0;
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    const auto& guidance = guidance_of(axes_[axis].family);
    slopes += guidance.slowing == guidance.accelerations.front() ? 1U : 2U;
    for (const auto parameter : guidance.accelerations) {
      auto unknown = co_await know(axis, parameter);
      if (unknown) co_return unknown;
    }
    if (auto wrong = objection_to_slope(axis)) co_return wrong;
    auto refused = co_await prepare_ramp(axis);
    if (refused) co_return refused;
  }
  const auto commands = segment_commands_of_an_axis * axes_.size() + slopes + 1;
  report_.period =
      std::max(options_.period_min, duration(time_to_send(report_.round_trip, commands)));
  segments_.emplace(course_, clock_, report_.period);
  set_pause_ramp();
  // Where the generator has an acceleration of its own for the way to the target, that must not
  // make it brake before the course does.
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    const auto& guidance = guidance_of(axes_[axis].family);
    const auto braking = guidance.accelerations.back();
    if (braking == guidance.slowing) continue;
    auto refused = co_await set(axis, {braking, axes_[axis].greatest_acceleration});
    if (refused) co_return refused;
  }
  co_return std::nullopt;
}

StreamScript SegmentRunner::pass_course() {
  auto wrong = co_await set_out();
  if (wrong) co_return wrong;
  // The clock starts when the first velocity is told.
  const auto lead = report_.period;
  clock_.start(now_ + lead, clock_.paused());
  auto span = segments_->from(now_ + lead);
  while (true) {
    wrong = co_await pass_segment(span);
    if (wrong) co_return wrong;
    ++report_.updates;
    const bool stands = stands_at_halt();
    if (stands) wrong = co_await pass_halt(lead);
    if (wrong) co_return wrong;
    if (clock_.is_over()) break;
    if (stands) {
      span = segments_->from(now_ + lead);
      continue;
    }
    const bool is_last = span.steady && span.course_end >= course_.duration();
    wrong = co_await watch_segment(span, is_last ? span.end + at_the_end : span.end - lead);
    if (wrong) co_return wrong;
    if (clock_.is_over()) break;
    const bool on_time = span.goes_with(clock_);
    const auto planned = on_time ? span.end : now_ + lead;
    wrong = note_delay(now_ + lead - planned, report_.period);
    if (wrong) co_return wrong;
    const auto begin = std::max(planned, now_ + report_.round_trip);
    span = segments_->from(begin);
  }
  wrong = co_await end_by_targets();
  co_return wrong;
}

// A stop could lead beyond them. An axis that creeps is stopped all the same.
StreamScript SegmentRunner::end_by_targets() {
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
TimePoint SegmentRunner::told_at(std::size_t axis, const SegmentSpan& span) const {
  const auto others = 2 * place_[axis] - static_cast<int>(axes_.size()) + 1;
  const auto planned = span.begin - span.early + others * report_.round_trip;
  return std::max(planned, now_ + report_.round_trip / 2);
}

// Where the course stands, a motor would go to and fro for one microstep.
bool SegmentRunner::may_stand(const SegmentTask& task, const SegmentSpan& span) {
  constexpr double nearly_there = 2;
  return !span.steady && task.end_speed == 0 && std::abs(task.way) < nearly_there &&
         std::abs(task.speed) * task.shortest_ramp_s < nearly_there;
}

// An acceleration that is steeper than needed is kept if the axis is off the course by little for
// it: that saves a command.
StreamScript SegmentRunner::tell_segment(std::size_t axis, const SegmentSpan& span) {
  auto& here = guided_[axis];
  const auto task = task_of(axis, span);
  if (may_stand(task, span)) {
    Fault wrong;
    if (here.velocity.value_or(0) == 0) co_return wrong;
    // As its last segment has it, it may brake for long.
    const double slope = greatest_slope(axis, false);
    if (slope_now(axis, 0) < slope) wrong = co_await set_slopes(axis, 0, slope, slope);
    if (!wrong) wrong = co_await tell_velocity(axis, 0, span.course_end - instant);
    co_return wrong;
  }
  const auto wanted = segment_for(task);
  const double change = std::abs(wanted.speed - task.speed);
  const double unit = axes_[axis].units.velocity.value;
  const double braking = braking_needed(axis, span, wanted.speed);
  const bool brakes = slope_now(axis, 0) >= braking;
  const bool keeps_speed = change < unit / 2 && expected_speed(axis, now_) == here.motion.end_speed;
  if (keeps_speed && brakes) co_return std::nullopt;
  const double slope = std::max(
      {braking, least_slope(axis, span, std::max(std::abs(task.speed), std::abs(wanted.speed))),
       std::min(change / wanted.ramp_s, greatest_slope(axis, span.smooth && span.steady))});
  const double within = options_.even_within * std::abs(axes_[axis].microsteps_per_unit);
  const double own = slope_now(axis, wanted.speed);
  const double off = change * (wanted.ramp_s - change / own) / 4;
  if (own < slope || !brakes || off > within) {
    auto refused = co_await set_slopes(axis, wanted.speed, slope, braking);
    if (refused) co_return refused;
  }
  co_await until(told_at(axis, span) - report_.round_trip / 2);
  if (auto asked = asked_to_stop()) co_return asked;
  clock_.advance(now_);
  const double speed = speed_for(axis, span, task, wanted);
  const auto most = axes_[axis].greatest_velocity;
  const auto value = std::clamp<long>(std::lround(speed / unit), -most, most);
  auto wrong =
      co_await tell_velocity(axis, static_cast<std::int32_t>(value), span.course_end - instant);
  if (!wrong && has_targets(axis) &&
      turn_is_due(axis, static_cast<std::int32_t>(value), span.course_end - instant))
    brought_back_[axis] = now_ + report_.period;
  co_return wrong;
}

// Those that turn round first: late, they would go too far.
std::vector<std::size_t> SegmentRunner::order_of(const SegmentSpan& span) {
  std::vector<std::size_t> order(axes_.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_partition(order.begin(), order.end(), [&](std::size_t axis) {
    const auto turns = course_.turns(axis);
    const auto stretch = guided_[axis].stretch;
    return stretch + 1 < turns.size() && turns[stretch].time < span.course_end - instant;
  });
  int place = 0;
  for (const auto axis : order) place_[axis] = place++;
  return order;
}

StreamScript SegmentRunner::pass_segment(const SegmentSpan& span) {
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
  if (reads_encoder(report_.updates)) {
    wrong = co_await look_at_encoder();
    co_return wrong;
  }
  const auto read = next_to_read();
  wrong = co_await read_position(read);
  if (wrong) co_return wrong;
  correct(read);
  co_return std::nullopt;
}

// As soon as they have come to rest where they turn.
StreamScript SegmentRunner::turn_late_ones(const SegmentSpan& span) {
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    auto& here = guided_[axis];
    if (!brought_back_[axis]) continue;
    brought_back_[axis].reset();
    const double way = here.target - expected(axis, now_);
    const double speed = std::max(std::abs(expected_speed(axis, now_)), 1.0);
    co_await until(now_ + std::min(report_.period, duration(2 * std::abs(way) / speed)));
    if (auto asked = asked_to_stop()) co_return asked;
    auto wrong = co_await tell_segment(axis, span);
    if (wrong) co_return wrong;
  }
  co_return std::nullopt;
}

// Until it is time for the next one, or for a pause.
StreamScript SegmentRunner::watch_segment(const SegmentSpan& span, TimePoint until_time) {
  auto unseen = co_await look_at_encoder(until_time - report_.period);
  if (unseen) co_return unseen;
  while (now_ < until_time && span.goes_with(clock_)) {
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
    if (!wrong) wrong = co_await look_at_encoder(until_time - report_.period);
    if (wrong) co_return wrong;
  }
  clock_.advance(now_);
  std::ranges::fill(brought_back_, std::nullopt);
  co_return std::nullopt;
}

// An axis that keeps its speed, and is not where it should be, is told a better one for a while. On
// a ramp it would get no nearer, for its acceleration is all that it has.
StreamScript SegmentRunner::bring_back(std::size_t axis, const SegmentSpan& span) {
  auto& here = guided_[axis];
  const auto takes = updates_of_a_correction * report_.period;
  const bool is_even = expected_speed(axis, now_) == here.motion.end_speed;
  if (brought_back_[axis] || !is_even || now_ + 2 * takes > span.end) co_return std::nullopt;
  const double off =
      planned_position(axis) - expected(axis, now_) / axes_[axis].microsteps_per_unit;
  if (std::abs(off) <= options_.even_within) co_return std::nullopt;
  brought_back_[axis] = now_ + takes;
  auto wrong = co_await tell_rest(axis, span);
  co_return wrong;
}

StreamScript SegmentRunner::end_corrections(const SegmentSpan& span) {
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    auto& until = brought_back_[axis];
    if (!until || now_ + 2 * report_.round_trip < *until) continue;
    until.reset();
    auto wrong = co_await tell_rest(axis, span);
    if (wrong) co_return wrong;
  }
  co_return std::nullopt;
}

StreamScript SegmentRunner::tell_rest(std::size_t axis, const SegmentSpan& span) {
  auto rest = span;
  rest.begin = now_ + 2 * report_.round_trip;
  rest.early = {};
  if (const auto until = brought_back_[axis]) {
    rest.end = *until;
    rest.at_end = at_rate(clock_.rate(), course_.at(clock_.passed_at(*until)));
  }
  auto wrong = co_await tell_segment(axis, rest);
  co_return wrong;
}

std::unique_ptr<StreamRunner> segment_runner(const Course& course, StreamAxes axes,
                                             StreamOptions options) {
  return std::make_unique<SegmentRunner>(course, std::move(axes), options);
}

}  // namespace tmcl::plan
