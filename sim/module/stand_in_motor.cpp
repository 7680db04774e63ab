#include "sim/module/stand_in_motor.hpp"

#include <algorithm>
#include <array>

#include "tmcl/parameter_number.hpp"

namespace tmcl::sim {
namespace {

namespace ap = axis_parameter;
using R = ramp::SixPoint::Register;

constexpr auto relative_positioning_option = number_of("relative_positioning_option");
constexpr auto swap_switches = number_of(Family::tmc4361, "swap_limit_switches");
constexpr auto soft_stop = number_of(Family::tmc4361, "soft_stop");
constexpr auto latched_position = number_of("latched_actual_position");
constexpr std::int64_t least_stop_velocity = 10;  // below that the chip may miss its target

}  // namespace

StandInMotor::StandInMotor(const Model& model, TimePoint power_on)
    : SixPointMotor(power_on),
      family_(model.family),
      greatest_velocity_(find_parameter(axis_parameters(model), ap::max_velocity)->maximum) {
  chip().write(R::vstop, least_stop_velocity);
}

// Below the break velocity a TMC4361 has a start acceleration and a final deceleration, as the
// sixPoint chip has A1 and D1 below V1.
std::span<const StandInMotor::Edge> StandInMotor::edges(Family family) {
  static constexpr std::array<Edge, 7> tmc4361{{
      {ap::max_acceleration, R::amax},
      {number_of(Family::tmc4361, "start_velocity"), R::vstart},
      {number_of("start_acceleration"), R::a1},
      {number_of("max_deceleration"), R::dmax},
      {number_of("break_velocity"), R::v1},
      {number_of("final_deceleration"), R::d1},
      {number_of("stop_velocity"), R::vstop},
  }};
  static constexpr std::array<Edge, 1> firmware{{{ap::max_acceleration, R::amax}}};
  if (family == Family::firmware) return firmware;
  return tmc4361;
}

std::optional<std::int32_t> StandInMotor::read(const ParameterInfo& row) const {
  switch (row.number) {
    case ap::target_position:
    case ap::actual_position:
    case ap::target_velocity:
    case ap::actual_velocity:
    case ap::position_reached: return SixPointMotor::read(row);
    case latched_position:
      return family_ == Family::tmc4361 ? SixPointMotor::read(row) : std::nullopt;
    default: return std::nullopt;
  }
}

Status StandInMotor::write(const ParameterInfo& row, std::int32_t value) {
  if (!units().accepts(row, value)) return Status::invalid_value;
  switch (row.number) {
    case ap::target_position:
    case ap::actual_position:
    case ap::target_velocity:
    case number_of("right_limit_switch_disable"):
    case number_of("left_limit_switch_disable"):
    case relative_positioning_option: return SixPointMotor::write(row, value);
    case ap::max_velocity: {
      const auto fitting = within(R::vmax, row.scale, value);
      return SixPointMotor::write(row, static_cast<std::int32_t>(fitting));
    }
    default: break;
  }
  if (family_ == Family::tmc4361) wire_switches(row.number, value == 1);
  set_edge(row, value);
  return Status::ok;
}

void StandInMotor::wire_switches(std::uint8_t number, bool on) {
  if (number == swap_switches) wiring_to_set().swapped = on;
  if (number == soft_stop) set_switch_mode(ramp::SixPoint::en_softstop, on);
}

Status StandInMotor::rotate(std::int64_t velocity) {
  if (velocity < -greatest_velocity_ || velocity > greatest_velocity_) return Status::invalid_value;
  const auto most = within(R::vmax, Scale::velocity, greatest_velocity_);
  return SixPointMotor::rotate(std::clamp(velocity, -most, most));
}

void StandInMotor::place(std::int32_t position, std::int32_t target) {
  stop();
  chip().write(R::xactual, position);
  chip().write(R::xtarget, target);
  if (position == target) move_to(target);
}

StandInMotor::Stops StandInMotor::stops() const {
  const auto mode = static_cast<std::int32_t>(chip().read(R::sw_mode));
  const auto has = [mode](std::int32_t bits) { return (mode & bits) != 0; };
  return {has(ramp::SixPoint::stop_l_enable), has(ramp::SixPoint::stop_r_enable),
          has(ramp::SixPoint::en_softstop)};
}

void StandInMotor::enable_stops(Stops stops) {
  set_switch_mode(ramp::SixPoint::stop_l_enable, stops.left);
  set_switch_mode(ramp::SixPoint::stop_r_enable, stops.right);
  set_switch_mode(ramp::SixPoint::en_softstop, stops.soft);
}

StandInMotor::Drive StandInMotor::drive() const {
  using Mode = ramp::SixPoint::Mode;
  const std::int64_t speed = read_register(R::vmax, Scale::velocity);
  return {chip().mode() == Mode::position,
          chip().mode() == Mode::velocity_negative ? -speed : speed};
}

void StandInMotor::drive(Drive drive) {
  rotate(drive.velocity);
  if (drive.to_target)
    chip().write(R::rampmode, static_cast<std::int64_t>(ramp::SixPoint::Mode::position));
}

std::int64_t StandInMotor::within(Register name, Scale scale, std::int64_t value) const {
  return std::min(value, units().greatest(scale, range_of(name)));
}

void StandInMotor::set_edge(const ParameterInfo& row, std::int32_t value) {
  const auto all = edges(family_);
  const auto edge = std::ranges::find(all, row.number, &Edge::number);
  if (edge == all.end()) return;
  const auto fitting = within(edge->name, row.scale, value);
  const auto number = in_register(edge->name, row.scale, fitting).value_or(0);
  if (edge->name == R::a1) start_acceleration_ = number;
  if (edge->name == R::d1) final_deceleration_ = number;
  chip().write(edge->name, edge->name == R::vstop ? std::max(number, least_stop_velocity) : number);
  fill_gaps();
}

void StandInMotor::fill_gaps() {
  if (family_ == Family::firmware) chip().write(R::dmax, chip().read(R::amax));
  if (start_acceleration_ == 0) chip().write(R::a1, chip().read(R::amax));
  if (final_deceleration_ == 0) chip().write(R::d1, chip().read(R::dmax));
}

}  // namespace tmcl::sim
