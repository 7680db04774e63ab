/// The methods that compute movements of no axis.
#pragma once

#include "tmcl/api/axis.hpp"

namespace tmcl::api::profile {

struct Solved {
  TMCL_STRUCT(Solved);
  TMCL_FIELD(double, distance, "how far it goes");
  TMCL_FIELD(double, speed, "the greatest");
  TMCL_FIELD(double, acceleration, "from the initial speed to that");
  TMCL_FIELD(double, deceleration, "from that to the final speed, as a positive number");
  TMCL_FIELD(double, acceleration_time, "how long it speeds up");
  TMCL_FIELD(double, slew_time, "how long it keeps its speed");
  TMCL_FIELD(double, deceleration_time, "how long it slows down");
  TMCL_FIELD(double, total_time, "all of them");
  TMCL_FIELD(double, initial_speed, "with which it begins");
  TMCL_FIELD(double, final_speed, "with which it ends");
  TMCL_FIELD(double, acceleration_distance, "how far it goes while it speeds up");
  TMCL_FIELD(double, slew_distance, "at its speed");
  TMCL_FIELD(double, deceleration_distance, "while it slows down");
};
struct Solve {
  TMCL_METHOD("profile.solve", reads, Solved,
              "all of a trapezoid from as much of it as determines it; asks no module", Solve);
  TMCL_FIELD(std::optional<double>, distance,
             "what is known, in any unit of length, the same for all, and seconds");
  TMCL_FIELD(std::optional<double>, speed, "the greatest");
  TMCL_FIELD(std::optional<double>, acceleration, "from the initial speed to that");
  TMCL_FIELD(std::optional<double>, deceleration,
             "from that to the final speed, as a positive number");
  TMCL_FIELD(std::optional<double>, acceleration_time, "how long it speeds up");
  TMCL_FIELD(std::optional<double>, slew_time, "how long it keeps its speed");
  TMCL_FIELD(std::optional<double>, deceleration_time, "how long it slows down");
  TMCL_FIELD(std::optional<double>, total_time, "all of them");
  TMCL_FIELD(std::optional<double>, initial_speed, "with which it begins; 0 if absent");
  TMCL_FIELD(std::optional<double>, final_speed, "with which it ends; 0 if absent");
  TMCL_FIELD(std::optional<double>, acceleration_distance, "how far it goes while it speeds up");
  TMCL_FIELD(std::optional<double>, slew_distance, "at its speed");
  TMCL_FIELD(std::optional<double>, deceleration_distance, "while it slows down");
  TMCL_FIELD(
      std::optional<std::string>, assumption,
      "symmetric: both ramps are equal; thirds: each of the three parts takes a third of the "
      "time; none if absent");
};

/// So many points at most: an answer has to be sent.
constexpr int most_curve_points = 2000;

/// At evenly spread times, from the start to the end.
struct Curve {
  TMCL_STRUCT(Curve);
  TMCL_FIELD(std::vector<double>, times_s, "of its points");
  TMCL_FIELD(std::vector<std::int32_t>, positions_microsteps, "where the motor is at each of them");
  TMCL_FIELD(std::vector<double>, velocities_pps, "how fast");
  TMCL_FIELD(std::vector<double>, accelerations_pps2, "and how that changes");
};
struct Simulated {
  TMCL_STRUCT(Simulated);
  TMCL_FIELD(std::string, model, "model of the module");
  TMCL_FIELD(std::optional<double>, move_s,
             "how long the move takes; null where it does not come to rest on its target");
  TMCL_FIELD(double, longest_phase_s, "the longest part of it in which the speed changes one way");
  TMCL_FIELD(double, top_speed_pps, "how fast it gets, in microsteps per second");
  TMCL_FIELD(std::optional<double>, swing_microsteps,
             "how far the load swings to either side when the motor has arrived; null without one");
  TMCL_FIELD(std::optional<double>, settled_s,
             "when the load swings by no more than the tolerance; null if it never does");
  TMCL_FIELD(std::optional<Curve>, curve, "to draw it; null unless points are asked for");
  TMCL_FIELD(std::vector<std::string>, warnings, axis::settings_summary);
};
struct Simulate {
  TMCL_METHOD(
      "profile.simulate", reads, Simulated,
      "a move as the ramp generator of a model makes it, of a module that need not be there",
      Simulate);
  TMCL_FIELD(std::string, model, "such as TMCM-6212");
  TMCL_FIELD(
      std::optional<std::vector<std::string>>, parameters,
      "names or numbers of axis parameters that are set, in this order; the others are as the "
      "module starts");
  TMCL_FIELD(std::optional<std::vector<std::int32_t>>, values,
             "what each of them is set to, as the module counts");
  TMCL_FIELD(std::int32_t, distance_microsteps, "how far the move goes, from rest");
  TMCL_FIELD(std::optional<double>, until_s,
             "how long the curve is, 0.000001 to 86400; until the motor stands if absent");
  TMCL_FIELD(std::optional<std::int32_t>, points, "how many of the curve are given; none if absent",
             {2, most_curve_points});
  TMCL_FIELD(std::optional<double>, resonance_hz,
             "how fast a load swings behind the motor, 0.01 to 100000; no load if absent");
  TMCL_FIELD(std::optional<double>, damping, "of its swings, 0 to 0.999; 0.05 if absent");
  TMCL_FIELD(std::optional<std::int32_t>, tolerance_microsteps,
             "within which the load is to stand; a thousandth of the distance if absent");
};

}  // namespace tmcl::api::profile
