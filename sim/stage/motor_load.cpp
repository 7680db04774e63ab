#include "sim/stage/motor_load.hpp"

#include <algorithm>
#include <cstdlib>

namespace tmcl::sim {
namespace {

bool can_start_at(const StageSettings& stage, std::int64_t speed) {
  return !stage.pull_in_speed || speed <= *stage.pull_in_speed;
}

}  // namespace

std::int64_t torque_demanded(const StageSettings& stage, const MotorState& motor) {
  const auto drag = stage.load + stage.load_per_velocity * motor.speed / 1000;
  const auto pull = motor.direction * stage.pull;
  return std::abs(drag + pull + stage.inertia * motor.acceleration / 1'000'000);
}

std::int64_t torque_demanded_at_rest(const StageSettings& stage) {
  return std::max(std::abs(stage.pull) - stage.load, 0);
}

std::int64_t torque_available(const StageSettings& stage, const MotorState& motor) {
  if (!motor.is_on) return 0;
  const auto by_current =
      stage.torque_follows_current ? full_torque * motor.current / full_current : full_torque;
  if (!stage.corner_speed || motor.speed == 0) return by_current;
  const auto by_voltage =
      full_torque * *stage.corner_speed * motor.supply / (nominal_supply * motor.speed);
  return std::min(by_current, by_voltage);
}

std::int64_t relative_load(const StageSettings& stage, const MotorState& motor) {
  const auto available = torque_available(stage, motor);
  const auto demanded = torque_demanded(stage, motor);
  if (available == 0) return std::max(demanded, 2 * full_torque);
  return full_torque * demanded / available;
}

bool changes_with_speed(const StageSettings& stage) {
  return stage.load_per_velocity != 0 || stage.inertia != 0 || stage.pull != 0 ||
         stage.corner_speed || stage.torque_follows_current;
}

void Rotor::look(const StageSettings& stage, const MotorState& motor, bool driven) {
  const auto available = torque_available(stage, motor);
  const auto demanded = driven ? torque_demanded(stage, motor) : torque_demanded_at_rest(stage);
  const bool keeps_up = available > demanded;
  const bool was_lost = slips_;
  slips_ = !keeps_up || (was_lost && driven && !can_start_at(stage, motor.speed));
}

}  // namespace tmcl::sim
