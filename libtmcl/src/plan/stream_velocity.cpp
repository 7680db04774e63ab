// A stream of velocities.
#include <algorithm>
#include <cmath>
#include <tuple>

#include "plan/stream_runner.hpp"

namespace tmcl::plan {
namespace {

namespace ap = axis_parameter;

// A change of velocity is over in this part of an update.
constexpr double ramp_part_of_update = 0.5;
// A pause brakes half as hard as the axis' own ramp would: the course may need the rest.
constexpr double pause_ramps = 2;
// How many updates are looked at to know how steep a course is.
constexpr double most_samples = 1e6;

}  // namespace

// With more, a TMC429 may oscillate around its target: 2^(ramp_div - pulse_div + 12) - 1, in its
// units of velocity and acceleration.
std::int32_t PathStream::Runner::greatest_acceleration_of(const StreamAxis& axis) {
  if (axis.family != Family::tmc429) return axis.greatest_acceleration;
  const double speed = axis.units.velocity.value;
  const double most = (1 << 15) * speed * speed / axis.units.acceleration.value - 1;
  return static_cast<std::int32_t>(std::min<double>(axis.greatest_acceleration, most));
}

Script<DriveRunner::Fault> PathStream::Runner::prepare_velocities() {
  const auto commands = static_cast<double>(2 * axes_.size() + 1);
  const auto needed = duration(seconds(report_.round_trip) * commands / (1 - spare_part_of_bus));
  report_.period = std::max(options_.period_min, needed);
  auto asked = co_await find_steepest();
  if (asked) co_return asked;
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    auto refused = co_await raise_accelerations(axis);
    if (!refused) refused = co_await prepare_ramp(axis);
    if (refused) co_return refused;
  }
  set_pause_ramp();
  co_return std::nullopt;
}

Script<DriveRunner::Fault> PathStream::Runner::raise_accelerations(std::size_t axis) {
  const auto& info = axes_[axis].info;
  const double wanted =
      std::ceil(axes_[axis].steepest / ramp_part_of_update * std::abs(info.microsteps_per_unit) /
                info.units.acceleration.value);
  for (const auto parameter : guidance_of(info.family).accelerations) {
    auto unknown = co_await know(axis, parameter);
    if (unknown) co_return unknown;
    const auto own = settings_[axis].before(parameter);
    const auto most = std::max(own, greatest_acceleration_of(info));
    const auto value = wanted < most ? std::max(own, static_cast<std::int32_t>(wanted)) : most;
    auto refused = co_await set(axis, {parameter, value});
    if (refused) co_return refused;
  }
  co_return std::nullopt;
}

// In microsteps per second squared.
double PathStream::Runner::acceleration_of(std::size_t axis, std::int32_t value) const {
  return value * axes_[axis].info.units.acceleration.value;
}

Script<DriveRunner::Fault> PathStream::Runner::find_steepest() {
  const double step = std::max(seconds(report_.period), course_.duration() / most_samples);
  auto before = course_.at(0).position;
  AxisValues speed{};
  for (std::size_t look = 0; static_cast<double>(look) * step < course_.duration() + step; ++look) {
    const auto position = course_.at(static_cast<double>(look + 1) * step).position;
    for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
      const double now = (position[axis] - before[axis]) / step;
      auto& steepest = axes_[axis].steepest;
      steepest = std::max(steepest, std::abs(now - speed[axis]) / step);
      speed[axis] = now;
    }
    before = position;
    if (takes_a_breath(look)) co_await until(now_);
    if (auto asked = asked_to_stop()) co_return asked;
  }
  co_return std::nullopt;
}

void PathStream::Runner::set_pause_ramp() {
  double longest = seconds(report_.period);
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    const auto& info = axes_[axis].info;
    const auto parameter = guidance_of(info.family).accelerations.front();
    const double acceleration = acceleration_of(axis, settings_[axis].before(parameter));
    const double top = course_.top_speed(axis) * std::abs(info.microsteps_per_unit);
    if (acceleration > 0) longest = std::max(longest, top / acceleration);
  }
  clock_.set_ramp(pause_ramps * longest);
}

Script<DriveRunner::Fault> PathStream::Runner::by_velocity() {
  auto wrong = co_await set_out();
  if (wrong) co_return wrong;
  for (auto& axis : axes_) axis.due = now_;
  clock_.start(now_, clock_.paused());
  for (std::size_t round = 0;; ++round) {
    const auto begin = now_;
    for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
      wrong = co_await update(axis);
      if (wrong) co_return wrong;
    }
    ++report_.updates;
    const auto read = round % axes_.size();
    auto off = co_await read_position(read);
    if (off) co_return off;
    correct(read);
    clock_.advance(now_);
    if (clock_.passed() >= course_.duration()) co_return std::nullopt;
    co_await until(begin + report_.period);
  }
}

Script<DriveRunner::Fault> PathStream::Runner::update(std::size_t axis) {
  auto wrong = co_await check(axis);
  if (!wrong) wrong = asked_to_stop();
  if (!wrong) wrong = note_delay(now_ - axes_[axis].due, report_.period);
  if (wrong) co_return wrong;
  axes_[axis].due = now_ + report_.period;
  clock_.advance(now_);
  wrong = co_await tell_velocity(axis, velocity_for(axis), clock_.passed_in(report_.period));
  co_return wrong;
}

Script<DriveRunner::Fault> PathStream::Runner::tell_velocity(std::size_t axis,
                                                             std::int32_t velocity,
                                                             double next_update) {
  if (has_targets(axis)) {
    auto wrong = co_await guide(axis, velocity, next_update);
    co_return wrong;
  }
  if (axes_[axis].velocity == velocity) co_return std::nullopt;
  co_await command({Kind::rotate, axis, 0, velocity});
  if (!answer_) co_return refusal(axis);
  axes_[axis].told = Setting{ap::target_velocity, velocity};
  note_velocity(axis, velocity, middle());
  co_return std::nullopt;
}

// On its way to a target it stops there.
double PathStream::Runner::expected(std::size_t axis, TimePoint at) const {
  const auto& [motion, target] = std::tie(axes_[axis].motion, axes_[axis].target);
  const double on = motion.position_at(at);
  if (!has_targets(axis)) return on;
  return heading(axis) > 0 ? std::min(on, std::max<double>(target, motion.position))
                           : std::max(on, std::min<double>(target, motion.position));
}

std::int32_t PathStream::Runner::velocity_for(std::size_t axis) const {
  const auto& info = axes_[axis].info;
  const double planned = course_.at(clock_.passed()).position[axis];
  const double next = course_.at(clock_.passed_in(report_.period)).position[axis];
  double behind = planned * info.microsteps_per_unit - expected(axis, now_);
  // Readings are whole microsteps. Where the course stands, a motor would go to and fro for one.
  if (std::abs(behind) < (next == planned ? 2 : 1)) behind = 0;
  const double period = seconds(report_.period);
  const double most_way =
      most_correction * course_.top_speed(axis) * std::abs(info.microsteps_per_unit) * period;
  const double way = (next - planned) * info.microsteps_per_unit +
                     std::clamp(position_gain * behind, -most_way, most_way);
  const double value = way / period / info.units.velocity.value;
  const double most = info.greatest_velocity;
  return static_cast<std::int32_t>(std::lround(std::clamp(value, -most, most)));
}

void PathStream::Runner::note_velocity(std::size_t axis, std::int32_t velocity, TimePoint at) {
  auto& here = axes_[axis];
  const auto& guidance = guidance_of(here.info.family);
  const bool slower = std::abs(velocity) < std::abs(here.velocity.value_or(0));
  const auto parameter = slower ? guidance.slowing : guidance.accelerations.front();
  const double acceleration = acceleration_of(axis, settings_[axis].now(parameter).value_or(0));
  here.motion = {at, expected(axis, at), here.motion.speed_at(at),
                 velocity * here.info.units.velocity.value};
  if (acceleration > 0) here.motion.slope = acceleration;
  here.velocity = velocity;
}

void PathStream::Runner::correct(std::size_t axis) {
  axes_[axis].motion.position += observer_gain * (*answer_ - expected(axis, middle()));
}

}  // namespace tmcl::plan
