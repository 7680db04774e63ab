/// One axis of the TMC457 ramp generator: S-shaped and trapezoidal ramps.
///
/// Registers, ranges, units and the 15/16 are those of Trinamic's application note "Motion Control
/// Profile Parameterization". From its unit formulas follows that the chip adds acceleration to
/// velocity every 16 clocks and bow to acceleration every 1024 clocks. How it finds the moment at
/// which to slow down is in no document. So the movement is the time-optimal one within the limits,
/// worked out anew from the present position, velocity and acceleration when a register is written;
/// its boundaries may lie between two clocks.
///
/// Further choices where no document says anything: a target more than 2^31 microsteps away is
/// reached the other way round; v_max does not limit the modes velocity and hold; d_stop and the
/// switches act in all modes; an acceleration that a lowered bow could not take back before the
/// 31-bit velocity register overflows is cut at once. The oscillation that the note warns of, where
/// the bow value exceeds a_max or d_max, has a model of our own: the acceleration is always one bow
/// value, up or down, for whole bow ticks of 1024 clocks counted from the last write, so that the
/// motor passes what it is to reach again and again.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "tmcl/ramp/cubic_track.hpp"
#include "tmcl/ramp/generator.hpp"
#include "tmcl/units.hpp"

namespace tmcl::ramp {

class Tmc457 {
 public:
  static constexpr std::string_view chip = "tmc457";
  /// A tick is one clock.
  static double ticks_per_second(double clock_hz) { return clock_hz; }
  static constexpr int position_bits = 32;
  static constexpr std::int64_t velocity_of_a_microstep = 1 << 30;

  enum class Mode : std::uint8_t {
    position = 0,  ///< Drives to x_target.
    velocity = 2,  ///< Ramps to v_target with a_max, d_max and bow_max.
    hold = 3,      ///< Takes v_target at once; no ramp parameter applies.
  };
  enum class Register : std::uint8_t {
    mode,
    x_target,
    x_actual,
    v_max,
    v_target,
    a_max,
    d_max,
    a_max_d_max,  ///< Writes both; reads a_max.
    d_stop,
    bow_max,
    enable_stop_l,
    enable_stop_r,
  };
  static std::span<const RegisterInfo> registers();

  /// All registers are zero at first, so nothing moves.
  Tmc457() = default;

  /// Everything may be changed in motion. Writing x_actual in the mode position makes the motor
  /// drive to x_target.
  Written write(Register name, std::int64_t value);
  Written write(Mode mode) { return write(Register::mode, static_cast<std::int64_t>(mode)); }
  std::int64_t read(Register name) const;
  std::vector<Finding> findings() const;

  /// The stop switches: where enabled, the left one stops negative, the right one positive motion,
  /// at d_stop and without bow, and keeps it from beginning.
  void set_switches(bool left, bool right);

  Tick tick() const { return tick_; }
  void advance_to(Tick tick) {
    if (tick <= tick_) return;
    if (!planned_ || track_.ends_by(tick)) run_to(tick);
    tick_ = tick;
  }
  /// Position to the nearest microstep; velocity and acceleration to the nearest unit of v_max and
  /// a_max.
  Motion motion() const;
  /// -1, 0 or 1: where it moves, be it slower than motion() shows.
  int heading() const;
  /// "I" .. "VII" in an S-shaped ramp; "accelerate", "cruise", "decelerate" in a trapezoid; "stop",
  /// "hold", "oscillate", "rest".
  std::string_view phase() const;
  Tick next_change();
  bool arrived() const;
  /// An oscillation never settles.
  bool settled() const { return planned_ ? track_.over() : planned().settled(); }

  /// Status bits. When exactly the chip sets them is not documented.
  struct Status {
    bool x_reached;  ///< arrived()
    bool v_reached;  ///< Has settled at v_target, or cruises at v_max in the mode position.
    bool v_zero;     ///< Stands; not while passing zero.
    bool operator==(const Status&) const = default;
  };
  Status status() const;

  Mode mode() const { return mode_; }

  /// The present stretch of the movement; as of the last call of advance_to() or next_change().
  const CubicTrack& track() const { return track_; }

  bool operator==(const Tmc457&) const = default;

 private:
  struct Rows;  // of registers

  enum class Course : std::uint8_t { ramp, stop, hold, oscillation };

  std::int32_t bow_value() const { return bow_max_ == 0 ? 0 : 1 << (bow_max_ - 1); }
  bool oscillates() const;
  bool barred(double velocity) const;
  Forces forces() const;

  Tmc457 planned() const;
  void plan();
  void run_to(Tick tick);
  void plan_ramp(double velocity, double acceleration);
  void plan_oscillation(double velocity);
  Profile leg_to_velocity(double velocity) const;
  Profile leg_to_target() const;
  double distance() const;
  double permitted(double velocity) const { return barred(velocity) ? 0 : velocity; }
  void next_stretch();
  void skip_periods(Tick until);

  CubicTrack track_;
  Tick tick_ = 0;
  std::int32_t x_target_ = 0;
  std::int32_t v_max_ = 0;
  std::int32_t v_target_ = 0;
  std::int32_t a_max_ = 0;
  std::int32_t d_max_ = 0;
  std::int32_t d_stop_ = 0;
  std::uint8_t bow_max_ = 0;
  Mode mode_ = Mode::position;
  Course course_ = Course::ramp;
  bool enable_stop_l_ = false;
  bool enable_stop_r_ = false;
  bool left_ = false;
  bool right_ = false;
  bool planned_ = false;
};

}  // namespace tmcl::ramp
