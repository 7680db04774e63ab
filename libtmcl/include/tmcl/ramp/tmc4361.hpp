/// One axis of the S-shaped ramps of a TMC4361. A model of them, not exact to the chip's tick.
///
/// The chips TMC4330A, TMC4331A and TMC4361A have one ramp generator. What is taken from chapter 6
/// of the data sheet of the TMC4331A (revision 1.01), "Ramp Configurations for different Motion
/// Profiles": names, ranges and units of the registers; the seven phases B1, B12, B2, B23, B3, B34
/// and B4; that a phase that is not needed is left out, that the fastest slopes are made, and that
/// a positioning ends exactly on its target; that the acceleration changes every 64 clocks, which
/// are the tick here; that VMAX = 0 stops a positioning; and how the motor turns round: it stands
/// for no time, and where BOW2 equals BOW4 its acceleration does not become 0 meanwhile.
///
/// Not in any document, and so a model: the movement is the fastest one within the limits, in
/// continuous time, worked out anew from the present position, velocity and acceleration when a
/// register is written; its boundaries may lie between two ticks. The real chip may overshoot when
/// other registers than XTARGET and VMAX are written in motion; this one overshoots only where it
/// must. A bow of 0, which the data sheet does not allow, is the steepest that it allows: the
/// greatest acceleration of all within 1024 clocks, nearly a trapezoid. A speed above VMAX falls at
/// once. A target more than 2^31 microsteps away is reached the other way round. An acceleration
/// that a lowered bow could not take back before the velocity register overflows is cut at once. A
/// motor that leaves a stop switch needs no event to be cleared.
///
/// Not here: the profiles without ramp and with trapezoids, start and stop velocities, start
/// acceleration, final deceleration, virtual stops, TZEROWAIT and the direct units of bows.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "tmcl/ramp/cubic_track.hpp"
#include "tmcl/ramp/generator.hpp"

namespace tmcl::ramp {

class Tmc4361 {
 public:
  static constexpr std::string_view chip = "tmc4361";
  static constexpr double clocks_per_tick = 64;
  static double ticks_per_second(double clock_hz) { return clock_hz / clocks_per_tick; }
  static constexpr int position_bits = 32;
  /// At the lowest clock; less at others.
  static constexpr std::int64_t velocity_of_a_microstep = 1 << 24;

  enum class Mode : std::uint8_t {
    velocity = 0b010,  ///< Ramps to vmax, which has a sign.
    position = 0b110,  ///< Drives to xtarget; the sign of vmax does not matter.
  };
  enum class Register : std::uint8_t {
    rampmode,
    xtarget,
    xactual,
    vmax,
    amax,
    dmax,
    dstop,
    bow1,
    bow2,
    bow3,
    bow4,
    stop_left_en,
    stop_right_en,
    soft_stop_en,
    clk_freq,
  };
  static std::span<const RegisterInfo> registers();

  /// All registers are zero at first but rampmode, which is position, and the clock's frequency,
  /// 16 MHz; so nothing moves.
  Tmc4361() = default;

  /// Everything may be changed in motion. Writing xactual in the mode position makes the motor
  /// drive to xtarget.
  Written write(Register name, std::int64_t value);
  Written write(Mode mode) { return write(Register::rampmode, static_cast<std::int64_t>(mode)); }
  std::int64_t read(Register name) const;
  std::vector<Finding> findings() const;

  /// The stop switches: where enabled, the left one stops negative, the right one positive motion,
  /// at once or linearly at dstop, and keeps it from beginning.
  void set_switches(bool left, bool right);
  /// Stops dead, as the mode velocity with a vmax of 0.
  void halt();

  Tick tick() const { return tick_; }
  void advance_to(Tick tick) {
    if (tick <= tick_) return;
    if (!planned_ || track_.ends_by(tick)) run_to(tick);
    tick_ = tick;
  }
  /// Position, velocity and acceleration to the nearest unit of xactual, vmax and amax.
  Motion motion() const;
  /// -1, 0 or 1: where it moves, be it slower than motion() shows.
  int heading() const;
  /// "B1" .. "B4", "stop", "rest".
  std::string_view phase() const;
  Tick next_change();
  bool arrived() const;
  bool settled() const { return planned_ ? track_.over() : planned().settled(); }

  Mode mode() const { return mode_; }

  /// The present stretch of the movement; as of the last call of advance_to() or next_change().
  const CubicTrack& track() const { return track_; }

  bool operator==(const Tmc4361&) const = default;

 private:
  struct Rows;  // of registers

  double ticks_a_second() const { return ticks_per_second(clk_freq_); }
  double velocity_of(std::int64_t registered) const;
  bool barred(double velocity) const;
  double permitted(double velocity) const { return barred(velocity) ? 0 : velocity; }
  Forces forces() const;
  double distance() const;

  Tmc4361 planned() const;
  void plan();
  void run_to(Tick tick);
  void plan_ramp(double velocity, double acceleration);

  CubicTrack track_;
  Tick tick_ = 0;
  std::int32_t xtarget_ = 0;
  std::int32_t vmax_ = 0;
  std::int32_t amax_ = 0;
  std::int32_t dmax_ = 0;
  std::int32_t dstop_ = 0;
  std::int32_t clk_freq_ = 16'000'000;
  std::int32_t bow1_ = 0;
  std::int32_t bow2_ = 0;
  std::int32_t bow3_ = 0;
  std::int32_t bow4_ = 0;
  Mode mode_ = Mode::position;
  bool stop_left_en_ = false;
  bool stop_right_en_ = false;
  bool soft_stop_en_ = false;
  bool left_ = false;
  bool right_ = false;
  bool stops_ = false;  // at a switch
  bool planned_ = false;
};

}  // namespace tmcl::ramp
