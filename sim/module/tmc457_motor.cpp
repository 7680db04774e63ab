#include "sim/module/tmc457_motor.hpp"

#include <array>
#include <cstdlib>

#include "tmcl/parameter_number.hpp"

namespace tmcl::sim {
namespace {

namespace ap = axis_parameter;

constexpr auto ramp_mode = number_of(Family::tmc457, "ramp_mode");
constexpr auto status_flags_number = number_of("status_flags");
constexpr auto velocity_reached = number_of("velocity_reached");

using R = ramp::Tmc457::Register;
using Mode = ramp::Tmc457::Mode;

/// What the chip alone writes.
namespace tmc457_address {
constexpr std::uint8_t v_actual = 0x02;
constexpr std::uint8_t status = 0x0B;
constexpr std::uint8_t a_actual = 0x0C;
}  // namespace tmc457_address

}  // namespace

Tmc457Motor::Tmc457Motor(TimePoint power_on)
    : ChipMotor(power_on, mapped(), {tmc457_velocity_unit, tmc457_acceleration_unit, false}) {}

std::span<const Tmc457Motor::Mapped> Tmc457Motor::mapped() {
  static constexpr std::array<Mapped, 10> all{{
      {ap::target_position, R::x_target},
      {ap::actual_position, R::x_actual},
      {ap::target_velocity, R::v_target},
      {ap::max_velocity, R::v_max},
      {ap::max_acceleration, R::a_max_d_max},
      {number_of(Family::tmc457, "stop_deceleration"), R::d_stop},
      {number_of("acceleration"), R::a_max},
      {number_of("max_deceleration"), R::d_max},
      {number_of("max_bow"), R::bow_max},
      {ramp_mode, R::mode},
  }};
  return all;
}

std::optional<std::int32_t> Tmc457Motor::read(const ParameterInfo& row) const {
  switch (row.number) {
    case ap::max_velocity: return units().read(row.scale, max_velocity_);
    case ap::actual_velocity: return units().read(row.scale, chip().motion().velocity);
    case ap::position_reached: return reached() ? 1 : 0;
    case status_flags_number: return status_flags();
    // The manual: the actual speed is equal to the target speed. So it is at rest, where the chip's
    // flag is not set.
    case velocity_reached: return chip().status().v_reached || chip().settled() ? 1 : 0;
    default: return ChipMotor::read(row);
  }
}

Status Tmc457Motor::write(const ParameterInfo& row, std::int32_t value) {
  switch (row.number) {
    case ap::unit_mode: units().set(value == 1); return Status::ok;
    case number_of("right_limit_switch_disable"):
      chip().write(R::enable_stop_r, 1 - value);
      return Status::ok;
    case number_of("left_limit_switch_disable"):
      chip().write(R::enable_stop_l, 1 - value);
      return Status::ok;
    case ap::max_velocity: return set_max_velocity(row, value);
    default: return ChipMotor::write(row, value);
  }
}

Status Tmc457Motor::set_max_velocity(const ParameterInfo& row, std::int32_t value) {
  const auto status = write_register(R::v_max, row.scale, value);
  if (status == Status::ok) max_velocity_ = chip().read(R::v_max);
  return status;
}

std::int32_t Tmc457Motor::status_flags() const {
  const auto status = chip().status();
  return (reached() ? 1 : 0) | (status.v_reached ? 2 : 0) | (status.v_zero ? 4 : 0);
}

Status Tmc457Motor::rotate(std::int64_t velocity) {
  const auto status = write_register(R::v_target, Scale::velocity, velocity);
  if (status == Status::ok) chip().write(Mode::velocity);
  return status;
}

void Tmc457Motor::stop() {
  chip().write(R::v_target, 0);
  chip().write(Mode::velocity);
}

void Tmc457Motor::move_to(std::int64_t position) {
  chip().write(R::v_max, max_velocity_);
  chip().write(R::x_target, static_cast<std::int32_t>(position));
  chip().write(Mode::position);
}

std::int64_t Tmc457Motor::speed() const {
  constexpr auto unit = tmc457_velocity_unit;
  return std::abs(chip().motion().velocity) * unit.numerator / unit.denominator;
}

// Only the mode hold takes a speed at once.
void Tmc457Motor::halt() {
  chip().write(R::v_target, 0);
  chip().write(Mode::hold);
  chip().next_change();
  chip().write(Mode::velocity);
}

std::optional<std::int32_t> Tmc457Motor::chip_reading(std::uint8_t address) {
  const auto motion = chip().motion();
  switch (address) {
    case tmc457_address::v_actual: return static_cast<std::int32_t>(motion.velocity);
    case tmc457_address::a_actual: return static_cast<std::int32_t>(motion.acceleration);
    case tmc457_address::status: return status_flags();
    default: return std::nullopt;
  }
}

}  // namespace tmcl::sim
