// A stream of positions: what the axes are told for a leg.
#include <algorithm>
#include <cmath>

#include "motion/drive/position_runner.hpp"

namespace tmcl::plan {
namespace {

namespace ap = axis_parameter;

constexpr std::int32_t least_vstop = 10;  // data sheets; below it a motor may not come to rest
// By how much a leg may be faster or slower than planned, to be back on time at its end.
constexpr double slowest_part = 0.8;
constexpr double fastest_part = 1.25;

}  // namespace

StreamScript PositionRunner::prepare_loads(const Passage& passage) {
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

StreamScript PositionRunner::write_before(const Passage& passage, const Load& load) {
  Fault refused;
  if (load.way != Way::goes_on_late)
    refused = co_await set(load.axis, {ap::max_acceleration, load.amax});
  if (!refused && load.way == Way::from_rest) refused = co_await set_braking(passage, load);
  if (!refused && (load.way == Way::from_rest || load.way == Way::brakes))
    refused = co_await set_start_speed(passage, load.axis);
  if (refused || load.way != Way::goes_on) co_return refused;
  if (is_too_gentle(passage, load)) refused = co_await set_deceleration(passage, load);
  if (!refused) refused = co_await set_target(load);
  if (!refused) refused = co_await set_braking(passage, load);
  co_return refused;
}

StreamScript PositionRunner::begin_leg(const Passage& passage) {
  even_leg_.reset();
  if (passage.drive == Drive::evenly) even_leg_ = passage.leg;
  for (const auto& load : loads_) {
    auto refused = asked_to_stop();
    if (!refused && load.way == Way::turns) refused = co_await see_standing(load.axis);
    if (!refused && load.way == Way::goes_on_late)
      refused = co_await set(load.axis, {ap::max_acceleration, load.amax});
    if (!refused) refused = co_await set_start_speed(passage, load.axis);
    const bool may_brake = load.way == Way::brakes || load.way == Way::goes_on_late ||
                           (load.way == Way::turns && is_too_gentle(passage, load));
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

// The velocities last, in quick succession: an axis that speeds up before the others leaves the
// path by what it is faster, until they are as fast.
StreamScript PositionRunner::load_ramps(const Passage& passage) {
  for (const auto& load : loads_) {
    auto wrong = co_await check(load.axis);
    if (!wrong) wrong = asked_to_stop();
    if (!wrong) wrong = co_await set(load.axis, {dmax, load.dmax});
    const bool speeds_up = passage.leg.speeds_up && !legs_.hardly_moves(passage.leg, load.axis);
    if (!wrong && speeds_up) {
      const auto amax = acceleration_in(axes_[load.axis], passage.leg.axis[load.axis].amax,
                                        axes_[load.axis].greatest_acceleration);
      wrong = co_await set(load.axis, {ap::max_acceleration, amax});
    }
    if (wrong) co_return wrong;
  }
  for (const auto& load : loads_) {
    auto wrong = co_await set_velocity(passage, passage.leg.axis[load.axis].vmax, load.axis);
    if (wrong) co_return wrong;
  }
  co_return std::nullopt;
}

StreamScript PositionRunner::set_start_speed(const Passage& passage, std::size_t axis) {
  const auto& ramp = passage.leg.axis[axis];
  const bool joint_only = passage.drive == Drive::by_ramps_after_joint;
  return set_velocity(passage, joint_only ? ramp.vstart : ramp.vmax, axis);
}

StreamScript PositionRunner::set_velocity(const Passage& passage, double speed, std::size_t axis) {
  const auto value = velocity_in(passage, speed, axis);
  auto refused = co_await set(axis, {ap::max_velocity, value});
  if (!refused) told_[axis] = Setting{ap::target_velocity, value};
  co_return refused;
}

StreamScript PositionRunner::set_target(const Load& load) {
  co_await command({Kind::set, load.axis, ap::target_position, load.target});
  if (!answer_) co_return refusal(load.axis);
  let_twin_run(load.axis, middle());
  axes_[load.axis].twin->move_to({load.target});
  co_return std::nullopt;
}

// With the deceleration of the leg, an axis that the joint makes slower would begin to brake for
// the leg's end there: it gets it when it has the speed of the leg.
std::int32_t PositionRunner::deceleration_of(const Passage& passage, const Load& load) const {
  const bool joint_only = passage.drive == Drive::by_ramps_after_joint;
  return joint_only ? legs_.joint_accelerations[load.axis] : load.dmax;
}

StreamScript PositionRunner::set_deceleration(const Passage& passage, const Load& load) {
  return set(load.axis, {dmax, deceleration_of(passage, load)});
}

// With the deceleration that it has, it might brake for the leg's end too soon; and a generator
// that brakes goes on with that until its target is written once more, however well it could brake
// by then.
bool PositionRunner::is_too_gentle(const Passage& passage, const Load& load) const {
  return settings_[load.axis].now(dmax).value_or(0) < deceleration_of(passage, load);
}

StreamScript PositionRunner::set_braking(const Passage& passage, const Load& load) {
  auto refused = co_await set_deceleration(passage, load);
  if (refused) co_return refused;
  refused = co_await set(load.axis, {vstop, load.vstop});
  co_return refused;
}

// How an axis comes to the leg.
PositionRunner::Way PositionRunner::way_to(const Passage& passage, std::size_t axis) const {
  if (passage.index == 0 || passage.leg.start_speed == 0) return Way::from_rest;
  const auto before = legs_.passage(passage.index - 1);
  if (before.leg.axis[axis].vmax == 0) return Way::from_rest;
  if (!legs_.goes_on(passage.index - 1, axis)) return Way::turns;
  if (before.drive == Drive::evenly || !before.leg.slows_down) return Way::goes_on;
  const bool brakes_by_then = duration(before.leg.down) >= legs_.early_by(passage);
  return brakes_by_then && has_slowed_down(axis) ? Way::brakes : Way::goes_on_late;
}

// A leg that is late, or that had a joint before it, has less way left to brake on than planned.
PositionRunner::Load PositionRunner::load_for(const Passage& passage, std::size_t axis) {
  const auto& leg = passage.leg;
  const auto& ramp = leg.axis[axis];
  Load load{axis, way_to(passage, axis), legs_.joint_accelerations[axis], own_acceleration(axis), 0,
            0};
  const bool by_ramps = passage.drive == Drive::by_ramps;
  if (passage.drive != Drive::evenly && !legs_.hardly_moves(leg, axis)) {
    const double in_time = pace(passage, ramp.vmax, axis);
    const double steeper = in_time > fastest_part ? in_time : 1;
    const auto most = std::max(legs_.joint_accelerations[axis], axes_[axis].greatest_acceleration);
    if (by_ramps && leg.speeds_up)
      load.amax = acceleration_in(axes_[axis], ramp.amax * steeper, most);
    if (leg.slows_down) {
      const double left =
          std::abs(ramp.target - expected_of_twin(axis) / axes_[axis].microsteps_per_unit);
      const double needed = (ramp.vstart * ramp.vstart - ramp.vstop * ramp.vstop) / (2 * left);
      const double planned = ramp.dmax * steeper;
      load.dmax =
          acceleration_in(axes_[axis], left > 0 ? std::max(planned, needed) : planned, most);
    }
  }
  if (by_ramps && legs_.must_turn(passage, axis)) {
    load.amax = std::max(load.amax, own_acceleration(axis));
    load.dmax = std::max(load.dmax, own_acceleration(axis));
  }
  aim(passage, load);
  return load;
}

// An axis that goes on at the joint is sent beyond it, as far as it takes to brake from its speed
// there: it has that speed at the joint, and if the next leg comes late, it comes to rest by its
// ramp and loses no steps. It is never sent beyond the place where it turns, or rests.
void PositionRunner::aim(const Passage& passage, Load& load) const {
  const auto& info = axes_[load.axis];
  const auto& ramp = passage.leg.axis[load.axis];
  double target = ramp.target;
  double speed_squared = ramp.vstop * ramp.vstop;
  const double deceleration =
      load.dmax * info.units.acceleration.value / std::abs(info.microsteps_per_unit);
  for (auto i = passage.index; speed_squared > 0 && legs_.goes_on(i, load.axis); ++i) {
    const double way = course_.leg(i + 1).axis[load.axis].target - target;
    const double needed = speed_squared / (2 * deceleration);
    target += std::copysign(std::min(needed, std::abs(way)), way);
    speed_squared = std::max(0.0, speed_squared - 2 * deceleration * std::abs(way));
  }
  load.target = microsteps(load.axis, target);
  const auto most = std::min(info.greatest_stop_velocity, info.greatest_velocity);
  load.vstop =
      std::max(least_vstop, in_units(info, std::sqrt(speed_squared), info.units.velocity, most));
}

// How much faster than planned an axis must be, to be at the end of its leg in time. An axis that
// is hardly moved by a leg may be off by more than its way: with a ramp it comes back to its end
// then, but on an even leg it goes on, and has to become slower.
double PositionRunner::pace(const Passage& passage, double speed, std::size_t axis) {
  const auto& leg = passage.leg;
  let_twin_run(axis, now_);
  clock_.advance(now_);
  const double begin = course_.at(leg.begin).position[axis];
  const double planned = planned_position(axis);
  const double is = expected_of_twin(axis) / axes_[axis].microsteps_per_unit;
  const double needed = 1 + (planned - is) / (leg.axis[axis].target - begin);
  const double part = passage.drive == Drive::evenly ? needed : std::abs(needed);
  const double slow = options_.even_within / seconds(look_interval);
  return std::clamp(part, slowest_part, std::max(fastest_part, 1 + slow / speed));
}

std::int32_t PositionRunner::velocity_in(const Passage& passage, double speed, std::size_t axis) {
  const auto& info = axes_[axis];
  return std::min(in_units(axes_[axis], speed * pace(passage, speed, axis), info.units.velocity),
                  info.greatest_velocity);
}

// With a steeper ramp than planned, an axis begins to brake later.
bool PositionRunner::has_slowed_down(std::size_t axis) const {
  const double speed = std::abs(axes_[axis].twin->motion().velocity.value);
  return told_[axis] && speed < (1 - near_speed) * told_[axis]->value;
}

// The smaller one of its two.
std::int32_t PositionRunner::own_acceleration(std::size_t axis) const {
  const auto up = settings_[axis].before(ap::max_acceleration);
  const auto down = settings_[axis].before(dmax);
  const auto least = acceleration_in(axes_[axis], 0, up);
  return std::max(least, down > 0 ? std::min(up, down) : up);
}

}  // namespace tmcl::plan
