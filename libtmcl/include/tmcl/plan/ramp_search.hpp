/// Ramps that are sought by letting the twin of an axis make the move: the gentlest that is there
/// in time, and the quickest that a motor can drive.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "tmcl/plan/motor_torque.hpp"
#include "tmcl/plan/ramp_wish.hpp"

namespace tmcl::plan {

/// The move, and what of its ramp is not sought.
struct RampSearch {
  AxisUnits units;                           ///< With a model, and what its module counts in.
  Microsteps distance{};                     ///< From rest to rest; not 0.
  std::vector<Setting> held{};               ///< What the axis has that a new module has not.
  std::optional<JerkWish> jerk{};            ///< Nothing: as it is.
  std::int32_t present_bow = 0;              ///< 0 where there is none.
  std::optional<PulsesPerSecond> fastest{};  ///< No velocity above it; nothing: the model's.
};

struct FoundRamp {
  PlannedRamp planned;
  FollowedMove move;  ///< With it; it comes to rest on its target.
};

struct MotorWish {
  MotorTorque torque;
  double microsteps_per_full_step = 256;
  double margin = 0.3;  ///< Of the torque that is there beyond what is asked, in parts of that.
};

struct RampSearchFault {
  enum class Kind {
    objection,          ///< By plan_ramp(), to the jerk or to the model.
    not_foreseeable,    ///< The ramps of the model, or this move, are not described.
    too_quick,          ///< There is no ramp that makes the move in that time.
    too_little_torque,  ///< The load alone takes more than the margin leaves.
  };
  Kind kind;
  std::optional<double> nearest_s{};  ///< Of a move that is too quick: how long it takes at least.
  std::optional<RampObjection> objection{};
};
/// A sentence without a full stop.
std::string describe(const RampSearchFault& fault, const RampSearch& search);

/// With the least acceleration, and then the least velocity, with which the move takes no longer
/// than this.
tl::expected<FoundRamp, RampSearchFault> gentlest_ramp(const RampSearch& search, double seconds);

/// With which the move takes the shortest time of all that ask for no more than their part of the
/// torque that is there.
tl::expected<FoundRamp, RampSearchFault> quickest_ramp(const RampSearch& search,
                                                       const MotorWish& motor);

}  // namespace tmcl::plan
