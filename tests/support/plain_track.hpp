/// A movement with piecewise constant jerk as plainly as possible: additions, one tick after the
/// other. When a stretch begins it takes the state from the generator that planned it.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "tmcl/ramp/cubic_track.hpp"
#include "tmcl/ramp/generator.hpp"

namespace tmcl::test {

template <class G>
class PlainTrack {
 public:
  PlainTrack() = default;
  /// From the present state of a generator.
  explicit PlainTrack(const G& planner)
      : planner_(planner), state_(planner.track().at(planner.tick())), tick_(planner.tick()) {}

  /// All writes go through here, at the present tick.
  template <class Change>
  void change(Change change) {
    planner_.advance_to(tick_);
    change(planner_);
    joined_ = false;
  }

  /// Where a stretch ends, the additions must have come to where the next one begins, but for the
  /// part of the last tick in which they went on with the old force: that makes no more than the
  /// change of force does. Where the jerk is limited, it adds up to twice `jerk` to the
  /// acceleration.
  void advance_to(ramp::Tick until, double jerk) {
    const auto& track = planner_.track();
    while (tick_ < until) {
      planner_.next_change();
      if (track.from() == tick_) join(jerk);
      const auto stop = std::min(until, track.until());
      add(stop - tick_);
      tick_ = stop;
      if (tick_ == track.until()) planner_.advance_to(tick_);
      if (track.from() == tick_) join(jerk);
    }
  }

  const ramp::Cubic& state() const { return state_; }
  /// For what does not follow from the state: phase and flags.
  G& planner() {
    planner_.advance_to(tick_);
    return planner_;
  }

  ramp::Motion motion(int velocity_bits, int acceleration_bits) const {
    return {round(state_.x, 0), round(state_.v, velocity_bits),
            round(2 * state_.h, acceleration_bits)};
  }

  int stretches() const { return stretches_; }

 private:
  static std::int64_t round(ramp::Fixed value, int bits) {
    constexpr auto low_half = ~std::uint64_t{0};
    const auto half = ramp::Fixed{1} << (95 - bits);
    const auto raised = value + half;
    // The highest bits are the sign's.
    const auto high = static_cast<std::int64_t>(static_cast<std::uint64_t>(raised >> 64));
    if (bits <= 32) return high >> (32 - bits);
    const auto shift = static_cast<unsigned>(96 - bits);
    const auto low = static_cast<std::uint64_t>(raised & low_half) >> shift;
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(high) << (64 - shift) | low);
  }

  void add(ramp::Tick ticks) {
    auto [x, v, h, i] = state_;
    for (; ticks > 0; --ticks) {
      x += v + h + i;
      v += 2 * h + 3 * i;
      h += 3 * i;
    }
    state_ = {x, v, h, i};
  }

  void join(double jerk) {
    const auto& next = planner_.track().start();
    if (joined_) expect_continuous(next, jerk);
    if (!(state_ == next)) ++stretches_;
    state_ = next;
    joined_ = true;
  }

  void expect_continuous(const ramp::Cubic& next, double jerk) const {
    constexpr double unseen = 0x1p-10;
    const auto gap = [](ramp::Fixed a, ramp::Fixed b) { return std::abs(ramp::to_double(a - b)); };
    const double force = gap(next.h, state_.h) + 3 * gap(next.i, state_.i) + jerk;
    EXPECT_LE(gap(next.x, state_.x), force + unseen) << "at tick " << tick_;
    EXPECT_LE(gap(next.v, state_.v), 2 * force + unseen * unseen) << "at tick " << tick_;
    EXPECT_LE(2 * gap(next.h, state_.h), 2 * jerk * 1.001) << "at tick " << tick_;
  }

  G planner_;
  ramp::Cubic state_;
  ramp::Tick tick_ = 0;
  bool joined_ = false;
  int stretches_ = 0;
};

}  // namespace tmcl::test
