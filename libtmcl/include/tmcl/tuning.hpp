/// The greatest velocity and acceleration that an axis bears, found by moves whose steps its
/// encoder counts; then the least current for them, a stallGuard2 threshold, the least standby
/// current with which nothing moves it, and the bow with which a load that swings stands first.
///
/// Each trial is a move there and back within the travel, and is ended at the first sign of
/// trouble: the encoder is not where the motor should be, or the motor does not arrive. Then the
/// position of the module is set as the encoder has it, and the next trial asks for less. The axis
/// ends where it began, and everything that was set is as it was, whatever failed; but if
/// something fails, the axis stands where it was stopped.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tmcl/address.hpp"
#include "tmcl/mechanics.hpp"
#include "tmcl/plan/axis_twin.hpp"
#include "tmcl/quantity.hpp"
#include "tmcl/ramp/resonant_load.hpp"
#include "tmcl/script.hpp"

namespace tmcl {

/// What a trial is for.
enum class Sought : std::uint8_t {
  velocity,
  acceleration,
  current,
  threshold,
  confirmation,
  hold,
  bow
};
std::string_view name_of(Sought sought);

/// A move there and back; for the standby current, the rest after each of them.
struct TuneTrial {
  Sought sought{};
  PulsesPerSecond velocity;
  PulsesPerSecond2 acceleration;
  std::int32_t current = 0;  ///< Axis parameter 6; for the standby current 7.
  bool held = false;
  double deviation = 0;                      ///< The greatest that the encoder had, in microsteps.
  std::optional<std::int32_t> load_value{};  ///< The least at full speed; nothing: not looked at.
  std::optional<std::int32_t> threshold{};   ///< With which that was.
  std::string trouble{};                     ///< Why it did not hold.
  /// Of its load when it stood, to either side, in microsteps; nothing: not looked at.
  std::optional<double> swing{};
};

/// Which of its limit switches tells whether an axis without an encoder has lost steps.
enum class LimitSwitch : std::uint8_t { left, right };

/// Why a search went no further.
enum class LimitedBy : std::uint8_t { motor, travel, bounds };
std::string_view name_of(LimitedBy limit);

struct TunedValue {
  double limit = 0;     ///< The greatest that held; of the current the least.
  double proposed = 0;  ///< With the margin.
  LimitedBy limited_by = LimitedBy::motor;
};

/// Of a TMC457: with it the load stands first after a move at the proposed velocity and
/// acceleration.
struct TunedBow {
  std::int32_t value = 0;  ///< What is proposed; what the axis has where no other is better.
  std::optional<ramp::Resonance> resonance{};  ///< Nothing: none was found.
  double swing = 0;                            ///< With it, at rest, to either side, in microsteps.
  double swing_before = 0;                     ///< With what the axis has.
};

struct Tuning {
  TunedValue velocity;                      ///< In microsteps per second.
  TunedValue acceleration;                  ///< Per second squared; at the proposed velocity.
  TunedValue current;                       ///< Of parameter 6; at both.
  std::optional<std::int32_t> threshold{};  ///< Of stallGuard2; nothing where none was found.
  double backlash = 0;                      ///< In microsteps, as the encoder has it.
  double counts_per_microstep = 0;          ///< Of the encoder.
  std::vector<TuneTrial> trials{};
  std::vector<plan::Setting> settings{};  ///< What is proposed, in the order in which to set it.
  std::vector<std::string> warnings{};    ///< Sentences without a full stop.
  bool lost_steps = false;                ///< Its position was set as its encoder had it.
  /// Of parameter 7. Where the axis stood with all less as well (LimitedBy::bounds), what it has is
  /// proposed. Nothing: the axis stood with none.
  std::optional<TunedValue> hold_current{};
  std::optional<TunedBow> bow{};  ///< Nothing for a module without.
};

struct TuneOptions {
  AxisUnits units{};  ///< With a model, and what its module counts in.
  /// What the settings are that are changed: tune_parameters(), read just before. They are given
  /// back.
  std::vector<plan::Setting> settings{};
  std::int32_t max_current = 0;  ///< Of parameter 6: no more flows, and the trials begin with it.
  ValueRange travel{};           ///< Where the axis may go, in microsteps.
  // What it must not exceed.
  std::optional<PulsesPerSecond> greatest_velocity{};
  std::optional<PulsesPerSecond2> greatest_acceleration{};
  double margin = 0.2;  ///< So much more than what is proposed is what held, in parts.
  /// Nothing: the encoder tells.
  std::optional<LimitSwitch> by_switch{};
  /// Told what is done next.
  std::function<void(const std::string& what)> tell{};
};

/// The axis parameter of its encoder; nothing for a model that has none.
std::optional<std::uint8_t> tune_encoder(const Model& model);
/// Which settings are changed.
std::vector<std::uint8_t> tune_parameters(const Model& model);

namespace verbs {

/// The axis stands, and no other client moves it, or sets anything in its module.
/// Errors: Errc::bad_argument for a model without an encoder where no switch is to tell, a switch
/// that is not within the travel, a travel that is too short, and an axis that moves;
/// Errc::move_interrupted if its encoder does not follow even a slow move; those
/// of the exchanges, which are with Outcome::unknown if something was set that could not be given
/// back.
Script<Result<Tuning>> tune(AxisAddress axis, TuneOptions options);

}  // namespace verbs
}  // namespace tmcl
