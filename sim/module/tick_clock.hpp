/// When the ticks of a ramp generator are. All in integers, so nothing drifts.
#pragma once

#include <cstdint>

#include "sim/module/due.hpp"
#include "tmcl/clock.hpp"
#include "tmcl/ramp/generator.hpp"

namespace tmcl::sim {

/// Tick n is n / `per_second` seconds after power-on; there are at most 1e9 in a second.
class TickClock {
 public:
  TickClock(TimePoint power_on, std::uint64_t per_second)
      : power_on_(power_on), per_second_(per_second) {}

  /// The last tick that is not after this time, which is not before power-on.
  ramp::Tick at(TimePoint time) const {
    const auto passed = static_cast<std::uint64_t>((time - power_on_).count());
    return passed / second * per_second_ + passed % second * per_second_ / second;
  }
  /// When a tick is, to the nanosecond after it; `never` if no time point is that late.
  TimePoint of(ramp::Tick tick) const {
    if (tick >= at(never)) return never;
    const auto rest = (tick % per_second_ * second + per_second_ - 1) / per_second_;
    return power_on_ + Duration(tick / per_second_ * second + rest);
  }

 private:
  static constexpr std::uint64_t second = 1'000'000'000;

  TimePoint power_on_;
  std::uint64_t per_second_;
};

}  // namespace tmcl::sim
