/// Jerks: how fast an acceleration changes.
#pragma once

#include <compare>
#include <cstdint>

#include "tmcl/quantity.hpp"
#include "tmcl/units.hpp"

namespace tmcl {

/// Microsteps per second cubed.
struct PulsesPerSecond3 {
  double value = 0;
  auto operator<=>(const PulsesPerSecond3&) const = default;
};

/// The greatest bow of a TMC457 (axis parameter 18); 0 is none, with which an acceleration changes
/// at once.
constexpr std::int32_t greatest_bow = 18;

/// Of a bow of 1 to greatest_bow: 2^(bow - 1) f^3 / 2^52, with the 16 MHz of TMCM modules;
/// application note "Motion Control Profile Parameterization".
PulsesPerSecond3 to_pps3(std::int32_t bow);
/// The greatest whose jerk is no higher; 1 if all are.
std::int32_t bow_within(PulsesPerSecond3 jerk);
/// How long an acceleration takes to be reached with it: register / 2^(bow - 1) * 1024 / f.
double seconds_to(PulsesPerSecond2 acceleration, PulsesPerSecond3 jerk);

/// A ramp from rest to a velocity, or back.
struct RampLength {
  double seconds = 0;
  double microsteps = 0;
};
/// All greater than 0; an infinite jerk makes a trapezoid. With a lower one the acceleration rises
/// and falls, and is not reached at all where the velocity is too low for it.
RampLength ramp_length(PulsesPerSecond velocity, PulsesPerSecond2 acceleration,
                       PulsesPerSecond3 jerk);

/// Whether a TMC457 comes to rest with it: above, its acceleration swings around 0.
bool may_oscillate(std::int32_t bow, PulsesPerSecond2 acceleration);

/// Whether it has the unit of a jerk.
bool is_jerk(const Quantity& quantity);
/// Behind a unit, "/s^3", "/s3" and "/s/s/s" are per second cubed; pps, rps and rpm are per second
/// and per minute already. Errors: those of to_pps2(); wrong_unit for what is no jerk; bare_number.
Result<PulsesPerSecond3> to_pps3(const Quantity& quantity, const AxisUnits& units);

}  // namespace tmcl
