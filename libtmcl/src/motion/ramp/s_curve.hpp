/// The time-optimal movement within limits of velocity, acceleration, deceleration and jerk, from
/// any state of motion. In real numbers; the CubicTrack brings it to ticks.
#pragma once

#include "tmcl/ramp/cubic_track.hpp"

namespace tmcl::ramp {

/// In microsteps and ticks.
struct Moving {
  double velocity;
  double acceleration;
};

/// The greatest speeds, in microsteps per tick; 0 for a direction in which it must not go.
struct Speeds {
  double forward;
  double backward;
};

/// A distance to a target, or a gap left in front of it, too small to matter. What is as near as
/// that is not corrected by another movement.
constexpr double unseen = 0x1p-10;

/// Where the velocity comes to if the acceleration is taken back at once.
double eventual_velocity(Moving from, const Forces& forces);

/// To `velocity`, with no acceleration at the end. Limited forces may let it end elsewhere: one
/// that cannot decelerate keeps its speed, one that cannot accelerate stops at the most.
Profile plan_velocity(Moving from, double velocity, const Forces& forces);

/// To a target `distance` microsteps away, at rest.
///
/// A speed that is above its limit falls at once, unless the target is so near that the movement
/// stops on it straight away. Where the target cannot be reached without turning round, the
/// motor turns without pause; the acceleration in the instant of standstill is then the greatest
/// that both limits allow, or none if the second and the fourth bow differ. A motor that may not go
/// in the direction of the target stops, one that cannot decelerate keeps its speed: such a profile
/// does not arrive.
Profile plan_move(Moving from, double distance, Speeds limits, const Forces& forces);

}  // namespace tmcl::ramp
