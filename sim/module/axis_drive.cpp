// What the driver gives a motor, and whether its rotor follows.
#include <algorithm>
#include <cstdlib>

#include "sim/module/axis.hpp"
#include "tmcl/parameter_number.hpp"

namespace tmcl::sim {
namespace {

namespace ap = axis_parameter;

// Parameters 204 and 214 are counted in these.
constexpr auto delay_unit = std::chrono::milliseconds(10);

// How often is looked at a load or a current that changes by itself: our choice.
constexpr auto model_period = std::chrono::milliseconds(1);
constexpr std::int64_t periods_per_second = 1000;
constexpr std::int64_t fine = 256;

// Of the drivers of these modules, a TMC249 works from 7 V on, a TMC5160 from 8 V, a TMC262 from
// 9 V. One limit for all is our choice.
constexpr std::int32_t least_supply = 70;

// Of the driver's current, and of the scaler that a TMC5160 has on top.
constexpr std::int32_t scales = 32;
constexpr std::int32_t full_scaler = 256;
static_assert(scales * full_scaler == full_current);

// Millivolts over the sense resistors at full current, by VSENSE.
struct FullScale {
  std::int32_t high;
  std::int32_t low;
};
constexpr FullScale of_tmc26x{305, 165};
constexpr FullScale of_tmc5130{320, 180};

// Of the TMC262 and its relatives.
constexpr std::int32_t stall_flag = 1 << 0;
constexpr std::int32_t standstill_flag = 1 << 7;

}  // namespace

// ---- Driver

bool Axis::is_driver_on() const {
  constexpr auto toff = number_of("toff");
  const bool enabled = values_[toff] != 0 || find_parameter(table_, toff) == nullptr;
  return enabled && supply_ >= least_supply && !protection_.is_off();
}

void Axis::watch_driver() {
  const bool against_shorts = values_[number_of("short_protection_disable")] == 0;
  if (supply_ < least_supply)
    protection_.reset();
  else
    protection_.look(coupling_.stage().settings().faults, against_shorts);
  watch_rotor();
}

std::int32_t Axis::driver_flags() const {
  if (motor_->heading() == 0) return protection_.flags() | standstill_flag;
  return protection_.flags() | (load_value() == 0 ? stall_flag : 0);
}

// ---- Rotor

// A motor with an open coil has a torque that points nowhere.
MotorState Axis::motor_state() const {
  const auto& faults = coupling_.stage().settings().faults;
  const bool is_whole =
      !faults.has(DriverFault::open_load_a) && !faults.has(DriverFault::open_load_b);
  return {.speed = coupling_.speed(),
          .acceleration = acceleration_,
          .current = torque_current(),
          .supply = supply_,
          .is_on = is_whole && is_driver_on()};
}

void Axis::watch_rotor() {
  if (model_tick_ == never) {
    speed_at_tick_ = coupling_.fine_speed();
    acceleration_ = 0;
  }
  if (!cools()) cool_step_.reset();
  rotor_.look(coupling_.stage().settings(), motor_state(), is_moving());
  coupling_.let_slip(rotor_.slips());
  model_tick_ = next_model_tick();
}

bool Axis::changes_by_itself() const {
  const bool may_cool = values_[number_of("smart_energy_hysteresis_start")] != 0;
  return may_cool || changes_with_speed(coupling_.stage().settings());
}

TimePoint Axis::next_model_tick() const {
  const bool waits = rotor_.slips() && coupling_.stage().settings().pull_in_speed;
  if (!is_moving() || (!changes_by_itself() && !waits)) return never;
  const auto passed = (now_ - power_on_) / model_period;
  return power_on_ + (passed + 1) * model_period;
}

// Whether the rotor has lost the field, or caught it again.
bool Axis::run_model_tick() {
  const auto speed = coupling_.fine_speed();
  acceleration_ = (speed - std::exchange(speed_at_tick_, speed)) * periods_per_second / fine;
  if (cools()) measure_load();
  const bool slipped = rotor_.slips();
  watch_rotor();
  return rotor_.slips() != slipped;
}

// stallGuard2 reads once in a full step.
void Axis::measure_load() {
  constexpr auto full_step = fine * periods_per_second;
  way_to_reading_ += speed_at_tick_;
  const auto readings = way_to_reading_ / full_step;
  way_to_reading_ %= full_step;
  const auto settings = cool_step_settings();
  for (std::int64_t i = 0; i < readings; ++i) cool_step_.take(load_value(), run_scale(), settings);
}

// ---- Current

Duration Axis::standstill() const { return is_moving() ? Duration::zero() : now_ - rest_; }

bool Axis::is_slow() const {
  // Without a sign, because a velocity that was wrapped may have any bits.
  const auto speed = static_cast<std::uint32_t>(std::abs(get(ap::actual_velocity).value_or(0)));
  return speed < static_cast<std::uint32_t>(values_[number_of("smart_energy_threshold_speed")]);
}

bool Axis::cools() const {
  return values_[number_of("smart_energy_hysteresis_start")] != 0 && is_moving() && !is_slow();
}

CoolStepSettings Axis::cool_step_settings() const {
  return {.minimum = values_[number_of("smart_energy_current_minimum")],
          .down_step = values_[number_of("smart_energy_current_down_step")],
          .hysteresis = values_[number_of("smart_energy_hysteresis")],
          .up_step = values_[number_of("smart_energy_current_up_step")],
          .hysteresis_start = values_[number_of("smart_energy_hysteresis_start")]};
}

std::int32_t Axis::moving_current() const {
  constexpr auto slow_run = number_of("smart_energy_slow_run_current");
  const bool has_slow_run = family_ != Family::sixpoint && find_parameter(table_, slow_run);
  if (has_slow_run && is_slow()) return values_[slow_run];
  const bool accelerates = motor_->accelerates() && values_[number_of("boost_current")] != 0;
  return values_[accelerates ? number_of("boost_current") : number_of("max_current")];
}

std::int32_t Axis::resting_current() const {
  const auto delay = [this](std::uint8_t parameter) { return values_[parameter] * delay_unit; };
  const auto stands = standstill();
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
}

// Models count currents in different units.
std::int32_t Axis::run_scale() const {
  const auto current = is_moving() ? moving_current() : resting_current();
  const auto greatest = find_parameter(table_, number_of("max_current"))->maximum;
  return current * scales / (greatest + 1);
}

// In steps of the driver, 0..31.
std::int32_t Axis::current_scale() const {
  return cool_step_.scale(run_scale(), cool_step_settings());
}

// A scale of 0 is the first of 32. A TMC5160 has another one for all of them.
std::int32_t Axis::torque_current() const {
  constexpr auto scaler = number_of("global_current_scaler");
  constexpr std::int32_t least = 32;
  const bool has_scaler = family_ == Family::sixpoint && values_[scaler] != 0;
  const auto factor = has_scaler ? std::max(values_[scaler], least) : full_scaler;
  const auto current = (current_scale() + 1) * factor;
  if (values_[number_of("vsense")] == 0) return current;
  const auto& full_scale = family_ == Family::sixpoint ? of_tmc5130 : of_tmc26x;
  return current * full_scale.low / full_scale.high;
}

}  // namespace tmcl::sim
