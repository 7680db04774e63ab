/// One motor of a module, its axis parameters, and how it deals with what it drives.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include <tl/expected.hpp>

#include "sim/module/closed_loop.hpp"
#include "sim/module/cool_step.hpp"
#include "sim/module/coupling.hpp"
#include "sim/module/driver_protection.hpp"
#include "sim/module/encoder_watch.hpp"
#include "sim/module/homing.hpp"
#include "sim/module/module_settings.hpp"
#include "sim/module/motor.hpp"
#include "sim/module/wrapping.hpp"
#include "sim/stage/motor_load.hpp"
#include "sim/stage/stage.hpp"
#include "tmcl/model.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/status.hpp"

namespace tmcl::sim {

/// Everything happens at its own tick: the axis says when something will, and has to be brought
/// there and asked to run it. With nothing on its stage, that costs nothing.
class Axis {
 public:
  /// The stage outlives the axis: a module that restarts finds it where it was.
  Axis(const Model& model, Stage& stage, TimePoint power_on, const ModuleTraits& traits = {});

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
  bool can_move(std::int32_t value) const { return wraps_ || is_position(value); }
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
  bool searching() const { return homing_.active(); }
  /// What RFS STATUS answers: 0, or the step that the search is at.
  std::int32_t search_step() const { return homing_.step(); }

  /// Global parameters 79 and 90, where a module has them.
  void reverse_limit_polarity(bool reversed);
  void reverse_shaft(bool reversed);
  /// The stage or its load has changed.
  void stage_changed();
  /// What the motors have, in tenths of a volt.
  void set_supply(std::int32_t supply);

  /// The active switches, after polarity and swapping.
  const Switches& switches() const { return switches_; }
  /// Why it was stopped, until that is read or, on a TMCM-351, until it moves: parameter 207.
  bool stalled() const { return (errors_ & stall_error) != 0; }
  bool deviated() const { return (errors_ & deviation_error) != 0; }
  /// The group that it moves with; 0 for none.
  std::int32_t group() const;
  bool position_reached() const { return get(axis_parameter::position_reached).value_or(0) != 0; }

  /// Lets time pass, no further than next_due().
  void advance_to(TimePoint time);
  /// When run_due() has something to do if no command comes before.
  TimePoint next_due() const { return std::min(due_, model_tick_); }
  void run_due();
  /// What becomes of the present movement if nothing stops it.
  const Outlook& outlook() const { return outlook_; }

 private:
  void move(std::int64_t position);
  void begin_movement();
  std::int32_t error_flags() const;
  std::optional<std::int32_t> reading(const ParameterInfo& row) const;
  std::optional<std::int32_t> closed_loop_reading(std::uint8_t number) const;
  /// As the motor has it, or else the firmware.
  std::int32_t in_force(const ParameterInfo& row) const;
  /// What a value that is written becomes; nothing if it is refused.
  std::optional<Wrapped> accepted(const ParameterInfo& row, std::int32_t value) const;
  void take_note(std::uint8_t number, std::int32_t value);

  /// Something was written: what follows from it is done, and when to look next is worked out.
  void settle();
  void look_ahead();
  TimePoint next_look() const;
  bool is_moving() const { return motor_->heading() != 0 || outlook_.rest > now_; }
  void sense();
  Switches sensed() const;

  /// What the motor is told of a parameter, whatever was set; nothing: what was.
  std::optional<std::int32_t> overruled(const ParameterInfo& row) const;
  std::int32_t in_motor(const ParameterInfo& row, std::int32_t value) const;
  /// What MVP REL counts from.
  std::int32_t relative_origin() const;
  bool goes_to_new_target() const;

  // axis_search.cpp
  void run_search();
  void obey(const Homing::Order& order);
  void drive(int direction, std::uint8_t speed_parameter);
  void finish_search(std::int32_t reference);

  // axis_watch.cpp: encoders, stalls.
  void scale_encoders();
  EncoderScale scale_by(std::uint8_t parameter) const;
  std::int64_t deviation(const EncoderWatch& encoder) const;
  void watch_encoders();
  void watch_stall();
  bool may_stall() const;
  TimePoint next_stall_check() const;
  std::int32_t load_value() const;
  std::int32_t scaled_load_value(const ParameterInfo& row) const;
  void emergency_stop(std::int32_t error);

  // axis_drive.cpp: the driver, its current, and whether the rotor follows.
  void watch_driver();
  void watch_rotor();
  bool run_model_tick();
  TimePoint next_model_tick() const;
  void measure_load();
  bool changes_by_itself() const;
  MotorState motor_state() const;
  bool is_driver_on() const;
  std::int32_t torque_current() const;
  std::int32_t driver_flags() const;
  std::int32_t current_scale() const;
  std::int32_t run_scale() const;
  std::int32_t current_setting() const;
  std::int32_t moving_current() const;
  std::int32_t resting_current() const;
  bool is_slow() const;
  bool cools() const;
  CoolStepSettings cool_step_settings() const;
  Duration standstill() const;

  static constexpr std::int32_t stall_error = 1;
  static constexpr std::int32_t deviation_error = 2;

  Family family_;
  ModuleTraits traits_;
  bool wraps_;
  std::span<const ParameterInfo> table_;
  bool keeps_errors_;  ///< Until the next movement, not until they are read.
  std::unique_ptr<Motor> motor_;
  Coupling coupling_;
  std::array<std::int32_t, 256> values_{};  // of those parameters that the motor has no part in
  std::map<std::uint8_t, std::int32_t> driver_words_;
  TimePoint power_on_;
  TimePoint now_;
  Outlook outlook_;
  TimePoint due_ = never;
  TimePoint model_tick_ = never;
  TimePoint rest_;  // since when it stands, or when it will
  Switches switches_;
  Switches barring_;  // as the chip was told
  Homing homing_;
  ClosedLoop closed_loop_;
  EncoderWatch encoder_;
  EncoderWatch external_encoder_;
  DriverProtection protection_;
  CoolStep cool_step_;
  Rotor rotor_;
  std::int32_t supply_ = nominal_supply;
  std::int64_t speed_at_tick_ = 0;   // in 1/256 of a full step per second
  std::int64_t acceleration_ = 0;    // in full steps per second squared, in the tick before
  std::int64_t way_to_reading_ = 0;  // towards the next full step, in 1/256000
  std::int32_t errors_ = 0;
  bool deviates_ = false;
  std::int32_t latched_encoder_ = 0;
  bool limits_reversed_ = false;
};

}  // namespace tmcl::sim
