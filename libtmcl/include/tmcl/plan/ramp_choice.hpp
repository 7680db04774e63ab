/// The axis parameters that make a module's ramp as near as it can be to a requested one.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "tmcl/conversion.hpp"
#include "tmcl/model.hpp"
#include "tmcl/plan/axis_twin.hpp"
#include "tmcl/units.hpp"

namespace tmcl::plan {

/// The unit in which a wish was said, for remarks about it.
struct WishUnit {
  double per_microstep = 1;  ///< How much of it is one microstep a second, or squared, or cubed.
  std::string name;          ///< May be empty, where a file has no units.
};
struct WishUnits {
  WishUnit velocity{1, "microsteps/s"};
  WishUnit acceleration{1, "microsteps/s^2"};
  WishUnit deceleration{1, "microsteps/s^2"};
  WishUnit jerk{1, "microsteps/s^3"};
};

/// What a ramp should be like. Everything is greater than 0.
struct RampRequest {
  PulsesPerSecond velocity;
  PulsesPerSecond2 acceleration;
  PulsesPerSecond2 deceleration;
  /// How fast the acceleration may change, in microsteps/s^3. Infinite: trapezoids; highest_jerk:
  /// as fast as the module can without swinging; nothing: as it is.
  std::optional<double> jerk = std::numeric_limits<double>::infinity();
  /// What the axis has now, for what is left as it is; 0 where the module has no bow.
  std::int32_t bow = 0;
  WishUnits said_in{};
};
constexpr double highest_jerk = std::numeric_limits<double>::max();

struct RampChoice {
  /// In the module's units of the moment; to be written in_safe_order().
  std::vector<Setting> settings;
  // What they give.
  PulsesPerSecond velocity;
  PulsesPerSecond2 acceleration;
  PulsesPerSecond2 deceleration;
  double jerk = std::numeric_limits<double>::infinity();
  /// What it will do instead where the module cannot do what was asked; sentences without a full
  /// stop.
  std::vector<std::string> remarks;
};

/// `units` is what the module counts in now; on a TMC429 the choice makes its own.
///
///  - TMC429: the dividers of choose_tmc429_ramp(), and as minimum velocity the speed that is
///    reached within one microstep anyway: sqrt(2048 p), where p is the chip's PMUL / PDIV. With a
///    minimum velocity of 1 the last microstep takes up to 2^(pulse_div + 16) / f seconds.
///  - TMC457: the greatest bow that does not exceed the jerk and with which the motor does not
///    oscillate; with a bow, 16/15 of the deceleration, because the chip uses 15/16 of it.
///  - others: all stages of the ramp get the same acceleration, or deceleration.
///
/// Errors: a velocity or an acceleration that the module does not have, and the nearest it has.
Reached<RampChoice> choose_ramp(const Model& model, const RampRequest& wish,
                                const ModuleUnits& units);

/// The error in the unit in which the wish was said.
OutOfReach in_unit(OutOfReach error, const WishUnit& unit);

/// A jerk that no bow of the model keeps, in microsteps/s^3, and the nearest one that a bow does:
/// infinite where the model has none. Nothing for jerks that can be had, and for trapezoids.
std::optional<OutOfReach> jerk_out_of_reach(const Model& model, double jerk);

/// In the order in which to write them, so that no speed in between is faster than both the old and
/// the new one: a module that stops answering half-way must not be left with a fast axis.
/// `pulse_div` is what a TMC429 has now; it makes no difference to settings without dividers.
std::vector<Setting> in_safe_order(std::vector<Setting> settings, std::int32_t pulse_div);

/// The speed that a TMC429 reaches within one microstep: floor(sqrt(2048 p)), where p is what PMUL
/// and PDIV make. 1 at least.
InternalVelocity speed_within_a_microstep(Tmc429Dividers dividers,
                                          InternalAcceleration acceleration);

}  // namespace tmcl::plan
