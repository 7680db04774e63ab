/// The motor of a module with a TMC4361: trapezoids by a stand-in, S-shaped ramps by a model.
#pragma once

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

 private:
  std::optional<std::int32_t> chip_reading(std::uint8_t /*address*/) override { return {}; }
  static std::span<const Mapped> mapped();
  void set_stop_deceleration();

  std::int64_t max_velocity_ = 0;  // what VMAX is while positioning
  std::int64_t stop_deceleration_ = 0;
  bool relative_to_actual_ = false;
};

/// Both know all parameters, and one of them moves. The data sheet advises against a change of the
/// profile in motion: so here one takes place as soon as a command finds the motor at rest.
class Tmc4361Motor final : public Motor {
 public:
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
  std::int32_t read_chip(std::uint8_t address) override { return trapezoid_.read_chip(address); }
  Status write_chip(std::uint8_t address, std::int32_t value) override {
    return trapezoid_.write_chip(address, value);
  }

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

  StandInMotor trapezoid_;
  BowMotor bows_;
  TimePoint now_;
  std::int32_t latched_ = 0;
  bool left_ = false;
  bool right_ = false;
  bool has_bows_ = false;
  bool wants_bows_ = false;
};

}  // namespace tmcl::sim
