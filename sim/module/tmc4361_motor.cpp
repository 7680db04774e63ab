#include "sim/module/tmc4361_motor.hpp"

#include <array>
#include <cstdlib>

#include "tmcl/parameter_number.hpp"

namespace tmcl::sim {
namespace {

namespace ap = axis_parameter;

constexpr auto ramp_type = number_of("ramp_type");
constexpr auto stop_deceleration = number_of(Family::tmc4361, "stop_deceleration");
constexpr auto relative_positioning_option = number_of("relative_positioning_option");
constexpr auto latched_position = number_of("latched_actual_position");

using R = ramp::Tmc4361::Register;
using Mode = ramp::Tmc4361::Mode;

constexpr RegisterUnit velocity_unit{1, 256};
constexpr RegisterUnit acceleration_unit{1, 4};

}  // namespace

// ---- S-shaped ramps

BowMotor::BowMotor(TimePoint power_on)
    : ChipMotor(power_on, mapped(), {velocity_unit, acceleration_unit, true}) {}

std::span<const BowMotor::Mapped> BowMotor::mapped() {
  static constexpr std::array<Mapped, 8> all{{
      {ap::target_position, R::xtarget},
      {ap::actual_position, R::xactual},
      {ap::max_acceleration, R::amax},
      {number_of("max_deceleration"), R::dmax},
      {number_of("bow1"), R::bow1},
      {number_of("bow2"), R::bow2},
      {number_of("bow3"), R::bow3},
      {number_of("bow4"), R::bow4},
  }};
  return all;
}

std::optional<std::int32_t> BowMotor::read(const ParameterInfo& row) const {
  switch (row.number) {
    case ap::target_position:
    case ap::actual_position: return ChipMotor::read(row);
    case ap::target_velocity: return read_register(R::vmax, row.scale);
    case ap::actual_velocity: return units().read(row.scale, chip().motion().velocity);
    case ap::position_reached: return position() == target() ? 1 : 0;
    default: return std::nullopt;
  }
}

Status BowMotor::write(const ParameterInfo& row, std::int32_t value) {
  switch (row.number) {
    case ap::target_velocity: return rotate(value);
    case ap::max_velocity:
      max_velocity_ = units().in_register(row.scale, value);
      if (chip().mode() == Mode::position) chip().write(R::vmax, max_velocity_);
      return Status::ok;
    case stop_deceleration:
      stop_deceleration_ = units().in_register(row.scale, value);
      set_stop_deceleration();
      return Status::ok;
    case relative_positioning_option: relative_to_actual_ = value == 1; return Status::ok;
    default: break;
  }
  const auto status = ChipMotor::write(row, value);
  set_stop_deceleration();
  return status;
}

void BowMotor::set_stop_deceleration() {
  chip().write(R::dstop, stop_deceleration_ != 0 ? stop_deceleration_ : chip().read(R::dmax));
}

void BowMotor::enable_stops(bool left, bool right, bool soft) {
  chip().write(R::stop_left_en, left ? 1 : 0);
  chip().write(R::stop_right_en, right ? 1 : 0);
  chip().write(R::soft_stop_en, soft ? 1 : 0);
}

Status BowMotor::rotate(std::int64_t velocity) {
  const auto status = write_register(R::vmax, Scale::velocity, velocity);
  if (status == Status::ok) chip().write(Mode::velocity);
  return status;
}

void BowMotor::stop() {
  chip().write(R::vmax, 0);
  chip().write(Mode::velocity);
}

void BowMotor::move_to(std::int64_t position) {
  chip().write(R::vmax, max_velocity_);
  chip().write(R::xtarget, static_cast<std::int32_t>(position));
  chip().write(Mode::position);
}

std::int32_t BowMotor::relative_origin() const {
  const bool has_target = chip().mode() == Mode::position;
  return has_target && !relative_to_actual_ ? target() : position();
}

std::int64_t BowMotor::speed() const {
  return std::abs(chip().motion().velocity) * velocity_unit.numerator / velocity_unit.denominator;
}

void BowMotor::place(std::int32_t position, std::int32_t target) {
  stop();
  chip().write(R::xactual, position);
  chip().write(R::xtarget, target);
  if (position == target) move_to(target);
}

// ---- Both

Tmc4361Motor::Tmc4361Motor(const Model& model, TimePoint power_on)
    : trapezoid_(model, power_on), bows_(power_on), now_(power_on) {}

void Tmc4361Motor::advance_to(TimePoint time) {
  now_ = time;
  trapezoid_.advance_to(time);
  bows_.advance_to(time);
}

void Tmc4361Motor::set_switches(bool left, bool right) {
  const bool closes = (left && !left_) || (right && !right_);
  if (closes) latched_ = position();
  left_ = left;
  right_ = right;
  trapezoid_.set_switches(left, right);
  bows_.set_switches(left, right);
}

std::optional<std::int32_t> Tmc4361Motor::read(const ParameterInfo& row) const {
  if (row.number == latched_position) return latched_;
  return active().read(row);
}

Status Tmc4361Motor::write(const ParameterInfo& row, std::int32_t value) {
  switch (row.number) {
    case ap::actual_position: return active().write(row, value);
    case ap::target_position: take_profile(); return active().write(row, value);
    case ap::target_velocity: return rotate(value);
    default: break;
  }
  const auto status = trapezoid_.write(row, value);
  if (status != Status::ok) return status;
  bows_.write(row, value);
  const auto stops = trapezoid_.stops();
  bows_.enable_stops(stops.left, stops.right, stops.soft);
  if (row.number == ramp_type) {
    wants_bows_ = value == 1;
    take_profile();
  }
  return status;
}

Status Tmc4361Motor::rotate(std::int64_t velocity) {
  take_profile();
  return active().rotate(velocity);
}

void Tmc4361Motor::move_to(std::int64_t position) {
  take_profile();
  active().move_to(position);
}

// From one that rests to the other, with its position and its target.
void Tmc4361Motor::take_profile() {
  if (has_bows_ == wants_bows_ || outlook().rest > now_) return;
  if (wants_bows_) {
    bows_.place(trapezoid_.position(), trapezoid_.target());
  } else {
    trapezoid_.place(bows_.position(), bows_.target());
  }
  has_bows_ = wants_bows_;
}

}  // namespace tmcl::sim
