/// What a move asks of a motor, and what the motor has: the model of docs/LOAD.md.
///
/// Torque is in 1/1000 of what the motor holds at its full current, speeds are in full steps per
/// second.
#pragma once

#include <optional>

#include "tmcl/plan/ramp_comparison.hpp"

namespace tmcl::plan {

struct MotorTorque {
  double load = 0;               ///< Whatever the speed.
  double load_per_velocity = 0;  ///< Friction: more of it for each full step per second, in 1/1000.
  double inertia = 0;            ///< For each full step per second squared, in 1/1,000,000.
  std::optional<double> corner_speed{};  ///< Above it the torque falls as 1/v; nothing: never.

  double asked(double speed, double acceleration) const;
  double there(double speed) const;

  bool operator==(const MotorTorque&) const = default;
};

/// Where a move comes nearest to what the motor has.
struct TorqueUse {
  double share = 0;  ///< What is asked, as a part of what is there.
  double speed = 0;
};

/// The acceleration is the change of the speed in a millisecond, as the model has it; in moves of
/// more than 5 s, in a longer time.
TorqueUse torque_use(const FollowedMove& move, const MotorTorque& motor,
                     double microsteps_per_full_step);

}  // namespace tmcl::plan
