/// One motor of a module, its axis parameters, and how it deals with what it drives.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>

#include <tl/expected.hpp>

#include "sim/module/axis_driver.hpp"
#include "sim/module/axis_encoders.hpp"
#include "sim/module/axis_search.hpp"
#include "sim/module/axis_state.hpp"
#include "sim/module/closed_loop.hpp"
#include "tmcl/status.hpp"

namespace tmcl::sim {

/// Bits of parameter 207; those of a TMCM-351 are the other way round.
inline constexpr std::int32_t stall_error = 1;
inline constexpr std::int32_t deviation_error = 2;

/// Everything happens at its own tick: the axis says when something will, and has to be brought
/// there and asked to run it. With nothing on its stage, that costs nothing.
class Axis {
 public:
  /// The stage outlives the axis: a module that restarts finds it where it was.
  Axis(const Model& model, Stage& stage, TimePoint power_on, const ModuleTraits& traits = {});
  Axis(const Axis&) = delete;
  Axis& operator=(const Axis&) = delete;

  /// What GAP answers: wrong_type for a number that is not in the model's table. A reading that is
  /// cleared by being read stays: see read().
  tl::expected<std::int32_t, Status> get(std::uint8_t number) const;
  /// GAP itself: on most models, error flags (207) are 0 from then on.
  tl::expected<std::int32_t, Status> read(std::uint8_t number);
  /// What SAP answers: wrong_type for a number that cannot be written, invalid_value out of range
  /// unless that wraps.
  Status set(std::uint8_t number, std::int32_t value);

  /// Registers of the motion controller, as Motor has them; where the driver is in the same chip,
  /// its registers are the settings of the axis.
  std::int32_t read_chip(std::uint8_t address);
  Status write_chip(std::uint8_t address, std::int32_t value);
  /// Those of a motor driver of its own: words without effect, 0 at first.
  std::int32_t read_driver(std::uint8_t address) const;
  void write_driver(std::uint8_t address, std::int32_t value) { driver_words_[address] = value; }

  /// What ROR answers, or ROL with the other sign: invalid_value for more than the chip can do. As
  /// stop() and a movement, it ends a reference search.
  Status rotate(std::int64_t velocity);
  void stop();
  /// Whether the chip has such a position.
  bool is_position(std::int32_t value) const;
  /// Whether MVP takes it, as a target or a distance.
  bool can_move(std::int32_t value) const { return state_.wraps || is_position(value); }
  /// What MVP ABS answers: invalid_value for a position that the chip does not have, unless it
  /// wraps.
  Status move_to(std::int32_t position);
  /// What MVP REL answers, for a distance. The target wraps as the chip's positions do.
  Status move_by(std::int32_t distance);

  /// Slows the positioning under way, so that it arrives as late as it can, but not after this
  /// time.
  void arrive_by(TimePoint time);

  /// What RFS START answers: invalid_value if parameter 193 has no such mode.
  Status start_search();
  /// RFS STOP: the motor comes to a stop as well.
  void stop_search();
  /// What RFS STATUS answers: 0 without a search, or the step that it is at.
  std::int32_t search_step() const { return search_.homing().step(); }

  /// Global parameters 79 and 90, where a module has them.
  void reverse_limit_polarity(bool reversed);
  void reverse_shaft(bool reversed);
  /// The stage or its load has changed.
  void stage_changed();
  /// What the motors have, in tenths of a volt.
  void set_supply(std::int32_t supply);

  /// The active switches, after polarity and swapping.
  const Switches& switches() const { return state_.switches; }
  /// Why it was stopped, until that is read or, on a TMCM-351, until it moves: parameter 207.
  bool stalled() const { return (errors_ & stall_error) != 0; }
  bool deviated() const { return (errors_ & deviation_error) != 0; }
  /// The group that it moves with; 0 for none.
  std::int32_t group() const;
  bool position_reached() const { return get(axis_parameter::position_reached).value_or(0) != 0; }

  /// Lets time pass, no further than next_due().
  void advance_to(TimePoint time);
  /// When run_due() has something to do if no command comes before.
  TimePoint next_due() const { return std::min({due_, driver_.tick(), swing_due_}); }
  void run_due();
  /// What becomes of the present movement if nothing stops it.
  const MotionForecast& outlook() const { return state_.outlook; }

 private:
  void move(std::int64_t position);
  void begin_movement();
  std::int32_t error_flags() const;
  std::optional<std::int32_t> reading(const ParameterInfo& row) const;
  std::optional<std::int32_t> closed_loop_reading(std::uint8_t number) const;
  void take_note(std::uint8_t number, std::int32_t value);

  /// Something was written: what follows from it is done, and when to look next is worked out.
  void settle();
  TimePoint next_look() const;
  void keep_swing();
  void sense();
  Switches sensed() const;

  void watch_encoders();
  void emergency_stop(std::int32_t error);

  AxisState state_;
  AxisEncoders encoders_{state_};
  AxisDriver driver_{state_};
  AxisSearch search_{state_, encoders_};
  ClosedLoop closed_loop_;
  bool keeps_errors_;  ///< Until the next movement, not until they are read.
  std::map<std::uint8_t, std::int32_t> driver_words_;
  TimePoint due_ = never;
  TimePoint swing_due_ = never;  // when its piece ends
  Switches barring_;             // as the chip was told
  std::int32_t errors_ = 0;
  bool deviates_ = false;
  std::int32_t latched_encoder_ = 0;
  bool limits_reversed_ = false;
};

}  // namespace tmcl::sim
