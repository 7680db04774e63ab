/// The twin of an axis: its module's ramp generator, set as the module is, in the library.
///
/// What the twin does, the axis will do. A twin is a value; a copy that is let run is a prediction,
/// exact to the tick of the generator. What cannot be read from a module limits that: where in its
/// ramp tick a TMC429 is when a command comes, and the fractions of a speed in mid-ramp.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "tmcl/clock.hpp"
#include "tmcl/conversion.hpp"
#include "tmcl/model.hpp"
#include "tmcl/module_traits.hpp"
#include "tmcl/ramp/generator.hpp"
#include "tmcl/ramp/sixpoint.hpp"
#include "tmcl/ramp/tmc429.hpp"
#include "tmcl/ramp/tmc457.hpp"
#include "tmcl/unit_mode.hpp"
#include "tmcl/units.hpp"

namespace tmcl::plan {

/// An axis parameter and what it holds, as SAP takes it.
struct Setting {
  std::uint8_t parameter = 0;
  std::int32_t value = 0;
  bool operator==(const Setting&) const = default;
};

/// Where an axis is, and how fast.
struct AxisMotion {
  Microsteps position;
  PulsesPerSecond velocity;
  PulsesPerSecond2 acceleration;
  bool operator==(const AxisMotion&) const = default;
};

/// No movement is followed for longer than that.
constexpr Duration longest_prediction = std::chrono::hours(24);

class AxisTwin {
 public:
  /// An axis as it is after power-up. Nothing for a model whose ramp generator is not
  /// described: the families tmc4361 and firmware.
  static std::optional<AxisTwin> of(const Model& model);
  /// The axis parameters that make a difference to a ramp, in the order in which to set() them.
  static std::vector<std::uint8_t> parameters(const Model& model);

  const Model& model() const { return *model_; }
  /// Null if it is another generator.
  const ramp::Tmc429* tmc429() const { return std::get_if<ramp::Tmc429>(&chip_); }

  /// It is the twin of a module that is like this.
  void take_traits(const ModuleTraits& traits);

  /// As SAP does, for the parameters of a ramp; others make no difference. False, and nothing has
  /// changed, for what the module would refuse.
  bool set(Setting setting);
  /// All of them, in this order; false if one was refused.
  bool set(std::span<const Setting> settings);

  /// It is there, and moves so fast, in the unit of the moment. Time goes on by as much as bringing
  /// it to that speed takes; positions before that are forgotten.
  void place(Microsteps position, InternalVelocity velocity = {});
  /// As MVP ABS does.
  void move_to(Microsteps target);
  /// As ROR does, and ROL with the other sign, in the unit of the moment; false for a speed that
  /// the module would refuse.
  bool rotate(InternalVelocity velocity);
  /// As MST does.
  void stop();

  void advance(Duration by);
  /// Since it was made.
  Duration elapsed() const { return elapsed_; }
  AxisMotion motion() const;
  /// How long until it stands on its target; nothing if that is after `limit`, or never.
  std::optional<Duration> time_to_arrival(Duration limit = longest_prediction) const;
  /// What about the settings will make it move in another way than one would wish: sentences
  /// without a full stop, about axis parameters by their names and values. `written`: what was
  /// written to them, where that is known; a value that the chip rounds is told as it was written.
  /// With a scale that has a unit, velocities and accelerations are told in that as well.
  std::vector<std::string> warnings(std::span<const Setting> written = {},
                                    const std::optional<UserScale>& scale = {}) const;

  /// What a velocity and an acceleration mean in the unit of the moment.
  PulsesPerSecond to_pps(InternalVelocity velocity) const;
  PulsesPerSecond2 to_pps2(InternalAcceleration acceleration) const;

 private:
  using Chip = std::variant<ramp::Tmc429, ramp::Tmc457, ramp::SixPoint>;

  AxisTwin(const Model& model, Chip chip, UnitMode units);
  bool take(const ParameterInfo& row, std::int32_t value);

  const Model* model_;
  Chip chip_;
  UnitMode units_;
  std::int64_t top_speed_ = 0;  // parameter 4, in the chip's unit
  Duration elapsed_{};
  ramp::Tick origin_ = 0;  // the tick that counts as the moment when it was made
};

/// Where it is at the end of each step of time, from now on: the curve of a prediction.
std::vector<AxisMotion> motions(AxisTwin twin, Duration step, std::size_t count);

}  // namespace tmcl::plan
