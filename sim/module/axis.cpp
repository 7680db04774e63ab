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

constexpr std::uint8_t exponent(std::int32_t value) { return static_cast<std::uint8_t>(value); }

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

// Parameters that are registers of the chip; all others are only kept.
void Axis::write(std::uint8_t number, std::int32_t value) {
  switch (number) {
    case ap::target_position: return chip_.set_x_target(value);
    case ap::actual_position: return chip_.set_x_actual(value);
    case ap::target_velocity: return chip_.set_v_target(value);
    case ap::max_velocity: return chip_.set_v_max(value);
    case ap::max_acceleration: return chip_.set_a_max(value);
    case min_velocity: return chip_.set_v_min(value);
    case ramp_mode: return set_ramp_mode(static_cast<ramp::Mode>(value));
    case ramp_divisor:
    case pulse_divisor:
      return chip_.set_dividers(
          {exponent(values_[pulse_divisor]), exponent(values_[ramp_divisor])});
    default: return;
  }
}

void Axis::set_ramp_mode(ramp::Mode mode) {
  if (mode != ramp::Mode::velocity) chip_.set_v_max(values_[ap::max_velocity]);
  chip_.set_mode(mode);
}

void Axis::rotate(std::int32_t velocity) {
  chip_.set_mode(ramp::Mode::velocity);
  chip_.set_v_max(greatest_velocity);
  chip_.set_v_target(velocity);
}

void Axis::stop() {
  chip_.set_mode(ramp::Mode::velocity);
  chip_.set_v_target(0);
}

void Axis::move_to(std::int32_t position) {
  chip_.set_x_target(position);
  set_ramp_mode(ramp::Mode::ramp);
}

}  // namespace tmcl::sim
