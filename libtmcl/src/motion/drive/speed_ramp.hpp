/// An axis that changes its speed evenly to another one and keeps that: what a ramp generator does
/// with a new velocity, and which velocity leads it where a course will be. In microsteps and
/// seconds; what goes backwards is negative.
#pragma once

#include <limits>
#include <optional>

#include "tmcl/clock.hpp"

namespace tmcl::plan {

struct SpeedRamp {
  TimePoint begin{};
  double position = 0;
  double speed = 0;
  double end_speed = 0;
  /// By how much the speed changes in a second; has no sign.
  double slope = std::numeric_limits<double>::infinity();

  double speed_at(TimePoint time) const;
  double position_at(TimePoint time) const;
  /// The same motion, as it is at that time and later.
  SpeedRamp from(TimePoint time) const;
  /// The motion of a ramp generator that brakes for its target, as it is at that time. `braking` is
  /// by how much its speed changes then.
  SpeedRamp to_target(double target, double braking, TimePoint time) const;
  /// How long the change of speed takes.
  double ramp_s() const;
};

/// What a segment of a course asks of an axis.
struct SegmentTask {
  double speed = 0;      ///< As it is at the begin.
  double end_speed = 0;  ///< As it should be at the end.
  double way = 0;
  double time_s = 0;           ///< Greater than 0.
  double shortest_ramp_s = 0;  ///< Greater than 0.
};
struct Segment {
  double speed = 0;   ///< What it is told.
  double ramp_s = 0;  ///< How long it takes to get there.
};
/// Makes the way in the time, with the end speed that was asked for if an even ramp can do both. To
/// rest it makes the way exactly, perhaps sooner or later.
Segment segment_for(const SegmentTask& task);
/// The speed that makes the way in the time if it is changed with that slope; nothing if the time
/// is too short.
std::optional<double> speed_by(double slope, const SegmentTask& task);

}  // namespace tmcl::plan
