/// Ways and speeds as a six-point generator counts them.
#pragma once

#include <cstdint>

#include "tmcl/ramp/sixpoint.hpp"

namespace tmcl::ramp {

/// Ways and speeds are counted in 2^-23 microsteps and 2^-23 microsteps a tick.
constexpr std::int64_t microstep = 1 << 23;
constexpr unsigned position_shift = 9;  // position_ counts 2^-32 microsteps

constexpr int sign(std::int64_t x) { return (x > 0 ? 1 : 0) - (x < 0 ? 1 : 0); }

/// The way of n ticks of which the first has the speed v + change. What overflows is a whole turn,
/// or multiplied by 0: a speed that changes has come to its end after 2^31 ticks.
constexpr std::int64_t way_of(std::uint64_t n, std::int64_t v, std::int64_t change) {
  return static_cast<std::int64_t>(n * static_cast<std::uint64_t>(v) +
                                   n * (n + 1) / 2 * static_cast<std::uint64_t>(change));
}

/// The first n in 1..most for which `holds`; `most` + 1 if there is none. Once true it stays so.
template <class Condition>
Tick first_tick(Tick most, Condition holds) {
  Tick low = 0;
  Tick high = most + 1;
  while (high - low > 1) {
    const auto middle = low + (high - low) / 2;
    (holds(middle) ? high : low) = middle;
  }
  return high;
}

}  // namespace tmcl::ramp
