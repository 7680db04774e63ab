/// Quantities that must never meet as bare integers.
#pragma once

#include <compare>
#include <cstdint>

namespace tmcl {

/// A position or a distance, in microsteps.
struct Microsteps {
  std::int32_t value = 0;
  auto operator<=>(const Microsteps&) const = default;
};

/// A velocity as the module's parameters 2, 3 and 4 count it: -2047..2047 on TMC429 modules.
struct InternalVelocity {
  std::int32_t value = 0;
  auto operator<=>(const InternalVelocity&) const = default;
};

/// An acceleration as the module's parameter 5 counts it: 0..2047 on TMC429 modules.
struct InternalAcceleration {
  std::int32_t value = 0;
  auto operator<=>(const InternalAcceleration&) const = default;
};

/// Microsteps per second.
struct PulsesPerSecond {
  double value = 0;
  auto operator<=>(const PulsesPerSecond&) const = default;
};

/// Microsteps per second squared.
struct PulsesPerSecond2 {
  double value = 0;
  auto operator<=>(const PulsesPerSecond2&) const = default;
};

/// The clock of a TMC429 on a TMCM module, in Hz.
constexpr double tmc429_clock_hz = 16e6;

/// The dividers of one axis of a TMC429, as exponents of two: 0..13 (axis parameters 154 and 153).
struct Tmc429Dividers {
  std::uint8_t pulse = 0;
  std::uint8_t ramp = 0;
};

/// f·v / 2^(pulse_div+16); TMC429 data sheet.
constexpr PulsesPerSecond to_pps(InternalVelocity velocity, Tmc429Dividers dividers) {
  return {tmc429_clock_hz * velocity.value / static_cast<double>(1ULL << (dividers.pulse + 16U))};
}

/// f²·a / 2^(pulse_div+ramp_div+29); TMC429 data sheet.
constexpr PulsesPerSecond2 to_pps2(InternalAcceleration acceleration, Tmc429Dividers dividers) {
  return {tmc429_clock_hz * tmc429_clock_hz * acceleration.value /
          static_cast<double>(1ULL << (dividers.pulse + dividers.ramp + 29U))};
}

}  // namespace tmcl
