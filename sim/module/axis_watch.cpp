// What the module watches while a motor turns: its encoders, its load and its current.
#include <algorithm>
#include <cstdlib>

#include "sim/module/axis.hpp"
#include "tmcl/parameter_number.hpp"

namespace tmcl::sim {
namespace {

namespace ap = axis_parameter;

// The control loop of the vendor's open firmware runs so often; it looks for a stall.
constexpr auto control_period = std::chrono::milliseconds(10);
// Parameters 204 and 214 are counted in these.
constexpr auto delay_unit = std::chrono::milliseconds(10);

// How a load shows: stallGuard2 reads 500 without one, and 0 from half of what the motor can drive;
// a threshold makes it less sensitive.
constexpr std::int64_t free_reading = 500;
constexpr std::int64_t reading_per_threshold = 8;
constexpr std::int64_t greatest_reading = 1023;

// Of the TMC262 and its relatives.
constexpr std::int32_t stall_flag = 1 << 0;
constexpr std::int32_t standstill_flag = 1 << 7;

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
                       coupling_.stage().load_at(coupling_.speed());
  return static_cast<std::int32_t>(std::clamp<std::int64_t>(reading, 0, greatest_reading));
}

// Older drivers have eight of them.
std::int32_t Axis::scaled_load_value(const ParameterInfo& row) const {
  return load_value() * row.maximum / static_cast<std::int32_t>(greatest_reading);
}

// Only then is it worth looking.
bool Axis::may_stall() const {
  if (values_[number_of("smart_energy_stall_velocity")] == 0 || !is_moving()) return false;
  const bool changes_with_speed = coupling_.stage().settings().load_per_velocity != 0;
  return motor_->heading() == 0 || changes_with_speed || load_value() == 0;
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

// ---- Current

Duration Axis::standstill() const { return is_moving() ? Duration::zero() : now_ - rest_; }

std::int32_t Axis::driver_flags() const {
  if (motor_->heading() == 0) return standstill_flag;
  return load_value() == 0 ? stall_flag : 0;
}

// In steps of the driver, 0..31; models count currents in different units.
std::int32_t Axis::current_scale() const {
  constexpr std::int32_t steps = 32;
  const auto current = [this] {
    const auto delay = [this](std::uint8_t parameter) { return values_[parameter] * delay_unit; };
    const auto stands = standstill();
    if (is_moving()) {
      const bool accelerates = motor_->accelerates() && values_[number_of("boost_current")] != 0;
      return values_[accelerates ? number_of("boost_current") : number_of("max_current")];
    }
    const bool at_end = switches_.left || switches_.right;
    // These numbers are something else on other families.
    const bool powers_down =
        family_ == Family::tmc429 && values_[number_of("end_switch_power_down")] == 1;
    if (at_end && powers_down) return 0;
    const bool has_delay = family_ == Family::tmc429 || family_ == Family::firmware;
    const bool freewheels = has_delay && values_[number_of("freewheeling_delay")] != 0;
    if (freewheels && stands >= delay(number_of("freewheeling_delay"))) return 0;
    const bool down = stands >= delay(number_of("power_down_delay"));
    return values_[down ? number_of("standby_current") : number_of("max_current")];
  };
  const auto greatest = find_parameter(table_, number_of("max_current"))->maximum;
  return current() * steps / (greatest + 1);
}

}  // namespace tmcl::sim
