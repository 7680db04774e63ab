// A stream of positions: legs, loaded into ramp generators one after the other.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "plan/stream_runner.hpp"
#include "tmcl/parameter_number.hpp"

namespace tmcl::plan {
namespace {

namespace ap = axis_parameter;

constexpr auto v1 = number_of("velocity_v1");
constexpr auto dmax = number_of("max_deceleration");
constexpr auto vstart = number_of(Family::sixpoint, "start_velocity");
constexpr auto vstop = number_of("stop_velocity");
constexpr auto tzerowait = number_of("ramp_wait_time");
// What ramp generators can hold: 2^-41 of the square of their clock, 116.4 at 16 MHz. Less is 0,
// with which a motor does not move.
constexpr double least_acceleration_pps2 = 128;
constexpr std::int32_t least_vstop = 10;  // data sheets; below it a motor may not come to rest

// By how much a leg may be faster or slower than planned, to be back on time at its end.
constexpr double slowest_part = 0.8;
constexpr double fastest_part = 1.25;
constexpr Duration look_interval = std::chrono::milliseconds(10);

// A leg is loaded earlier than it has to be, in case that it takes longer; by so much at most.
constexpr double max_lead_s = 0.02;

constexpr std::size_t commands_of_a_look = 2;

// An axis on an even leg may go on beyond its end for so long, and be so far off the course then,
// in even_within.
constexpr double max_blend_s = 0.05;
constexpr double farthest_lead_on = 5;

// That every moving axis of a leg gets: it is checked, velocity and target are written.
constexpr std::size_t commands_of_an_axis = 3;
// Both accelerations and the stop velocity.
constexpr std::size_t commands_of_ramps = 3;
// That it gets once more if ramps follow its joint: it is checked, and its velocity is written.
constexpr std::size_t commands_after_joint = commands_of_ramps + 2;
// What part of a leg the axes may take for the joint before it; with ramps, they need the rest.
constexpr double joint_part_of_even_leg = 1. / 2;
constexpr double joint_part_of_ramps = 1. / 8;
// What part of its velocity an axis may gain or lose at a joint with the acceleration of a ramp.
constexpr double turning_part = 1. / 4;

}  // namespace

Script<DriveRunner::Fault> PathStream::Runner::prepare_legs() {
  if (auto unsuited = fault_of_axes()) co_return unsuited;
  constexpr std::uint8_t needed[] = {
      ap::max_velocity, ap::max_acceleration, v1, dmax, vstart, vstop, tzerowait};
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    for (const auto parameter : needed) {
      auto unknown = co_await know(axis, parameter);
      if (unknown) co_return unknown;
    }
  }
  auto wrong = co_await set_joint_accelerations();
  if (!wrong) wrong = co_await fit_legs_to_bus();
  co_return wrong;
}

// By its ramps, a leg that begins on the way is loaded twice. First come the speeds at the joint,
// which the axes change with an acceleration of the joint's own: that of the ramp is in proportion
// to where the leg goes, and would keep an axis that the turn makes faster or slower off the path.
PathStream::Runner::Passage PathStream::Runner::passage(std::size_t index) const {
  Passage made{course_.leg(index), Drive::by_ramps, index};
  const auto& leg = made.leg;
  const double time = leg.end - leg.begin;
  const double off = std::abs(leg.acceleration) * time * time / 8;
  const bool loadable_twice = time_to_send(commands_after_joint * axes_.size()) < time / 4;
  const bool on_the_way = leg.start_speed > 0;
  if (leg.end_speed > 0 && (off <= options_.even_within || (on_the_way && !loadable_twice))) {
    made.drive = Drive::evenly;
    for (auto& ramp : made.leg.axis) ramp.vmax *= leg.mean_speed / leg.peak_speed;
    for (auto& ramp : made.leg.axis) ramp.vstart = ramp.vstop = ramp.vmax;
  } else if (on_the_way && loadable_twice) {
    made.drive = Drive::by_ramps_after_joint;
  }
  return made;
}

// The velocities that the axes gain or lose where a leg begins.
AxisValues PathStream::Runner::changes_at(std::size_t index) const {
  const auto velocity = [&](const CourseLeg& leg, const AxisValues& begin, std::size_t axis,
                            double speed) {
    return std::copysign(speed, leg.axis[axis].target - begin[axis]);
  };
  AxisValues changes{};
  const auto next = passage(index).leg;
  const auto begin = course_.at(next.begin).position;
  for (std::size_t axis = 0; axis < axes_.size(); ++axis)
    changes[axis] = velocity(next, begin, axis, next.axis[axis].vstart);
  if (index == 0) return changes;
  const auto before = passage(index - 1).leg;
  const auto before_begin = course_.at(before.begin).position;
  for (std::size_t axis = 0; axis < axes_.size(); ++axis)
    changes[axis] -= velocity(before, before_begin, axis, before.axis[axis].vstop);
  return changes;
}

// An axis that changes its speed at a joint falls behind by half of the change, times the time that
// takes.
Script<DriveRunner::Fault> PathStream::Runner::set_joint_accelerations() {
  AxisValues needed{};
  for (std::size_t i = 0; i < course_.legs(); ++i) {
    const auto changes = changes_at(i);
    const double longest = longest_joint(passage(i));
    for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
      const double change = std::abs(changes[axis]);
      if (change == 0) continue;
      const double time = std::min(longest, 2 * options_.even_within / change);
      needed[axis] = std::max(needed[axis], change / time);
    }
    if (takes_a_breath(i)) co_await until(now_);
    if (auto asked = asked_to_stop()) co_return asked;
  }
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    auto& here = axes_[axis];
    const auto own = settings_[axis].before(ap::max_acceleration);
    const auto most = std::max(own, here.info.greatest_acceleration);
    here.joint_acceleration = std::max(own, acceleration_in(axis, needed[axis], most));
  }
  co_return std::nullopt;
}

std::int32_t PathStream::Runner::acceleration_in(std::size_t axis, double value,
                                                 std::int32_t most) const {
  const auto unit = axes_[axis].info.units.acceleration;
  const auto least = static_cast<std::int32_t>(std::ceil(least_acceleration_pps2 / unit.value));
  return std::clamp(in_units(axis, value, unit), least, std::max(least, most));
}

double PathStream::Runner::longest_joint(const Passage& passage) {
  const bool evenly = passage.drive == Drive::evenly;
  return (evenly ? joint_part_of_even_leg : joint_part_of_ramps) *
         (passage.leg.end - passage.leg.begin);
}

Duration PathStream::Runner::time_of_joint(std::size_t index) const {
  const auto changes = changes_at(index);
  double time = 0;
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    const double acceleration = axes_[axis].joint_acceleration *
                                axes_[axis].info.units.acceleration.value /
                                std::abs(axes_[axis].info.microsteps_per_unit);
    time = std::max(time, std::abs(changes[axis]) / acceleration);
  }
  return duration(std::min(time, longest_joint(passage(index))));
}

// What belongs to ramps is written for a leg that has them, and again after it.
std::size_t PathStream::Runner::commands_of(std::size_t index) const {
  const auto [leg, drive, place] = passage(index);
  const bool ramps =
      drive == Drive::by_ramps || index == 0 || passage(index - 1).drive != Drive::evenly;
  const auto of_axis = commands_of_an_axis + (ramps ? commands_of_ramps : 0);
  std::size_t moving = 0;
  for (std::size_t axis = 0; axis < axes_.size(); ++axis)
    moving += leg.axis[axis].vmax > 0 ? 1U : 0U;
  return 1 + moving * of_axis;
}

double PathStream::Runner::time_to_send(std::size_t commands) const {
  return seconds(report_.round_trip) * static_cast<double>(commands) / (1 - spare_part_of_bus);
}

Duration PathStream::Runner::lead_of(std::size_t index) const {
  return duration(time_to_send(commands_of(index)));
}

// Whoever turns a corner early leaves the path by what the velocity changes there, times how early
// that is. Not before the leg that comes before has begun.
Duration PathStream::Runner::ahead_of(std::size_t index) const {
  if (index == 0) return {};
  const auto before = course_.leg(index - 1);
  const auto changes = changes_at(index);
  double change = 0;
  for (std::size_t axis = 0; axis < axes_.size(); ++axis)
    change = std::hypot(change, changes[axis]);
  const double room = before.end - before.begin - seconds(lead_of(index));
  const double tolerable = change > 0 ? options_.even_within / change : max_lead_s;
  return duration(std::clamp(std::min(room, tolerable), 0.0, max_lead_s));
}

// A turn where the course stands is not to be cut short.
Duration PathStream::Runner::early_by(const Passage& passage) const {
  const auto early = lead_of(passage.index) + ahead_of(passage.index);
  if (passage.leg.start_speed > 0 || passage.index == 0) return early;
  return std::min(early, duration(passage.leg.begin - course_.leg(passage.index - 1).end));
}

DriveRunner::Fault PathStream::Runner::fault_of_axes() const {
  using FaultKind = DriveFault::Kind;
  if (!course_.has_legs())
    return fault(FaultKind::unsuited, {}, "a table with times has no legs; velocity mode takes it");
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    const auto& info = axes_[axis].info;
    if (!info.twin || info.twin->model().family != Family::sixpoint) {
      return fault(FaultKind::unsuited, axis,
                   "has no start and stop velocities; velocity mode takes any module");
    }
    const double most = info.greatest_stop_velocity * info.units.velocity.value;
    const double top = course_.top_speed(axis) * std::abs(info.microsteps_per_unit);
    if (course_.legs() > 1 && top > most) {
      return fault(FaultKind::unsuited, axis,
                   fmt::format("would be as fast as {:.6g} microsteps/s, and its stop "
                               "velocity is {:.6g} at most",
                               top, most));
    }
  }
  return std::nullopt;
}

Script<DriveRunner::Fault> PathStream::Runner::fit_legs_to_bus() {
  Duration free{};
  report_.period = Duration::max();
  for (std::size_t i = 0; i < course_.legs(); ++i) {
    const auto [leg, drive, place] = passage(i);
    const auto lead = lead_of(i);
    const auto begin = duration(leg.begin);
    free = std::max(free, begin - lead) + lead;
    report_.period = std::min(report_.period, duration(leg.end - leg.begin));
    if (i > 0 && free > begin + lead / 2) {
      co_return fault(
          DriveFault::Kind::slow_bus, {},
          fmt::format("line {}: its leg takes {:.2f} ms, and to load it takes {:.2f} ms: {} "
                      "commands of {:.0f} us, and a quarter spare; velocity mode needs fewer",
                      leg.line, (leg.end - leg.begin) * 1e3, seconds(lead) * 1e3, commands_of(i),
                      seconds(report_.round_trip) * 1e6));
    }
    if (drive == Drive::by_ramps_after_joint)
      free = begin + time_of_joint(i) + duration(time_to_send(commands_after_joint * axes_.size()));
    if (takes_a_breath(i)) co_await until(now_);
    if (auto asked = asked_to_stop()) co_return asked;
  }
  co_return std::nullopt;
}

// A move to where it stands brings a motor into the mode in which targets count.
Script<DriveRunner::Fault> PathStream::Runner::start_ramps() {
  const auto start = course_.at(0).position;
  twin_start_ = now_;
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    auto& here = axes_[axis];
    here.twin_begin = here.info.twin->elapsed();
    const auto position = microsteps(axis, start[axis]);
    here.info.twin->place({position});
    co_await command({Kind::move_to, axis, 0, position});
    if (!answer_) co_return refusal(axis);
    here.info.twin->move_to({position});
    here.told = Setting{ap::target_velocity, *settings_[axis].now(ap::max_velocity)};
    for (const auto parameter : {v1, vstart, tzerowait}) {
      auto refused = co_await set(axis, {parameter, 0});
      if (refused) co_return refused;
    }
  }
  co_return std::nullopt;
}

Script<DriveRunner::Fault> PathStream::Runner::by_position() {
  auto wrong = co_await start_ramps();
  if (wrong) co_return wrong;
  clock_.start(now_, true);
  clock_.pause(true);  // until the first leg is loaded
  for (std::size_t i = 0; i < course_.legs(); ++i) {
    const auto here = passage(i);
    clock_.advance(now_);
    const auto early = early_by(here);
    const auto due = now_ + duration(here.leg.begin - clock_.passed()) - early;
    if (i > 0) wrong = co_await watch_until(due);
    if (!wrong) wrong = asked_to_stop();
    if (!wrong && i > 0)
      wrong = note_delay(now_ - due, std::max(shortest_stream_period, lead_of(i)));
    if (!wrong) wrong = co_await pause_between(here.leg);
    if (wrong) co_return wrong;
    clock_.advance(now_);
    if (i > 0 && early < lead_of(i)) clock_.pause(true);  // at rest, until it is loaded
    wrong = co_await load(here);
    if (wrong) co_return wrong;
    ++report_.updates;
    clock_.advance(now_);
    clock_.pause(false);
    if (here.drive == Drive::by_ramps_after_joint) {
      co_await until(now_ + duration(here.leg.begin - clock_.passed()) + time_of_joint(i));
      wrong = co_await load_ramps(here);
      if (wrong) co_return wrong;
    }
    even_leg_.reset();
    if (here.drive == Drive::evenly) even_leg_ = here.leg;
    const auto read = i % axes_.size();
    wrong = co_await read_position(read);
    if (wrong) co_return wrong;
    correct_twin(read);
  }
  clock_.advance(now_);
  wrong = co_await watch_until(now_ + duration(course_.duration() - clock_.passed()));
  clock_.advance(now_);
  if (!wrong) wrong = asked_to_stop();
  co_return wrong;
}

// An axis that the joint makes much slower or faster needs the joint's acceleration: with that of
// the ramp, which is in proportion to where the leg goes, it would go far beyond.
bool PathStream::Runner::must_turn(const Passage& passage, std::size_t axis) const {
  if (passage.leg.start_speed == 0) return false;
  return std::abs(changes_at(passage.index)[axis]) > turning_part * passage.leg.axis[axis].vmax;
}

// On a long leg nothing is to be told to the axes, but they are looked at.
Script<DriveRunner::Fault> PathStream::Runner::watch_until(TimePoint due) {
  const auto look_takes = duration(time_to_send(commands_of_a_look));
  while (due - now_ > watch_interval + look_takes && !stop_asked_) {
    co_await until(now_ + watch_interval);
    watched_ = (watched_ + 1) % axes_.size();
    auto wrong = co_await check(watched_);
    if (!wrong) wrong = co_await read_position(watched_);
    if (wrong) co_return wrong;
    correct_twin(watched_);
  }
  co_await until(due);
  co_return asked_to_stop();
}

// At a corner where the course stands.
Script<DriveRunner::Fault> PathStream::Runner::pause_between(const CourseLeg& next) {
  if (next.start_speed > 0 || next.begin == 0 || !pause_asked_) co_return std::nullopt;
  clock_.advance(now_);
  co_await until(now_ + duration(next.begin - clock_.passed()));
  clock_.advance(now_);
  clock_.pause(true);
  while (pause_asked_ && !stop_asked_) co_await until(now_ + look_interval);
  co_return asked_to_stop();
}

Script<DriveRunner::Fault> PathStream::Runner::load(const Passage& passage) {
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    if (passage.leg.axis[axis].vmax == 0) continue;
    auto wrong = co_await check(axis);
    if (!wrong) wrong = asked_to_stop();
    if (!wrong) wrong = co_await load_axis(passage, axis);
    if (wrong) co_return wrong;
  }
  co_return std::nullopt;
}

// Even legs are passed evenly, whatever the course does between their ends.
double PathStream::Runner::planned_position(std::size_t axis) const {
  const double passed = clock_.passed();
  if (!even_leg_ || passed < even_leg_->begin || passed > even_leg_->end)
    return course_.at(passed).position[axis];
  const auto& [begin, end] = std::pair(even_leg_->begin, even_leg_->end);
  const double from = course_.at(begin).position[axis];
  return std::lerp(from, even_leg_->axis[axis].target, (passed - begin) / (end - begin));
}

// How much faster than planned an axis must be, to be at the end of its leg in time. An axis that
// is hardly moved by a leg may be off by more than its way: with a ramp it comes back to its end
// then, but on an even leg it goes on, and has to become slower.
double PathStream::Runner::pace(const Passage& passage, double speed, std::size_t axis) {
  const auto& leg = passage.leg;
  let_twin_run(axis, now_);
  clock_.advance(now_);
  const double begin = course_.at(leg.begin).position[axis];
  const double planned = planned_position(axis);
  const double is = expected_of_twin(axis) / axes_[axis].info.microsteps_per_unit;
  const double needed = 1 + (planned - is) / (leg.axis[axis].target - begin);
  const double part = passage.drive == Drive::evenly ? needed : std::abs(needed);
  const double slow = options_.even_within / seconds(look_interval);
  return std::clamp(part, slowest_part, std::max(fastest_part, 1 + slow / speed));
}

std::int32_t PathStream::Runner::velocity_in(const Passage& passage, double speed,
                                             std::size_t axis) {
  const auto& info = axes_[axis].info;
  return std::min(in_units(axis, speed * pace(passage, speed, axis), info.units.velocity),
                  info.greatest_velocity);
}

PathStream::Runner::Ramps PathStream::Runner::no_ramps(std::size_t axis) const {
  const auto& here = axes_[axis];
  return {here.joint_acceleration, here.joint_acceleration, here.info.greatest_stop_velocity};
}

// With ramps in proportion to such a way, an axis could not brake what the leg before it left.
bool PathStream::Runner::hardly_moves(const CourseLeg& leg, std::size_t axis) const {
  const double way = leg.axis[axis].target - course_.at(leg.begin).position[axis];
  return std::abs(way) <= options_.even_within;
}

// A leg that is late, or that had a joint before it, has less way left to brake on than planned.
PathStream::Runner::Ramps PathStream::Runner::ramps_for(const Passage& passage, std::size_t axis) {
  const auto& here = axes_[axis];
  const auto& leg = passage.leg;
  const auto& ramp = leg.axis[axis];
  auto ramps = no_ramps(axis);
  if (hardly_moves(leg, axis)) return ramps;
  const double in_time = pace(passage, ramp.vmax, axis);
  const double steeper = in_time > fastest_part ? in_time : 1;
  const auto most = std::max(here.joint_acceleration, here.info.greatest_acceleration);
  if (leg.speeds_up) ramps.amax = acceleration_in(axis, ramp.amax * steeper, most);
  if (!leg.slows_down) return ramps;
  const double left =
      std::abs(ramp.target - expected_of_twin(axis) / here.info.microsteps_per_unit);
  const double needed = (ramp.vstart * ramp.vstart - ramp.vstop * ramp.vstop) / (2 * left);
  const double planned = ramp.dmax * steeper;
  const double dmax_wanted = left > 0 ? std::max(planned, needed) : planned;
  ramps.dmax = acceleration_in(axis, dmax_wanted, most);
  ramps.vstop = std::max(least_vstop, in_units(axis, ramp.vstop, here.info.units.velocity));
  return ramps;
}

double PathStream::Runner::expected_of_twin(std::size_t axis) const {
  return axes_[axis].info.twin->motion().position.value + axes_[axis].ahead_of_twin;
}

// A command takes effect earlier or later than its twin is told; where that makes a motor stand for
// a moment, it is behind its twin for longer.
void PathStream::Runner::correct_twin(std::size_t axis) {
  const double position = *answer_;
  let_twin_run(axis, middle());
  axes_[axis].ahead_of_twin += observer_gain * (position - expected_of_twin(axis));
}

// What matters for braking comes after the target: written before, it would brake for the old one.
Script<DriveRunner::Fault> PathStream::Runner::load_axis(const Passage& passage, std::size_t axis) {
  const auto& [leg, drive, index] = passage;
  const auto& ramp = leg.axis[axis];
  const bool joint_only = drive == Drive::by_ramps_after_joint;
  auto ramps = drive == Drive::by_ramps ? ramps_for(passage, axis) : no_ramps(axis);
  if (drive == Drive::by_ramps && must_turn(passage, axis)) {
    const auto least = axes_[axis].joint_acceleration;
    ramps.amax = std::max(ramps.amax, least);
    ramps.dmax = std::max(ramps.dmax, least);
  }
  const auto velocity = velocity_in(passage, joint_only ? ramp.vstart : ramp.vmax, axis);
  const auto target = microsteps(axis, target_of(passage, axis));
  auto refused = co_await set_velocity(axis, velocity);
  if (refused) co_return refused;
  refused = co_await set(axis, {ap::max_acceleration, ramps.amax});
  if (refused) co_return refused;
  co_await command({Kind::set, axis, ap::target_position, target});
  if (!answer_) co_return refusal(axis);
  let_twin_run(axis, middle());
  axes_[axis].info.twin->move_to({target});
  co_return co_await set_braking(axis, ramps);
}

// What comes next may come late: an axis does not stand then, and need not speed up from rest, if
// it goes on as it does. So its target is beyond the end of an even leg, as far as that is on the
// path.
double PathStream::Runner::target_of(const Passage& passage, std::size_t axis) const {
  double target = passage.leg.axis[axis].target;
  if (passage.drive != Drive::evenly) return target;
  for (std::size_t i = passage.index + 1; i < course_.legs(); ++i) {
    const auto next = course_.leg(i);
    if (!leads_on(passage.leg, next, axis)) break;
    target = next.axis[axis].target;
    if (next.end_speed == 0) break;
  }
  return target;
}

bool PathStream::Runner::leads_on(const CourseLeg& leg, const CourseLeg& next,
                                  std::size_t axis) const {
  const double time = next.end - leg.begin;
  if (next.end - leg.end > max_blend_s) return false;
  const double from = course_.at(leg.begin).position[axis];
  const double speed = (leg.axis[axis].target - from) / (leg.end - leg.begin);
  const double way = next.axis[axis].target - course_.at(next.begin).position[axis];
  const double off = std::abs(from + speed * time - next.axis[axis].target);
  return speed * way > 0 && off <= farthest_lead_on * options_.even_within;
}

Script<DriveRunner::Fault> PathStream::Runner::load_ramps(const Passage& passage) {
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    const auto& ramp = passage.leg.axis[axis];
    if (ramp.vmax == 0) continue;
    auto wrong = co_await check(axis);
    if (!wrong) wrong = asked_to_stop();
    if (wrong) co_return wrong;
    const auto velocity = velocity_in(passage, ramp.vmax, axis);
    const auto ramps = ramps_for(passage, axis);
    wrong = co_await set_braking(axis, ramps);
    if (!wrong) wrong = co_await set(axis, {ap::max_acceleration, ramps.amax});
    if (!wrong) wrong = co_await set_velocity(axis, velocity);
    if (wrong) co_return wrong;
  }
  co_return std::nullopt;
}

Script<DriveRunner::Fault> PathStream::Runner::set_velocity(std::size_t axis, std::int32_t value) {
  auto refused = co_await set(axis, {ap::max_velocity, value});
  if (!refused) axes_[axis].told = Setting{ap::target_velocity, value};
  co_return refused;
}

Script<DriveRunner::Fault> PathStream::Runner::set_braking(std::size_t axis, Ramps ramps) {
  auto refused = co_await set(axis, {dmax, ramps.dmax});
  if (refused) co_return refused;
  refused = co_await set(axis, {vstop, ramps.vstop});
  co_return refused;
}

}  // namespace tmcl::plan
