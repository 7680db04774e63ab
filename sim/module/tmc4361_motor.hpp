/// The motor of a module with a TMC4361: trapezoids by a stand-in, S-shaped ramps by a model.
#pragma once

#include <map>

#include "sim/module/chip_motor.hpp"
#include "sim/module/stand_in_motor.hpp"
#include "tmcl/ramp/tmc4361.hpp"

namespace tmcl::sim {

/// While parameter 14 is 1. Not in any document at hand, and here: start and stop velocity, start
/// acceleration, final deceleration and the scale of the bows make no difference; at a switch a
/// soft stop without a deceleration of its own has the greatest one; a motor that turns goes on
/// from where it stands, and so on as the stand-in.
class BowMotor final : public ChipMotor<ramp::Tmc4361> {
 public:
  explicit BowMotor(TimePoint power_on);

  std::optional<std::int32_t> read(const ParameterInfo& row) const override;
  Status write(const ParameterInfo& row, std::int32_t value) override;

  Status rotate(std::int64_t velocity) override;
  void stop() override;
  void move_to(std::int64_t position) override;
  std::int64_t top_speed() const override { return max_velocity_; }
  void limit_positioning(std::int64_t speed) override { chip().write(Register::vmax, speed); }
  std::int32_t relative_origin() const override;

  std::int64_t speed() const override;
  void halt() override { chip().halt(); }

  std::int32_t target() const { return static_cast<std::int32_t>(chip().read(Register::xtarget)); }
  /// Stands there from now on, and calls that its target.
  void place(std::int32_t position, std::int32_t target);
  void enable_stops(bool left, bool right, bool soft);
  StandInMotor::Stops stops() const;
  bool drives_to_target() const { return chip().mode() == ramp::Tmc4361::Mode::position; }
  /// As the register has it.
  std::int32_t vmax() const { return static_cast<std::int32_t>(chip().read(Register::vmax)); }
  void drive(bool to_target, std::int32_t vmax);

 private:
  std::optional<std::int32_t> chip_reading(std::uint8_t /*address*/) override { return {}; }
  static std::span<const Mapped> mapped();
  void set_stop_deceleration();

  std::int64_t max_velocity_ = 0;  // what VMAX is while positioning
  std::int64_t stop_deceleration_ = 0;
  bool relative_to_actual_ = false;
};

/// Both know all parameters, and one of them moves. The data sheet advises against a change of the
/// profile in motion: so here one takes place as soon as a command, or a register that is written,
/// finds the motor at rest.
///
/// Registers and parameters that mean the same follow each other; of trapezoids VMAX is in whole
/// microsteps per second. Only VSTART, VSTOP, ASTART, DFINAL and VBREAK keep the trapezoids' edges;
/// AACTUAL, STATUS, EVENTS and what else is not in the model are words without effect.
class Tmc4361Motor final : public Motor {
 public:
  /// A register that holds a parameter, in parts of that one's unit.
  struct Setting {
    std::uint8_t address;
    std::uint8_t parameter;
    std::int32_t parts;
    int bits;
  };

  Tmc4361Motor(const Model& model, TimePoint power_on);

  void advance_to(TimePoint time) override;
  MotionForecast outlook() const override { return active().outlook(); }

  int heading() const override { return active().heading(); }
  bool accelerates() const override { return active().accelerates(); }
  std::int32_t position() const override { return active().position(); }
  int position_bits() const override { return active().position_bits(); }
  std::int64_t speed() const override { return active().speed(); }
  TimePoint passing(std::int64_t back, std::int64_t ahead) const override {
    return active().passing(back, ahead);
  }
  TimePoint turning() const override { return active().turning(); }
  TimePoint next_change() override { return active().next_change(); }

  SwitchWiring wiring() const override { return trapezoid_.wiring(); }
  void set_switches(bool left, bool right) override;
  void halt() override { active().halt(); }
  void set_position(std::int32_t position) override { active().set_position(position); }

  std::optional<std::int32_t> read(const ParameterInfo& row) const override;
  Status write(const ParameterInfo& row, std::int32_t value) override;
  std::int32_t read_chip(std::uint8_t address) override;
  /// Errors: also a RAMPMODE without ramp, and one of the two that no document has.
  Status write_chip(std::uint8_t address, std::int32_t value) override;

  Status rotate(std::int64_t velocity) override;
  void stop() override { active().stop(); }
  void move_to(std::int64_t position) override;
  std::int64_t top_speed() const override { return active().top_speed(); }
  void limit_positioning(std::int64_t speed) override { active().limit_positioning(speed); }
  std::int32_t relative_origin() const override { return active().relative_origin(); }

 private:
  const Motor& active() const {
    return has_bows_ ? static_cast<const Motor&>(bows_) : static_cast<const Motor&>(trapezoid_);
  }
  Motor& active() {
    return has_bows_ ? static_cast<Motor&>(bows_) : static_cast<Motor&>(trapezoid_);
  }
  void take_profile();

  /// How the present profile is driven: to the target or not, and VMAX as the register has it.
  struct Drive {
    bool to_target;
    std::int32_t vmax;
  };
  Drive drive() const;
  void set(Drive drive);
  void set(const Setting& setting, std::int32_t value);
  Status set_mode(std::int32_t mode);
  Status set_target(std::int32_t position);
  const ParameterInfo& row_of(std::uint8_t number) const;

  const Model& model_;
  StandInMotor trapezoid_;
  BowMotor bows_;
  TimePoint now_;
  std::map<std::uint8_t, std::int32_t> settings_;  // registers that are parameters as well
  std::int32_t latched_ = 0;
  bool left_ = false;
  bool right_ = false;
  bool has_bows_ = false;
  bool wants_bows_ = false;
};

}  // namespace tmcl::sim
