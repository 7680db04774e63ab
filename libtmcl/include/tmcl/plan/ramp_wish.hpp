/// A ramp as a user wishes it, in whatever units, and what a module makes of it: for an axis of a
/// gateway and for one that need not be there.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "tmcl/error.hpp"
#include "tmcl/jerk.hpp"
#include "tmcl/plan/ramp_choice.hpp"
#include "tmcl/quantity.hpp"

namespace tmcl::plan {

/// How fast an acceleration may change: one of them.
struct JerkWish {
  std::optional<tmcl::Quantity> quantity{};
  std::optional<std::int32_t> bow{};
  bool highest = false;  ///< As fast as the module can without swinging.
};

struct RampWish {
  tmcl::Quantity velocity;
  tmcl::Quantity acceleration;
  std::optional<tmcl::Quantity> deceleration{};  ///< Nothing: the acceleration.
  std::optional<JerkWish> jerk{};                ///< Nothing: as it is.
};

/// What of a wish cannot be.
struct RampObjection {
  enum class Part : std::uint8_t { velocity, acceleration, deceleration, jerk, bow };
  Part part;
  Error error;
};

struct PlannedRamp {
  RampChoice choice;
  /// What comes of a move that gets up to speed: sentences without a full stop.
  std::vector<std::string> warnings;

  /// From rest to speed.
  RampLength ramp_up() const;
};

/// The same in pulses, before anything is chosen; arguments and errors as below.
tl::expected<RampRequest, RampObjection> ramp_request(const RampWish& wish, const AxisUnits& units,
                                                      std::int32_t present_bow);

/// The parameters that come nearest. `units` has a model, what its module counts in, and a scale
/// where the wish needs one; `present_bow`: of the axis, for a jerk that is left as it is; 0 where
/// there is none. Errors: what to_pps(), to_pps2() and to_pps3() object to; out_of_range for what
/// is not above 0, for a ramp that the module does not have, with the nearest that it has and the
/// microsteps that would do, and for a jerk that no bow keeps.
tl::expected<PlannedRamp, RampObjection> plan_ramp(const RampWish& wish, const AxisUnits& units,
                                                   std::int32_t present_bow);

}  // namespace tmcl::plan
