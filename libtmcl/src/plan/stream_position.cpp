// A stream of positions: legs, loaded into ramp generators one after the other.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "plan/stream_runner.hpp"
#include "tmcl/parameter_number.hpp"
#include "tmcl/plain_number.hpp"

namespace tmcl::plan {
namespace {

namespace ap = axis_parameter;

constexpr auto v1 = number_of("velocity_v1");
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

// Where the course stands, an axis that is late is waited for.
constexpr Duration longest_lag = std::chrono::milliseconds(50);
constexpr Duration shortest_look = std::chrono::milliseconds(1);

constexpr std::size_t commands_of_a_look = 2;

// That every moving axis of a leg gets: it is checked, velocity and target are written.
constexpr std::size_t commands_of_an_axis = 3;
// Both accelerations and the stop velocity.
constexpr std::size_t commands_of_ramps = 3;
// That it gets once more if ramps follow its joint: it is checked, and its velocity is written.
constexpr std::size_t commands_after_joint = commands_of_ramps + 2;
// What part of a leg the axes may take for the joint before it; with ramps, they need the rest.
constexpr double joint_part_of_even_leg = 1. / 2;
constexpr double joint_part_of_ramps = 1. / 8;
// What part of the speed it was told for a joint an axis may lack when its ramp is loaded.
constexpr double near_speed = 1. / 32;
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
  if (leg.end_speed > 0 && off <= options_.even_within) {
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

// How long before its begin a leg's load begins. Its commands may take as long as the longest one
// did before the start; but not before the leg before it has begun.
Duration PathStream::Runner::early_by(const Passage& passage) const {
  const auto before = course_.leg(passage.index - 1);
  const auto commands = static_cast<std::int64_t>(commands_of(passage.index));
  const auto longest = std::max(lead_of(passage.index), commands * report_.worst_round_trip);
  const auto needed = longest + time_of_joint(passage.index) / 2;
  return std::min(needed, duration(passage.leg.begin - before.begin));
}

TimePoint PathStream::Runner::time_of(double course_time) {
  clock_.advance(now_);
  return now_ + duration(course_time - clock_.passed());
}

DriveRunner::Fault PathStream::Runner::fault_of_axes() const {
  using FaultKind = DriveFault::Kind;
  if (!course_.has_legs())
    return fault(FaultKind::unsuited, {},
                 "position mode needs a path without times; use velocity mode");
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
                   fmt::format("would be as fast as {} microsteps/s, and its stop velocity is {} "
                               "at most",
                               plain_number(top, 6), plain_number(most, 6)));
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
  for (std::size_t i = 0; i < course_.legs(); ++i) {
    const auto here = passage(i);
    if (here.leg.start_speed > 0) {
      wrong = co_await begin_on_the_way(here);
    } else {
      wrong = co_await begin_from_rest(here);
    }
    if (wrong) co_return wrong;
    ++report_.updates;
    if (here.drive == Drive::by_ramps_after_joint) {
      co_await until(time_of(here.leg.begin) + time_of_joint(i));
      wrong = co_await see_joint_speeds(here);
      if (!wrong) wrong = co_await load_ramps(here);
      if (wrong) co_return wrong;
    }
    const auto read = i % axes_.size();
    wrong = co_await read_position(read);
    if (wrong) co_return wrong;
    correct_twin(read);
  }
  wrong = co_await watch_until(time_of(course_.duration()));
  clock_.advance(now_);
  if (!wrong) wrong = asked_to_stop();
  co_return wrong;
}

// All that the axes need is written while they stand, then their targets in quick succession: that
// is when the course goes on.
Script<DriveRunner::Fault> PathStream::Runner::begin_from_rest(const Passage& passage) {
  auto wrong = co_await see_standing(passage);
  if (!wrong) wrong = co_await pause_between(passage.leg);
  if (wrong) co_return wrong;
  const auto due = time_of(passage.leg.begin);
  clock_.pause(true);
  wrong = co_await prepare_loads(passage);
  if (wrong) co_return wrong;
  co_await until(due);
  if (auto asked = asked_to_stop()) co_return asked;
  const auto begin = now_;
  wrong = co_await begin_leg(passage);
  clock_.go_on(begin + (now_ - begin) / 2, passage.leg.begin);
  co_return wrong;
}

// Written before the end of the leg that comes first, what an axis needs would change how it
// brakes for that end; and it may be a little late.
Script<DriveRunner::Fault> PathStream::Runner::see_standing(const Passage& passage) {
  if (passage.index == 0) co_return asked_to_stop();
  auto wrong = co_await watch_until(time_of(course_.leg(passage.index - 1).end));
  for (std::size_t axis = 0; axis < axes_.size() && !wrong; ++axis)
    wrong = co_await see_standing(axis);
  co_return wrong;
}

Script<DriveRunner::Fault> PathStream::Runner::see_standing(std::size_t axis) {
  const auto limit = now_ + longest_lag;
  while (now_ < limit && !stop_asked_) {
    let_twin_run(axis, now_);
    if (axes_[axis].info.twin->motion().velocity.value == 0) break;
    co_await until(now_ + shortest_look);
  }
  co_return asked_to_stop();
}

// An axis that was told its speed before it had braked for the joint needs longer to have it; and
// with the acceleration of a ramp that hardly moves it, it would never get there in time.
Script<DriveRunner::Fault> PathStream::Runner::see_joint_speeds(const Passage& passage) {
  const auto limit = time_of(passage.leg.begin) + duration(longest_joint(passage));
  for (const auto& load : loads_) {
    const double wanted = axes_[load.axis].told->value;
    while (now_ < limit && !stop_asked_) {
      let_twin_run(load.axis, now_);
      const double speed = std::abs(axes_[load.axis].info.twin->motion().velocity.value);
      if (std::abs(speed - wanted) <= near_speed * wanted) break;
      co_await until(now_ + shortest_look);
    }
  }
  co_return asked_to_stop();
}

// What changes nothing before the joint is written before it; what the joint itself is, for all
// axes in quick succession around its time; and what would change how an axis brakes for it, after.
Script<DriveRunner::Fault> PathStream::Runner::begin_on_the_way(const Passage& passage) {
  const auto lead = early_by(passage);
  const auto due = time_of(passage.leg.begin) - lead;
  auto wrong = co_await watch_until(due);
  if (!wrong)
    wrong = note_delay(now_ - due, std::max(shortest_stream_period, lead_of(passage.index)));
  if (!wrong) wrong = co_await prepare_loads(passage);
  const auto most = std::max(shortest_stream_period, lead_of(passage.index));
  if (!wrong) wrong = note_delay(now_ - time_of(passage.leg.begin), most);
  if (wrong) co_return wrong;
  const auto spread = static_cast<std::int64_t>(loads_.size()) * report_.round_trip;
  // Half of the change of speed comes before the joint: that departs least from the corner.
  const auto change = time_of_joint(passage.index) / 2;
  const auto joint = std::max(now_, time_at_joint(passage) - spread / 2 - change);
  co_await until(joint);
  const auto begin = now_;
  wrong = note_delay(now_ - joint, most);
  if (!wrong) wrong = asked_to_stop();
  if (!wrong) wrong = co_await begin_leg(passage);
  clock_.go_on(begin + (now_ - begin) / 2 + change, passage.leg.begin);
  co_return wrong;
}

// When the axes pass the joint by what their twins do. An axis that is sent on before it has got
// there cuts the corner by far more than a course that goes on a little later costs.
TimePoint PathStream::Runner::time_at_joint(const Passage& passage) {
  const auto before = course_.leg(passage.index - 1);
  const auto from = course_.at(before.begin).position;
  const auto limit = time_of(passage.leg.begin) + longest_lag;
  std::vector<AxisTwin> twins;
  double length = 0;
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    let_twin_run(axis, now_);
    twins.push_back(*axes_[axis].info.twin);
    length = std::hypot(length, before.axis[axis].target - from[axis]);
  }
  const double near = before.end_speed * seconds(shortest_look) / 2;
  auto time = now_;
  for (; time < limit; time += shortest_look / 2) {
    double left = 0;
    for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
      const auto is = twins[axis].motion().position.value + axes_[axis].ahead_of_twin;
      const double joint = before.axis[axis].target;
      const double way = joint - is / axes_[axis].info.microsteps_per_unit;
      left += way * (joint - from[axis]) / length;
      twins[axis].advance(shortest_look / 2);
    }
    if (left <= near) break;
  }
  return time;
}

Script<DriveRunner::Fault> PathStream::Runner::prepare_loads(const Passage& passage) {
  loads_.clear();
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    if (passage.leg.axis[axis].vmax == 0) continue;
    auto wrong = co_await check(axis);
    if (wrong) co_return wrong;
  }
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    if (passage.leg.axis[axis].vmax == 0) continue;
    auto wrong = asked_to_stop();
    loads_.push_back(load_for(passage, axis));
    if (!wrong) wrong = co_await write_before(passage, loads_.back());
    if (wrong) co_return wrong;
  }
  // Those that turn last: they stop there by themselves.
  std::ranges::stable_sort(loads_, {}, &Load::way);
  co_return std::nullopt;
}

Script<DriveRunner::Fault> PathStream::Runner::write_before(const Passage& passage,
                                                            const Load& load) {
  Fault refused;
  if (load.way != Way::goes_on_late)
    refused = co_await set(load.axis, {ap::max_acceleration, load.amax});
  if (!refused && load.way == Way::from_rest) refused = co_await set_braking(passage, load);
  if (!refused && (load.way == Way::from_rest || load.way == Way::brakes))
    refused = co_await set_start_speed(passage, load.axis);
  if (refused || load.way != Way::goes_on) co_return refused;
  refused = co_await set_target(load);
  if (!refused) refused = co_await set_braking(passage, load);
  co_return refused;
}

Script<DriveRunner::Fault> PathStream::Runner::begin_leg(const Passage& passage) {
  even_leg_.reset();
  if (passage.drive == Drive::evenly) even_leg_ = passage.leg;
  for (const auto& load : loads_) {
    auto refused = asked_to_stop();
    if (!refused && load.way == Way::turns) refused = co_await see_standing(load.axis);
    if (!refused && load.way == Way::goes_on_late)
      refused = co_await set(load.axis, {ap::max_acceleration, load.amax});
    if (!refused) refused = co_await set_start_speed(passage, load.axis);
    // A generator that brakes by less would go on with that for a target that stays where it is.
    const bool may_brake = load.way == Way::brakes || load.way == Way::goes_on_late;
    if (!refused && may_brake) refused = co_await set_deceleration(passage, load);
    if (!refused && load.way != Way::goes_on) refused = co_await set_target(load);
    if (refused) co_return refused;
  }
  for (const auto& load : loads_) {
    auto refused = asked_to_stop();
    if (!refused) refused = co_await set_braking(passage, load);
    if (refused) co_return refused;
  }
  co_return std::nullopt;
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

// With ramps in proportion to such a way, an axis could not brake what the leg before it left.
bool PathStream::Runner::hardly_moves(const CourseLeg& leg, std::size_t axis) const {
  const double way = leg.axis[axis].target - course_.at(leg.begin).position[axis];
  return std::abs(way) <= options_.even_within;
}

// With a steeper ramp than planned, an axis begins to brake later.
bool PathStream::Runner::has_slowed_down(std::size_t axis) const {
  const double speed = std::abs(axes_[axis].info.twin->motion().velocity.value);
  return axes_[axis].told && speed < (1 - near_speed) * axes_[axis].told->value;
}

// How an axis comes to the leg.
PathStream::Runner::Way PathStream::Runner::way_to(const Passage& passage, std::size_t axis) const {
  if (passage.index == 0 || passage.leg.start_speed == 0) return Way::from_rest;
  const auto before = this->passage(passage.index - 1);
  if (before.leg.axis[axis].vmax == 0) return Way::from_rest;
  if (!goes_on(passage.index - 1, axis)) return Way::turns;
  if (before.drive == Drive::evenly || !before.leg.slows_down) return Way::goes_on;
  const bool brakes_by_then = duration(before.leg.down) >= early_by(passage);
  return brakes_by_then && has_slowed_down(axis) ? Way::brakes : Way::goes_on_late;
}

// In the same sense on the next leg.
bool PathStream::Runner::goes_on(std::size_t index, std::size_t axis) const {
  if (index + 1 >= course_.legs()) return false;
  const auto leg = course_.leg(index), next = course_.leg(index + 1);
  if (leg.end_speed == 0 || leg.axis[axis].vmax == 0) return false;
  const double from = course_.at(leg.begin).position[axis];
  const double joint = leg.axis[axis].target;
  return (joint - from) * (next.axis[axis].target - joint) > 0;
}

// A leg that is late, or that had a joint before it, has less way left to brake on than planned.
PathStream::Runner::Load PathStream::Runner::load_for(const Passage& passage, std::size_t axis) {
  const auto& here = axes_[axis];
  const auto& leg = passage.leg;
  const auto& ramp = leg.axis[axis];
  Load load{axis, way_to(passage, axis), here.joint_acceleration, own_acceleration(axis), 0, 0};
  const bool by_ramps = passage.drive == Drive::by_ramps;
  if (passage.drive != Drive::evenly && !hardly_moves(leg, axis)) {
    const double in_time = pace(passage, ramp.vmax, axis);
    const double steeper = in_time > fastest_part ? in_time : 1;
    const auto most = std::max(here.joint_acceleration, here.info.greatest_acceleration);
    if (by_ramps && leg.speeds_up) load.amax = acceleration_in(axis, ramp.amax * steeper, most);
    if (leg.slows_down) {
      const double left =
          std::abs(ramp.target - expected_of_twin(axis) / here.info.microsteps_per_unit);
      const double needed = (ramp.vstart * ramp.vstart - ramp.vstop * ramp.vstop) / (2 * left);
      const double planned = ramp.dmax * steeper;
      load.dmax = acceleration_in(axis, left > 0 ? std::max(planned, needed) : planned, most);
    }
  }
  if (by_ramps && must_turn(passage, axis)) {
    load.amax = std::max(load.amax, own_acceleration(axis));
    load.dmax = std::max(load.dmax, own_acceleration(axis));
  }
  aim(passage, load);
  return load;
}

// An axis that goes on at the joint is sent beyond it, as far as it takes to brake from its speed
// there: it has that speed at the joint, and if the next leg comes late, it comes to rest by its
// ramp and loses no steps. It is never sent beyond the place where it turns, or rests.
void PathStream::Runner::aim(const Passage& passage, Load& load) const {
  const auto& info = axes_[load.axis].info;
  const auto& ramp = passage.leg.axis[load.axis];
  double target = ramp.target;
  double speed_squared = ramp.vstop * ramp.vstop;
  const double deceleration =
      load.dmax * info.units.acceleration.value / std::abs(info.microsteps_per_unit);
  for (auto i = passage.index; speed_squared > 0 && goes_on(i, load.axis); ++i) {
    const double way = course_.leg(i + 1).axis[load.axis].target - target;
    const double needed = speed_squared / (2 * deceleration);
    target += std::copysign(std::min(needed, std::abs(way)), way);
    speed_squared = std::max(0.0, speed_squared - 2 * deceleration * std::abs(way));
  }
  load.target = microsteps(load.axis, target);
  load.vstop = std::max(least_vstop, in_units(load.axis, std::sqrt(speed_squared),
                                              info.units.velocity, info.greatest_stop_velocity));
}

// The smaller one of its two.
std::int32_t PathStream::Runner::own_acceleration(std::size_t axis) const {
  const auto up = settings_[axis].before(ap::max_acceleration);
  const auto down = settings_[axis].before(dmax);
  const auto least = acceleration_in(axis, 0, up);
  return std::max(least, down > 0 ? std::min(up, down) : up);
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

Script<DriveRunner::Fault> PathStream::Runner::load_ramps(const Passage& passage) {
  for (const auto& load : loads_) {
    auto wrong = co_await check(load.axis);
    if (!wrong) wrong = asked_to_stop();
    if (wrong) co_return wrong;
    wrong = co_await set(load.axis, {dmax, load.dmax});
    if (wrong) co_return wrong;
    const auto& ramp = passage.leg.axis[load.axis];
    const auto most = axes_[load.axis].info.greatest_acceleration;
    if (passage.leg.speeds_up && !hardly_moves(passage.leg, load.axis)) {
      const auto amax = acceleration_in(load.axis, ramp.amax, most);
      wrong = co_await set(load.axis, {ap::max_acceleration, amax});
    }
    if (!wrong) wrong = co_await set_velocity(passage, ramp.vmax, load.axis);
    if (wrong) co_return wrong;
  }
  co_return std::nullopt;
}

Script<DriveRunner::Fault> PathStream::Runner::set_start_speed(const Passage& passage,
                                                               std::size_t axis) {
  const auto& ramp = passage.leg.axis[axis];
  const bool joint_only = passage.drive == Drive::by_ramps_after_joint;
  return set_velocity(passage, joint_only ? ramp.vstart : ramp.vmax, axis);
}

Script<DriveRunner::Fault> PathStream::Runner::set_velocity(const Passage& passage, double speed,
                                                            std::size_t axis) {
  const auto value = velocity_in(passage, speed, axis);
  auto refused = co_await set(axis, {ap::max_velocity, value});
  if (!refused) axes_[axis].told = Setting{ap::target_velocity, value};
  co_return refused;
}

Script<DriveRunner::Fault> PathStream::Runner::set_target(const Load& load) {
  co_await command({Kind::set, load.axis, ap::target_position, load.target});
  if (!answer_) co_return refusal(load.axis);
  let_twin_run(load.axis, middle());
  axes_[load.axis].info.twin->move_to({load.target});
  co_return std::nullopt;
}

// With the deceleration of the leg, an axis that the joint makes slower would begin to brake for
// the leg's end there: it gets it when it has the speed of the leg.
Script<DriveRunner::Fault> PathStream::Runner::set_deceleration(const Passage& passage,
                                                                const Load& load) {
  const bool joint_only = passage.drive == Drive::by_ramps_after_joint;
  return set(load.axis, {dmax, joint_only ? axes_[load.axis].joint_acceleration : load.dmax});
}

Script<DriveRunner::Fault> PathStream::Runner::set_braking(const Passage& passage,
                                                           const Load& load) {
  auto refused = co_await set_deceleration(passage, load);
  if (refused) co_return refused;
  refused = co_await set(load.axis, {vstop, load.vstop});
  co_return refused;
}

}  // namespace tmcl::plan
