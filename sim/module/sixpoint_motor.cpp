#include "sim/module/sixpoint_motor.hpp"

#include <array>
#include <cstdlib>

#include "tmcl/parameter_number.hpp"

namespace tmcl::sim {
namespace {

namespace ap = axis_parameter;

constexpr auto swap_switches = number_of(Family::sixpoint, "swap_limit_switches");
constexpr auto right_switch_polarity = number_of("right_limit_switch_polarity");
constexpr auto left_switch_polarity = number_of("left_limit_switch_polarity");
constexpr auto soft_stop = number_of(Family::sixpoint, "soft_stop");
constexpr auto relative_positioning_option = number_of("relative_positioning_option");
constexpr auto latched_position = number_of("latched_actual_position");

using R = ramp::SixPoint::Register;
using Mode = ramp::SixPoint::Mode;

/// RAMP_STAT, in the order of its bits. No load ever stops the motor by itself here: bit 6 is 0.
std::int32_t to_word(const ramp::SixPoint::Status& status) {
  const std::array<bool, 13> bits{status.status_stop_l,
                                  status.status_stop_r,
                                  status.status_latch_l,
                                  status.status_latch_r,
                                  status.event_stop_l,
                                  status.event_stop_r,
                                  false,
                                  status.event_pos_reached,
                                  status.velocity_reached,
                                  status.position_reached,
                                  status.vzero,
                                  status.t_zerowait_active,
                                  status.second_move};
  std::int32_t word = 0;
  for (std::size_t i = 0; i < bits.size(); ++i) word |= bits[i] ? 1 << i : 0;
  return word;
}

// What most modules call the disabling of a switch is its enabling on others.
bool lets_stop(const ParameterInfo& row, std::int32_t value) {
  return row.name.ends_with("_disable") == (value == 0);
}

/// What the chip alone writes.
namespace sixpoint_address {
constexpr std::uint8_t vactual = 0x22;
constexpr std::uint8_t ramp_stat = 0x35;
constexpr std::uint8_t xlatch = 0x36;
}  // namespace sixpoint_address

}  // namespace

SixPointMotor::SixPointMotor(TimePoint power_on)
    : ChipMotor(power_on, mapped(), {sixpoint_velocity_unit, sixpoint_acceleration_unit, true}) {
  // The position is latched whenever a switch becomes active.
  set_switch_mode(ramp::SixPoint::latch_l_active | ramp::SixPoint::latch_r_active, true);
}

std::span<const SixPointMotor::Mapped> SixPointMotor::mapped() {
  static constexpr std::array<Mapped, 10> all{{
      {ap::target_position, R::xtarget},
      {ap::actual_position, R::xactual},
      {ap::max_acceleration, R::amax},
      {number_of("acceleration_a1"), R::a1},
      {number_of("velocity_v1"), R::v1},
      {number_of("max_deceleration"), R::dmax},
      {number_of("deceleration_d1"), R::d1},
      {number_of(Family::sixpoint, "start_velocity"), R::vstart},
      {number_of("stop_velocity"), R::vstop},
      {number_of("ramp_wait_time"), R::tzerowait},
  }};
  return all;
}

std::optional<std::int32_t> SixPointMotor::read(const ParameterInfo& row) const {
  switch (row.number) {
    case ap::target_velocity: return target_velocity(row.scale);
    case ap::actual_velocity: return units().read(row.scale, chip().motion().velocity);
    case ap::max_velocity: return units().read(row.scale, max_velocity_);
    case latched_position: return chip().xlatch();
    case ap::position_reached: return chip().status().position_reached ? 1 : 0;
    default: return ChipMotor::read(row);
  }
}

Status SixPointMotor::write(const ParameterInfo& row, std::int32_t value) {
  switch (row.number) {
    case ap::target_velocity: return rotate(value);
    case ap::max_velocity: return set_max_velocity(row.scale, value);
    case relative_positioning_option: relative_to_actual_ = value == 1; return Status::ok;
    case number_of("right_limit_switch_disable"):
      set_switch_mode(ramp::SixPoint::stop_r_enable, lets_stop(row, value));
      return Status::ok;
    case number_of("left_limit_switch_disable"):
      set_switch_mode(ramp::SixPoint::stop_l_enable, lets_stop(row, value));
      return Status::ok;
    case ap::unit_mode: units().set(value == 1); return Status::ok;
    default: wire_switches(row.number, value == 1); return ChipMotor::write(row, value);
  }
}

void SixPointMotor::wire_switches(std::uint8_t number, bool on) {
  switch (number) {
    case swap_switches: wiring_.swapped = on; break;
    case right_switch_polarity: wiring_.right_inverted = on; break;
    case left_switch_polarity: wiring_.left_inverted = on; break;
    case soft_stop: set_switch_mode(ramp::SixPoint::en_softstop, on); break;
    default: break;
  }
}

std::int32_t SixPointMotor::target_velocity(Scale scale) const {
  const auto speed = read_register(R::vmax, scale);
  return chip().mode() == Mode::velocity_negative ? -speed : speed;
}

// In the velocity modes VMAX is the speed that was asked for.
Status SixPointMotor::set_max_velocity(Scale scale, std::int32_t value) {
  const auto number = in_register(R::vmax, scale, value);
  if (!number) return Status::invalid_value;
  max_velocity_ = *number;
  if (chip().mode() == Mode::position) chip().write(R::vmax, max_velocity_);
  return Status::ok;
}

void SixPointMotor::set_mode(Mode mode) {
  chip().write(R::rampmode, static_cast<std::int64_t>(mode));
}

Status SixPointMotor::rotate(std::int64_t velocity) {
  const auto speed = velocity < 0 ? -velocity : velocity;
  const auto status = write_register(R::vmax, Scale::velocity, speed);
  if (status != Status::ok) return status;
  set_mode(velocity < 0 ? Mode::velocity_negative : Mode::velocity_positive);
  return status;
}

void SixPointMotor::stop() {
  chip().write(R::vmax, 0);
  set_mode(Mode::velocity_positive);
}

void SixPointMotor::move_to(std::int64_t position) {
  chip().write(R::vmax, max_velocity_);
  chip().write(R::xtarget, static_cast<std::int32_t>(position));
  set_mode(Mode::position);
}

// A motor that was rotated or stopped since has no target any more: PyTrinamic's demo for the
// TMCM-1276 moves on from where such a motor stands.
std::int32_t SixPointMotor::relative_origin() const {
  const bool has_target = chip().mode() == Mode::position;
  const bool from_target = has_target && !relative_to_actual_;
  return static_cast<std::int32_t>(chip().read(from_target ? R::xtarget : R::xactual));
}

void SixPointMotor::set_switch_mode(std::int32_t bits, bool on) {
  const auto mode = static_cast<std::int32_t>(chip().read(R::sw_mode));
  chip().write(R::sw_mode, on ? mode | bits : mode & ~bits);
}

std::int64_t SixPointMotor::speed() const {
  constexpr auto unit = sixpoint_velocity_unit;
  return std::abs(chip().motion().velocity) * unit.numerator / unit.denominator;
}

void SixPointMotor::halt() {
  stop();
  chip().halt();
}

std::optional<std::int32_t> SixPointMotor::chip_reading(std::uint8_t address) {
  switch (address) {
    case sixpoint_address::vactual: return static_cast<std::int32_t>(chip().motion().velocity);
    case sixpoint_address::ramp_stat: return to_word(chip().take_events());
    case sixpoint_address::xlatch: return chip().xlatch();
    default: return std::nullopt;
  }
}

}  // namespace tmcl::sim
