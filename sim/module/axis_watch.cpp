// What the module watches while a motor turns: its encoders and its load.
#include <algorithm>
#include <cstdlib>

#include "sim/module/axis.hpp"
#include "tmcl/parameter_number.hpp"

namespace tmcl::sim {
namespace {

namespace ap = axis_parameter;

// The control loop of the vendor's open firmware runs so often; it looks for a stall.
constexpr auto control_period = std::chrono::milliseconds(10);

// How a load shows: stallGuard2 reads 500 without one, and 0 from half of what the motor can drive;
// a threshold makes it less sensitive.
constexpr std::int64_t free_reading = 500;
constexpr std::int64_t reading_per_threshold = 8;
constexpr std::int64_t greatest_reading = 1023;

}  // namespace

// ---- Encoders

void Axis::scale_encoders() {
  encoder_.set_scale(scale_by(number_of("encoder_resolution")));
  external_encoder_.set_scale(scale_by(number_of("external_encoder_resolution")));
}

// With a prescaler, a count is worth so many 512ths of a microstep (manuals of the TMCM-1161 and
// PD-1160); with a resolution, a turn has so many counts. What was never set fits the encoder.
EncoderScale Axis::scale_by(std::uint8_t parameter) const {
  const auto* row = find_parameter(table_, parameter);
  const auto value = row == nullptr ? 0 : values_[parameter];
  const bool is_prescaler =
      family_ == Family::tmc429 || (row != nullptr && row->name.ends_with("_prescaler"));
  const bool is_resolution = row != nullptr && row->name.ends_with("_resolution");
  if (value != 0 && is_prescaler) return {value, 512};
  if (value != 0 && is_resolution) return {coupling_.microsteps(), value};
  const auto& encoder = coupling_.stage().settings().encoder;
  return {coupling_.microsteps(), encoder ? encoder->counts_per_turn : 1};
}

std::int64_t Axis::deviation(const EncoderWatch& encoder) const {
  const auto counted = static_cast<std::int32_t>(encoder.position(coupling_.stage()));
  return way_between(counted, motor_->position(), motor_->position_bits());
}

void Axis::watch_encoders() {
  const bool deviated =
      std::exchange(deviates_, encoder_.is_exceeded_by(deviation(encoder_)) ||
                                   external_encoder_.is_exceeded_by(deviation(external_encoder_)));
  if (!deviates_ || (deviated && !is_moving())) return;
  emergency_stop(deviation_error);
}

void Axis::emergency_stop(std::int32_t error) {
  errors_ |= error;
  homing_.abort();
  motor_->halt();
  look_ahead();
}

// ---- Load

std::int32_t Axis::load_value() const {
  if (motor_->heading() == 0 || coupling_.is_held()) return 0;
  const auto threshold = values_[number_of("stallguard2_threshold")];
  const auto reading = free_reading + reading_per_threshold * threshold -
                       relative_load(coupling_.stage().settings(), motor_state());
  return static_cast<std::int32_t>(std::clamp<std::int64_t>(reading, 0, greatest_reading));
}

// Older drivers have eight of them.
std::int32_t Axis::scaled_load_value(const ParameterInfo& row) const {
  return load_value() * row.maximum / static_cast<std::int32_t>(greatest_reading);
}

// Only then is it worth looking.
bool Axis::may_stall() const {
  if (values_[number_of("smart_energy_stall_velocity")] == 0 || !is_moving()) return false;
  return motor_->heading() == 0 || changes_by_itself() || load_value() == 0;
}

TimePoint Axis::next_stall_check() const {
  if (!may_stall()) return never;
  const auto passed = (now_ - power_on_) / control_period;
  return power_on_ + (passed + 1) * control_period;
}

void Axis::watch_stall() {
  if (!may_stall() || load_value() != 0) return;
  if ((now_ - power_on_) % control_period != Duration::zero()) return;
  // Without a sign, because a velocity that was wrapped may have any bits.
  const auto speed = static_cast<std::uint32_t>(std::abs(get(ap::actual_velocity).value_or(0)));
  const auto least = static_cast<std::uint32_t>(values_[number_of("smart_energy_stall_velocity")]);
  if (motor_->heading() == 0 || speed <= least) return;
  emergency_stop(stall_error);
}

}  // namespace tmcl::sim
