#include "sim/module/globals.hpp"

#include "tmcl/parameter.hpp"

namespace tmcl::sim {
namespace {

constexpr std::uint8_t tick_timer_number = 132;

}  // namespace

Globals::Globals(ModuleAddress address, const Clock& clock)
    : clock_(&clock), timer_zero_(clock.now()) {
  for (const auto& row : global_parameters()) values_[row.number] = row.initial;
  values_[global_parameter::serial_address] = reply_byte(address);
  values_[global_parameter::can_id] = number(address);
}

std::int32_t Globals::tick_timer() const {
  const auto passed =
      std::chrono::duration_cast<std::chrono::milliseconds>(clock_->now() - timer_zero_).count();
  return static_cast<std::int32_t>(passed & INT32_MAX);
}

tl::expected<std::int32_t, Status> Globals::get(std::uint8_t number) const {
  if (find_parameter(global_parameters(), number) == nullptr) {
    return tl::unexpected(Status::wrong_type);
  }
  return number == tick_timer_number ? tick_timer() : values_[number];
}

Status Globals::set(std::uint8_t number, std::int32_t value) {
  const auto* row = find_parameter(global_parameters(), number);
  if (row == nullptr || row->access == Access::read) return Status::wrong_type;
  if (value < row->minimum || value > row->maximum) return Status::invalid_value;
  if (number == tick_timer_number) timer_zero_ = clock_->now() - std::chrono::milliseconds(value);
  values_[number] = value;
  return Status::ok;
}

}  // namespace tmcl::sim
