#include "sim/module/tmc4361_motor.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <limits>

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

namespace address {
constexpr std::uint8_t reference_conf = 0x01;
constexpr std::uint8_t rampmode = 0x20;
constexpr std::uint8_t xactual = 0x21;
constexpr std::uint8_t vactual = 0x22;
constexpr std::uint8_t aactual = 0x23;
constexpr std::uint8_t vmax = 0x24;
constexpr std::uint8_t x_latch = 0x36;
constexpr std::uint8_t x_target = 0x37;
}  // namespace address

using Setting = Tmc4361Motor::Setting;

constexpr int velocity_bits = 31;
constexpr int acceleration_bits = 24;
constexpr int bow_bits = 24;

constexpr auto setting_registers = std::to_array<Setting>({
    {0x25, number_of(Family::tmc4361, "start_velocity"), 256, velocity_bits},
    {0x26, number_of("stop_velocity"), 256, velocity_bits},
    {0x27, number_of("break_velocity"), 256, velocity_bits},
    {0x28, ap::max_acceleration, 4, acceleration_bits},
    {0x29, number_of("max_deceleration"), 4, acceleration_bits},
    {0x2A, number_of("start_acceleration"), 4, acceleration_bits},
    {0x2B, number_of("final_deceleration"), 4, acceleration_bits},
    {0x2C, stop_deceleration, 4, acceleration_bits},
    {0x2D, number_of("bow1"), 1, bow_bits},
    {0x2E, number_of("bow2"), 1, bow_bits},
    {0x2F, number_of("bow3"), 1, bow_bits},
    {0x30, number_of("bow4"), 1, bow_bits},
});

const Setting* setting_at(std::uint8_t address) {
  const auto found = std::ranges::find(setting_registers, address, &Setting::address);
  return found == setting_registers.end() ? nullptr : &*found;
}

const Setting* setting_of(std::uint8_t parameter) {
  const auto found = std::ranges::find(setting_registers, parameter, &Setting::parameter);
  return found == setting_registers.end() ? nullptr : &*found;
}

// RAMPMODE: the profile, and whether there is a target.
constexpr std::int32_t trapezoids = 1;
constexpr std::int32_t s_curves = 2;
constexpr std::int32_t of_profile = 3;
constexpr std::int32_t to_target = 4;

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

StandInMotor::Stops BowMotor::stops() const {
  const auto has = [this](Register name) { return chip().read(name) == 1; };
  return {has(R::stop_left_en), has(R::stop_right_en), has(R::soft_stop_en)};
}

void BowMotor::drive(bool to_target, std::int32_t vmax) {
  chip().write(R::vmax, vmax);
  chip().write(to_target ? Mode::position : Mode::velocity);
}

void BowMotor::place(std::int32_t position, std::int32_t target) {
  stop();
  chip().write(R::xactual, position);
  chip().write(R::xtarget, target);
  if (position == target) move_to(target);
}

// ---- Both

Tmc4361Motor::Tmc4361Motor(const Model& model, TimePoint power_on)
    : model_(model), trapezoid_(model, power_on), bows_(power_on), now_(power_on) {}

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
  if (row.number == ramp_type) return wants_bows_ ? 1 : 0;
  const auto* setting = setting_of(row.number);
  const auto kept = setting == nullptr ? settings_.end() : settings_.find(setting->address);
  if (kept != settings_.end()) return kept->second / setting->parts;
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
  if (const auto* setting = setting_of(row.number))
    settings_[setting->address] = value * setting->parts;
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

// ---- Registers

std::int32_t Tmc4361Motor::read_chip(std::uint8_t address) {
  switch (address) {
    case address::rampmode:
      return (has_bows_ ? s_curves : trapezoids) | (drive().to_target ? to_target : 0);
    case address::xactual: return position();
    case address::vactual: return active().read(row_of(ap::actual_velocity)).value_or(0);
    case address::vmax: return drive().vmax;
    case address::x_latch: return latched_;
    case address::x_target: return has_bows_ ? bows_.target() : trapezoid_.target();
    default: break;
  }
  if (const auto kept = settings_.find(address); kept != settings_.end()) return kept->second;
  return bows_.read_chip(address);
}

Status Tmc4361Motor::write_chip(std::uint8_t address, std::int32_t value) {
  switch (address) {
    case address::vactual:
    case address::aactual:
    case address::x_latch: return Status::ok;
    case address::rampmode: return set_mode(value);
    case address::xactual: return active().write(row_of(ap::actual_position), value);
    case address::x_target: return set_target(value);
    case address::vmax:
      if (value == std::numeric_limits<std::int32_t>::min()) return Status::invalid_value;
      set({drive().to_target, value});
      return Status::ok;
    default: break;
  }
  if (const auto* setting = setting_at(address)) set(*setting, value);
  const auto status = bows_.write_chip(address, value);
  if (address == address::reference_conf) trapezoid_.enable_stops(bows_.stops());
  return status;
}

// Whole units; the S-curve has the fractions in its own register.
void Tmc4361Motor::set(const Setting& setting, std::int32_t value) {
  const auto mask = static_cast<std::int32_t>((std::uint32_t{1} << setting.bits) - 1);
  const auto& row = row_of(setting.parameter);
  const auto kept = settings_[setting.address] = value & mask;
  trapezoid_.write(row, kept / setting.parts);
  bows_.write(row, kept / setting.parts);
}

Status Tmc4361Motor::set_target(std::int32_t position) {
  const auto driven = drive();
  const bool had_bows = has_bows_;
  take_profile();
  if (had_bows != has_bows_) set(driven);
  return active().write(row_of(ap::target_position), position);
}

Status Tmc4361Motor::set_mode(std::int32_t mode) {
  const auto profile = mode & of_profile;
  if (profile != trapezoids && profile != s_curves) return Status::invalid_value;
  const auto vmax = drive().vmax;
  wants_bows_ = profile == s_curves;
  take_profile();
  set({(mode & to_target) != 0, vmax});
  return Status::ok;
}

Tmc4361Motor::Drive Tmc4361Motor::drive() const {
  if (has_bows_) return {bows_.drives_to_target(), bows_.vmax()};
  const auto driven = trapezoid_.drive();
  return {driven.to_target, static_cast<std::int32_t>(driven.velocity * velocity_unit.denominator)};
}

void Tmc4361Motor::set(Drive drive) {
  if (has_bows_) {
    bows_.drive(drive.to_target, drive.vmax);
  } else {
    trapezoid_.drive({drive.to_target, drive.vmax / velocity_unit.denominator});
  }
}

const ParameterInfo& Tmc4361Motor::row_of(std::uint8_t number) const {
  return *find_parameter(axis_parameters(model_), number);
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
