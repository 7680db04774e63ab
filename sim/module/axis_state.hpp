/// What an axis is made of, for those who watch and drive it.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "sim/module/coupling.hpp"
#include "sim/module/homing.hpp"
#include "sim/module/module_settings.hpp"
#include "sim/module/motor.hpp"
#include "sim/module/wrapping.hpp"
#include "sim/stage/stage.hpp"
#include "tmcl/model.hpp"
#include "tmcl/parameter.hpp"

namespace tmcl::sim {

inline bool is_in_range(const ParameterInfo& row, std::int32_t value) {
  return value >= row.minimum && value <= row.maximum;
}

struct AxisState {
  AxisState(const Model& model, Stage& stage, TimePoint begin, const ModuleTraits& variants);

  /// As the motor has it, or else the firmware.
  std::int32_t in_force(const ParameterInfo& row) const;
  /// What was set, where the firmware keeps that, or what is in force.
  std::int32_t kept(const ParameterInfo& row) const;
  /// What a value that is written becomes; nothing if it is refused.
  std::optional<Wrapped> accepted(const ParameterInfo& row, std::int32_t value) const;
  /// What the motor is told of a parameter, whatever was set; nothing: what was.
  std::optional<std::int32_t> overruled(const ParameterInfo& row) const;
  std::int32_t in_motor(const ParameterInfo& row, std::int32_t value) const;
  bool is_moving() const { return motor->heading() != 0 || outlook.rest > now; }
  /// Without a sign, because a velocity that was wrapped may have any bits.
  std::uint32_t speed() const;
  /// What MVP REL counts from.
  std::int32_t relative_origin() const;
  bool goes_to_new_target() const;
  void look_ahead();

  Family family;
  ModuleTraits traits;
  bool wraps;
  std::span<const ParameterInfo> table;
  std::unique_ptr<Motor> motor;
  Coupling coupling;
  std::array<std::int32_t, 256> values{};  ///< Of those parameters that the motor has no part in.
  TimePoint power_on;
  TimePoint now;
  MotionForecast outlook;
  TimePoint rest;  ///< Since when it stands, or when it will.
  Switches switches;
};

}  // namespace tmcl::sim
