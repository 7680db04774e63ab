/// The fastest movement along one axis within limits of velocity, acceleration, deceleration and
/// jerk: from any state of motion to any other, or to a velocity. Trapezoids and S-curves, in real
/// numbers of any units; a plan is a value, allocates nothing and throws nothing.
///
/// What acceleration and deceleration mean: a movement has one direction, which it keeps. The
/// acceleration limits what acts in this direction, the deceleration what acts against it, whatever
/// the sign of the velocity at the moment. From rest to rest the first one lets the speed grow and
/// the second one lets it fall; a movement that overshoots its target and comes back gathers speed
/// for its way back with the deceleration. The direction is that to the target position; if that
/// is where it starts, the direction of the target velocity, then that of the start velocity, then
/// that of the start acceleration, whichever is the first that is not zero. For a movement to a
/// velocity it is the direction of the start velocity, then of the target velocity, then of the
/// start acceleration. A mirror image of the problem has the mirror image of the plan.
///
/// A start outside the limits is allowed. An acceleration beyond its limit is brought back to it by
/// the jerk; then a speed that is beyond its limit, or will be even if the acceleration is taken
/// back at once, is brought down to the limit as fast as the limits allow. The rest of the
/// movement is the fastest one from there.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>
#include <tl/expected.hpp>

#include "tmcl/ensure.hpp"

namespace tmcl::plan {

/// A state of motion. If the jerk is infinite, accelerations of the start and of the target have no
/// effect: they can change at once.
struct State {
  double position = 0;
  double velocity = 0;
  double acceleration = 0;
  bool operator==(const State&) const = default;
};

/// All are greater than zero and finite; only the jerk may be infinite, which makes trapezoids.
struct Limits {
  double velocity;      ///< In both directions.
  double acceleration;  ///< In the direction of the movement.
  double deceleration;  ///< Against it.
  double jerk = std::numeric_limits<double>::infinity();
  bool operator==(const Limits&) const = default;
};

/// Why there is no plan.
enum class Fault : std::uint8_t {
  velocity_limit,
  acceleration_limit,
  deceleration_limit,
  jerk_limit,
  start,
  target,
  target_velocity,
  target_acceleration,
  target_not_entered,
  magnitude,
};

/// A sentence, with what would be right.
std::string_view describe(Fault fault);

/// A time in which the jerk is constant. The position is counted from where the movement starts.
struct Phase {
  double begin;  ///< Since the start of the movement.
  double duration;
  State start;
  double jerk;  ///< Zero throughout if the limit is infinite.

  /// So long after its begin.
  constexpr State after(double t) const {
    return {start.position + t * (start.velocity + t * (start.acceleration / 2 + t * jerk / 6)),
            start.velocity + t * (start.acceleration + t * jerk / 2),
            start.acceleration + t * jerk};
  }
};

/// A movement.
class Trajectory {
 public:
  /// One to bring the acceleration inside its limit, two for the velocity, and the seven of an
  /// S-curve.
  static constexpr std::size_t most_phases = 10;

  Trajectory() : Trajectory(State{}) {}
  /// Of no duration; append() makes it longer.
  explicit Trajectory(const State& start) : start_(start), end_(start) {}

  const State& start() const { return start_; }
  /// Exactly what was asked for.
  const State& end() const { return end_; }
  double duration() const { return duration_; }

  /// At a time since the start. Before it the start, after the duration the end; if the
  /// acceleration jumps at that time, the one after the jump.
  State at(double t) const;

  /// In order, none of no duration.
  std::size_t phases() const { return count_; }
  const Phase& phase(std::size_t index) const {
    ensure(index < count_);
    return phases_[index];
  }

  /// So much longer, starting with this acceleration. Nothing if the duration is not positive.
  void append(double duration, double acceleration, double jerk);
  /// Where it ends; what at() gives at its end and afterwards.
  void finish(const State& end) { end_ = end; }
  /// The state to which the phases lead, the position counted from the start.
  State reached() const;

 private:
  std::array<Phase, most_phases> phases_{};  // the first count_ of them mean something
  std::size_t count_ = 0;
  double duration_ = 0;
  State start_;
  State end_;
};

/// From a state to a state. The target must be one that can be entered within the limits: its
/// velocity and acceleration are inside them, and so is the velocity velocity - a |a| / (2 jerk)
/// from which the acceleration a of the target was built up.
tl::expected<Trajectory, Fault> plan_move(const State& start, const State& target,
                                          const Limits& limits);

/// To a velocity and no acceleration, wherever that leads.
tl::expected<Trajectory, Fault> plan_velocity(const State& start, double velocity,
                                              const Limits& limits);

}  // namespace tmcl::plan
