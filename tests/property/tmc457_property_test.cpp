// Random scripts against additions tick by tick, and what is true of all movements.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <string>

#include "support/plain_track.hpp"
#include "support/random.hpp"
#include "support/seed.hpp"
#include "tmcl/ramp/tmc457.hpp"

namespace tmcl::ramp {
namespace {

using R = Tmc457::Register;
using Mode = Tmc457::Mode;

constexpr std::int64_t v_greatest = 0x7FFF0000;
constexpr std::int64_t a_greatest = 0xFFFFFD;

class Script : public test::Random<> {
 public:
  using Random::Random;

  // Forces so great that movements take some thousand ticks.
  std::int64_t strong() { return between(1 << 20, a_greatest); }
  std::int64_t strong_bow() { return one_in(2) ? 0 : between(16, 18); }
};

// Something that is done to an axis.
using Change = std::function<void(Tmc457&)>;

Change writing(R name, std::int64_t value) {
  return [=](Tmc457& axis) { ASSERT_TRUE(axis.write(name, value)); };
}

Change beginning(Script& script) {
  const bool strong = !script.one_in(3);
  const auto v = strong ? script.between(1 << 22, v_greatest) : script.positive(v_greatest);
  const auto a = strong ? script.strong() : script.positive(a_greatest);
  const auto d = strong ? script.strong() : script.positive(a_greatest);
  const auto stop = strong ? script.strong() : script.positive(a_greatest);
  const auto bow = strong ? script.strong_bow() : script.between(0, 18);
  return [=](Tmc457& axis) {
    writing(R::v_max, v)(axis);
    writing(R::a_max, a)(axis);
    writing(R::d_max, d)(axis);
    writing(R::d_stop, stop)(axis);
    writing(R::bow_max, bow)(axis);
  };
}

Change switching(Script& script) {
  const auto enable_l = script.between(0, 1), enable_r = script.between(0, 1);
  const bool left = script.one_in(3), right = script.one_in(3);
  return [=](Tmc457& axis) {
    writing(R::enable_stop_l, enable_l)(axis);
    writing(R::enable_stop_r, enable_r)(axis);
    axis.set_switches(left, right);
  };
}

Change retargeting(Script& script, std::int64_t position) {
  const auto far = script.one_in(8) ? script.positive(1LL << 31) - 1 : script.positive(300);
  return writing(R::x_target,
                 std::clamp<std::int64_t>(position + script.either_way(far), INT32_MIN, INT32_MAX));
}

Change anything(Script& script, std::int64_t position) {
  const bool strong = !script.one_in(4);
  const auto force = strong ? script.strong() : script.positive(a_greatest) - 1;
  switch (script.between(0, 15)) {
    case 0: return writing(R::v_max, script.positive(v_greatest + 1) - 1);
    case 1: return writing(R::v_target, script.either_way(script.positive(v_greatest)));
    case 2: return writing(R::a_max, force);
    case 3: return writing(R::d_max, force);
    case 4: return writing(R::d_stop, force);
    case 5: return writing(R::bow_max, strong ? script.strong_bow() : script.between(0, 18));
    case 6: return writing(R::x_actual, script.either_way(script.positive(1LL << 31) - 1));
    case 7: return writing(R::mode, script.one_in(2) ? 0 : script.between(2, 3));
    case 8:
    case 9: return switching(script);
    default: return retargeting(script, position);
  }
}

// The most that the acceleration may change in a tick while nothing is written; any amount
// without bow, where it oscillates, and at switches.
double jerk_of(const Tmc457& axis) {
  const auto bow = axis.read(R::bow_max);
  const auto least = std::min(axis.read(R::a_max), axis.read(R::d_max));
  const bool smooth = bow > 0 && (least == 0 || (1 << (bow - 1)) <= least);
  const bool switches = axis.read(R::enable_stop_l) != 0 || axis.read(R::enable_stop_r) != 0;
  return smooth && !switches ? std::exp2(static_cast<double>(bow - 1) - 52) : 1;
}

// One by jumps, the other by additions.
class Pair {
 public:
  const Tmc457& chip() const { return chip_; }

  void apply(const Change& change) {
    change(chip_);
    plain_.change(change);
  }

  void advance(Tick ticks) {
    const auto until = chip_.tick() + ticks;
    plain_.advance_to(until, jerk_of(chip_));
    chip_.advance_to(until);
  }

  void expect_same() {
    ASSERT_EQ(chip_.track().at(chip_.tick()), plain_.state());
    ASSERT_EQ(chip_.motion(), plain_.motion(30, 42));
    auto& planner = plain_.planner();
    ASSERT_EQ(chip_.phase(), planner.phase());
    ASSERT_EQ(chip_.status(), planner.status());
    ASSERT_EQ(chip_.settled(), planner.settled());
    ASSERT_EQ(chip_.next_change(), planner.next_change());
  }

 private:
  Tmc457 chip_;
  test::PlainTrack<Tmc457> plain_;
};

// What has been seen in a script, or in how many scripts.
struct Seen {
  int arrival = 0, reversal = 0, replan = 0, oscillation = 0, stop = 0, hold = 0;

  void watch(const Motion& before, bool stood, const Tmc457& now) {
    const auto velocity = now.motion().velocity;
    arrival |= now.arrived() && !stood;
    reversal |= (before.velocity > 0 && velocity < 0) || (before.velocity < 0 && velocity > 0);
    oscillation |= now.phase() == "oscillate";
    stop |= now.phase() == "stop";
    hold |= now.phase() == "hold";
  }
  void add(const Seen& other) {
    arrival += other.arrival;
    reversal += other.reversal;
    replan += other.replan;
    oscillation += other.oscillation;
    stop += other.stop;
    hold += other.hold;
  }
};

// Often to the end of the stretch, so that movements come to their end.
Tick pause(Script& script, Tmc457 axis) {
  if (script.one_in(2)) return static_cast<Tick>(script.positive(1'000));
  return std::min<Tick>(axis.next_change() - axis.tick(), 8'000);
}

void run_script(std::uint64_t seed, Seen& seen) {
  Script script(seed);
  Pair pair;
  pair.apply(beginning(script));
  for (int step = 0; step < 6; ++step) {
    seen.replan |= pair.chip().motion().velocity != 0;
    pair.apply(anything(script, pair.chip().motion().position));
    for (auto pauses = script.between(0, 8); pauses > 0; --pauses) {
      const auto before = pair.chip().motion();
      const bool stood = pair.chip().arrived();
      pair.advance(pause(script, pair.chip()));
      ASSERT_NO_FATAL_FAILURE(pair.expect_same())
          << "step " << step << ", tick " << pair.chip().tick();
      seen.watch(before, stood, pair.chip());
    }
  }
}

TEST(Tmc457Property, JumpingEqualsTicking) {
  constexpr int scripts = 100'000;
  Seen all;
  for (std::uint64_t seed = test::seed(); seed < test::seed() + scripts; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Seen seen;
    ASSERT_NO_FATAL_FAILURE(run_script(seed, seen));
    all.add(seen);
  }
  EXPECT_GT(all.arrival, scripts / 5);
  EXPECT_GT(all.reversal, scripts / 6);
  EXPECT_GT(all.replan, scripts / 2);
  EXPECT_GT(all.oscillation, scripts / 50);
  EXPECT_GT(all.stop, scripts / 50);
  EXPECT_GT(all.hold, scripts / 20);
}

TEST(Tmc457Property, ManyShortAdvancesEqualOneLong) {
  for (std::uint64_t seed = test::seed(); seed < test::seed() + 10'000; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Script script(seed);
    Tmc457 once;
    beginning(script)(once);
    for (int step = 0; step < 10; ++step) {
      anything(script, once.motion().position)(once);
      auto often = once;
      // Not so long that following an oscillation bow tick by bow tick takes its time.
      const auto pause = script.positive(1 << 24);
      const auto until = once.tick() + static_cast<Tick>(pause);
      once.advance_to(until);
      while (often.tick() < until) {
        often.advance_to(
            std::min(until, often.tick() + static_cast<Tick>(script.between(1, 1 + pause / 20))));
      }
      ASSERT_TRUE(once == often) << "step " << step << ", tick " << until;
    }
  }
}

// The rule written down plainly: every bow tick the acceleration is one bow value, towards
// v_target.
TEST(Tmc457Property, OscillatesAroundAVelocityBowTickByBowTick) {
  for (std::uint64_t seed = test::seed(); seed < test::seed() + 5'000; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Script script(seed);
    const auto bow = script.between(2, 18);
    const std::int64_t bow_value = 1LL << (bow - 1);
    const auto goal = script.either_way(script.positive(1000 * bow_value));
    Tmc457 axis;
    writing(R::mode, 2)(axis);
    writing(R::a_max_d_max, script.between(1, bow_value - 1))(axis);
    writing(R::bow_max, bow)(axis);
    writing(R::v_target, goal)(axis);
    // In quarters of a unit of v_target, which is what a bow value adds in 1024 clocks; positions
    // are counted in 2^-22 microsteps.
    std::int64_t v = 0, x = 0;
    Tick tick = 0;
    for (int step = 0; step < 5; ++step) {
      for (auto bow_ticks = script.positive(3'000); bow_ticks > 0; --bow_ticks, tick += 1024) {
        const auto gap = 4 * goal - v;
        const auto force = gap > 0 ? bow_value : gap < 0 ? -bow_value : 0;
        x += 2 * v + force;
        v += force;
      }
      axis.advance_to(tick);
      const auto now = axis.track().at(tick);
      ASSERT_EQ(now.v, to_fixed(static_cast<double>(v) * 0x1p-32)) << "tick " << tick;
      ASSERT_EQ(now.x, to_fixed(static_cast<double>(x) * 0x1p-23)) << "tick " << tick;
    }
  }
}

TEST(Tmc457Property, OscillatesAroundItsTargetForEver) {
  for (std::uint64_t seed = test::seed(); seed < test::seed() + 5'000; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Script script(seed);
    const auto bow = script.between(2, 18);
    const auto bow_value = 1LL << (bow - 1);
    Tmc457 axis;
    writing(R::v_max, script.positive(v_greatest))(axis);
    writing(R::a_max_d_max, script.between(1, bow_value - 1))(axis);
    writing(R::bow_max, bow)(axis);
    const auto target = script.either_way(script.positive(1LL << 30));
    writing(R::x_target, target)(axis);
    // At the least speed, half a unit, 2^30 microsteps take 2^61 ticks.
    axis.advance_to(Tick{1} << 62);
    const double quantum = static_cast<double>(bow_value) * 0x1p-22;
    for (int i = 0; i < 20; ++i) {
      axis.advance_to(axis.next_change());
      ASSERT_FALSE(axis.arrived());
      const auto off = axis.track().start().x - to_fixed(static_cast<double>(target));
      ASSERT_LE(std::abs(to_double(off)), 5 * quantum);
    }
  }
}

// Registers that go together, and only the target changes in motion.
Tmc457 sound_axis(Script& script) {
  Tmc457 axis;
  const auto bow = script.between(0, 18);
  const auto least = bow == 0 ? 1 : 1LL << (bow - 1);
  writing(R::v_max, script.positive(v_greatest))(axis);
  writing(R::a_max, least - 1 + script.positive(a_greatest - least + 1))(axis);
  writing(R::d_max, least - 1 + script.positive(a_greatest - least + 1))(axis);
  writing(R::bow_max, bow)(axis);
  return axis;
}

std::int64_t random_target(Script& script) { return script.either_way(script.positive(1LL << 30)); }

// Somewhere in the present stretch, or its end.
void advance_a_little(Tmc457& axis, Script& script) {
  const auto left = std::min<Tick>(axis.next_change() - axis.tick(), Tick{1} << 62);
  axis.advance_to(axis.tick() +
                  static_cast<Tick>(script.positive(static_cast<std::int64_t>(left))));
}

void expect_within_limits(const Tmc457& axis, const Motion& before, Tick ticks) {
  const auto now = axis.motion();
  const auto a_max = axis.read(R::a_max);
  const auto bow = axis.read(R::bow_max);
  const auto d_max = bow == 0 ? axis.read(R::d_max) : (axis.read(R::d_max) * 15 + 15) / 16;
  ASSERT_LE(std::abs(now.velocity), axis.read(R::v_max));
  const bool slows_down = (now.velocity > 0) != (now.acceleration > 0);
  const auto limit = now.velocity == 0 ? std::max(a_max, d_max) : slows_down ? d_max : a_max;
  ASSERT_LE(std::abs(now.acceleration), limit);
  if (bow == 0) return;
  const auto change = static_cast<double>(std::abs(now.acceleration - before.acceleration));
  const auto jerk = std::exp2(static_cast<double>(bow - 1)) / 1024;
  ASSERT_LE(change, jerk * static_cast<double>(ticks) * (1 + 1e-9) + 1);
}

TEST(Tmc457Property, KeepsItsLimitsAndReachesEveryTarget) {
  int turned = 0;
  constexpr int scripts = 30'000;
  for (std::uint64_t seed = test::seed(); seed < test::seed() + scripts; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Script script(seed);
    auto axis = sound_axis(script);
    bool turns = false;
    for (int target = 0; target < 4; ++target) {
      writing(R::x_target, random_target(script))(axis);
      const auto end = arrival(axis, forever);
      ASSERT_TRUE(end);
      const bool stops_here = target == 3;
      for (int i = 0; !axis.arrived() && (i < 6 || stops_here); ++i) {
        ASSERT_LT(i, 1000);
        const auto before = axis.motion();
        const auto tick = axis.tick();
        if (i > 20) {
          axis.advance_to(axis.next_change());
        } else {
          advance_a_little(axis, script);
        }
        ASSERT_NO_FATAL_FAILURE(expect_within_limits(axis, before, axis.tick() - tick));
        turns |= (before.velocity > 0) != (axis.motion().velocity > 0) && before.velocity != 0;
      }
      if (!stops_here) continue;
      ASSERT_EQ(axis.tick(), *end);
      const Motion there{axis.read(R::x_target), 0, 0};
      ASSERT_EQ(axis.motion(), there);
      axis.advance_to(*end + 1'000'000);
      ASSERT_EQ(axis.motion(), there);
      ASSERT_TRUE(axis.settled());
    }
    turned += turns;
  }
  EXPECT_GT(turned, scripts / 4);
}

TEST(Tmc457Property, NeverTurnsBackOnItsWayFromRest) {
  for (std::uint64_t seed = test::seed(); seed < test::seed() + 30'000; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Script script(seed);
    auto axis = sound_axis(script);
    const auto target = random_target(script);
    writing(R::x_target, target)(axis);
    const auto forward = target < 0 ? -1 : 1;
    const auto end = arrival(axis, forever).value();
    auto before = axis.motion();
    for (int i = 0; i < 30; ++i) {
      const auto tick = script.between(0, static_cast<std::int64_t>(end / 30));
      axis.advance_to(axis.tick() + static_cast<Tick>(tick));
      const auto now = axis.motion();
      ASSERT_GE(now.position * forward, before.position * forward);
      ASSERT_GE(now.velocity * forward, 0);
      before = now;
    }
  }
}

TEST(Tmc457Property, DeceleratesWith15SixteenthsOfDMaxInAnSRamp) {
  int plateaus = 0;
  for (std::uint64_t seed = test::seed(); seed < test::seed() + 10'000; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Script script(seed);
    auto axis = sound_axis(script);
    const auto d_max = std::max(std::int64_t{10'000}, axis.read(R::d_max));
    writing(R::d_max, d_max)(axis);
    writing(R::x_target, random_target(script))(axis);
    while (!axis.arrived()) {
      if (axis.phase() == "VI") {
        ++plateaus;
        ASSERT_NEAR(static_cast<double>(std::abs(axis.motion().acceleration)),
                    0.9375 * static_cast<double>(d_max), 0.001 * static_cast<double>(d_max));
      }
      axis.advance_to(axis.next_change());
    }
  }
  EXPECT_GT(plateaus, 1000);
}

// The reference itself: from wherever the generator is, it comes to the same.
TEST(Tmc457Property, TheReferenceMayBeginInTheMiddleOfAMovement) {
  for (std::uint64_t seed = test::seed(); seed < test::seed() + 1'000; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Script script(seed);
    Tmc457 axis;
    beginning(script)(axis);
    retargeting(script, 0)(axis);
    axis.advance_to(static_cast<Tick>(script.positive(20'000)));
    test::PlainTrack<Tmc457> plain(axis);
    const auto until = axis.tick() + static_cast<Tick>(script.positive(20'000));
    axis.advance_to(until);
    plain.advance_to(until, 1);
    ASSERT_EQ(plain.motion(30, 42), axis.motion());
  }
}

}  // namespace
}  // namespace tmcl::ramp
