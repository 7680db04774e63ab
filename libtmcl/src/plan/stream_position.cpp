// A stream of positions: legs, loaded into ramp generators one after the other.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "plan/stream_runner.hpp"

namespace tmcl::plan {
namespace {

namespace ap = axis_parameter;
using Kind = StreamCommand::Kind;

constexpr std::uint8_t v1 = 16;
constexpr std::uint8_t dmax = 17;
constexpr std::uint8_t vstart = 19;
constexpr std::uint8_t vstop = 20;
constexpr std::uint8_t tzerowait = 21;
constexpr std::int32_t least_vstop = 10;  // data sheets; below it a motor may not come to rest

// By how much a leg may be faster or slower than planned, to be back on time at its end.
constexpr double slowest_part = 0.8;
constexpr double fastest_part = 1.25;
constexpr Duration look_interval = std::chrono::milliseconds(10);

// A leg is loaded earlier than it has to be, in case that it takes longer; by so much at most.
constexpr double most_ahead_s = 0.02;
constexpr double instant_s = 1e-7;

// That every moving axis of a leg gets: it is checked, velocity and target are written.
constexpr std::size_t commands_of_an_axis = 3;

}  // namespace

Script<PathStream::Runner::Fault> PathStream::Runner::prepare_legs() {
  auto wrong = fault_of_legs();
  if (wrong) co_return wrong;
  constexpr std::uint8_t needed[] = {
      ap::max_velocity, ap::max_acceleration, v1, dmax, vstart, vstop, tzerowait};
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    for (const auto parameter : needed) {
      auto unknown = co_await know(axis, parameter);
      if (unknown) co_return unknown;
    }
  }
  co_return std::nullopt;
}

// A short leg that does not end at rest is passed with its mean speed.
CourseLeg PathStream::Runner::leg_at(std::size_t index) const {
  auto leg = course_.leg(index);
  const double time = leg.end - leg.begin;
  const double off = std::abs(leg.acceleration) * time * time / 8;
  if (leg.end_speed == 0 || off > options_.even_within) return leg;
  leg.speeds_up = leg.slows_down = false;
  for (auto& ramp : leg.axis) ramp.vmax *= leg.mean_speed / leg.peak_speed;
  return leg;
}

// An acceleration is written for a leg that needs it, and again after it.
std::size_t PathStream::Runner::commands_of(std::size_t index) const {
  const auto leg = leg_at(index);
  const auto before = index > 0 ? leg_at(index - 1) : CourseLeg{};
  std::size_t of_axis = commands_of_an_axis;
  if (leg.speeds_up || before.speeds_up) of_axis += 1;
  if (leg.slows_down || before.slows_down || index == 0) of_axis += 2;
  std::size_t moving = 0;
  for (std::size_t axis = 0; axis < axes_.size(); ++axis)
    moving += leg.axis[axis].vmax > 0 ? 1U : 0U;
  return 1 + moving * of_axis;
}

Duration PathStream::Runner::lead_of(std::size_t index) const {
  return duration(seconds(report_.round_trip) * static_cast<double>(commands_of(index)) /
                  (1 - spare_part_of_bus));
}

// Whoever turns a corner early leaves the path by what the velocity changes there, times how early
// that is. Not before the leg that comes before has begun.
Duration PathStream::Runner::ahead_of(std::size_t index) const {
  if (index == 0) return {};
  const auto before = course_.leg(index - 1);
  const auto from = course_.at(before.end - instant_s).velocity;
  const auto to = course_.at(course_.leg(index).begin + instant_s).velocity;
  double change = 0;
  for (std::size_t axis = 0; axis < axes_.size(); ++axis)
    change = std::hypot(change, to[axis] - from[axis]);
  const double room = before.end - before.begin - seconds(lead_of(index));
  const double tolerable = change > 0 ? options_.even_within / change : most_ahead_s;
  return duration(std::clamp(std::min(room, tolerable), 0.0, most_ahead_s));
}

PathStream::Runner::Fault PathStream::Runner::fault_of_legs() {
  using FaultKind = StreamFault::Kind;
  if (!course_.has_legs())
    return fault(FaultKind::unsuited, 0, "a table with times has no legs; velocity mode takes it");
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    const auto& info = axes_[axis].info;
    if (!info.twin || info.twin->model().family != Family::sixpoint) {
      return fault(FaultKind::unsuited, axis,
                   fmt::format("{{{}}} has no start and stop velocities; velocity mode takes any "
                               "module",
                               axis));
    }
    const double most = info.greatest_stop_velocity * info.units.velocity.value;
    const double top = course_.top_speed(axis) * std::abs(info.microsteps_per_unit);
    if (course_.legs() > 1 && top > most) {
      return fault(FaultKind::unsuited, axis,
                   fmt::format("{{{}}} would be as fast as {:.6g} microsteps/s, and its stop "
                               "velocity is {:.6g} at most",
                               axis, top, most));
    }
  }
  Duration free{};
  report_.period = Duration::max();
  for (std::size_t i = 0; i < course_.legs(); ++i) {
    const auto leg = leg_at(i);
    const auto lead = lead_of(i);
    const auto begin = duration(leg.begin);
    free = std::max(free, begin - lead) + lead;
    report_.period = std::min(report_.period, duration(leg.end - leg.begin));
    if (i > 0 && free > begin + lead / 2) {
      return fault(FaultKind::slow_bus, 0,
                   fmt::format("line {}: its leg takes {:.2f} ms, and to load it takes {:.2f} ms: "
                               "{} commands of {:.0f} us, and a quarter spare; velocity mode needs "
                               "fewer",
                               leg.line, (leg.end - leg.begin) * 1e3, seconds(lead) * 1e3,
                               commands_of(i), seconds(report_.round_trip) * 1e6));
    }
  }
  return std::nullopt;
}

// A move to where it stands brings a motor into the mode in which targets count.
Script<PathStream::Runner::Fault> PathStream::Runner::start_ramps() {
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
    here.velocity = here.parameters[ap::max_velocity];
    for (const auto parameter : {v1, vstart, tzerowait}) {
      auto refused = co_await set(axis, parameter, 0);
      if (refused) co_return refused;
    }
  }
  co_return std::nullopt;
}

Script<PathStream::Runner::Fault> PathStream::Runner::by_position() {
  auto wrong = co_await start_ramps();
  if (wrong) co_return wrong;
  clock_.start(now_, true);
  clock_.pause(true);  // until the first leg is loaded
  for (std::size_t i = 0; i < course_.legs(); ++i) {
    const auto leg = leg_at(i);
    clock_.advance(now_);
    const auto due = now_ + duration(leg.begin - clock_.passed()) - lead_of(i) - ahead_of(i);
    if (i > 0) co_await until(due);
    wrong = asked_to_stop();
    if (!wrong && i > 0)
      wrong = note_delay(now_ - due, std::max(shortest_stream_period, lead_of(i)));
    if (!wrong) wrong = co_await pause_between(leg);
    if (wrong) co_return wrong;
    wrong = co_await load(leg);
    if (wrong) co_return wrong;
    ++report_.updates;
    clock_.advance(now_);
    clock_.pause(false);
    const auto read = i % axes_.size();
    wrong = co_await read_position(read);
    if (wrong) co_return wrong;
    correct_twin(read);
  }
  clock_.advance(now_);
  co_await until(now_ + duration(course_.duration() - clock_.passed()));
  clock_.advance(now_);
  co_return asked_to_stop();
}

// At a corner where the course stands.
Script<PathStream::Runner::Fault> PathStream::Runner::pause_between(const CourseLeg& next) {
  if (next.start_speed > 0 || next.begin == 0 || !pause_asked_) co_return std::nullopt;
  clock_.advance(now_);
  co_await until(now_ + duration(next.begin - clock_.passed()));
  clock_.advance(now_);
  clock_.pause(true);
  while (pause_asked_ && !stop_asked_) co_await until(now_ + look_interval);
  co_return asked_to_stop();
}

Script<PathStream::Runner::Fault> PathStream::Runner::load(const CourseLeg& leg) {
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    if (leg.axis[axis].vmax == 0) continue;
    auto wrong = co_await check(axis);
    if (!wrong) wrong = asked_to_stop();
    if (!wrong) wrong = co_await load_axis(leg, axis);
    if (wrong) co_return wrong;
  }
  co_return std::nullopt;
}

PathStream::Runner::Load PathStream::Runner::load_for(const CourseLeg& leg, std::size_t axis) {
  auto& here = axes_[axis];
  const auto& ramp = leg.axis[axis];
  const double scale = std::abs(here.info.microsteps_per_unit);
  const auto in_units = [&](double value, double unit) {
    return std::max(1, static_cast<std::int32_t>(std::ceil(value * scale / unit - 1e-6)));
  };
  let_twin_run(axis, now_);
  clock_.advance(now_);
  Load load;
  load.target = microsteps(axis, ramp.target);
  const double begin = course_.at(leg.begin).position[axis];
  const double planned = course_.at(clock_.passed()).position[axis];
  const double is = expected_of_twin(axis) / here.info.microsteps_per_unit;
  const double part = 1 + (planned - is) / (ramp.target - begin);
  load.vmax = in_units(ramp.vmax * std::clamp(part, slowest_part, fastest_part),
                       here.info.units.velocity.value);
  load.amax = leg.speeds_up ? in_units(ramp.amax, here.info.units.acceleration.value)
                            : here.before[ap::max_acceleration];
  load.dmax = leg.slows_down ? in_units(ramp.dmax, here.info.units.acceleration.value)
                             : here.before[ap::max_acceleration];
  load.vstop = leg.slows_down
                   ? std::max(least_vstop, in_units(ramp.vstop, here.info.units.velocity.value))
                   : here.info.greatest_stop_velocity;
  return load;
}

double PathStream::Runner::expected_of_twin(std::size_t axis) const {
  return axes_[axis].info.twin->motion().position.value + axes_[axis].position;
}

// A command takes effect earlier or later than its twin is told; where that makes a motor stand for
// a moment, it is behind its twin for longer.
void PathStream::Runner::correct_twin(std::size_t axis) {
  const double position = *answer_;
  let_twin_run(axis, middle());
  axes_[axis].position += trust_in_a_reading * (position - expected_of_twin(axis));
}

// What matters for braking comes after the target: written before, it would brake for the old one.
Script<PathStream::Runner::Fault> PathStream::Runner::load_axis(const CourseLeg& leg,
                                                                std::size_t axis) {
  const auto load = load_for(leg, axis);
  auto refused = co_await set(axis, ap::max_velocity, load.vmax);
  if (refused) co_return refused;
  axes_[axis].velocity = load.vmax;
  refused = co_await set(axis, ap::max_acceleration, load.amax);
  if (refused) co_return refused;
  co_await command({Kind::set, axis, ap::target_position, load.target});
  if (!answer_) co_return refusal(axis);
  let_twin_run(axis, middle());
  axes_[axis].info.twin->move_to({load.target});
  refused = co_await set(axis, dmax, load.dmax);
  if (refused) co_return refused;
  refused = co_await set(axis, vstop, load.vstop);
  co_return refused;
}

}  // namespace tmcl::plan
