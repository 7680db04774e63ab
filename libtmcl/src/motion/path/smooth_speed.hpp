/// The speed along a stretch of a path, from rest to rest, whose acceleration changes by no more
/// than a jerk.
///
/// First there are ramps of one acceleration `a`, looked ahead. Then their way is averaged over the
/// last T = a / jerk seconds: each step of the acceleration becomes a change that takes T. The mean
/// comes to a place at another time than the ramps do, so the ramps keep more than the limits:
///
/// - A limit V from one place to another one (of a leg; of a corner, where both are one) holds for
///   the ramps from V T / 2 before the first to V T / 2 behind the second. Let them be there from
///   t0 to t1. At t0 + T the mean is not yet beyond the first place, at t1 it is not short of the
///   second one. So while it is between them, all that it is the mean of lies between t0 and t1.
/// - Speeding up and slowing down are T apart: a top that is passed sooner is cut off. Between
///   slowing down and speeding up, the limit in between takes as long. So two accelerations that
///   are T apart differ by `a` at most, and the mean changes its own by a / T.
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
