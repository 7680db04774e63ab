// Random scripts against a model that knows nothing but one tick at a time.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <string>

#include "support/seed.hpp"
#include "tmcl/ramp/tmc429.hpp"

namespace tmcl::ramp {
namespace {

std::int32_t sign_extend_24(std::int64_t x) {
  x &= 0xFFFFFF;
  return static_cast<std::int32_t>(x >= 0x800000 ? x - 0x1000000 : x);
}

// The algorithm written down as plainly as possible, tick by tick.
struct PlainAxis {
  Tick n = 0;
  std::int32_t xt = 0, x = 0, v_min = 0, v_max = 0, vt = 0, v = 0, a_max = 0;
  std::int32_t accumulator = 0;
  std::uint8_t pd = 0, rd = 0;
  Mode mode = Mode::ramp;
  std::int64_t p = 128, pdiv = 13;

  std::int32_t speed_at(std::int64_t distance) const {
    const auto d = std::min<std::int64_t>(distance, 1 << 19);
    std::int64_t w = 0;
    if (mode == Mode::soft) {
      w = d * p / (std::int64_t{8} << pdiv);
    } else {
      const auto m = (d - 1) * p;
      const auto square = pdiv <= 8 ? m << (8 - pdiv) : m >> (pdiv - 8);
      w = static_cast<std::int64_t>(std::floor(std::sqrt(static_cast<double>(square))));
    }
    const auto floored = std::max<std::int64_t>(std::min<std::int64_t>(w, 2047), v_min);
    return static_cast<std::int32_t>(std::min<std::int64_t>(floored, v_max));
  }

  std::int32_t asked() const {
    const auto dx = sign_extend_24(std::int64_t{xt} - x);
    if (dx == 0) return 0;
    return dx > 0 ? speed_at(dx) : -speed_at(-std::int64_t{dx});
  }

  void slew_to(std::int32_t goal) { v += std::clamp(256 * goal - v, -a_max, a_max); }

  void ramp_tick() {
    if (mode == Mode::hold) return;
    if (mode == Mode::velocity) return slew_to(std::clamp(vt, -v_max, v_max));
    if (x == xt && std::abs(v) / 256 <= v_min) {
      v = 0;
      accumulator = 0;
    } else {
      slew_to(asked());
    }
  }

  void pulse_tick() {
    accumulator += std::abs(v) / 256;
    if (accumulator < 2048) return;
    accumulator -= 2048;
    x = sign_extend_24(std::int64_t{x} + (v < 0 ? -1 : 1));
  }

  void advance_to(Tick until) {
    while (n < until) {
      ++n;
      if (n % (1ULL << rd) == 0) ramp_tick();
      if (n % (1ULL << pd) == 0) pulse_tick();
    }
  }

  void set_mode(Mode to) {
    if (mode == Mode::ramp || mode == Mode::soft) vt = asked();
    mode = to;
  }

  // As the data sheet's example does it, in floating point.
  void update_factor() {
    const double ideal = 0.99 * a_max / (128 * std::exp2(rd - pd));
    p = 128;
    pdiv = 13;
    if (ideal * 8 >= 256) {
      p = 255;
      pdiv = 0;
    }
    for (int div = 0; div <= 13; ++div) {
      const auto pmul = std::floor(ideal * 8 * std::exp2(div) + 1e-9) - 128;
      if (pmul < 0 || pmul > 127) continue;
      p = static_cast<std::int64_t>(pmul) + 128;
      pdiv = div;
    }
  }
};

class Script {
 public:
  explicit Script(std::uint64_t seed) : random_(seed) {}

  std::int32_t between(std::int32_t low, std::int32_t high) {
    return std::uniform_int_distribution(low, high)(random_);
  }
  // Magnitudes of all sizes are equally likely.
  std::int32_t any_size(std::int32_t greatest) {
    return between(0, std::min(greatest, (1 << between(0, 24)) - 1));
  }
  std::int32_t position() { return between(0, 1) != 0 ? any_size(1 << 23) : -any_size(1 << 23); }
  std::int32_t velocity() { return between(-2047, 2047); }
  Tick pause() { return static_cast<Tick>(any_size(between(0, 3) != 0 ? 2'000 : 30'000)); }

  void write_something(Tmc429& axis, PlainAxis& plain) {
    switch (between(0, 9)) {
      case 0:
      case 1:
      case 2: return axis.set_x_target(plain.xt = sign_extend_24(position()));
      case 3: return axis.set_x_actual(plain.x = sign_extend_24(position()));
      case 4: return axis.set_v_max(plain.v_max = any_size(2047));
      case 5: return axis.set_v_target(plain.vt = velocity());
      case 6: return set_acceleration(axis, plain);
      case 7: return set_mode(axis, plain);
      case 8: return set_dividers(axis, plain);
      default: return write_something_rare(axis, plain);
    }
  }

  void set_acceleration(Tmc429& axis, PlainAxis& plain) {
    axis.set_a_max(plain.a_max = any_size(2047));
    plain.update_factor();
  }

  void set_dividers(Tmc429& axis, PlainAxis& plain) {
    plain.pd = static_cast<std::uint8_t>(between(0, 8));
    plain.rd = static_cast<std::uint8_t>(between(0, 8));
    axis.set_dividers({plain.pd, plain.rd});
    plain.update_factor();
  }

 private:
  void set_mode(Tmc429& axis, PlainAxis& plain) {
    const auto mode = static_cast<Mode>(std::max(0, between(-4, 3)));
    axis.set_mode(mode);
    plain.set_mode(mode);
  }

  void write_something_rare(Tmc429& axis, PlainAxis& plain) {
    if (between(0, 1) != 0) return axis.set_v_min(plain.v_min = any_size(between(1, 200)));
    const auto v = velocity();
    axis.set_v_actual(v);
    plain.v = v * 256;
  }

  std::mt19937_64 random_;
};

void expect_same(const Tmc429& axis, const PlainAxis& plain) {
  ASSERT_EQ(axis.x_actual(), plain.x);
  ASSERT_EQ(axis.x_target(), plain.xt);
  ASSERT_EQ(axis.v_actual(), plain.v / 256);
  ASSERT_EQ(axis.pmul() + 128, plain.p);
  ASSERT_EQ(axis.pdiv(), plain.pdiv);
}

TEST(Tmc429Property, JumpingEqualsTicking) {
  for (std::uint64_t seed = test::seed(); seed < test::seed() + 2'000; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Script script(seed);
    Tmc429 axis;
    PlainAxis plain;
    axis.set_v_max(plain.v_max = script.any_size(2047));
    axis.set_v_min(plain.v_min = 1);
    script.set_dividers(axis, plain);
    script.set_acceleration(axis, plain);
    for (int step = 0; step < 30; ++step) {
      script.write_something(axis, plain);
      const auto until = plain.n + script.pause();
      plain.advance_to(until);
      axis.advance_to(until);
      ASSERT_NO_FATAL_FAILURE(expect_same(axis, plain)) << "step " << step << ", tick " << until;
    }
  }
}

// However the time is cut into calls, the hidden parts of the state are the same too.
TEST(Tmc429Property, ManyShortAdvancesEqualOneLong) {
  for (std::uint64_t seed = test::seed(); seed < test::seed() + 300; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Script script(seed);
    Tmc429 once;
    PlainAxis ignored;
    once.set_v_max(script.any_size(2047));
    once.set_v_min(1);
    script.set_dividers(once, ignored);
    script.set_acceleration(once, ignored);
    for (int step = 0; step < 20; ++step) {
      script.write_something(once, ignored);
      auto often = once;
      const auto until = once.tick() + script.pause();
      once.advance_to(until);
      while (often.tick() < until) {
        often.advance_to(std::min(until, often.tick() + static_cast<Tick>(script.between(1, 40))));
      }
      ASSERT_TRUE(once == often) << "step " << step << ", tick " << until;
    }
  }
}

struct Move {
  Tmc429 axis;
  std::int32_t target;
};

// With an acceleration that the data sheet allows for these dividers.
Move random_move(Script& script) {
  Move move;
  const auto pd = script.between(0, 6);
  const auto rd = script.between(0, 6);
  const auto least = std::max(1, static_cast<int>(std::exp2(rd - pd - 1)));
  const auto most = std::min(2047, static_cast<int>(std::exp2(rd - pd + 12)) - 1);
  move.axis.set_v_min(1);
  move.axis.set_v_max(script.between(1, 2047));
  move.axis.set_dividers({static_cast<std::uint8_t>(pd), static_cast<std::uint8_t>(rd)});
  move.axis.set_a_max(script.between(least, most));
  move.target = script.any_size(100'000) * (script.between(0, 1) != 0 ? 1 : -1);
  move.axis.advance_to(static_cast<Tick>(script.between(0, 1000)));
  move.axis.set_x_target(move.target);
  return move;
}

TEST(Tmc429Property, KeepsItsLimitsOnEveryMove) {
  for (std::uint64_t seed = test::seed(); seed < test::seed() + 40; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Script script(seed);
    auto [axis, target] = random_move(script);
    const Tick ramp_tick = 1ULL << axis.dividers().ramp;
    auto before = axis.v_actual();
    for (int i = 0; i < 200'000 && !axis.arrived(); ++i) {
      axis.advance_to((axis.tick() / ramp_tick + 1) * ramp_tick);
      ASSERT_LE(std::abs(axis.v_actual()), axis.v_max());
      // Read without its fraction, the speed may seem to change by up to one unit more.
      ASSERT_LE(std::abs(axis.v_actual() - before), axis.a_max() / 256 + 1);
      before = axis.v_actual();
    }
  }
}

TEST(Tmc429Property, ReachesEveryTargetExactlyAndStaysThere) {
  for (std::uint64_t seed = test::seed(); seed < test::seed() + 1'000; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Script script(seed);
    auto [axis, target] = random_move(script);
    // The slowest: 100,000 microsteps at speed 1 and pulse divisor 6, 2^17 ticks each.
    const auto arrival = axis.arrival(axis.tick() + 14'000'000'000ULL);
    ASSERT_TRUE(arrival);
    axis.advance_to(*arrival);
    ASSERT_EQ(axis.x_actual(), target);
    axis.advance_to(*arrival + 1'000'000);
    ASSERT_EQ(axis.x_actual(), target);
    ASSERT_TRUE(axis.settled());
  }
}

}  // namespace
}  // namespace tmcl::ramp
