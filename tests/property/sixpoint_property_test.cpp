// Random scripts against a model that knows nothing but one tick at a time.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "support/plain_sixpoint.hpp"
#include "support/random.hpp"
#include "support/seed.hpp"
#include "tmcl/ramp/sixpoint.hpp"

namespace tmcl::ramp {
namespace {

using Register = SixPoint::Register;
using test::PlainSixPoint;

// The same axis twice.
struct Pair {
  SixPoint axis;
  PlainSixPoint plain;

  void write(Register name, std::int64_t value) {
    ASSERT_TRUE(axis.write(name, value)) << value;
    const bool was_reached = plain.xactual() == plain.xtarget;
    write_plain(name, value);
    if (!was_reached && plain.xactual() == plain.xtarget) plain.pos_reached_event = true;
  }

  void set_switches(bool left, bool right) {
    axis.set_switches(left, right);
    plain.set_switches(left, right);
  }

  void take_events() {
    axis.take_events();
    plain.pos_reached_event = plain.second_move = plain.latched_l = plain.latched_r = false;
  }

 private:
  void write_plain(Register name, std::int64_t value) {
    const auto set = [&](std::int32_t bit) { return (value & bit) != 0; };
    switch (name) {
      case Register::vstart: plain.vstart = value; return;
      case Register::a1: plain.a1 = value; return;
      case Register::v1: plain.v1 = value; return;
      case Register::amax: plain.amax = value; return;
      case Register::vmax: plain.vmax = value; return;
      case Register::dmax: plain.dmax = value; return;
      case Register::d1: plain.d1 = value; return;
      case Register::vstop: plain.vstop = value; return;
      case Register::tzerowait: plain.tzerowait = value; return;
      case Register::xtarget: plain.xtarget = value; break;
      case Register::rampmode: plain.rampmode = value; break;
      case Register::xactual: plain.x = value * PlainSixPoint::microstep; break;
      case Register::sw_mode:
        plain.stop_l_enable = set(SixPoint::stop_l_enable);
        plain.stop_r_enable = set(SixPoint::stop_r_enable);
        plain.latch_l_active = set(SixPoint::latch_l_active);
        plain.latch_l_inactive = set(SixPoint::latch_l_inactive);
        plain.latch_r_active = set(SixPoint::latch_r_active);
        plain.latch_r_inactive = set(SixPoint::latch_r_inactive);
        plain.soft = set(SixPoint::en_softstop);
        return;
    }
    plain.latched = false;
  }
};

SixPoint::Status status_of(const PlainSixPoint& plain) {
  return {
      .status_stop_l = plain.left,
      .status_stop_r = plain.right,
      .status_latch_l = plain.latched_l,
      .status_latch_r = plain.latched_r,
      .event_stop_l = plain.event_stop_l(),
      .event_stop_r = plain.event_stop_r(),
      .event_pos_reached = plain.pos_reached_event,
      .velocity_reached = std::abs(plain.v) == 256 * plain.vmax,
      .position_reached = plain.xactual() == plain.xtarget,
      .vzero = plain.v == 0,
      .t_zerowait_active = plain.wait > 0,
      .second_move = plain.second_move,
  };
}

void expect_same(const SixPoint& axis, const PlainSixPoint& plain) {
  ASSERT_EQ(axis.tick(), plain.n);
  ASSERT_EQ(axis.exact().position, PlainSixPoint::wrap55(plain.x));
  ASSERT_EQ(axis.exact().velocity, plain.v);
  ASSERT_EQ(axis.motion().position, plain.xactual());
  ASSERT_EQ(axis.motion().velocity, plain.v / 256);
  ASSERT_EQ(axis.motion().acceleration, plain.acceleration);
  ASSERT_EQ(axis.phase(), plain.phase);
  ASSERT_EQ(axis.xlatch(), plain.xlatch);
  ASSERT_TRUE(axis.status() == status_of(plain));
}

class Script : public test::Random<> {
 public:
  using Random::Random;

  std::int64_t any(Register name) { return any_size(greatest(name)); }
  Tick pause() { return static_cast<Tick>(one_in(2) ? any_size(1'500) : between(0, 900)); }

  // Each register over its whole range, in any combination.
  void set_up_anything(Pair& pair) {
    for (const auto name : {Register::vstart, Register::a1, Register::v1, Register::amax,
                            Register::vmax, Register::dmax, Register::d1, Register::vstop}) {
      pair.write(name, any(name));
    }
    pair.write(Register::tzerowait, one_in(2) ? 0 : any_size(300));
    if (one_in(4)) pair.write(Register::xactual, any_position());
    if (one_in(3)) pair.write(Register::v1, 0);
  }

  // Without contradictions, and quick enough for a move to end within some hundred ticks.
  void set_up_sensibly(Pair& pair) {
    const auto vmax = any_size(1'000'000) + 2'000;
    const auto acceleration = [&] {
      return std::clamp<std::int64_t>(vmax * 256 / between(10, 800), 1, greatest(Register::amax));
    };
    for (const auto name : {Register::a1, Register::amax, Register::dmax, Register::d1}) {
      pair.write(name, acceleration());
    }
    pair.write(Register::vmax, vmax);
    pair.write(Register::v1,
               one_in(2) ? 0 : std::min(vmax * between(0, 12) / 10, greatest(Register::v1)));
    const auto vstart = one_in(2) ? 0 : between(0, vmax / 8);
    pair.write(Register::vstart, vstart);
    pair.write(Register::vstop, std::max(vstart, vmax / 50) + between(10, 1'000));
    pair.write(Register::tzerowait, one_in(2) ? 0 : between(1, 100));
  }

  // So that every tick is many microsteps, and the last ones are gone in a few ticks.
  void set_up_coarsely(Pair& pair) {
    set_up_sensibly(pair);
    pair.write(Register::vstop, greatest(Register::vstop) / between(1, 10));
    pair.write(Register::vmax, between(50'000, 1'000'000));
    pair.write(Register::amax, any(Register::amax));
    pair.write(Register::dmax, any(Register::dmax));
  }

  // Near enough to be reached within a script, most of the time.
  std::int64_t target(const Pair& pair) {
    if (one_in(12)) return any_position();
    const auto reach = std::max<std::int64_t>(4, pair.plain.vmax / 50);
    return static_cast<std::int32_t>(pair.plain.xactual() + either_way(any_size(reach)));
  }

  void write_something(Pair& pair) {
    switch (between(0, 15)) {
      case 0: return pair.write(Register::vmax, new_vmax(pair));
      case 1: return pair.write(Register::amax, any(Register::amax));
      case 2: return pair.write(Register::a1, any(Register::a1));
      case 3: return pair.write(Register::dmax, any(Register::dmax));
      case 4: return pair.write(Register::d1, any(Register::d1));
      case 5: return pair.write(Register::v1, one_in(3) ? 0 : any(Register::v1));
      case 6: return pair.write(one_in(2) ? Register::vstart : Register::vstop, any_size(100'000));
      case 7: return pair.write(Register::rampmode, one_in(2) ? 0 : between(0, 3));
      case 8: return pair.write(Register::xactual, target(pair));
      case 9: return use_switches(pair);
      case 10: return pair.take_events();
      default: return pair.write(Register::xtarget, target(pair));
    }
  }

 private:
  static std::int64_t greatest(Register name) {
    return SixPoint::registers()[static_cast<std::size_t>(name)].maximum;
  }

  std::int64_t any_position() {
    if (one_in(2)) return either_way(any_size(INT32_MAX));
    return one_in(2) ? INT32_MIN + any_size(1'000'000) : INT32_MAX - any_size(1'000'000);
  }

  std::int64_t new_vmax(const Pair& pair) {
    return one_in(2) ? pair.plain.vmax * between(0, 10) / 10 : any(Register::vmax);
  }

  void use_switches(Pair& pair) {
    pair.write(Register::sw_mode, any(Register::sw_mode) | SixPoint::stop_l_enable);
    pair.set_switches(one_in(3), one_in(3));
  }
};

// What has to happen in the scripts for them to prove anything, in how many of them.
struct Coverage {
  int scripts = 0, arrivals = 0, braking = 0, cruise = 0, reversals = 0, stops = 0, waits = 0;

  void add(const Coverage& one) {
    ++scripts;
    arrivals += one.arrivals != 0;
    braking += one.braking != 0;
    cruise += one.cruise != 0;
    reversals += one.reversals != 0;
    stops += one.stops != 0;
    waits += one.waits != 0;
  }

  void tick(PlainSixPoint& plain) {
    const auto v = plain.v;
    const bool second_move = plain.second_move;
    plain.tick();
    const bool halts = v != 0 && plain.v == 0;
    arrivals += halts && plain.rampmode == 0 && plain.xactual() == plain.xtarget;
    braking += plain.latched && plain.acceleration != 0;
    cruise += plain.phase == "VMAX";
    reversals += plain.second_move && !second_move;
    stops += halts && ((v < 0 && plain.left) || (v > 0 && plain.right));
    waits += plain.wait > 0;
  }

  void check(std::string_view name, int count, int percent) const {
    testing::Test::RecordProperty(std::string(name), std::to_string(100.0 * count / scripts));
    EXPECT_GE(100 * count, percent * scripts) << name;
  }
};

void set_up(Script& script, Pair& pair) {
  switch (script.between(0, 5)) {
    case 0:
    case 1: script.set_up_anything(pair); break;
    case 2: script.set_up_coarsely(pair); break;
    default: script.set_up_sensibly(pair);
  }
  pair.write(Register::xtarget, script.target(pair));
}

TEST(SixPointProperty, JumpingEqualsTicking) {
  Coverage all;
  for (std::uint64_t seed = test::seed(); seed < test::seed() + 100'000; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Script script(seed);
    Pair pair;
    Coverage here;
    set_up(script, pair);
    for (int step = 0; step < 8; ++step) {
      const auto until = pair.plain.n + script.pause();
      while (pair.plain.n < until) here.tick(pair.plain);
      pair.axis.advance_to(until);
      ASSERT_NO_FATAL_FAILURE(expect_same(pair.axis, pair.plain)) << "step " << step;
      script.write_something(pair);
      ASSERT_NO_FATAL_FAILURE(expect_same(pair.axis, pair.plain)) << "write " << step;
    }
    all.add(here);
  }
  all.check("arrivals", all.arrivals, 40);
  all.check("braking", all.braking, 40);
  all.check("cruise", all.cruise, 20);
  all.check("reversals", all.reversals, 20);
  all.check("stops", all.stops, 5);
  all.check("waits", all.waits, 20);
}

// Up to the tick that next_change() names, only position and speed change; and looking ahead
// changes nothing.
void follow(Pair& pair, Tick until) {
  auto& [axis, plain] = pair;
  while (plain.n < until) {
    const bool settled = axis.settled();
    const auto change = axis.next_change();
    ASSERT_GT(change, plain.n);
    if (plain.v == 0) {
      ASSERT_EQ(settled, change == forever);
    }
    const auto before = plain;
    while (plain.n < until) {
      plain.tick();
      if (settled) {
        ASSERT_EQ(plain.v, before.v);
        ASSERT_EQ(plain.phase, before.phase);
        ASSERT_EQ(plain.acceleration, before.acceleration);
      }
      if (plain.n == change) break;
      ASSERT_TRUE(status_of(plain) == status_of(before)) << plain.n << " before " << change;
      ASSERT_EQ(plain.phase, before.phase) << plain.n << " before " << change;
      ASSERT_EQ(plain.acceleration, before.acceleration) << plain.n << " before " << change;
    }
    axis.advance_to(plain.n);
    ASSERT_NO_FATAL_FAILURE(expect_same(axis, plain));
  }
}

TEST(SixPointProperty, NextChangeMissesNothing) {
  for (std::uint64_t seed = test::seed(); seed < test::seed() + 20'000; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Script script(seed);
    Pair pair;
    set_up(script, pair);
    for (int step = 0; step < 4; ++step) {
      ASSERT_NO_FATAL_FAILURE(follow(pair, pair.plain.n + script.pause()));
      script.write_something(pair);
    }
  }
}

// At half a microstep a tick, from a whole one on: every other tick ends on the very edge between
// two counts.
TEST(SixPointProperty, CountsRightAtTheEdgesOfItsMicrosteps) {
  for (const std::int64_t mode : {1, 2}) {
    Pair pair;
    pair.write(Register::vmax, 1 << 14);
    pair.write(Register::amax, 1 << 15);
    pair.write(Register::rampmode, mode);
    ASSERT_NO_FATAL_FAILURE(follow(pair, 200));
    for (std::int64_t target = -10; target <= 10; ++target) {
      pair.write(Register::xtarget, target);
      pair.write(Register::xactual, 0);
      pair.take_events();
      ASSERT_NO_FATAL_FAILURE(follow(pair, pair.plain.n + 30));
    }
  }
}

// While it brakes for its target, its speed is VMAX in one tick and not in the next.
TEST(SixPointProperty, SeesThatItPassesVmaxWhileItBrakes) {
  for (int below = 0; below < 12; ++below) {
    Pair pair;
    pair.write(Register::vmax, 20'000);
    pair.write(Register::amax, 1'024);
    pair.write(Register::dmax, 1'024);
    pair.write(Register::xtarget, 5'000);
    while (pair.plain.phase != "DMAX" || pair.plain.acceleration == 0) pair.plain.tick();
    pair.axis.advance_to(pair.plain.n);
    pair.write(Register::vmax, pair.plain.v / 256 - below);
    ASSERT_NO_FATAL_FAILURE(follow(pair, pair.plain.n + 100));
  }
}

// VMAX is lowered on the last microsteps, to below VSTOP or to nothing.
TEST(SixPointProperty, SlowsDownThroughVstopBeforeItsTarget) {
  for (std::uint64_t seed = test::seed(); seed < test::seed() + 20'000; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Script script(seed);
    Pair pair;
    const auto vstop = script.any(Register::vstop);
    pair.write(Register::vstop, vstop);
    pair.write(Register::vmax,
               script.one_in(2) ? vstop + 1 + script.any_size(3'000) : 1 + vstop / 2);
    pair.write(Register::amax, 65'535);
    pair.write(Register::rampmode, 1);
    while (pair.plain.phase != "VMAX") pair.plain.tick();
    for (auto n = script.any_size(300); n > 0; --n) pair.plain.tick();
    pair.axis.advance_to(pair.plain.n);
    pair.write(Register::amax, script.any(Register::amax));
    pair.write(Register::dmax, script.any(Register::dmax));
    pair.write(Register::vmax, script.one_in(2) ? 0 : vstop - script.any_size(vstop));
    pair.write(Register::xtarget,
               pair.plain.xactual() + script.between(0, script.one_in(2) ? 1 : 60));
    pair.write(Register::rampmode, 0);
    ASSERT_NO_FATAL_FAILURE(follow(pair, pair.plain.n + 300));
  }
}

// Over times that no tick-by-tick model could follow. A write of what is there already makes it
// forget what it has worked out.
TEST(SixPointProperty, ManyShortAdvancesEqualOneLong) {
  for (std::uint64_t seed = test::seed(); seed < test::seed() + 30'000; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Script script(seed);
    Pair pair;  // whose plain half stays behind
    set_up(script, pair);
    for (int step = 0; step < 10; ++step) {
      script.write_something(pair);
      auto often = pair.axis;
      const auto until = often.tick() + static_cast<Tick>(script.any_size(std::int64_t{1} << 40));
      pair.axis.advance_to(until);
      for (int i = 0; i < 40; ++i) {
        if (script.one_in(8)) often.next_change();
        if (script.one_in(2)) {
          ASSERT_TRUE(often.write(Register::vmax, often.read(Register::vmax)));
        }
        const auto left = static_cast<std::int64_t>(until - often.tick());
        often.advance_to(often.tick() + static_cast<Tick>(script.any_size(left)));
      }
      often.advance_to(until);
      ASSERT_TRUE(pair.axis == often) << "step " << step << ", tick " << until;
    }
  }
}

// The speed may change by this much in a tick: by an acceleration, from standstill to the speeds to
// start and to creep with, and from VSTOP to standstill, be it in the tick that comes down to
// VSTOP.
std::int64_t most_change(const PlainSixPoint& plain, std::int64_t before) {
  const auto a = std::max({plain.a1, plain.amax, plain.dmax, plain.d1});
  if (before == 0) return std::max({a, 256 * plain.vstart, 256 * plain.vstop});
  if (plain.v == 0) return a + 256 * plain.vstop;
  return a;
}

TEST(SixPointProperty, MovesFromRestStraightToItsTargetAndStays) {
  for (std::uint64_t seed = test::seed(); seed < test::seed() + 10'000; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Script script(seed);
    Pair pair;
    script.set_up_sensibly(pair);
    ASSERT_TRUE(pair.axis.findings().empty());
    pair.write(Register::xtarget, script.either_way(script.any_size(pair.plain.vmax / 50)));
    const auto target = pair.plain.xtarget;
    const auto there = arrival(pair.axis, last_tick);
    ASSERT_TRUE(there);
    while (pair.plain.n < *there) {
      const auto before = pair.plain;
      pair.plain.tick();
      ASSERT_EQ(pair.plain.v == 0, pair.plain.n == *there) << pair.plain.n;
      ASSERT_LE(std::abs(pair.plain.v), 256 * pair.plain.vmax);
      ASSERT_LE(std::abs(pair.plain.v - before.v), most_change(pair.plain, before.v));
      ASSERT_GE((pair.plain.x - before.x) * (target < 0 ? -1 : 1), 0);
    }
    ASSERT_EQ(pair.plain.x, target * PlainSixPoint::microstep);
    pair.axis.advance_to(*there);
    ASSERT_NO_FATAL_FAILURE(expect_same(pair.axis, pair.plain));
    pair.axis.advance_to(*there + 1'000'000'000);
    ASSERT_EQ(pair.axis.motion(), (Motion{target, 0, 0}));
    ASSERT_TRUE(pair.axis.settled());
  }
}

// However it was disturbed: with settings that make sense, it finds its target.
TEST(SixPointProperty, ReachesItsTargetFromAnyMotion) {
  for (std::uint64_t seed = test::seed(); seed < test::seed() + 20'000; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Script script(seed);
    Pair pair;
    set_up(script, pair);
    for (int step = 0; step < 5; ++step) {
      pair.axis.advance_to(pair.axis.tick() + script.pause());
      script.write_something(pair);
    }
    script.set_up_sensibly(pair);
    pair.set_switches(false, false);
    pair.write(Register::rampmode, 0);
    pair.write(Register::xtarget, script.either_way(script.any_size(INT32_MAX)));
    const auto there = arrival(pair.axis, last_tick);
    ASSERT_TRUE(there);
    pair.axis.advance_to(*there);
    ASSERT_EQ(pair.axis.motion(), (Motion{pair.plain.xtarget, 0, 0}));
    ASSERT_TRUE(pair.axis.arrived());
  }
}

// The model's own arithmetic.
TEST(SixPointProperty, SumsItsBrakingDistanceAsALoopWould) {
  for (std::uint64_t seed = test::seed(); seed < test::seed() + 2'000; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Script script(seed);
    Pair pair;
    script.set_up_sensibly(pair);
    const auto speed = script.any_size(256 * pair.plain.vmax);
    std::int64_t sum = 0;
    for (auto v = speed; v > 256 * pair.plain.vstop;) sum += v = pair.plain.decelerated(v);
    ASSERT_EQ(pair.plain.brake(speed), sum);
  }
}

}  // namespace
}  // namespace tmcl::ramp
