// What the driver gives a motor, and whether its rotor follows.
#include <algorithm>
#include <cstdlib>
#include <random>

#include "sim/module/axis_driver.hpp"
#include "tmcl/parameter_number.hpp"

namespace tmcl::sim {
namespace {

// Parameters 204 and 214 are counted in these.
constexpr auto delay_unit = std::chrono::milliseconds(10);

// How often is looked at a load or a current that changes by itself: our choice.
constexpr auto model_period = std::chrono::milliseconds(1);
constexpr std::int64_t periods_per_second = 1000;
constexpr std::int64_t fine = 256;

// So far a pull takes a rotor that slips in that time: 125 full steps a second, our choice.
constexpr Place slide = 32;

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

// The control loop of the vendor's open firmware runs so often; it looks for a stall.
constexpr auto control_period = std::chrono::milliseconds(10);

// How a load shows: stallGuard2 reads 500 without one, and 0 from half of what the motor can drive;
// a threshold makes it less sensitive.
constexpr std::int64_t free_reading = 500;
constexpr std::int64_t reading_per_threshold = 8;
constexpr std::int64_t greatest_reading = 1023;

}  // namespace

// ---- Driver

bool AxisDriver::is_on() const {
  constexpr auto toff = number_of("toff");
  const bool enabled = axis_.values[toff] != 0 || find_parameter(axis_.table, toff) == nullptr;
  return enabled && supply_ >= least_supply && !protection_.is_off();
}

void AxisDriver::look() {
  const bool against_shorts = axis_.values[number_of("short_protection_disable")] == 0;
  if (supply_ < least_supply)
    protection_.reset();
  else
    protection_.look(axis_.coupling.stage().settings().faults, against_shorts);
  watch_rotor();
}

std::int32_t AxisDriver::flags() const {
  if (axis_.motor->heading() == 0) return protection_.flags() | standstill_flag;
  return protection_.flags() | (load_value() == 0 ? stall_flag : 0);
}

// ---- Rotor

// A motor with an open coil has a torque that points nowhere.
MotorState AxisDriver::motor_state() const {
  const auto& faults = axis_.coupling.stage().settings().faults;
  const bool is_whole =
      !faults.has(DriverFault::open_load_a) && !faults.has(DriverFault::open_load_b);
  return {.speed = axis_.coupling.speed(),
          .direction = axis_.coupling.direction(),
          .acceleration = acceleration_,
          .current = torque_current(),
          .supply = supply_,
          .is_on = is_whole && is_on()};
}

void AxisDriver::watch_rotor() {
  if (tick_ == never) {
    speed_at_tick_ = axis_.coupling.fine_speed();
    acceleration_ = 0;
  }
  if (!cools()) cool_step_.reset();
  rotor_.look(axis_.coupling.stage().settings(), motor_state(), axis_.is_moving());
  axis_.coupling.let_slip(rotor_.slips());
  tick_ = next_tick();
}

bool AxisDriver::changes_by_itself() const {
  const bool may_cool = axis_.values[number_of("smart_energy_hysteresis_start")] != 0;
  const auto& stage = axis_.coupling.stage().settings();
  return may_cool || stage.load_value_noise != 0 || changes_with_speed(stage);
}

TimePoint AxisDriver::next_tick() const {
  const auto& stage = axis_.coupling.stage().settings();
  const bool waits = rotor_.slips() && stage.pull_in_speed;
  const bool may_go = axis_.is_moving() || stage.pull != 0;
  if (!may_go || (!changes_by_itself() && !waits)) return never;
  const auto passed = (axis_.now - axis_.power_on) / model_period;
  return axis_.power_on + (passed + 1) * model_period;
}

// Whether the rotor has lost the field, or caught it again, or was taken along.
bool AxisDriver::run_tick() {
  const auto& stage = axis_.coupling.stage().settings();
  const auto speed = axis_.coupling.fine_speed();
  acceleration_ = (speed - std::exchange(speed_at_tick_, speed)) * periods_per_second / fine;
  if (cools()) measure_load();
  const bool slipped = rotor_.slips();
  const bool slides = slipped && torque_demanded_at_rest(stage) != 0;
  if (slides) axis_.coupling.slide(stage.pull > 0 ? -slide : slide);
  watch_rotor();
  return slides || rotor_.slips() != slipped;
}

// stallGuard2 reads once in a full step.
void AxisDriver::measure_load() {
  constexpr auto full_step = fine * periods_per_second;
  way_to_reading_ += speed_at_tick_;
  const auto readings = way_to_reading_ / full_step;
  way_to_reading_ %= full_step;
  const auto settings = cool_step_settings();
  for (std::int64_t i = 0; i < readings; ++i) cool_step_.take(load_value(), run_scale(), settings);
}

// ---- Current

Duration AxisDriver::standstill() const {
  return axis_.is_moving() ? Duration::zero() : axis_.now - axis_.rest;
}

bool AxisDriver::is_slow() const {
  return axis_.speed() <
         static_cast<std::uint32_t>(axis_.values[number_of("smart_energy_threshold_speed")]);
}

bool AxisDriver::cools() const {
  return axis_.values[number_of("smart_energy_hysteresis_start")] != 0 && axis_.is_moving() &&
         !is_slow();
}

CoolStepSettings AxisDriver::cool_step_settings() const {
  return {.minimum = axis_.values[number_of("smart_energy_current_minimum")],
          .down_step = axis_.values[number_of("smart_energy_current_down_step")],
          .hysteresis = axis_.values[number_of("smart_energy_hysteresis")],
          .up_step = axis_.values[number_of("smart_energy_current_up_step")],
          .hysteresis_start = axis_.values[number_of("smart_energy_hysteresis_start")]};
}

std::int32_t AxisDriver::moving_current() const {
  constexpr auto slow_run = number_of("smart_energy_slow_run_current");
  const bool has_slow_run =
      axis_.family != Family::sixpoint && find_parameter(axis_.table, slow_run);
  if (has_slow_run && is_slow()) return axis_.values[slow_run];
  const bool accelerates =
      axis_.motor->accelerates() && axis_.values[number_of("boost_current")] != 0;
  return axis_.values[accelerates ? number_of("boost_current") : number_of("max_current")];
}

std::int32_t AxisDriver::resting_current() const {
  const auto delay = [this](std::uint8_t parameter) {
    return axis_.values[parameter] * delay_unit;
  };
  const auto stands = standstill();
  const bool at_end = axis_.switches.left || axis_.switches.right;
  // These numbers are something else on other families.
  const bool powers_down =
      axis_.family == Family::tmc429 && axis_.values[number_of("end_switch_power_down")] == 1;
  if (at_end && powers_down) return 0;
  const bool has_delay = axis_.family == Family::tmc429 || axis_.family == Family::firmware;
  const bool freewheels = has_delay && axis_.values[number_of("freewheeling_delay")] != 0;
  if (freewheels && stands >= delay(number_of("freewheeling_delay"))) return 0;
  const bool down = stands >= delay(number_of("power_down_delay"));
  return axis_.values[down ? number_of("standby_current") : number_of("max_current")];
}

// Models count currents in different units.
std::int32_t AxisDriver::run_scale() const {
  const auto current = axis_.is_moving() ? moving_current() : resting_current();
  const auto greatest = find_parameter(axis_.table, number_of("max_current"))->maximum;
  return current * scales / (greatest + 1);
}

// In steps of the driver, 0..31.
std::int32_t AxisDriver::current_scale() const {
  return cool_step_.scale(run_scale(), cool_step_settings());
}

// A scale of 0 is the first of 32. A TMC5160 has another one for all of them.
std::int32_t AxisDriver::torque_current() const {
  constexpr auto scaler = number_of("global_current_scaler");
  constexpr std::int32_t least = 32;
  const bool has_scaler = axis_.family == Family::sixpoint && axis_.values[scaler] != 0;
  const auto factor = has_scaler ? std::max(axis_.values[scaler], least) : full_scaler;
  const auto current = (current_scale() + 1) * factor;
  if (axis_.values[number_of("vsense")] == 0) return current;
  const auto& full_scale = axis_.family == Family::sixpoint ? of_tmc5130 : of_tmc26x;
  return current * full_scale.low / full_scale.high;
}

// ---- Load

std::int32_t AxisDriver::load_value() const {
  if (axis_.motor->heading() == 0 || axis_.coupling.is_held()) return 0;
  const auto& stage = axis_.coupling.stage().settings();
  const auto threshold = axis_.values[number_of("stallguard2_threshold")];
  const auto fall = stage.load_value_slope * relative_load(stage, motor_state()) / full_torque;
  const auto reading = free_reading + reading_per_threshold * threshold - fall + noise();
  return static_cast<std::int32_t>(std::clamp<std::int64_t>(reading, 0, greatest_reading));
}

// The same for as long as nothing is looked at: it does not matter when it is read.
std::int64_t AxisDriver::noise() const {
  const auto most = axis_.coupling.stage().settings().load_value_noise;
  if (most == 0) return 0;
  const auto period = (axis_.now - axis_.power_on) / model_period;
  std::minstd_rand random(static_cast<std::uint32_t>(period + 1));
  // Its first numbers are like the seed.
  random.discard(7);
  return std::uniform_int_distribution(-most, most)(random);
}

// Older drivers have eight of them.
std::int32_t AxisDriver::scaled_load_value(const ParameterInfo& row) const {
  return load_value() * row.maximum / static_cast<std::int32_t>(greatest_reading);
}

// Only then is it worth looking.
bool AxisDriver::may_stall() const {
  if (axis_.values[number_of("smart_energy_stall_velocity")] == 0 || !axis_.is_moving())
    return false;
  return axis_.motor->heading() == 0 || changes_by_itself() || load_value() == 0;
}

TimePoint AxisDriver::next_stall_check() const {
  if (!may_stall()) return never;
  const auto passed = (axis_.now - axis_.power_on) / control_period;
  return axis_.power_on + (passed + 1) * control_period;
}

bool AxisDriver::stalls() const {
  if (!may_stall() || load_value() != 0) return false;
  if ((axis_.now - axis_.power_on) % control_period != Duration::zero()) return false;
  const auto least =
      static_cast<std::uint32_t>(axis_.values[number_of("smart_energy_stall_velocity")]);
  return axis_.motor->heading() != 0 && axis_.speed() > least;
}

}  // namespace tmcl::sim
