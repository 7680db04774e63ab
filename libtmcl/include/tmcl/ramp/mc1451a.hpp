/// One axis of the MC1451A motion control chipset in its profile modes "S-curve point to point" and
/// "trapezoidal point to point".
///
/// What the parameters mean, their scales and the seven phases are those of its data sheet; how the
/// chipset computes them is not in there. So the profile is the time-optimal one within the limits,
/// its phases begin at fractions of a tick, and it ends on its target at the first tick after that.
/// The axis starts as soon as a position is set that it is not at.
///
/// In motion an S-curve takes no new parameter; a trapezoid takes all but another profile, and goes
/// on from the speed that it has. Above a new maximum velocity it slows down with its acceleration.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "tmcl/ramp/cubic_track.hpp"
#include "tmcl/ramp/generator.hpp"

namespace tmcl::ramp {

class Mc1451a {
 public:
  static constexpr std::string_view chip = "mc1451a";
  static constexpr Tick ticks_per_cycle = 16;
  /// In a cycle of the chipset, which is the unit of time of all its parameters; the clock does not
  /// matter.
  static double ticks_per_second(double /*clock_hz*/) { return ticks_per_cycle; }
  static constexpr int position_bits = 32;
  static constexpr std::int64_t velocity_of_a_microstep = 1 << 20;

  enum class Shape : std::uint8_t { s_curve, trapezoidal };
  enum class Register : std::uint8_t { profile, position, velocity, acceleration, jerk };
  static std::span<const RegisterInfo> registers();

  /// All parameters are zero at first: nothing moves before velocity, acceleration and, in an
  /// S-curve, jerk are set.
  Mc1451a() = default;

  /// What is refused in motion, the chipset's "command error", lets the profile go on as it was:
  /// every parameter in an S-curve, and the profile.
  Written write(Register name, std::int64_t value);
  std::int64_t read(Register name) const;
  std::vector<Finding> findings() const;

  Tick tick() const { return tick_; }
  void advance_to(Tick tick) {
    if (tick <= tick_) return;
    if (!planned_ || track_.ends_by(tick)) run_to(tick);
    tick_ = tick;
  }
  /// Steps, 2^-16 steps/cycle and 2^-16 steps/cycle^2, all to the nearest.
  Motion motion() const;
  /// -1, 0 or 1: where it moves, be it slower than motion() shows.
  int heading() const;
  /// "I" .. "VII" in an S-curve; "accelerate", "cruise", "decelerate" in a trapezoid; "rest".
  std::string_view phase() const;
  Tick next_change();
  bool arrived() const { return settled() && !in_motion() && motion().position == position_; }
  bool settled() const { return planned_ ? track_.over() : planned().settled(); }

  /// The present stretch of the movement; as of the last call of advance_to() or next_change().
  const CubicTrack& track() const { return track_; }

  bool operator==(const Mc1451a&) const = default;

 private:
  struct Rows;  // of registers

  bool in_motion() const { return track_.at(tick_).v != 0; }
  Forces forces() const;
  bool takes_in_motion(Register name) const {
    return shape_ == Shape::trapezoidal && name != Register::profile;
  }
  void plan();
  void run_to(Tick tick);
  Mc1451a planned() const;

  CubicTrack track_;
  Tick tick_ = 0;
  std::int32_t position_ = 0;
  std::int32_t velocity_ = 0;
  std::int32_t jerk_ = 0;
  std::int16_t acceleration_ = 0;
  Shape shape_ = Shape::s_curve;
  bool planned_ = false;
  bool slows_ = false;  ///< To the maximum velocity: the way to the target is planned after that.
};

}  // namespace tmcl::ramp
