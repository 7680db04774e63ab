// A stream of positions: how the course is passed.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "motion/drive/position_runner.hpp"
#include "tmcl/plain_number.hpp"

namespace tmcl::plan {
namespace {

namespace ap = axis_parameter;

constexpr auto v1 = number_of("velocity_v1");
constexpr auto vstart = number_of(Family::sixpoint, "start_velocity");
constexpr auto tzerowait = number_of("ramp_wait_time");
// Where the course stands, an axis that is late is waited for.
constexpr Duration longest_lag = std::chrono::milliseconds(50);
constexpr Duration shortest_look = std::chrono::milliseconds(1);
constexpr std::size_t commands_of_a_look = 2;

}  // namespace

StreamScript PositionRunner::prepare() {
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

// An axis that changes its speed at a joint falls behind by half of the change, times the time that
// takes.
StreamScript PositionRunner::set_joint_accelerations() {
  AxisValues needed{};
  for (std::size_t i = 0; i < course_.legs(); ++i) {
    const auto changes = legs_.changes_at(i);
    const double longest = RampLegs::longest_joint(legs_.passage(i));
    for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
      const double change = std::abs(changes[axis]);
      if (change == 0) continue;
      const double time = std::min(longest, 2 * options_.even_within / change);
      needed[axis] = std::max(needed[axis], change / time);
    }
    if (yields_at(i)) co_await until(now_);
    if (auto asked = asked_to_stop()) co_return asked;
  }
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    const auto own = settings_[axis].before(ap::max_acceleration);
    const auto most = std::max(own, axes_[axis].greatest_acceleration);
    legs_.joint_accelerations[axis] =
        std::max(own, acceleration_in(axes_[axis], needed[axis], most));
  }
  co_return std::nullopt;
}

DriveRunner::Fault PositionRunner::fault_of_axes() const {
  using FaultKind = DriveFault::Kind;
  if (!course_.has_legs())
    return fault(FaultKind::unsuited, {},
                 "position mode needs a path without times; use velocity mode");
  if (!course_.impulses().empty())
    return fault(FaultKind::unsuited, {},
                 "position mode cannot shape a path; use velocity mode, or segments");
  if (std::isfinite(course_.limits().jerk))
    return fault(FaultKind::unsuited, {},
                 "position mode cannot limit a jerk; use velocity mode, or segments");
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    const auto& info = axes_[axis];
    if (!info.twin || info.twin->model().family != Family::sixpoint) {
      return fault(FaultKind::unsuited, axis,
                   "has no start and stop velocities; velocity mode takes any module");
    }
    const double most = info.greatest_stop_velocity * info.units.velocity.value /
                        std::abs(info.microsteps_per_unit);
    const double top = course_.top_speed(axis);
    if (course_.legs() > 1 && top > most) {
      return fault(FaultKind::unsuited, axis,
                   fmt::format("would be as fast as {} units/s, and its stop velocity (parameter "
                               "20) is {} units/s at most",
                               plain_number(top, 6), plain_number(most, 6)));
    }
  }
  return std::nullopt;
}

// A leg is loaded while those before it are passed.
std::string PositionRunner::too_short(std::size_t index) const {
  const auto leg = course_.leg(index), before = course_.leg(index - 1);
  return fmt::format(
      "line {}: to load it takes {:.2f} ms ({} commands of {:.0f} us, and a quarter spare), and "
      "the leg before it, of line {}, takes {:.2f} ms; velocity mode needs fewer commands",
      leg.line, seconds(legs_.lead_of(index)) * 1e3, legs_.commands_of(index),
      seconds(report_.round_trip) * 1e6, before.line, (before.end - before.begin) * 1e3);
}

StreamScript PositionRunner::fit_legs_to_bus() {
  Duration free{};
  report_.period = Duration::max();
  for (std::size_t i = 0; i < course_.legs(); ++i) {
    const auto [leg, drive, place] = legs_.passage(i);
    const auto lead = legs_.lead_of(i);
    const auto begin = duration(leg.begin);
    free = std::max(free, begin - lead) + lead;
    report_.period = std::min(report_.period, duration(leg.end - leg.begin));
    if (i > 0 && free > begin + lead / 2) {
      co_return fault(DriveFault::Kind::slow_bus, {}, too_short(i));
    }
    if (drive == Drive::by_ramps_after_joint)
      free = begin + legs_.time_of_joint(i) +
             duration(time_to_send(report_.round_trip, commands_after_joint * axes_.size()));
    if (yields_at(i)) co_await until(now_);
    if (auto asked = asked_to_stop()) co_return asked;
  }
  co_return std::nullopt;
}

// A move to where it stands brings a motor into the mode in which targets count.
StreamScript PositionRunner::start_ramps() {
  const auto start = course_.at(0).position;
  twin_start_ = now_;
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    twins_[axis].begin = axes_[axis].twin->elapsed();
    const auto position = microsteps(axis, start[axis]);
    axes_[axis].twin->place({position});
    co_await command({Kind::move_to, axis, 0, position});
    if (!answer_) co_return refusal(axis);
    axes_[axis].twin->move_to({position});
    told_[axis] = Setting{ap::target_velocity, *settings_[axis].now(ap::max_velocity)};
    for (const auto parameter : {v1, vstart, tzerowait}) {
      auto refused = co_await set(axis, {parameter, 0});
      if (refused) co_return refused;
    }
  }
  co_return std::nullopt;
}

StreamScript PositionRunner::pass_course() {
  auto wrong = co_await start_ramps();
  if (wrong) co_return wrong;
  clock_.start(now_, true);
  for (std::size_t i = 0; i < course_.legs(); ++i) {
    const auto here = legs_.passage(i);
    if (here.leg.start_speed > 0) {
      wrong = co_await begin_on_the_way(here);
    } else {
      wrong = co_await begin_from_rest(here);
    }
    if (wrong) co_return wrong;
    ++report_.updates;
    if (here.drive == Drive::by_ramps_after_joint) {
      co_await until(time_of(here.leg.begin) + legs_.time_of_joint(i));
      wrong = co_await see_joint_speeds(here);
      if (!wrong) wrong = co_await load_ramps(here);
      if (wrong) co_return wrong;
    }
    if (reads_encoder(i)) {
      wrong = co_await look_at_encoder();
      if (wrong) co_return wrong;
      continue;
    }
    const auto read = next_to_read();
    wrong = co_await read_position(read);
    if (wrong) co_return wrong;
    correct_twin(read);
  }
  wrong = co_await pass_halts(course_.duration());
  if (!wrong) wrong = co_await watch_until(time_of(course_.duration()));
  clock_.advance(now_);
  if (!wrong) wrong = asked_to_stop();
  co_return wrong;
}

// All that the axes need is written while they stand, then their targets in quick succession: that
// is when the course goes on.
StreamScript PositionRunner::begin_from_rest(const Passage& passage) {
  auto wrong = co_await see_standing(passage);
  if (!wrong) wrong = co_await pass_halts(passage.leg.begin);
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
StreamScript PositionRunner::see_standing(const Passage& passage) {
  if (passage.index == 0) co_return asked_to_stop();
  auto wrong = co_await watch_until(time_of(course_.leg(passage.index - 1).end));
  for (std::size_t axis = 0; axis < axes_.size() && !wrong; ++axis)
    wrong = co_await see_standing(axis);
  co_return wrong;
}

StreamScript PositionRunner::see_standing(std::size_t axis) {
  const auto limit = now_ + longest_lag;
  while (now_ < limit && !stop_asked_) {
    let_twin_run(axis, now_);
    if (axes_[axis].twin->motion().velocity.value == 0) break;
    co_await until(now_ + shortest_look);
  }
  co_return asked_to_stop();
}

// An axis that was told its speed before it had braked for the joint needs longer to have it; and
// with the acceleration of a ramp that hardly moves it, it would never get there in time.
StreamScript PositionRunner::see_joint_speeds(const Passage& passage) {
  const auto limit = time_of(passage.leg.begin) + duration(RampLegs::longest_joint(passage));
  for (const auto& load : loads_) {
    const double wanted = told_[load.axis]->value;
    while (now_ < limit && !stop_asked_) {
      let_twin_run(load.axis, now_);
      const double speed = std::abs(axes_[load.axis].twin->motion().velocity.value);
      if (std::abs(speed - wanted) <= near_speed * wanted) break;
      co_await until(now_ + shortest_look);
    }
  }
  co_return asked_to_stop();
}

// What changes nothing before the joint is written before it; what the joint itself is, for all
// axes in quick succession around its time; and what would change how an axis brakes for it, after.
StreamScript PositionRunner::begin_on_the_way(const Passage& passage) {
  const auto lead = legs_.early_by(passage);
  const auto due = time_of(passage.leg.begin) - lead;
  auto wrong = co_await watch_until(due);
  if (!wrong)
    wrong = note_delay(now_ - due, std::max(shortest_stream_period, legs_.lead_of(passage.index)));
  if (!wrong) wrong = co_await prepare_loads(passage);
  const auto most = std::max(shortest_stream_period, legs_.lead_of(passage.index));
  if (!wrong) wrong = note_delay(now_ - time_of(passage.leg.begin), most);
  if (wrong) co_return wrong;
  const auto spread = static_cast<std::int64_t>(loads_.size()) * report_.round_trip;
  // Half of the change of speed comes before the joint: that departs least from the corner.
  const auto change = legs_.time_of_joint(passage.index) / 2;
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
TimePoint PositionRunner::time_at_joint(const Passage& passage) {
  const auto before = course_.leg(passage.index - 1);
  const auto from = course_.at(before.begin).position;
  const auto limit = time_of(passage.leg.begin) + longest_lag;
  std::vector<AxisTwin> twins;
  double length = 0;
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    let_twin_run(axis, now_);
    twins.push_back(*axes_[axis].twin);
    length = std::hypot(length, before.axis[axis].target - from[axis]);
  }
  const double near = before.end_speed * seconds(shortest_look) / 2;
  auto time = now_;
  for (; time < limit; time += shortest_look / 2) {
    double left = 0;
    for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
      const auto is = twins[axis].motion().position.value + twins_[axis].ahead;
      const double joint = before.axis[axis].target;
      const double way = joint - is / axes_[axis].microsteps_per_unit;
      left += way * (joint - from[axis]) / length;
      twins[axis].advance(shortest_look / 2);
    }
    if (left <= near) break;
  }
  return time;
}

// On a long leg nothing is to be told to the axes, but they are looked at.
StreamScript PositionRunner::watch_until(TimePoint due) {
  const auto look_takes = duration(time_to_send(report_.round_trip, commands_of_a_look));
  while (due - now_ > watch_interval + look_takes && !stop_asked_) {
    co_await until(now_ + watch_interval);
    watched_ = (watched_ + 1) % axes_.size();
    auto wrong = co_await check(watched_);
    if (!wrong) wrong = co_await read_position(watched_);
    if (wrong) co_return wrong;
    correct_twin(watched_);
    wrong = co_await look_at_encoder(due - look_takes);
    if (wrong) co_return wrong;
  }
  auto unseen = co_await look_at_encoder(due - look_takes);
  if (unseen) co_return unseen;
  co_await until(due);
  co_return asked_to_stop();
}

// At a corner where the course stands.
StreamScript PositionRunner::pause_between(const CourseLeg& next) {
  if (next.start_speed > 0 || next.begin == 0 || !pause_asked_) co_return std::nullopt;
  clock_.advance(now_);
  co_await until(now_ + duration(next.begin - clock_.passed()));
  clock_.advance(now_);
  clock_.pause(true);
  while (pause_asked_ && !stop_asked_) co_await until(now_ + look_interval);
  co_return asked_to_stop();
}

// Before the course goes on then; what comes before them has been passed, but for dwells.
StreamScript PositionRunner::pass_halts(double until_time) {
  while (clock_.next_halt() != nullptr && clock_.next_halt()->time <= until_time) {
    auto wrong = co_await watch_until(time_of(clock_.next_halt()->time));
    clock_.advance(now_);
    const auto* halt = clock_.halt();
    while (!wrong && halt != nullptr && clock_.halt() == halt) {
      wrong = co_await pass_halt({});
      if (waits_ && !wrong) co_await until(now_ + look_interval);
      if (waits_ && !wrong) wrong = asked_to_stop();
    }
    if (wrong) co_return wrong;
  }
  co_return std::nullopt;
}

// Even legs are passed evenly, whatever the course does between their ends.
double PositionRunner::planned_position(std::size_t axis) const {
  const double passed = clock_.passed();
  if (!even_leg_ || passed < even_leg_->begin || passed > even_leg_->end)
    return course_.at(passed).position[axis];
  const auto& [begin, end] = std::pair(even_leg_->begin, even_leg_->end);
  const double from = course_.at(begin).position[axis];
  return std::lerp(from, even_leg_->axis[axis].target, (passed - begin) / (end - begin));
}

TimePoint PositionRunner::time_of(double course_time) {
  clock_.advance(now_);
  return now_ + duration(course_time - clock_.passed());
}

void PositionRunner::on_written(std::size_t axis, Setting setting) {
  let_twin_run(axis, middle());
  axes_[axis].twin->set(setting);
}

void PositionRunner::let_twin_run(std::size_t axis, TimePoint to) {
  auto& twin = *axes_[axis].twin;
  const auto ahead = to - twin_start_ - (twin.elapsed() - twins_[axis].begin);
  if (ahead > Duration::zero()) twin.advance(ahead);
}

double PositionRunner::expected_of_twin(std::size_t axis) const {
  return axes_[axis].twin->motion().position.value + twins_[axis].ahead;
}

// A command takes effect earlier or later than its twin is told; where that makes a motor stand for
// a moment, it is behind its twin for longer.
void PositionRunner::correct_twin(std::size_t axis) {
  const double position = *answer_;
  let_twin_run(axis, middle());
  twins_[axis].ahead += observer_gain * (position - expected_of_twin(axis));
}

std::unique_ptr<StreamRunner> position_runner(const Course& course, StreamAxes axes,
                                              StreamOptions options) {
  return std::make_unique<PositionRunner>(course, std::move(axes), options);
}

}  // namespace tmcl::plan
