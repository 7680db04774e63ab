/// The speed along a stretch of a path, from rest to rest, whose acceleration changes by no more
/// than a jerk.
///
/// A speed of ramps with one acceleration `a` is looked ahead first. Its way is averaged over the
/// last T = a / jerk seconds then: each step of the acceleration becomes a ramp that takes T. The
/// mean comes to a place at another time than the ramps do, so the ramps keep more than the limits:
///
/// - A limit V from one place to another one (of a leg; of a corner, where both are one) holds from
///   V T / 2 before the one to V T / 2 behind the other. Ramps that keep to V from t0 to t1 and
///   start that far before have a mean that is not beyond the place by t0 + T, and that is not short
///   of the end at t1: where the mean is between them, all that it is of is within t0 and t1.
/// - Speeding up and slowing down are T apart: a top that is passed sooner is cut off. Between
///   slowing down and speeding up that is so by the limit that is between them. So two accelerations
///   that are T apart differ by `a` at most.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "tmcl/plan/path.hpp"

namespace tmcl::plan {

struct SpeedLimit {
  double length = 0;
  double speed = 0;
  /// Where it begins.
  double corner = std::numeric_limits<double>::infinity();
};

/// One after the other without a stop; all is greater than 0. The last phase is the end. A lower
/// acceleration is taken where that is faster.
std::vector<SpeedPhase> smooth_speed(std::span<const SpeedLimit> limits, double acceleration,
                                     double jerk);

}  // namespace tmcl::plan
