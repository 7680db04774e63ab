/// The torque that a stage asks of its motor, what the motor has, and whether its rotor follows.
///
/// Torque is in 1/1000 of what the motor holds at its full current. Asked are the load, the load
/// that grows with the speed, and the inertia times the acceleration; slowing down, the inertia
/// drives. The motor has as much as its current is of the full one, up to a corner speed, which the
/// supply moves; above it, so much less as it is faster. A motor that is asked for all it has, or
/// for more, stalls: its field goes on, and its rotor stays where it is. It catches on again when
/// it has enough and the field is slow enough for it. A pull asks for torque in one direction,
/// gives it in the other, and turns a rotor that has stalled. docs/LOAD.md tells where that comes
/// from.
#pragma once

#include <cstdint>

#include "sim/stage/stage.hpp"

namespace tmcl::sim {

/// Of a motor at full current.
constexpr std::int64_t full_torque = 1000;
/// In the finest steps in which a driver scales it.
constexpr std::int32_t full_current = 32 * 256;
/// In tenths of a volt: at this one a stage's corner speed is what it is said to be.
constexpr std::int32_t nominal_supply = 240;

struct MotorState {
  std::int64_t speed = 0;               ///< In full steps per second, without a sign.
  int direction = 0;                    ///< On the stage: 1 up, -1 down, 0 at rest.
  std::int64_t acceleration = 0;        ///< How it grows, in full steps per second squared.
  std::int32_t current = full_current;  ///< As a part of `full_current`.
  std::int32_t supply = nominal_supply;
  bool is_on = true;  ///< There is a current in both coils.
};

std::int64_t torque_demanded(const StageSettings& stage, const MotorState& motor);
/// By what pulls, as far as the load, which is friction, does not hold that.
std::int64_t torque_demanded_at_rest(const StageSettings& stage);
std::int64_t torque_available(const StageSettings& stage, const MotorState& motor);
/// What is asked in 1/1000 of what there is; that is more than 1000 of a motor without torque.
std::int64_t relative_load(const StageSettings& stage, const MotorState& motor);

/// Its load or its torque changes with the speed or its direction, so that the moment of a stall is
/// found only by looking.
bool changes_with_speed(const StageSettings& stage);

class Rotor {
 public:
  bool slips() const { return slips_; }
  /// A motor that is not `driven` has come to rest, and no ramp goes on.
  void look(const StageSettings& stage, const MotorState& motor, bool driven);

 private:
  bool slips_ = false;
};

}  // namespace tmcl::sim
