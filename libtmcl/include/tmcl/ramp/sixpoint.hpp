/// One axis of the sixPoint ramp generator of the TMC5130, TMC5160 and TMC5072, exact to its tick
/// of 512 clocks.
///
/// What the data sheets say (TMC5160 rev. 1.14, chapters 6.3 and 12; TMC5130 and TMC5072 alike):
///  - the registers with their ranges and units, v[Hz] = v * f / 2^24, a[Hz/s] = a * f^2 / 2^41;
///  - which acceleration holds when: A1 up to V1, AMAX above; DMAX down to V1, D1 below; V1 = 0
///  turns
///    A1 and D1 off. Start at VSTART, stop from VSTOP. AMAX and A1 also slow down to a lowered
///    VMAX; DMAX, D1 and VSTOP serve only to stop for the target, after a reversal and at a switch;
///  - after each stop the motor stands for TZEROWAIT, then it may move again or turn round;
///  - once it brakes for its target it goes on braking until XTARGET is written again;
///  - velocity modes use AMAX and VMAX only; the flags of RAMP_STAT and the stop switches.
///
/// What they leave open, and how it is settled here:
///  - The tick: 512 clocks, which makes an acceleration register count 1/256 of v's unit a tick.
///  - The speed of a tick is reached at its beginning, and the position grows by it: by v / 2^15
///    microsteps, without rounding. A tick that would cross V1 ends on V1. XACTUAL is the nearest
///    whole microstep; a motor that stops drops what is hidden behind it.
///  - It goes on accelerating as long as the way left allows braking to VSTOP from the speed that
///    the tick would bring, and once it brakes, it holds its speed for a tick whenever that still
///    fits: so it does not creep with VSTOP for more than a few ticks' worth of way.
///  - From VSTOP or less it stops within the tick that brings XACTUAL to XTARGET. What not even a
///    start at VSTART allows to reach is reached with VSTOP.
///  - XACTUAL and RAMPMODE, when written, also end the braking phase.
///  - A TZEROWAIT written while the motor waits counts from its next stop on.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "tmcl/ramp/generator.hpp"

namespace tmcl::ramp {

/// Its registers and its motion, and what the next tick does by them.
class SixPointRules {
 public:
  enum class Register : std::uint8_t {
    vstart,
    a1,
    v1,
    amax,
    vmax,
    dmax,
    d1,
    vstop,
    tzerowait,
    xtarget,
    rampmode,
    xactual,
    sw_mode,
  };

  /// RAMPMODE.
  enum class Mode : std::uint8_t {
    position = 0,           ///< Drives to XTARGET with all parameters.
    velocity_positive = 1,  ///< Slews to VMAX with AMAX.
    velocity_negative = 2,  ///< Slews to -VMAX with AMAX.
    hold = 3,               ///< Keeps its velocity unless a switch stops it.
  };

  /// Bits of SW_MODE. The others are kept without effect: set_switches() is told which switch is
  /// active, whatever its polarity; there is no encoder and no load.
  static constexpr std::int32_t stop_l_enable = 1 << 0;
  static constexpr std::int32_t stop_r_enable = 1 << 1;
  static constexpr std::int32_t latch_l_active = 1 << 5;
  static constexpr std::int32_t latch_l_inactive = 1 << 6;
  static constexpr std::int32_t latch_r_active = 1 << 7;
  static constexpr std::int32_t latch_r_inactive = 1 << 8;
  static constexpr std::int32_t en_softstop = 1 << 11;

  Mode mode() const { return static_cast<Mode>(value(Register::rampmode)); }
  bool operator==(const SixPointRules&) const = default;

 protected:
  enum class Phase : std::uint8_t { rest, a1, amax, vmax, dmax, d1, vstop, hold };

  // Ticks that all change the velocity by the same amount. It follows from everything else, so two
  // generators do not differ by it.
  struct Run {
    Tick ticks = 0;
    std::int64_t change = 0;
    std::int32_t acceleration = 0;  // the register behind it, signed
    Phase phase = Phase::rest;
    bool brakes = false;   // for the target: the braking phase begins or goes on
    bool turns = false;    // comes to rest in order to go back
    bool arrives = false;  // its only tick ends on the target
    Tick end = 0;
    Tick reach = forever;  // the tick that brings XACTUAL to XTARGET
    bool operator==(const Run&) const { return true; }
  };

  // How the speed goes to VMAX when nothing else matters.
  struct Slew {
    std::int64_t step;
    std::int64_t limit;  // V1 or VMAX
    std::int64_t next;
    Phase phase;
  };

  std::int32_t value(Register name) const { return registers_[static_cast<std::size_t>(name)]; }
  std::int64_t speed_in(Register name) const { return std::int64_t{value(name)} * 256; }
  std::int64_t speed() const { return velocity_ < 0 ? -velocity_ : velocity_; }
  std::int32_t xactual() const {
    return static_cast<std::int32_t>((position_ + (std::uint64_t{1} << 31)) >> 32);
  }
  std::uint64_t target() const;
  std::int64_t distance() const;
  bool position_reached() const { return xactual() == value(Register::xtarget); }
  int wanted_direction() const;
  bool blocked(int direction) const;

  std::int64_t braking_distance(std::int64_t speed) const;
  std::int64_t reserve(std::int64_t speed) const;
  Slew slew_from(std::int64_t speed) const;

  Run next_run() const;
  Run standing(Tick ticks) const { return {.ticks = ticks}; }
  Run to_speed(int heading, std::int64_t next, Phase phase, Tick ticks) const;
  Run stopping() const;
  Run slewing() const;
  Run positioning() const;
  Run approaching(int heading, std::int64_t left) const;
  Run speeding(int heading, std::int64_t left, const Slew& slew) const;
  Run braking(int heading, std::int64_t left, std::int64_t held) const;
  Run holding(int heading, std::int64_t left, std::int64_t held) const;
  Run ending(int heading, std::int64_t left) const;
  Run slowing(int heading, std::int64_t floor, Tick most) const;
  Phase slowing_phase() const;
  Tick fitting_steps(std::int64_t left, std::int64_t change, Tick most) const;

  std::array<std::int32_t, 13> registers_{};
  Tick tick_ = 0;
  Tick stands_until_ = 0;       // TZEROWAIT
  std::uint64_t position_ = 0;  // 2^-32 microsteps, wraps; always a multiple of 2^9
  std::int64_t velocity_ = 0;   // 1/256 of VACTUAL's unit: 2^-23 microsteps a tick
  bool braking_ = false;
  bool left_ = false;
  bool right_ = false;
};

class SixPoint : public SixPointRules {
 public:
  static constexpr std::string_view chip = "sixpoint";

  /// RAMP_STAT.
  struct Status {
    bool status_stop_l = false;      ///< The left switch is active.
    bool status_stop_r = false;      ///< The right switch is active.
    bool status_latch_l = false;     ///< Event: XLATCH was taken at the left switch.
    bool status_latch_r = false;     ///< Event: XLATCH was taken at the right switch.
    bool event_stop_l = false;       ///< The left switch stops it or keeps it from starting.
    bool event_stop_r = false;       ///< The right switch does.
    bool event_pos_reached = false;  ///< Event: XACTUAL has come to XTARGET, be it in passing.
    bool velocity_reached = false;   ///< The speed is VMAX.
    bool position_reached = false;   ///< XACTUAL is XTARGET in this instant.
    bool vzero = false;              ///< Standstill.
    bool t_zerowait_active = false;  ///< Stands because TZEROWAIT is not over.
    bool second_move = false;        ///< Event: it had to turn round to come to its target.
    bool operator==(const Status&) const = default;
  };

  static constexpr double ticks_per_second(double clock_hz) { return clock_hz / 512; }
  static constexpr int position_bits = 32;
  static constexpr std::int64_t velocity_of_a_microstep = 1 << 15;
  static std::span<const RegisterInfo> registers();

  /// Nothing moves after power-up: everything is 0 but VSTOP, which is 10.
  SixPoint();

  /// At any time; out_of_range is the only error. Acts from the next tick on.
  Written write(Register name, std::int64_t value);
  Written write(Mode mode) { return write(Register::rampmode, static_cast<std::int64_t>(mode)); }
  std::int64_t read(Register name) const;
  /// Contradictions between the registers, for positioning and for the velocity modes.
  std::vector<Finding> findings() const;

  Tick tick() const { return tick_; }
  /// Lets time pass. An earlier tick than the present one changes nothing.
  void advance_to(Tick tick);

  /// Position XACTUAL, velocity VACTUAL (towards zero, without its fraction), acceleration: the
  /// register that changed the speed in the last tick, with the sign of the change.
  Motion motion() const { return {xactual(), velocity_ / 256, acceleration_}; }
  /// -1, 0 or 1: where it moves, be it slower than VACTUAL shows.
  int heading() const { return (velocity_ > 0) - (velocity_ < 0); }
  /// What the last tick did: "A1", "AMAX", "VMAX", "DMAX", "D1", "VSTOP" (the creeping end) and
  /// "hold"; at standstill "TZEROWAIT" and "rest".
  std::string_view phase() const;
  Tick next_change();
  bool arrived() const;
  bool settled() const;

  Status status() const;
  /// Reads the status and clears its events.
  Status take_events();

  /// Tells which switches are active from now on. With an edge that SW_MODE names, XLATCH takes
  /// XACTUAL.
  void set_switches(bool left, bool right);
  /// Stops dead, as a stall may make it do. The registers stay as they are: it starts again at the
  /// next tick unless they tell it to stand.
  void halt();
  std::int32_t xlatch() const { return xlatch_; }

  /// What the registers do not show.
  struct Exact {
    std::int64_t position;  ///< 2^-23 microsteps, -2^54..2^54-1; wraps as XACTUAL does.
    std::int64_t velocity;  ///< 1/256 of VACTUAL's unit: 2^-23 microsteps a tick.
    bool operator==(const Exact&) const = default;
  };
  Exact exact() const;

  /// All of the state, however it came about.
  bool operator==(const SixPoint&) const = default;

 private:
  void latch(bool before, bool now, std::int32_t on_active, std::int32_t on_inactive, bool& event);

  void plan();
  void take(Tick ticks);
  void come_to_rest();
  int run_heading() const;
  Tick way_to(std::int64_t microstep) const;
  Tick tick_after(Tick way) const;
  Tick tick_at_speed(std::int64_t speed) const;

  std::int32_t xlatch_ = 0;
  std::int32_t acceleration_ = 0;
  Phase phase_ = Phase::rest;
  bool pos_reached_event_ = false;
  bool second_move_event_ = false;
  bool latch_l_event_ = false;
  bool latch_r_event_ = false;
  Run run_;
};

}  // namespace tmcl::ramp
