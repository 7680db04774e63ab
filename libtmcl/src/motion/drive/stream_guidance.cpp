// A stream of velocities whose axes go to targets: each command may be the last one.
#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "motion/drive/guided_runner.hpp"
#include "tmcl/parameter_number.hpp"

namespace tmcl::plan {
namespace {

namespace ap = axis_parameter;

constexpr std::array<std::uint8_t, 1> one_acceleration{ap::max_acceleration};
constexpr std::array<std::uint8_t, 2> tmc457_accelerations{number_of("acceleration"), dmax};
constexpr std::array<std::uint8_t, 2> sixpoint_accelerations{ap::max_acceleration, dmax};

// A TMC429 would stop short of its target, or abruptly; sixPoint generators would have other
// accelerations at low speeds, jump to the start velocity, and wait where they turn round.
constexpr std::array<Setting, 1> tmc429_settings{{{number_of("minimum_velocity"), 1}}};
// A bow would take time from each change of speed.
constexpr std::array<Setting, 1> tmc457_settings{{{number_of("max_bow"), 0}}};
constexpr std::array<Setting, 1> tmc4361_settings{{{number_of("ramp_type"), 0}}};
constexpr std::array<Setting, 3> sixpoint_settings{
    {{number_of("velocity_v1"), 0},
     {number_of(Family::sixpoint, "start_velocity"), 0},
     {number_of("ramp_wait_time"), 0}}};

constexpr Setting tmc429_goes_to_target{number_of(Family::tmc429, "ramp_mode"), 0};
constexpr Setting tmc457_goes_to_target{number_of(Family::tmc457, "ramp_mode"), 0};
constexpr Setting sixpoint_goes_to_target{ap::target_velocity, 0};

// Half of what its position counter allows.
constexpr std::int32_t farthest_of_tmc429 = 1 << 22;
constexpr std::int32_t farthest_of_others = 1 << 30;
// A pause brakes half as hard as the axis' own ramp would: the course may need the rest.
constexpr double pause_ramps = 2;

// The least part of an acceleration that is there to make up for differences.
constexpr double least_left = 0.25;

}  // namespace

const Guidance& guidance_of(Family family) {
  static constexpr Guidance tmc429{true,
                                   one_acceleration,
                                   ap::max_acceleration,
                                   tmc429_settings,
                                   tmc429_goes_to_target,
                                   farthest_of_tmc429};
  static constexpr Guidance tmc457{
      true, tmc457_accelerations, dmax, tmc457_settings, tmc457_goes_to_target, farthest_of_others};
  static constexpr Guidance sixpoint{true,
                                     sixpoint_accelerations,
                                     ap::max_acceleration,
                                     sixpoint_settings,
                                     sixpoint_goes_to_target,
                                     farthest_of_others};
  static constexpr Guidance tmc4361{
      false, one_acceleration, ap::max_acceleration, tmc4361_settings, {}, 0};
  static constexpr Guidance by_velocities{false, one_acceleration, ap::max_acceleration, {}, {}, 0};
  switch (family) {
    case Family::tmc429: return tmc429;
    case Family::tmc457: return tmc457;
    case Family::sixpoint: return sixpoint;
    case Family::tmc4361: return tmc4361;
    case Family::firmware: break;
  }
  return by_velocities;
}

// With a greatest speed of 0 a target sets nothing in motion.
StreamScript GuidedRunner::prepare_ramp(std::size_t axis) {
  for (const auto setting : guidance_of(axes_[axis].family).settings) {
    auto refused = co_await set(axis, setting);
    if (refused) co_return refused;
  }
  if (!has_targets(axis)) co_return std::nullopt;
  auto refused = co_await set(axis, {ap::max_velocity, 0});
  co_return refused;
}

StreamScript GuidedRunner::set_out() {
  const auto start = course_.at(0).position;
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    guided_[axis].motion = {now_, start[axis] * axes_[axis].microsteps_per_unit};
    Fault wrong;
    if (has_targets(axis)) wrong = co_await set_out(axis);
    if (wrong) co_return wrong;
  }
  co_return std::nullopt;
}

StreamScript GuidedRunner::set_out(std::size_t axis) {
  if (auto asked = asked_to_stop()) co_return asked;
  auto& here = guided_[axis];
  here.target = target_from(axis, here.motion.position);
  co_await command({Kind::move_to, axis, 0, here.target});
  if (!answer_) co_return refusal(axis);
  told_[axis] = guidance_of(axes_[axis].family).told;
  here.velocity = 0;
  co_return std::nullopt;
}

StreamScript GuidedRunner::tell_velocity(std::size_t axis, std::int32_t velocity,
                                         double next_update) {
  if (has_targets(axis)) {
    auto wrong = co_await guide(axis, velocity, next_update);
    co_return wrong;
  }
  if (guided_[axis].velocity == velocity) co_return std::nullopt;
  co_await command({Kind::rotate, axis, 0, velocity});
  if (!answer_) co_return refusal(axis);
  told_[axis] = Setting{ap::target_velocity, velocity};
  note_velocity(axis, velocity, middle());
  co_return std::nullopt;
}

// Targets are parameter 0, which does not start a stopped motor.
StreamScript GuidedRunner::guide(std::size_t axis, std::int32_t velocity, double next_update) {
  auto& here = guided_[axis];
  std::optional<TimePoint> turned;
  const double from = expected(axis, now_);
  const bool is_near = std::abs(here.target - from) < guidance_of(axes_[axis].family).farthest / 2;
  const bool turns = turn(axis, velocity, next_update);
  const auto target = turns || is_near ? target_from(axis, from) : here.target;
  if (target != here.target) {
    co_await command({Kind::set, axis, ap::target_position, target});
    if (!answer_) co_return refusal(axis);
    here.motion = motion_at(axis, middle());
    here.target = target;
    if (turns) turned = middle();
  }
  const auto along = std::max(0, heading(axis) * velocity);
  auto refused = co_await set(axis, {ap::max_velocity, along});
  if (refused) co_return refused;
  if (told_[axis]->parameter == ap::target_velocity) told_[axis]->value = along;
  if (here.velocity != heading(axis) * along)
    note_velocity(axis, heading(axis) * along, turned.value_or(middle()));
  co_return std::nullopt;
}

// Turned round, it brakes at once, by the acceleration with which it gets slower. Otherwise its
// generator brakes for the target: if that is no harder, the axis goes as far. At the target it has
// stopped.
bool GuidedRunner::stops_in_time(std::size_t axis) const {
  const auto& here = guided_[axis];
  const auto& guidance = guidance_of(axes_[axis].family);
  const double slowing = acceleration_now(axis, guidance.slowing);
  if (acceleration_now(axis, guidance.accelerations.back()) <= slowing) return true;
  const auto then = now_ + report_.round_trip / 2;
  const double way = (here.target - expected(axis, then)) * heading(axis);
  const double speed = expected_speed(axis, then) * heading(axis);
  return speed <= 0 || way <= 1 || speed * speed <= 2 * slowing * (way - 1);
}

// Once the course has turned; or a little earlier, if it does so before the next update and leads
// back all in all.
bool GuidedRunner::turn_is_due(std::size_t axis, std::int32_t velocity, double next_update) const {
  const auto turns = course_.turns(axis);
  const auto stretch = guided_[axis].stretch;
  if (stretch + 1 >= turns.size()) return false;
  const double time = turns[stretch].time;
  const bool leads_back = heading(axis) * velocity < 0;
  return time <= clock_.passed() || (leads_back && time < next_update);
}

// Not while it would go beyond the place where the course turns.
bool GuidedRunner::turn(std::size_t axis, std::int32_t velocity, double next_update) {
  if (!stops_in_time(axis)) return false;
  const auto before = guided_[axis].stretch;
  while (turn_is_due(axis, velocity, next_update)) ++guided_[axis].stretch;
  return guided_[axis].stretch != before;
}

bool GuidedRunner::stands_at_halt() const {
  const auto moves = [](const Guided& axis) { return axis.velocity.value_or(0) != 0; };
  return clock_.halt() != nullptr && std::ranges::none_of(guided_, moves);
}

int GuidedRunner::heading(std::size_t axis) const {
  const auto stretch = guided_[axis].stretch;
  const auto turns = course_.turns(axis);
  const double begin = stretch == 0 ? course_.at(0).position[axis] : turns[stretch - 1].position;
  const auto from = microsteps(axis, begin);
  const auto to = microsteps(axis, turns[stretch].position);
  return (to > from ? 1 : 0) - (to < from ? 1 : 0);
}

std::int32_t GuidedRunner::target_from(std::size_t axis, double position) const {
  const double farthest = guidance_of(axes_[axis].family).farthest;
  const double end = microsteps(axis, course_.turns(axis)[guided_[axis].stretch].position);
  return static_cast<std::int32_t>(
      std::lround(std::clamp(end, position - farthest, position + farthest)));
}

SpeedRamp GuidedRunner::motion_at(std::size_t axis, TimePoint at) const {
  const auto& [motion, target] = std::tie(guided_[axis].motion, guided_[axis].target);
  if (!has_targets(axis)) return motion.from(at);
  const auto braking = guidance_of(axes_[axis].family).accelerations.back();
  auto there = motion.to_target(target, acceleration_now(axis, braking), at);
  // If it cannot brake in time it goes beyond the target, and comes back.
  const double on = there.position;
  there.position = heading(axis) > 0 ? std::min(on, std::max<double>(target, motion.position))
                                     : std::max(on, std::min<double>(target, motion.position));
  return there;
}

void GuidedRunner::note_velocity(std::size_t axis, std::int32_t velocity, TimePoint at) {
  auto& here = guided_[axis];
  const auto& guidance = guidance_of(axes_[axis].family);
  const bool slower = std::abs(velocity) < std::abs(here.velocity.value_or(0));
  const auto parameter = slower ? guidance.slowing : guidance.accelerations.front();
  const double acceleration = acceleration_now(axis, parameter);
  here.motion = motion_at(axis, at);
  here.motion.end_speed = velocity * axes_[axis].units.velocity.value;
  if (acceleration > 0) here.motion.slope = acceleration;
  here.velocity = velocity;
}

// Where it was read between question and answer is not known. What that does not explain is made up
// for at once.
void GuidedRunner::correct(std::size_t axis) {
  const auto [time, position, speed, end_speed, slope] = motion_at(axis, middle());
  const double off = *answer_ - position;
  const double unsure = 1 + std::abs(speed) * seconds(now_ - asked_at_) / 2;
  const double unexplained = off - std::clamp(off, -unsure, unsure);
  guided_[axis].motion.position += unexplained + observer_gain * (off - unexplained);
}

double GuidedRunner::acceleration_of(std::size_t axis, std::int32_t value) const {
  return value * axes_[axis].units.acceleration.value;
}

double GuidedRunner::acceleration_now(std::size_t axis, std::uint8_t parameter) const {
  return acceleration_of(axis, settings_[axis].now(parameter).value_or(0));
}

double GuidedRunner::left_by_course(std::size_t axis, double acceleration) const {
  const double scale = std::abs(axes_[axis].microsteps_per_unit);
  const double needed = course_.limits().axis[axis].acceleration * scale;
  return std::max(acceleration - needed, least_left * acceleration);
}

// With more, a TMC429 may oscillate around its target: 2^(ramp_div - pulse_div + 12) - 1, in its
// units of velocity and acceleration.
std::int32_t GuidedRunner::greatest_acceleration_of(const StreamAxis& axis) {
  if (axis.family != Family::tmc429) return axis.greatest_acceleration;
  const double speed = axis.units.velocity.value;
  const double most = (1 << 15) * speed * speed / axis.units.acceleration.value - 1;
  return static_cast<std::int32_t>(std::min<double>(axis.greatest_acceleration, most));
}

void GuidedRunner::set_pause_ramp() {
  double longest = seconds(report_.period);
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    const auto& info = axes_[axis];
    const auto parameter = guidance_of(info.family).accelerations.front();
    const double scale = std::abs(info.microsteps_per_unit);
    const double acceleration = std::min(acceleration_of(axis, settings_[axis].before(parameter)),
                                         course_.limits().axis[axis].acceleration * scale);
    const double top = course_.top_speed(axis) * scale;
    if (acceleration > 0) longest = std::max(longest, top / acceleration);
  }
  clock_.set_ramp(pause_ramps * longest);
}

}  // namespace tmcl::plan
