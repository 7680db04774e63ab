/// The method that measures how the load of an axis swings.
#pragma once

#include "tmcl/api/axis.hpp"

namespace tmcl::api::axis {

constexpr std::int64_t shortest_listening_ms = 50;
constexpr std::int64_t longest_listening_ms = 10'000;

struct MeasuredResonance {
  TMCL_STRUCT(MeasuredResonance);
  TMCL_FIELD(std::string, axis, axis_summary);
  TMCL_FIELD(std::string, verdict,
             "rings: the next three are known; still: its encoder stood as soon as the motor; "
             "unclear: it did neither");
  TMCL_FIELD(std::optional<double>, resonance_hz, "how fast the load swings behind the motor");
  TMCL_FIELD(std::optional<double>, damping, "of its swings, 0 to less than 1");
  TMCL_FIELD(std::optional<double>, swing,
             "how far it swung to either side when the motor had arrived, as its encoder counts");
  TMCL_FIELD(double, confidence,
             "the part of what the encoder did then that this explains, 0 to 1");
  TMCL_FIELD(double, lowest_hz, "what swings more slowly is not seen in readings over this time");
  TMCL_FIELD(double, highest_hz, "what swings faster is not seen in so few readings a second");
  TMCL_FIELD(std::int32_t, readings, "how many of the encoder");
  TMCL_FIELD(bool, recorded,
             "the module has recorded them by itself, by command 142; else the bus was asked");
  TMCL_FIELD(double, readings_s, "over which time, in seconds");
  TMCL_FIELD(std::int32_t, distance_microsteps, "how far the move went");
  TMCL_FIELD(double, velocity_pps, "the greatest velocity of the move, in microsteps per second");
  TMCL_FIELD(double, acceleration_pps2, "its acceleration, per second squared");
  TMCL_FIELD(std::vector<std::string>, warnings, settings_summary);
};
struct Resonance {
  TMCL_METHOD("axis.resonance", moves, MeasuredResonance,
              "makes a small move and finds from the encoder how the load swings after it",
              Resonance);
  TMCL_FIELD(std::string, axis, axis_summary);
  TMCL_FIELD(std::optional<std::int32_t>, distance_microsteps,
             "how far to move, 1000 full steps at most; a quarter of a turn if absent");
  TMCL_FIELD(std::optional<Amount>, distance, in_unit_summary);
  TMCL_FIELD(std::optional<std::int64_t>, listen_ms,
             "for how long the encoder is read then; 1000 if absent",
             {shortest_listening_ms, longest_listening_ms});
  TMCL_FIELD(std::optional<std::int64_t>, deadline_ms, deadline_summary, milliseconds);
};

}  // namespace tmcl::api::axis
