#include "sim/module/axis.hpp"

namespace tmcl::sim {
namespace {

namespace ap = axis_parameter;

bool in_range(const ParameterInfo& row, std::int32_t value) {
  return value >= row.minimum && value <= row.maximum;
}

}  // namespace

Axis::Axis(const Model& model, TimePoint power_on)
    : table_(axis_parameters(model)), motor_(make_motor(model.family, power_on)), now_(power_on) {
  // The chip itself starts with zeros; the firmware writes what it has stored.
  for (const auto& row : table_) {
    values_[row.number] = row.initial;
    if (row.stored) motor_->write(row, row.initial);
  }
  look_ahead();
}

tl::expected<std::int32_t, Status> Axis::get(std::uint8_t number) const {
  const auto* row = find_parameter(table_, number);
  if (row == nullptr) return tl::unexpected(Status::wrong_type);
  return motor_->read(*row).value_or(values_[number]);
}

Status Axis::set(std::uint8_t number, std::int32_t value) {
  const auto* row = find_parameter(table_, number);
  if (row == nullptr || row->access == Access::read) return Status::wrong_type;
  if (row->scale == Scale::fixed && !in_range(*row, value)) return Status::invalid_value;
  const auto status = motor_->write(*row, value);
  if (status != Status::ok) return status;
  values_[number] = value;
  look_ahead();
  return status;
}

Status Axis::rotate(std::int64_t velocity) {
  const auto status = motor_->rotate(velocity);
  look_ahead();
  return status;
}

void Axis::stop() {
  motor_->stop();
  look_ahead();
}

Status Axis::move_to(std::int32_t position) {
  if (!is_position(position)) return Status::invalid_value;
  move(position);
  return Status::ok;
}

Status Axis::move_by(std::int32_t distance) {
  if (!is_position(distance)) return Status::invalid_value;
  move(std::int64_t{motor_->relative_origin()} + distance);
  return Status::ok;
}

bool Axis::is_position(std::int32_t value) const {
  return in_range(*find_parameter(table_, ap::target_position), value);
}

void Axis::move(std::int64_t position) {
  motor_->move_to(position);
  look_ahead();
}

void Axis::advance_to(TimePoint time) {
  now_ = time;
  motor_->advance_to(now_);
}

void Axis::run_due() {
  if (now_ >= outlook_.look_again) look_ahead();
}

}  // namespace tmcl::sim
