/// A path of straight legs through several axes, passed as fast as the axes can: speeds are looked
/// ahead, so that it slows down for a corner in time and stops only where it must.
///
/// All axes have the same unit, or units that may be added as the sides of a right-angled triangle;
/// lengths and speeds along the path are Euclidean. Along a leg the speed is a trapezoid.
///
/// What happens at a corner. A corner of the path can be rounded by an arc that touches both legs,
/// that departs from the corner by no more than the tolerance, and that takes no more than half of
/// either leg. The path is passed through the corner no faster than each axis could follow this arc
/// at that speed within its limits of velocity and acceleration. The plan itself stays on the legs:
/// in the corner the velocity of an axis changes at once, by no more than its acceleration changes
/// it in the time that the arc would take. So a tolerance of 0 stops at each corner, and a path
/// that turns back stops in any case. A corner that turns by less than `straight` is none; a leg so
/// short that the last bits of its coordinates turn it by more has corners.
///
/// With a jerk the acceleration along the path changes by no more than that in a second: the speed
/// is an S-curve, and the path takes longer. From one stop to the next one there is one
/// acceleration, the least that a leg there has, or less. In a corner a velocity still changes at
/// once.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

namespace tmcl::plan {

constexpr std::size_t most_path_axes = 6;
constexpr std::size_t most_legs = 1'000'000;
/// In radians.
constexpr double straight = 1e-9;

/// One number for each axis; those of axes that a path does not have mean nothing.
using AxisValues = std::array<double, most_path_axes>;

struct AxisLimits {
  double velocity = 0;
  double acceleration = 0;
  /// By how much its velocity may change at once in a corner.
  double corner_jump = std::numeric_limits<double>::infinity();
};

struct PathLimits {
  std::size_t axes = 0;  ///< 1..most_path_axes.
  /// Greater than zero; all but the jump finite.
  std::array<AxisLimits, most_path_axes> axis{};
  double corner_tolerance = 0;
  /// Along the path; greater than zero.
  double jerk = std::numeric_limits<double>::infinity();
};

/// Straight to a target, along all axes together.
struct Leg {
  AxisValues target{};
  /// The greatest speed along the path: greater than zero.
  double feed = std::numeric_limits<double>::infinity();
};

/// Why there is no plan.
struct PathFault {
  enum class Kind : std::uint8_t {
    axes,
    legs,
    tolerance,
    velocity_limit,
    acceleration_limit,
    corner_jump,
    start,
    target,
    feed,
    magnitude,
    jerk,
  };
  Kind kind;
  std::size_t leg = 0;   ///< From 0; for target and feed.
  std::size_t axis = 0;  ///< From 0; for what concerns one axis.
  bool operator==(const PathFault&) const = default;
};

/// A sentence that names the leg or the axis.
std::string describe(const PathFault& fault);

/// How a leg is passed: three times, of which any may be zero. A leg of no length takes no time.
/// With a jerk there is one time, `even`, and the peak speed and the acceleration are the greatest.
struct LegPlan {
  double begin = 0;  ///< Since the start of the path.
  double length = 0;
  double start_speed = 0;
  double peak_speed = 0;
  double end_speed = 0;
  double acceleration = 0;  ///< Along the path, in both ramps.
  double up = 0;            ///< How long it speeds up...
  double even = 0;          ///< ...keeps its speed...
  double down = 0;          ///< ...and slows down.

  double way = 0;  ///< Along the path, before it.

  double duration() const { return up + even + down; }
  double end() const { return begin + duration(); }
  /// The speed and the way along the leg, so long after its begin.
  double speed_after(double t) const;
  double way_after(double t) const;
  double acceleration_after(double t) const;
};

/// What one axis does on a leg, in the parameters of a ramp generator with start and stop speeds.
/// Speeds and accelerations have no sign; all are zero if the axis does not move.
struct AxisRamp {
  double target = 0;
  double vstart = 0;
  double vmax = 0;
  double amax = 0;
  double dmax = 0;
  double vstop = 0;
};

/// The speed along a path, with a jerk: where it is at first, and how it changes.
struct SpeedPhase {
  double begin = 0;
  double way = 0;
  double speed = 0;
  double acceleration = 0;
  double jerk = 0;

  /// `t`: since its begin.
  SpeedPhase after(double t) const {
    return {begin + t, way + t * (speed + t * (acceleration / 2 + t * jerk / 6)),
            speed + t * (acceleration + t * jerk / 2), acceleration + t * jerk, jerk};
  }
};

struct PathState {
  AxisValues position{};
  AxisValues velocity{};
};
/// And how the velocity changes. What jumps in a corner has no jerk.
struct PathMotion : PathState {
  AxisValues acceleration{};
  AxisValues jerk{};
};

/// A path with its speeds; it begins and ends at rest.
class PathPlan {
 public:
  std::size_t axes() const { return axes_; }
  double duration() const { return legs_.empty() ? 0 : legs_.back().end(); }

  std::span<const LegPlan> legs() const { return legs_; }
  /// The index is less than the number of legs, the axis less than that of axes.
  AxisRamp ramp(std::size_t leg, std::size_t axis) const;

  /// At a time since the start; before it the start, after the duration the end. In a corner it is
  /// already on the next leg.
  PathState at(double t) const;
  PathMotion motion_at(double t) const;

  /// With a jerk the first time, not before `t`, at which a phase of the speed begins, or a part of
  /// one whose acceleration changes; infinite if there is none.
  double bend_not_before(double t) const;

  /// What it holds of memory, beside itself.
  std::size_t bytes() const {
    return corners_.capacity() * sizeof(AxisValues) + legs_.capacity() * sizeof(LegPlan) +
           phases_.capacity() * sizeof(SpeedPhase);
  }

 private:
  friend tl::expected<PathPlan, PathFault> plan_path(const AxisValues&, std::span<const Leg>,
                                                     const PathLimits&);
  double share(std::size_t leg, std::size_t axis) const;
  std::size_t leg_at(double t) const;
  SpeedPhase speed_at(double t) const;
  void pass_smoothly(std::vector<SpeedPhase> phases);

  std::size_t axes_ = 0;
  std::vector<AxisValues> corners_;  // the start, and the target of each leg
  std::vector<LegPlan> legs_;
  std::vector<SpeedPhase> phases_;  // with a jerk; the last one is the end
};

/// From rest at `start` through all legs, at most most_legs, to rest.
tl::expected<PathPlan, PathFault> plan_path(const AxisValues& start, std::span<const Leg> legs,
                                            const PathLimits& limits);

/// How fast a corner may be passed from one leg to the next one. The directions have the length 1;
/// `room` is the length of the shorter leg.
double corner_speed(const AxisValues& from, const AxisValues& to, double room,
                    const PathLimits& limits);

}  // namespace tmcl::plan
