#include "motion/drive/ramp_legs.hpp"

#include <algorithm>

namespace tmcl::plan {
namespace {

// What ramp generators can hold: 2^-41 of the square of their clock, 116.4 at 16 MHz. Less is 0,
// with which a motor does not move.
constexpr double least_acceleration_pps2 = 128;
// That every moving axis of a leg gets: it is checked, velocity and target are written.
constexpr std::size_t commands_of_an_axis = 3;
// Both accelerations and the stop velocity.
constexpr std::size_t commands_of_ramps = 3;
// What part of a leg the axes may take for the joint before it; with ramps, they need the rest.
constexpr double joint_part_of_even_leg = 1. / 2;
constexpr double joint_part_of_ramps = 1. / 8;
// What part of its velocity an axis may gain or lose at a joint with the acceleration of a ramp.
constexpr double turning_part = 1. / 4;

}  // namespace

// By its ramps, a leg that begins on the way is loaded twice. First come the speeds at the joint,
// which the axes change with an acceleration of the joint's own: that of the ramp is in proportion
// to where the leg goes, and would keep an axis that the turn makes faster or slower off the path.
Passage RampLegs::passage(std::size_t index) const {
  Passage made{course_.leg(index), Passage::Drive::by_ramps, index};
  const auto& leg = made.leg;
  const double time = leg.end - leg.begin;
  const double off = std::abs(leg.acceleration) * time * time / 8;
  const bool loadable_twice =
      time_to_send(report_.round_trip, commands_after_joint * axes_.size()) < time / 4;
  const bool on_the_way = leg.start_speed > 0;
  if (leg.end_speed > 0 && off <= even_within_) {
    made.drive = Passage::Drive::evenly;
    for (auto& ramp : made.leg.axis) ramp.vmax *= leg.mean_speed / leg.peak_speed;
    for (auto& ramp : made.leg.axis) ramp.vstart = ramp.vstop = ramp.vmax;
  } else if (on_the_way && loadable_twice) {
    made.drive = Passage::Drive::by_ramps_after_joint;
  }
  return made;
}

AxisValues RampLegs::changes_at(std::size_t index) const {
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

double RampLegs::longest_joint(const Passage& passage) {
  const bool evenly = passage.drive == Passage::Drive::evenly;
  return (evenly ? joint_part_of_even_leg : joint_part_of_ramps) *
         (passage.leg.end - passage.leg.begin);
}

Duration RampLegs::time_of_joint(std::size_t index) const {
  const auto changes = changes_at(index);
  double time = 0;
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    const double acceleration = joint_accelerations[axis] * axes_[axis].units.acceleration.value /
                                std::abs(axes_[axis].microsteps_per_unit);
    time = std::max(time, std::abs(changes[axis]) / acceleration);
  }
  return duration(std::min(time, longest_joint(passage(index))));
}

// What belongs to ramps is written for a leg that has them, and again after it.
std::size_t RampLegs::commands_of(std::size_t index) const {
  const auto [leg, drive, place] = passage(index);
  const bool ramps = drive == Passage::Drive::by_ramps || index == 0 ||
                     passage(index - 1).drive != Passage::Drive::evenly;
  const auto of_axis = commands_of_an_axis + (ramps ? commands_of_ramps : 0);
  std::size_t moving = 0;
  for (std::size_t axis = 0; axis < axes_.size(); ++axis)
    moving += leg.axis[axis].vmax > 0 ? 1U : 0U;
  return 1 + moving * of_axis;
}

Duration RampLegs::lead_of(std::size_t index) const {
  return duration(time_to_send(report_.round_trip, commands_of(index)));
}

// How long before its begin a leg's load begins. Its commands may take as long as the longest one
// did before the start; but not before the leg before it has begun.
Duration RampLegs::early_by(const Passage& passage) const {
  const auto before = course_.leg(passage.index - 1);
  const auto commands = static_cast<std::int64_t>(commands_of(passage.index));
  const auto longest = std::max(lead_of(passage.index), commands * report_.worst_round_trip);
  const auto needed = longest + time_of_joint(passage.index) / 2;
  return std::min(needed, duration(passage.leg.begin - before.begin));
}

bool RampLegs::goes_on(std::size_t index, std::size_t axis) const {
  if (index + 1 >= course_.legs()) return false;
  const auto leg = course_.leg(index), next = course_.leg(index + 1);
  if (leg.end_speed == 0 || leg.axis[axis].vmax == 0) return false;
  const double from = course_.at(leg.begin).position[axis];
  const double joint = leg.axis[axis].target;
  return (joint - from) * (next.axis[axis].target - joint) > 0;
}

// An axis that the joint makes much slower or faster needs the joint's acceleration: with that of
// the ramp, which is in proportion to where the leg goes, it would go far beyond.
bool RampLegs::must_turn(const Passage& passage, std::size_t axis) const {
  if (passage.leg.start_speed == 0) return false;
  return std::abs(changes_at(passage.index)[axis]) > turning_part * passage.leg.axis[axis].vmax;
}

// With ramps in proportion to such a way, an axis could not brake what the leg before it left.
bool RampLegs::hardly_moves(const CourseLeg& leg, std::size_t axis) const {
  const double way = leg.axis[axis].target - course_.at(leg.begin).position[axis];
  return std::abs(way) <= even_within_;
}
std::int32_t acceleration_in(const StreamAxis& axis, double value, std::int32_t most) {
  const auto unit = axis.units.acceleration;
  const auto least = static_cast<std::int32_t>(std::ceil(least_acceleration_pps2 / unit.value));
  return std::clamp(in_units(axis, value, unit), least, std::max(least, most));
}

}  // namespace tmcl::plan
