/// One axis of the TMC429 ramp generator, exact to its base tick.
///
/// Structure and rates are those of the TMC429 data sheet (rev. 2.06, section 8.1): a ramp stage
/// that changes the speed by a_max every 2^ramp_div base ticks, and a pulse stage that makes a
/// microstep whenever an 11-bit accumulator overflows, every 2^pulse_div base ticks.
///
/// What the chip does in the last microsteps is not documented. The enumerations LastStep,
/// FactorRule, Order and Accumulator name the possibilities; their first values are the defaults,
/// and the only ones that agree with all remarks of the data sheet. A measurement on a module can
/// settle them.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tmcl/clock.hpp"
#include "tmcl/ramp/generator.hpp"
#include "tmcl/units.hpp"

namespace tmcl::ramp {

/// Its registers and its motion, and what the coming ramp ticks will do by them.
class Tmc429Rules {
 public:
  enum class Mode : std::uint8_t {
    ramp,      ///< Drives to x_target, decelerating at a_max.
    soft,      ///< Drives to x_target, slowing down exponentially.
    velocity,  ///< Slews to v_target, which v_max limits.
    hold,      ///< Keeps v_actual as it was written; no limit applies.
  };
  /// From which distance the ramp takes the speed it asks for.
  enum class LastStep : std::uint8_t {
    r3,  ///< v² = 2048 p (distance - 1)
    r1,  ///< v² = 2048 floor(p distance)
    r2,  ///< v² = 2048 p distance
  };
  /// What people call them, as with the other enumerations that are about open points.
  static constexpr std::array<std::string_view, 3> last_steps{"r3", "r1", "r2"};
  /// Which stage comes first where both have a tick at once.
  enum class Order : std::uint8_t { ramp_first, pulse_first };
  static constexpr std::array<std::string_view, 2> orders{"ramp_first", "pulse_first"};
  /// What becomes of the fraction of a microstep when the motor stops on its target.
  enum class Accumulator : std::uint8_t { cleared, kept };
  static constexpr std::array<std::string_view, 2> accumulators{"cleared", "kept"};

  /// Without its fraction: 0 is read while |v| < 1, not only at standstill.
  std::int32_t v_actual() const { return velocity_ / v_unit; }
  bool operator==(const Tmc429Rules&) const = default;

 protected:
  static constexpr std::int32_t v_unit = 256;  // speeds carry eight bits of fraction

  // A stretch in which every ramp tick changes the velocity by the same amount. Only kept to be
  // quick: it follows from the rest of the state, and so takes no part in comparisons.
  struct Run {
    Tick end = 0;  // its last tick; before the present one: to be planned
    std::int32_t slew = 0;
    bool stops_on_target = false;
    bool is_steady() const { return slew == 0 && !stops_on_target; }
    bool operator==(const Run&) const { return true; }
  };
  // As the next ramp tick will see it.
  struct Seen {
    std::int32_t dx;
    std::uint32_t accumulator;
  };
  // The same along the direction of motion.
  struct Approach;

  bool positioning() const { return mode_ == Mode::ramp || mode_ == Mode::soft; }
  bool blocked(std::int32_t velocity) const;
  bool stops_dead() const { return !soft_stop_ && blocked(velocity_); }
  bool stops_on_target(std::int32_t dx) const;
  std::int32_t distance() const;
  std::int32_t goal(std::int32_t dx) const;
  std::int32_t slew(std::int32_t dx) const;

  std::int32_t asked_velocity(std::int32_t dx) const;
  std::uint32_t factor() const { return 128U + pmul_; }
  std::uint32_t unclipped_speed(std::uint32_t distance) const;
  std::uint32_t nearest_distance_of(std::uint32_t speed) const;

  Tick next_ramp_tick() const { return ((tick_ >> ramp_div_) + 1) << ramp_div_; }
  Tick seen_at(Tick ramp_tick) const { return ramp_tick - (order_ == Order::ramp_first ? 1 : 0); }
  Tick pulses(Tick from, Tick to) const { return (to >> pulse_div_) - (from >> pulse_div_); }
  Seen seen() const;

  Run plan() const;
  Run plan_slew(std::int32_t goal) const;
  Run plan_positioning() const;
  Run plan_cruise(const Approach& approach) const;
  Run plan_crawl(const Approach& approach) const;
  Run plan_acceleration(const Approach& approach) const;
  Run plan_deceleration(const Approach& approach) const;
  Run run_of(Tick ramp_ticks, std::int32_t slew) const;
  Run run_until_step(const Approach& approach, std::uint32_t steps) const;
  bool still_below_ramp(const Approach& approach, std::uint32_t slews) const;
  std::uint64_t sum_of_pulses(Tick begin, Tick count, std::int32_t first, std::int32_t slew) const;

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
  std::uint8_t pmul_ = 0;
  std::uint8_t pdiv_ = 0;
  Mode mode_ = Mode::ramp;
  LastStep last_step_ = LastStep::r3;
  Order order_ = Order::ramp_first;
  Accumulator at_stop_ = Accumulator::cleared;
  bool disable_stop_l_ = false;
  bool disable_stop_r_ = false;
  bool soft_stop_ = false;
  bool left_ = false;
  bool right_ = false;
};

class Tmc429 : public Tmc429Rules {
 public:
  static constexpr std::string_view chip = "tmc429";
  /// 32 periods of the 16 MHz clock.
  static constexpr Duration base_tick = std::chrono::microseconds(2);
  static double ticks_per_second(double clock_hz) { return clock_hz / 32; }
  static constexpr int position_bits = 24;
  static constexpr std::int64_t velocity_of_a_microstep = 2048;  ///< With pulse_div 0.

  /// How pmul and pdiv follow from a_max and the dividers; the ideal is a_max / (128 * 2^(ramp_div
  /// - pulse_div)).
  enum class FactorRule : std::uint8_t {
    percent_99,        ///< 0.99 of the ideal, as in the data sheet's rev. 2.06.
    percent_95,        ///< 0.95, as in its rev. 1.07.
    percent_98_8,      ///< 0.988, as in the open firmware of the TMCM-1110.
    nearest,           ///< The nearest value.
    nearest_less_one,  ///< The nearest value with pmul less one.
  };
  static constexpr std::array<std::string_view, 5> factor_rules{
      "percent_99", "percent_95", "percent_98_8", "nearest", "nearest_less_one"};
  enum class Register : std::uint8_t {
    mode,
    v_min,
    v_max,
    v_target,
    v_actual,
    a_max,
    pulse_div,
    ramp_div,
    pmul,
    pdiv,
    x_target,
    x_actual,
    disable_stop_l,
    disable_stop_r,
    soft_stop,
    ref_rnl,
    // Not registers of the chip: which reading of the data sheet applies.
    last_step,
    factor_rule,
    order,
    accumulator,
  };
  static std::span<const RegisterInfo> registers();

  /// All registers are zero after power-up, so nothing moves before v_max and a_max are written.
  Tmc429() = default;

  /// A write acts at the next ramp tick. Writing x_actual in the modes ramp and soft makes the
  /// motor drive to x_target (data sheet 8.1.2). pmul and pdiv follow a_max and the dividers, as
  /// the firmware of the modules sees to it, until one of the two is written.
  Written write(Register name, std::int64_t value);
  Written write(Mode mode) { return write(Register::mode, static_cast<std::int64_t>(mode)); }
  std::int64_t read(Register name) const;
  std::vector<Finding> findings() const;

  /// The stop switches as the chip's inputs see them: the left one stops negative, the right one
  /// positive motion. A switch that closes latches the position if that is armed.
  void set_switches(bool left, bool right);
  /// The next closing of the switch that ref_rnl selects (1: right) stores the position.
  void arm_latch() { latch_armed_ = true; }
  bool latch_armed() const { return latch_armed_; }
  std::int32_t x_latched() const { return x_latched_; }

  Tick tick() const { return tick_; }
  void advance_to(Tick tick);
  Motion motion() const { return {x_actual_, v_actual(), a_actual()}; }
  /// -1, 0 or 1: where it moves, be it slower than v_actual shows.
  int heading() const { return (velocity_ > 0) - (velocity_ < 0); }
  std::string_view phase() const;
  Tick next_change();
  bool arrived() const { return positioning() && at_target() && velocity_ == 0; }
  bool settled() const { return (tick_ < run_.end ? run_ : plan()).end == forever; }

  Mode mode() const { return mode_; }
  std::int32_t x_target() const { return x_target_; }
  std::int32_t x_actual() const { return x_actual_; }
  /// In the modes ramp and soft: the speed that the ramp asks for at this distance.
  std::int32_t v_target() const { return positioning() ? asked_velocity(distance()) : v_target_; }
  /// What the next ramp tick adds to the speed, in 1/256 of its unit: -a_max..a_max, also where it
  /// stops at once.
  std::int32_t a_actual() const {
    const auto next = next_ramp_tick() <= run_.end ? run_.slew : slew(seen().dx);
    return std::clamp(next, -a_max_, a_max_);
  }
  /// x_actual equals x_target in this instant, which may be in passing.
  bool at_target() const { return x_actual_ == x_target_; }
  Tmc429Dividers dividers() const { return {pulse_div_, ramp_div_}; }
  /// What the registers do not show.
  struct Exact {
    std::int32_t velocity;      ///< In 1/256 of v_actual's unit.
    std::uint32_t accumulator;  ///< The fraction of a microstep, in 1/2048.
  };
  Exact exact() const { return {velocity_, accumulator_}; }

  /// All of the state, however it came about.
  bool operator==(const Tmc429&) const = default;

 private:
  struct Rows;  // of registers

  void move(Tick until);
  void slew_through(Tick until);
  void coast(Tick until);
  void add_pulses(std::uint64_t sum, bool backwards);
  bool brakes(const Seen& seen) const;
  bool brake(Tick until);
  Tick earliest_halt() const;
  Tick earliest_pass(std::int32_t velocity) const;

  std::optional<Finding> wrong_deceleration() const;
  void follow(Register written);
  void update_factor();

  Run run_;
  std::int32_t x_latched_ = 0;
  bool factor_written_ = false;
  FactorRule factor_rule_ = FactorRule::percent_99;
  bool ref_rnl_ = false;
  bool latch_armed_ = false;
};

}  // namespace tmcl::ramp
