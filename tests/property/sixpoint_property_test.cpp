// Random scripts against a model that knows nothing but one tick at a time.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <string>

#include "support/plain_sixpoint.hpp"
#include "support/seed.hpp"
#include "tmcl/ramp/sixpoint.hpp"

namespace tmcl::ramp {
namespace {

using Register = SixPoint::Register;

// The same axis twice.
struct Pair {
  SixPoint axis;
  test::PlainSixPoint plain;

  void write(Register name, std::int64_t value) {
    ASSERT_TRUE(axis.write(name, value)) << value;
    const bool was_reached = plain.xactual() == plain.xtarget;
    switch (name) {
      case Register::vstart: plain.vstart = value; break;
      case Register::a1: plain.a1 = value; break;
      case Register::v1: plain.v1 = value; break;
      case Register::amax: plain.amax = value; break;
      case Register::vmax: plain.vmax = value; break;
      case Register::dmax: plain.dmax = value; break;
      case Register::d1: plain.d1 = value; break;
      case Register::vstop: plain.vstop = value; break;
      case Register::tzerowait: plain.tzerowait = value; break;
      case Register::xtarget: plain.xtarget = value; break;
      case Register::rampmode: plain.rampmode = value; break;
      case Register::xactual: plain.x = value * (1 << 23); break;
      case Register::sw_mode:
        plain.stop_l_enable = (value & SixPoint::stop_l_enable) != 0;
        plain.stop_r_enable = (value & SixPoint::stop_r_enable) != 0;
        plain.soft = (value & SixPoint::en_softstop) != 0;
        break;
    }
    if (name == Register::xtarget || name == Register::xactual || name == Register::rampmode) {
      plain.latched = false;
    }
    if (!was_reached && plain.xactual() == plain.xtarget) plain.pos_reached_event = true;
  }

  void set_switches(bool left, bool right) {
    axis.set_switches(left, right);
    plain.left = left;
    plain.right = right;
  }

  void take_events() {
    axis.take_events();
    plain.pos_reached_event = plain.second_move = false;
  }
};

SixPoint::Status status_of(const test::PlainSixPoint& plain) {
  SixPoint::Status status;
  status.status_stop_l = plain.left;
  status.status_stop_r = plain.right;
  status.event_stop_l = plain.event_stop_l();
  status.event_stop_r = plain.event_stop_r();
  status.event_pos_reached = plain.pos_reached_event;
  status.velocity_reached = std::abs(plain.v) == 256 * plain.vmax;
  status.position_reached = plain.xactual() == plain.xtarget;
  status.vzero = plain.v == 0;
  status.t_zerowait_active = plain.wait > 0;
  status.second_move = plain.second_move;
  return status;
}

Motion motion_of(const test::PlainSixPoint& plain) {
  return {plain.xactual(), plain.v / 256, plain.acceleration};
}

void expect_same(const Pair& pair) {
  ASSERT_EQ(pair.axis.tick(), pair.plain.n);
  ASSERT_EQ(pair.axis.motion().position, pair.plain.xactual());
  ASSERT_EQ(pair.axis.motion().velocity, pair.plain.v / 256);
  ASSERT_EQ(pair.axis.phase(), pair.plain.phase);
  ASSERT_EQ(pair.axis.motion(), motion_of(pair.plain));
  ASSERT_TRUE(pair.axis.status() == status_of(pair.plain));
}

class Script {
 public:
  explicit Script(std::uint64_t seed) : random_(seed) {}

  std::int64_t between(std::int64_t low, std::int64_t high) {
    return std::uniform_int_distribution(low, high)(random_);
  }
  bool one_in(std::int64_t n) { return between(1, n) == 1; }
  // Magnitudes of all sizes are equally likely.
  std::int64_t any_size(std::int64_t greatest) {
    std::int64_t size = 0;
    while (greatest >> size != 0) ++size;
    const auto exponent = between(0, size);
    return between(
        exponent == 0 ? 0 : std::int64_t{1} << (exponent - 1),
        std::max<std::int64_t>(0, std::min(greatest, (std::int64_t{1} << exponent) - 1)));
  }
  std::int64_t signed_size(std::int64_t greatest) {
    return one_in(2) ? any_size(greatest) : -any_size(greatest);
  }

  static std::int64_t greatest(Register name) {
    return SixPoint::registers()[static_cast<std::size_t>(name)].maximum;
  }
  std::int64_t any(Register name) { return any_size(greatest(name)); }

  // Over their whole ranges, in any combination.
  void set_up_anything(Pair& pair) {
    for (const auto name : {Register::vstart, Register::a1, Register::v1, Register::amax,
                            Register::vmax, Register::dmax, Register::d1, Register::vstop}) {
      pair.write(name, any(name));
    }
    pair.write(Register::tzerowait, one_in(2) ? 0 : any_size(300));
    if (one_in(4)) pair.write(Register::xactual, any_position());
    if (one_in(3)) pair.write(Register::v1, 0);
  }

  // What one would set, with accelerations so high that a move takes some hundred ticks.
  void set_up_sensibly(Pair& pair) {
    const auto vmax = between(2'000, one_in(4) ? 2'000'000 : 200'000);
    const auto slowest = vmax * 256 / between(10, 800);
    const auto acceleration = [&] {
      return std::clamp<std::int64_t>(slowest * between(10, 40) / 20, 1, 65'535);
    };
    pair.write(Register::vmax, vmax);
    pair.write(Register::a1, acceleration());
    pair.write(Register::amax, acceleration());
    pair.write(Register::dmax, acceleration());
    pair.write(Register::d1, acceleration());
    pair.write(Register::v1,
               one_in(2) ? 0 : std::min(vmax * between(0, 12) / 10, greatest(Register::v1)));
    const auto vstart = one_in(2) ? 0 : between(0, vmax / 8);
    pair.write(Register::vstart, std::min(vstart, greatest(Register::vstart)));
    pair.write(Register::vstop, std::min(std::max(vstart, vmax / 50) + between(10, 1'000),
                                         greatest(Register::vstop)));
    pair.write(Register::tzerowait, one_in(2) ? 0 : between(1, 100));
  }

  std::int64_t any_position() {
    return one_in(3)
               ? (one_in(2) ? INT32_MIN + any_size(1'000'000) : INT32_MAX - any_size(1'000'000))
               : signed_size(INT32_MAX);
  }

  // A target that can be reached within a script, most of the time.
  std::int64_t near_target(const Pair& pair) {
    if (one_in(12)) return any_position();
    const auto reach = std::max<std::int64_t>(4, pair.plain.vmax / 200);
    return static_cast<std::int32_t>(pair.axis.motion().position + signed_size(reach * 4));
  }

  void write_something(Pair& pair) {
    switch (between(0, 15)) {
      case 0: return pair.write(Register::vmax, any_below_now(pair));
      case 1: return pair.write(Register::amax, any(Register::amax));
      case 2: return pair.write(Register::a1, any(Register::a1));
      case 3: return pair.write(Register::dmax, any(Register::dmax));
      case 4: return pair.write(Register::d1, any(Register::d1));
      case 5: return pair.write(Register::v1, one_in(3) ? 0 : any(Register::v1));
      case 6: return pair.write(one_in(2) ? Register::vstart : Register::vstop, any_size(100'000));
      case 7: return pair.write(Register::rampmode, one_in(2) ? 0 : between(0, 3));
      case 8: return pair.write(Register::xactual, near_target(pair));
      case 9: return switches(pair);
      case 10: return pair.take_events();
      default: return pair.write(Register::xtarget, near_target(pair));
    }
  }

 private:
  std::int64_t any_below_now(const Pair& pair) {
    return one_in(2) ? pair.plain.vmax * between(0, 10) / 10 : any(Register::vmax);
  }

  void switches(Pair& pair) {
    const auto bits = SixPoint::stop_l_enable | SixPoint::stop_r_enable | SixPoint::en_softstop;
    pair.write(Register::sw_mode, between(0, 0xFFF) & bits);
    pair.set_switches(one_in(3), one_in(3));
  }

  std::mt19937_64 random_;
};

// How much of what matters the scripts have in them.
struct Seen {
  std::int64_t scripts = 0, ticks = 0, with_arrival = 0, with_braking = 0, with_reversal = 0,
               with_cruise = 0, with_stop = 0, with_wait = 0;
};

struct Events {
  bool arrival = false, braking = false, reversal = false, cruise = false, stop = false,
       wait = false;

  void look(const test::PlainSixPoint& plain, std::int64_t v_before) {
    const bool stopped = plain.v == 0 && v_before != 0;
    arrival |= stopped && plain.rampmode == 0 && plain.xactual() == plain.xtarget;
    braking |= plain.latched && plain.acceleration != 0;
    reversal |= stopped && plain.second_move;
    cruise |= plain.phase == "VMAX";
    stop |= stopped && (plain.left || plain.right);
    wait |= plain.wait > 0;
  }

  void add_to(Seen& seen) const {
    seen.scripts += 1;
    seen.with_arrival += arrival;
    seen.with_braking += braking;
    seen.with_reversal += reversal;
    seen.with_cruise += cruise;
    seen.with_stop += stop;
    seen.with_wait += wait;
  }
};

void report(const Seen& seen) {
  const auto share = [&](std::int64_t n) { return std::to_string(100 * n / seen.scripts) + " %"; };
  testing::Test::RecordProperty("arrivals", share(seen.with_arrival));
  testing::Test::RecordProperty("braking", share(seen.with_braking));
  testing::Test::RecordProperty("reversals", share(seen.with_reversal));
  testing::Test::RecordProperty("cruise", share(seen.with_cruise));
  testing::Test::RecordProperty("stops", share(seen.with_stop));
  testing::Test::RecordProperty("waits", share(seen.with_wait));
}

TEST(SixPointProperty, JumpingEqualsTicking) {
  Seen seen;
  for (std::uint64_t seed = test::seed(); seed < test::seed() + 100'000; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Script script(seed);
    Pair pair;
    Events events;
    script.one_in(3) ? script.set_up_anything(pair) : script.set_up_sensibly(pair);
    for (int step = 0; step < 8; ++step) {
      if (step == 0) {
        pair.write(Register::xtarget, script.near_target(pair));
      } else {
        script.write_something(pair);
      }
      const auto until = pair.plain.n + static_cast<Tick>(script.any_size(800));
      while (pair.plain.n < until) {
        const auto before = pair.plain.v;
        pair.plain.tick();
        events.look(pair.plain, before);
      }
      pair.axis.advance_to(until);
      ASSERT_NO_FATAL_FAILURE(expect_same(pair)) << "step " << step << ", tick " << until;
    }
    events.add_to(seen);
    seen.ticks += static_cast<std::int64_t>(pair.plain.n);
  }
  report(seen);
  // If this fails, the scripts no longer contain what they are to test.
  EXPECT_GT(seen.with_arrival, seen.scripts / 4);
  EXPECT_GT(seen.with_reversal, seen.scripts / 10);
  EXPECT_GT(seen.with_cruise, seen.scripts / 4);
  EXPECT_GT(seen.with_stop, seen.scripts / 50);
}

}  // namespace
}  // namespace tmcl::ramp
