/// Ramps of one axis beside each other: how long each takes for a move, and how a load that swings
/// takes it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "tmcl/model.hpp"
#include "tmcl/plan/axis_twin.hpp"
#include "tmcl/ramp/resonant_load.hpp"

namespace tmcl::plan {

/// A part of a move in which the acceleration changes evenly, in microsteps and seconds.
struct MotionStretch {
  double seconds = 0;
  double acceleration = 0;  ///< At its beginning.
  double jerk = 0;
};

/// A move from rest, as the ramp generator of a module makes it.
struct FollowedMove {
  std::vector<MotionStretch> stretches;
  std::optional<double> seconds;  ///< Nothing if it does not come to rest on its target.
  double longest_phase_s = 0;     ///< Of those in which the speed changes.
  double top_speed = 0;           ///< In microsteps per second.
};

/// The axis parameters are those of a module that has just started, but for `settings`, in this
/// order. A move with too many changes is followed as far as it may be, without an end. Nothing for
/// a model whose ramp generator is not described, and for a setting or a distance that the module
/// does not take.
std::optional<FollowedMove> follow_move(const Model& model, std::span<const Setting> settings,
                                        Microsteps distance);

/// What else the ramp could be, with the same greatest velocity, acceleration and deceleration:
/// each bow of a TMC457, sets of A1, V1 and D1 on a sixPoint generator, equal bows of a TMC4361. Of
/// all but the last the first is the trapezoid; on a TMC429 there is no other. `settings`: those of
/// the axis, which these are to follow.
std::vector<std::vector<Setting>> ramp_variants(const Model& model,
                                                std::span<const Setting> settings);

struct LoadWish {
  ramp::Resonance resonance;
  double tolerance = 0;  ///< Within which the load is to stand, in microsteps.
};
/// What part of a move its load may swing by, unless something else is said.
constexpr double usual_load_tolerance = 1e-3;

struct RampVerdict {
  std::optional<double> seconds;  ///< Nothing if it swings around its target.
  double longest_phase_s = 0;
  std::optional<double> swing;  ///< When the motor has arrived, to either side, in microsteps.
  std::optional<double>
      settled_s;  ///< When the load keeps its tolerance; nothing if it never does.
};

/// `load`: nothing without one.
RampVerdict judge(const FollowedMove& move, const std::optional<LoadWish>& load);

/// Of a move with `settings`, then one of their variants; nothing where follow_move() gives none.
std::optional<RampVerdict> judge_variant(const Model& model, std::vector<Setting> settings,
                                         std::span<const Setting> variant, Microsteps distance,
                                         const std::optional<LoadWish>& load);

/// The one whose load stands first; of equal ones the first. Nothing if no load does.
std::optional<std::size_t> first_settled(std::span<const RampVerdict> verdicts);

}  // namespace tmcl::plan
