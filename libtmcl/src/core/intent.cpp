#include "tmcl/intent.hpp"

#include <algorithm>
#include <utility>

#include "tmcl/address.hpp"
#include "tmcl/command_type.hpp"
#include "tmcl/mechanics.hpp"
#include "tmcl/model.hpp"

namespace tmcl {
namespace {

constexpr std::uint8_t all_motors = 255;

bool has_mask(const Request& request) {
  return (request.motor & (motor_mask::each_for_itself | motor_mask::interpolated)) != 0;
}

/// A parameter that is the ramp mode of another family is none here.
bool is_mode_of_other(const Request& request, const Model* model) {
  if (model == nullptr) return false;
  const auto mode = mode_parameter(axis_parameters(*model));
  return !mode || mode->number != request.type;
}

/// Of SAP. A zero sets nothing turning; nor does it surely end that, for the motor may be in a mode
/// that keeps its speed.
Intent of_parameter(const Request& request, const Model* model) {
  auto it = intent_of(Command::SAP, request.type);
  if (it.sets == Setpoint::mode && is_mode_of_other(request, model)) it.sets = Setpoint::none;
  if (it.motion == Motion::turns && request.value == 0) it.motion = Motion::unchanged;
  return it;
}

/// Of RSAP and AAP: whatever the parameter may be set to.
Intent of_unseen_parameter(const Request& request, const Model* model) {
  auto it = intent_of(request.command, request.type);
  auto some_value = request;
  some_value.value = 1;
  const auto seen = of_parameter(some_value, model);
  it.motion = seen.motion;
  it.sets = seen.sets;
  return it;
}

}  // namespace

Intent intent_of(const Request& request, const Model* model) {
  auto it = intent_of(request.command, request.type);
  if (it.subject == Subject::several && !has_mask(request)) it.subject = Subject::motor;
  switch (request.command) {
    case Command::ROR:
    case Command::ROL:
      if (request.value == 0) it.motion = Motion::stops;
      return it;
    case Command::SAP: return of_parameter(request, model);
    case Command::RSAP:
    case Command::AAP: return of_unseen_parameter(request, model);
    case Command::GCO: it.changes_coordinates = request.motor == all_motors; return it;
    default: return it;
  }
}

bool can_move(const Request& request) {
  return intent_of(request.command, request.type).effect == Effect::moves;
}

namespace {

bool is_in_mask(const Request& request, std::uint8_t motor) {
  return motor < motor_mask::motors && (request.motor >> motor & 1) != 0;
}

}  // namespace

bool can_move(const Request& request, AxisAddress motor) {
  const auto it = intent_of(request);
  if (it.effect != Effect::moves || request.address != motor.module) return false;
  switch (it.subject) {
    case Subject::motor: return request.motor == motor.motor;
    case Subject::several: return is_in_mask(request, motor.motor);
    default: return true;
  }
}

bool starts_search(const Request& request) {
  return intent_of(request.command, request.type).motion == Motion::searches;
}

std::set<AxisAddress> motors_of(const Request& request) {
  switch (intent_of(request).subject) {
    case Subject::chip:
    case Subject::module: return {{request.address, 0}};
    case Subject::several: break;
    default: return {{request.address, request.motor}};
  }
  std::set<AxisAddress> motors;
  for (std::uint8_t motor = 0; motor < motor_mask::motors; ++motor)
    if (is_in_mask(request, motor)) motors.insert({request.address, motor});
  return motors;
}

// ---- registers ---------------------------------------------------------------------------------

namespace {

struct MotorRange {
  std::size_t first = 0;
  std::size_t end = 0;
  bool has(std::size_t motor) const { return motor >= first && motor < end; }
};

/// Of a model: a TMC429 leads three motors, and the address of a register says which. A driver has
/// one, and a module with one motor counts that as 1 where it is the driver's.
MotorRange motors_of_chip(const Request& request, const Model& model) {
  constexpr std::size_t motors_of_tmc429 = 3;
  const bool is_driver = request.command == Command::WRITE_DRV;
  const bool is_only = is_driver && model.axes == 1 && request.motor == 1;
  const std::size_t chip = is_only ? 0 : request.motor;
  const std::size_t each = !is_driver && model.family == Family::tmc429 ? motors_of_tmc429 : 1;
  return {std::min<std::size_t>(chip * each, model.axes),
          std::min<std::size_t>((chip + 1) * each, model.axes)};
}

/// The driver is in the chip of the ramp generator only where that is a sixPoint one.
bool has_ramp_generator(const Request& request, const Model& model) {
  return request.command != Command::WRITE_DRV || model.family == Family::sixpoint;
}

}  // namespace

bool concerns(const Request& request, AxisAddress motor, const Model* model) {
  if (request.address != motor.module) return false;
  switch (intent_of(request).subject) {
    case Subject::motor: return request.motor == motor.motor || request.motor == all_motors;
    case Subject::several: return is_in_mask(request, motor.motor);
    case Subject::chip: return model == nullptr || motors_of_chip(request, *model).has(motor.motor);
    default: return true;
  }
}

std::set<AxisAddress> motors_turned_by(const Request& request, const Model* model) {
  const auto it = intent_of(request, model);
  if (it.motion != Motion::turns) return {};
  MotorRange range{request.motor, request.motor + std::size_t{1}};
  if (model != nullptr && it.subject == Subject::chip) {
    if (!has_ramp_generator(request, *model)) return {};
    range = motors_of_chip(request, *model);
  }
  std::set<AxisAddress> motors;
  for (auto motor = range.first; motor < range.end; ++motor)
    if (model == nullptr || motor < model->axes)
      motors.insert({request.address, static_cast<std::uint8_t>(motor)});
  return motors;
}

}  // namespace tmcl
