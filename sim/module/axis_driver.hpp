/// The driver of an axis: what it gives the motor, whether the rotor follows, and which load shows.
#pragma once

#include "sim/module/axis_state.hpp"
#include "sim/module/cool_step.hpp"
#include "sim/module/driver_protection.hpp"
#include "sim/stage/motor_load.hpp"

namespace tmcl::sim {

class AxisDriver {
 public:
  explicit AxisDriver(AxisState& axis) : axis_(axis) {}

  /// In tenths of a volt.
  void set_supply(std::int32_t supply) { supply_ = supply; }
  /// The firmware has disabled it.
  void reset() { protection_.reset(); }
  /// What is wrong with it, and what that does to the rotor.
  void look();
  void watch_rotor();
  /// When a load or a current that changes by itself is looked at.
  TimePoint tick() const { return tick_; }
  /// Whether the rotor has lost the field, or caught it again, or was taken along by a pull.
  bool run_tick();
  TimePoint next_stall_check() const;
  bool stalls() const;

  /// Parameters 208, 180 and 206.
  std::int32_t flags() const;
  std::int32_t current_scale() const;
  std::int32_t scaled_load_value(const ParameterInfo& row) const;
  std::int32_t load_value() const;

 private:
  TimePoint next_tick() const;
  bool may_stall() const;
  std::int64_t noise() const;
  void measure_load();
  bool changes_by_itself() const;
  MotorState motor_state() const;
  bool is_on() const;
  std::int32_t torque_current() const;
  std::int32_t run_scale() const;
  std::int32_t moving_current() const;
  std::int32_t resting_current() const;
  bool is_slow() const;
  bool cools() const;
  CoolStepSettings cool_step_settings() const;
  Duration standstill() const;

  AxisState& axis_;
  DriverProtection protection_;
  CoolStep cool_step_;
  Rotor rotor_;
  TimePoint tick_ = never;
  std::int32_t supply_ = nominal_supply;
  std::int64_t speed_at_tick_ = 0;   // in 1/256 of a full step per second
  std::int64_t acceleration_ = 0;    // in full steps per second squared, in the tick before
  std::int64_t way_to_reading_ = 0;  // towards the next full step, in 1/256000
};

}  // namespace tmcl::sim
