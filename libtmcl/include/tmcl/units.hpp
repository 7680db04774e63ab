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

/// A velocity as the module's parameters 2, 3 and 4 count it: -2047..2047 on TMC429 modules, and
/// what axis parameter 255 says on others.
struct InternalVelocity {
  std::int32_t value = 0;
  auto operator<=>(const InternalVelocity&) const = default;
};

/// An acceleration as the module's parameter 5 counts it: 0..2047 on TMC429 modules, and what axis
/// parameter 255 says on others.
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
  bool operator==(const Tmc429Dividers&) const = default;
};
/// The greatest exponent of either.
constexpr std::uint8_t tmc429_max_divider = 13;

/// f·v / 2^(pulse_div+16); TMC429 data sheet.
constexpr PulsesPerSecond to_pps(InternalVelocity velocity, Tmc429Dividers dividers) {
  return {tmc429_clock_hz * velocity.value / static_cast<double>(1ULL << (dividers.pulse + 16U))};
}

/// f²·a / 2^(pulse_div+ramp_div+29); TMC429 data sheet.
constexpr PulsesPerSecond2 to_pps2(InternalAcceleration acceleration, Tmc429Dividers dividers) {
  return {tmc429_clock_hz * tmc429_clock_hz * acceleration.value /
          static_cast<double>(1ULL << (dividers.pulse + dividers.ramp + 29U))};
}

/// What one unit of a register is in microsteps and seconds, with the 16 MHz of TMCM modules;
/// exact.
struct RegisterUnit {
  std::int64_t numerator;
  std::int64_t denominator;
  bool operator==(const RegisterUnit&) const = default;
};

/// f / 2^30; application note "Motion Control Profile Parameterization".
constexpr RegisterUnit tmc457_velocity_unit{15'625, 1 << 20};
/// f^2 / 2^42; the same application note.
constexpr RegisterUnit tmc457_acceleration_unit{244'140'625, 1 << 22};
/// f / 2^24; TMC5130, TMC5160 and TMC5072 data sheets.
constexpr RegisterUnit sixpoint_velocity_unit{15'625, 1 << 14};
/// f^2 / 2^41; the same data sheets.
constexpr RegisterUnit sixpoint_acceleration_unit{244'140'625, 1 << 21};

}  // namespace tmcl
