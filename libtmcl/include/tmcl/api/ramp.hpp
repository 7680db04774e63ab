/// The methods that choose among the ramps of an axis.
#pragma once

#include "tmcl/api/axis.hpp"

namespace tmcl::api::ramp {

struct ComparedRamp {
  TMCL_STRUCT(ComparedRamp);
  TMCL_FIELD(std::vector<axis::RampSetting>, settings,
             "what makes it, beside the velocity and the accelerations that all have");
  TMCL_FIELD(std::optional<double>, move_s,
             "how long the move takes; null where it does not come to rest on its target");
  TMCL_FIELD(double, longest_phase_s, "the longest part of it in which the speed changes one way");
  TMCL_FIELD(std::optional<double>, swing_microsteps,
             "how far the load swings to either side when the motor has arrived; null without one");
  TMCL_FIELD(std::optional<double>, swing, "the same in the unit");
  TMCL_FIELD(std::optional<double>, settled_s,
             "when the load swings by no more than the tolerance; null if it never does");
};
struct Comparison {
  TMCL_STRUCT(Comparison);
  TMCL_FIELD(std::string, axis, axis::axis_summary);
  TMCL_FIELD(std::string, model, "model of its module");
  TMCL_FIELD(std::optional<std::string>, unit, axis::unit_summary);
  TMCL_FIELD(std::int32_t, distance_microsteps, "how far the move goes");
  TMCL_FIELD(std::optional<double>, tolerance_microsteps,
             "within which the load is to stand; null without a load");
  TMCL_FIELD(std::vector<ComparedRamp>, ramps, "the steepest first");
  TMCL_FIELD(std::optional<std::int32_t>, proposed,
             "which of them, from 0 on, has its load stand first; null without a load");
};
struct Compare : axis::OfRamp {
  TMCL_METHOD("ramp.compare", reads, Comparison,
              "what the ramps of an axis that stands make of a move and of a load that swings",
              Compare, axis::OfRamp);
  TMCL_FIELD(std::optional<std::int32_t>, distance_microsteps, "how far the move goes");
  TMCL_FIELD(std::optional<Amount>, distance, axis::in_unit_summary);
  TMCL_FIELD(std::optional<double>, resonance_hz,
             "how fast the load swings behind the motor, 0.01 to 100000; no load if absent");
  TMCL_FIELD(std::optional<double>, damping, "of its swings, 0 to 0.999; 0.05 if absent");
  TMCL_FIELD(std::optional<std::int32_t>, tolerance_microsteps,
             "within which the load is to stand; a thousandth of the distance if absent");
  TMCL_FIELD(std::optional<Amount>, tolerance, axis::in_unit_summary);
};

struct Found : axis::Ramp {
  TMCL_STRUCT(Found, axis::Ramp);
  TMCL_FIELD(std::int32_t, distance_microsteps, "how far the move goes");
  TMCL_FIELD(double, move_s, "how long it takes");
  TMCL_FIELD(double, top_speed_pps, "how fast it gets, in microsteps per second");
  TMCL_FIELD(std::optional<double>, top_speed, "the same in the unit per second");
  TMCL_FIELD(std::optional<double>, torque_share,
             "the greatest part that it asks for of the torque that is there at its speed; null "
             "without figures of a motor");
  TMCL_FIELD(std::optional<double>, torque_share_pps, "the speed at which that is");
};
/// The figures of the motor are those of docs/LOAD.md.
struct Find {
  TMCL_METHOD("ramp.find", reads, Found,
              "finds the gentlest ramp that makes a move in time, or the quickest that a motor can "
              "drive; writes nothing",
              Find);
  TMCL_FIELD(std::string, axis, axis::axis_summary);
  TMCL_FIELD(std::optional<std::int32_t>, distance_microsteps, "how far the move goes");
  TMCL_FIELD(std::optional<Amount>, distance, axis::in_unit_summary);
  TMCL_FIELD(std::optional<double>, time_s,
             "how long the move may take, 0.000001 to 86400; the quickest ramp if absent");
  TMCL_FIELD(std::optional<Amount>, velocity,
             "no faster than this; a number: in the axis' unit per second; the greatest of the "
             "model if absent");
  TMCL_FIELD(std::optional<std::int32_t>, velocity_internal,
             "the same, instead, in the module's own unit");
  TMCL_FIELD(std::optional<Amount>, jerk, "as that of axis.plan_ramp");
  TMCL_FIELD(std::optional<std::int32_t>, bow, "the same, instead, as a TMC457 counts it",
             {1, greatest_bow});
  TMCL_FIELD(std::optional<double>, load,
             "that the motor drives at every speed, in 1/1000 of the torque that it holds; 0 if "
             "absent, as the next two");
  TMCL_FIELD(std::optional<double>, load_per_velocity,
             "friction: more of it for each full step per second, in 1/1000");
  TMCL_FIELD(std::optional<double>, inertia,
             "more of it for each full step per second squared, in 1/1000000");
  TMCL_FIELD(std::optional<double>, corner_speed,
             "full steps per second above which the torque of the motor falls; never if absent");
  TMCL_FIELD(std::optional<double>, margin,
             "torque that is left, as a part of what is asked, 0 to 100; 0.3 if absent");
};

}  // namespace tmcl::api::ramp
