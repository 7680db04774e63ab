/// One axis of the TMC429 ramp generator, exact to its base tick.
///
/// Structure and rates are those of the TMC429 data sheet (rev. 2.06, section 8.1): a ramp stage
/// that changes the speed by a_max every 2^ramp_div base ticks, and a pulse stage that makes a
/// microstep whenever an 11-bit accumulator overflows, every 2^pulse_div base ticks. How the chip
/// rounds in the last microsteps is not documented; of the rules tried, the one used here (the ramp
/// law applied to the distance minus one) is the only one that agrees with all remarks of the data
/// sheet.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "tmcl/clock.hpp"
#include "tmcl/units.hpp"

namespace tmcl::ramp {

enum class Mode : std::uint8_t {
  ramp = 0,      ///< Drives to x_target, decelerating at a_max.
  soft = 1,      ///< Drives to x_target, slowing down exponentially.
  velocity = 2,  ///< Slews to v_target, which v_max limits.
  hold = 3,      ///< Keeps v_actual as it was written; no limit applies.
};

/// Base ticks since the chip's reset. The dividers count from there too, so the instant of a write
/// matters: it acts at the next ramp tick.
using Tick = std::uint64_t;

class Tmc429 {
 public:
  /// 32 periods of the 16 MHz clock.
  static constexpr Duration base_tick = std::chrono::microseconds(2);

  /// Everything is zero after power-up, so nothing moves before v_max and a_max are written.
  Tmc429() = default;

  Tick tick() const { return tick_; }
  /// Lets time pass. An earlier tick than the present one changes nothing.
  void advance_to(Tick tick);

  /// Positions are 24 bit and wrap. A target 2^23 microsteps away or more is reached the wrong way.
  void set_x_target(std::int32_t microsteps);
  /// In the modes ramp and soft the motor then moves to x_target; data sheet 8.1.2.
  void set_x_actual(std::int32_t microsteps);
  /// 0..2047. The speed at or below which the motor may stop at once; 1 is needed to arrive
  /// exactly.
  void set_v_min(std::int32_t v);
  /// 0..2047. Lowered below the present speed it slows down at a_max; 0 lets a standing motor
  /// stand.
  void set_v_max(std::int32_t v);
  /// -2047..2047. Overwritten by the chip in the modes ramp and soft.
  void set_v_target(std::int32_t v);
  /// -2047..2047, without fraction. Keeps only in the mode hold.
  void set_v_actual(std::int32_t v);
  /// 0..2047. The proportionality factor follows by itself, as in the firmware of the modules.
  void set_a_max(std::int32_t a);
  /// Exponents 0..13; as set_a_max() for the factor.
  void set_dividers(Tmc429Dividers dividers);
  void set_mode(Mode mode);

  std::int32_t x_target() const { return x_target_; }
  std::int32_t x_actual() const { return x_actual_; }
  std::int32_t v_min() const { return v_min_; }
  std::int32_t v_max() const { return v_max_; }
  /// In the modes ramp and soft: the speed that the ramp asks for at this distance.
  std::int32_t v_target() const;
  /// Without its fraction: 0 is read while |v| < 1, not only at standstill.
  std::int32_t v_actual() const;
  std::int32_t a_max() const { return a_max_; }
  /// What the next ramp tick adds to the speed, in 1/256 of its unit: -a_max..a_max.
  std::int32_t a_actual() const;
  Tmc429Dividers dividers() const { return {pulse_div_, ramp_div_}; }
  Mode mode() const { return mode_; }
  /// The factor p of the deceleration is (128 + pmul) / 2^(3 + pdiv).
  std::uint8_t pmul() const { return pmul_; }
  std::uint8_t pdiv() const { return pdiv_; }

  /// x_actual equals x_target in this instant, which may be in passing.
  bool at_target() const { return x_actual_ == x_target_; }
  /// Stands on the target, and stays there.
  bool arrived() const;
  /// Nothing but the position changes any more until a register is written.
  bool settled() const { return steady_until() == forever; }
  /// The tick at which the motor comes to stand on its target if nothing is written until then.
  /// Nothing if that is after `limit`, or if the present mode does not drive to a target.
  std::optional<Tick> arrival(Tick limit) const;

  bool operator==(const Tmc429&) const = default;

 private:
  static constexpr Tick forever = UINT64_MAX;

  bool positioning() const { return mode_ == Mode::ramp || mode_ == Mode::soft; }
  std::int32_t distance() const;
  std::int32_t asked_velocity() const;
  std::uint64_t unclipped_speed(std::uint32_t distance) const;
  std::uint32_t nearest_distance_of(std::int32_t speed) const;
  std::int32_t slew() const;
  Tick steady_until() const;
  Tick next_ramp_tick() const { return ((tick_ >> ramp_div_) + 1) << ramp_div_; }
  void step_towards(Tick until);
  void coast(Tick until);
  void ramp_stage();
  void update_factor();

  Tick tick_ = 0;
  std::int32_t x_target_ = 0;
  std::int32_t x_actual_ = 0;
  std::int32_t v_min_ = 0;
  std::int32_t v_max_ = 0;
  std::int32_t v_target_ = 0;
  std::int32_t velocity_ = 0;      // 1/256 of v_actual's unit
  std::uint32_t accumulator_ = 0;  // 0..2047; a microstep is 2048
  std::int32_t a_max_ = 0;
  std::uint8_t pulse_div_ = 0;
  std::uint8_t ramp_div_ = 0;
  Mode mode_ = Mode::ramp;
  std::uint8_t pmul_ = 0;
  std::uint8_t pdiv_ = 0;
};

}  // namespace tmcl::ramp
