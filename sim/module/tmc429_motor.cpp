#include "sim/module/tmc429_motor.hpp"

#include <array>
#include <cmath>
#include <cstdlib>

#include "tmcl/parameter_number.hpp"

namespace tmcl::sim {
namespace {

namespace ap = axis_parameter;

constexpr auto actual_acceleration = number_of("actual_acceleration");
constexpr auto ramp_mode = number_of(Family::tmc429, "ramp_mode");
constexpr std::int32_t greatest_velocity = 2047;

using R = ramp::Tmc429::Register;
using Mode = ramp::Tmc429::Mode;

/// What the chip alone writes.
namespace tmc429_address {
constexpr std::uint8_t a_actual = 0x0E;
constexpr std::uint8_t x_latched = 0x1C;
}  // namespace tmc429_address

}  // namespace

Tmc429Motor::Tmc429Motor(TimePoint power_on, const ModuleTraits& traits)
    : ChipMotor(power_on, mapped()) {
  take_traits(chip(), traits);
}

std::span<const Tmc429Motor::Mapped> Tmc429Motor::mapped() {
  static constexpr std::array<Mapped, 11> all{{
      {ap::target_position, R::x_target},
      {ap::actual_position, R::x_actual},
      {ap::target_velocity, R::v_target},
      {ap::actual_velocity, R::v_actual},
      {ap::max_acceleration, R::a_max},
      {number_of("right_limit_switch_disable"), R::disable_stop_r},
      {number_of("left_limit_switch_disable"), R::disable_stop_l},
      {number_of("minimum_velocity"), R::v_min},
      {number_of(Family::tmc429, "soft_stop"), R::soft_stop},
      {number_of("ramp_divisor"), R::ramp_div},
      {number_of("pulse_divisor"), R::pulse_div},
  }};
  return all;
}

std::optional<std::int32_t> Tmc429Motor::read(const ParameterInfo& row) const {
  switch (row.number) {
    case ap::max_velocity: return max_velocity_;
    case ap::position_reached: return chip().at_target() ? 1 : 0;
    case actual_acceleration: return chip().a_actual();
    case ramp_mode: return static_cast<std::int32_t>(chip().mode());
    default: return ChipMotor::read(row);
  }
}

Status Tmc429Motor::write(const ParameterInfo& row, std::int32_t value) {
  switch (row.number) {
    case ap::max_velocity: max_velocity_ = value; return write_register(R::v_max, row.scale, value);
    case ramp_mode: set_ramp_mode(static_cast<Mode>(value)); return Status::ok;
    default: return ChipMotor::write(row, value);
  }
}

void Tmc429Motor::set_ramp_mode(Mode mode) {
  if (mode != Mode::velocity) chip().write(R::v_max, max_velocity_);
  chip().write(mode);
}

Status Tmc429Motor::rotate(std::int64_t velocity) {
  if (velocity < -greatest_velocity || velocity > greatest_velocity) return Status::invalid_value;
  chip().write(Mode::velocity);
  chip().write(R::v_max, greatest_velocity);
  chip().write(R::v_target, velocity);
  return Status::ok;
}

void Tmc429Motor::stop() {
  chip().write(Mode::velocity);
  chip().write(R::v_target, 0);
}

void Tmc429Motor::move_to(std::int64_t position) {
  constexpr std::int64_t turn = 1 << 24;
  chip().write(R::x_target, ((position + turn / 2) & (turn - 1)) - turn / 2);
  set_ramp_mode(Mode::ramp);
}

std::int64_t Tmc429Motor::speed() const {
  return std::llround(
      to_pps(InternalVelocity{std::abs(chip().v_actual())}, chip().dividers()).value);
}

void Tmc429Motor::halt() {
  stop();
  chip().write(R::v_actual, 0);
}

std::optional<std::int32_t> Tmc429Motor::chip_reading(std::uint8_t address) {
  switch (address) {
    case tmc429_address::a_actual: return chip().a_actual();
    case tmc429_address::x_latched: return chip().x_latched();
    default: return std::nullopt;
  }
}

}  // namespace tmcl::sim
