#include "sim/module/axis.hpp"

namespace tmcl::sim {
namespace {

namespace ap = axis_parameter;

constexpr std::uint8_t min_velocity = 130;
constexpr std::uint8_t actual_acceleration = 135;
constexpr std::uint8_t ramp_mode = 138;
constexpr std::uint8_t ramp_divisor = 153;
constexpr std::uint8_t pulse_divisor = 154;
constexpr std::int32_t greatest_velocity = 2047;

using R = ramp::Tmc429::Register;
using Mode = ramp::Tmc429::Mode;

}  // namespace

Axis::Axis(Family family) : table_(axis_parameters(family)) {
  // The chip itself starts with zeros; the firmware writes its defaults.
  for (const auto& row : table_) {
    values_[row.number] = row.initial;
    write(row.number, row.initial);
  }
}

tl::expected<std::int32_t, Status> Axis::get(std::uint8_t number) const {
  if (find_parameter(table_, number) == nullptr) return tl::unexpected(Status::wrong_type);
  switch (number) {
    case ap::target_position: return chip_.x_target();
    case ap::actual_position: return chip_.x_actual();
    case ap::target_velocity: return chip_.v_target();
    case ap::actual_velocity: return chip_.v_actual();
    case ap::position_reached: return chip_.at_target() ? 1 : 0;
    case actual_acceleration: return chip_.a_actual();
    case ramp_mode: return static_cast<std::int32_t>(chip_.mode());
    default: return values_[number];
  }
}

Status Axis::set(std::uint8_t number, std::int32_t value) {
  const auto* row = find_parameter(table_, number);
  if (row == nullptr || row->access == Access::read) return Status::wrong_type;
  if (value < row->minimum || value > row->maximum) return Status::invalid_value;
  values_[number] = value;
  write(number, value);
  return Status::ok;
}

// Parameters that are registers of the chip; all others are only kept. The ranges of the parameters
// are those of the registers.
void Axis::write(std::uint8_t number, std::int32_t value) {
  const auto write = [&](R name) { chip_.write(name, value); };
  switch (number) {
    case ap::target_position: return write(R::x_target);
    case ap::actual_position: return write(R::x_actual);
    case ap::target_velocity: return write(R::v_target);
    case ap::max_velocity: return write(R::v_max);
    case ap::max_acceleration: return write(R::a_max);
    case min_velocity: return write(R::v_min);
    case ramp_mode: return set_ramp_mode(static_cast<Mode>(value));
    case ramp_divisor: return write(R::ramp_div);
    case pulse_divisor: return write(R::pulse_div);
    default: return;
  }
}

void Axis::set_ramp_mode(Mode mode) {
  if (mode != Mode::velocity) chip_.write(R::v_max, values_[ap::max_velocity]);
  chip_.write(mode);
}

void Axis::rotate(std::int32_t velocity) {
  chip_.write(Mode::velocity);
  chip_.write(R::v_max, greatest_velocity);
  chip_.write(R::v_target, velocity);
}

void Axis::stop() {
  chip_.write(Mode::velocity);
  chip_.write(R::v_target, 0);
}

void Axis::move_to(std::int64_t position) {
  constexpr std::int64_t turn = 1 << 24;
  chip_.write(R::x_target, ((position + turn / 2) & (turn - 1)) - turn / 2);
  set_ramp_mode(Mode::ramp);
}

}  // namespace tmcl::sim
