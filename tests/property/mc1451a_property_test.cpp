// Random movements against additions tick by tick, and what is true of all of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "support/plain_track.hpp"
#include "support/random.hpp"
#include "support/seed.hpp"
#include "tmcl/ramp/mc1451a.hpp"

namespace tmcl::ramp {
namespace {

using R = Mc1451a::Register;

struct Parameters {
  std::int64_t profile, position, velocity, acceleration, jerk;
};

class Script : public test::Random<> {
 public:
  using Random::Random;

  Parameters parameters() {
    return {between(0, 1), either_way(positive(1 << 30)) * between(0, 99) / 100,
            positive(1'073'741'823), positive(32'767), positive(2'147'483'647)};
  }
  // For movements that take some thousand ticks.
  Parameters quick() {
    return {between(0, 1), either_way(positive(5'000)), (1 << 14) + positive(1 << 26),
            (1 << 9) + positive(1 << 14), (1 << 20) + positive(1 << 30)};
  }
};

void write(Mc1451a& axis, const Parameters& parameters) {
  ASSERT_TRUE(axis.write(R::profile, parameters.profile));
  ASSERT_TRUE(axis.write(R::velocity, parameters.velocity));
  ASSERT_TRUE(axis.write(R::acceleration, parameters.acceleration));
  ASSERT_TRUE(axis.write(R::jerk, parameters.jerk));
  ASSERT_TRUE(axis.write(R::position, parameters.position));
}

// The most that the acceleration may change in a tick; any amount in a trapezoid.
double jerk_of(const Parameters& parameters) {
  return parameters.profile == 1 ? 1 : static_cast<double>(parameters.jerk) * 0x1p-44;
}

TEST(Mc1451aProperty, JumpingEqualsTicking) {
  int complete = 0;
  int refused = 0;
  constexpr int scripts = 100'000;
  for (std::uint64_t seed = test::seed(); seed < test::seed() + scripts; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Script script(seed);
    Mc1451a axis;
    test::PlainTrack<Mc1451a> plain;
    auto parameters = script.between(0, 2) == 0 ? script.parameters() : script.quick();
    Tick tick = 0;
    for (int step = 0; step < 20; ++step) {
      if (axis.arrived()) {
        complete += step > 0 ? 1 : 0;
        write(axis, parameters);
        plain.change([&](Mc1451a& planner) { write(planner, parameters); });
      } else if (script.between(0, 3) == 0 && axis.motion().velocity != 0 &&
                 axis.read(R::profile) == 0) {
        ASSERT_FALSE(axis.write(R::velocity, 1));
        plain.change([&](Mc1451a& planner) { ASSERT_FALSE(planner.write(R::velocity, 1)); });
        ++refused;
      }
      tick += static_cast<Tick>(script.positive(3'000));
      plain.advance_to(tick, jerk_of(parameters));
      axis.advance_to(tick);
      ASSERT_EQ(axis.track().at(tick), plain.state()) << "step " << step << ", tick " << tick;
      ASSERT_EQ(axis.motion(), plain.motion(20, 24)) << "step " << step << ", tick " << tick;
      ASSERT_EQ(axis.phase(), plain.planner().phase());
      ASSERT_EQ(axis.arrived(), plain.planner().arrived());
      if (axis.arrived()) parameters = script.quick();
    }
  }
  EXPECT_GT(complete, scripts / 2);
  EXPECT_GT(refused, scripts / 10);
}

TEST(Mc1451aProperty, ManyShortAdvancesEqualOneLong) {
  for (std::uint64_t seed = test::seed(); seed < test::seed() + 20'000; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Script script(seed);
    Mc1451a once;
    write(once, script.parameters());
    auto often = once;
    const auto last = script.positive(1LL << 40);
    once.advance_to(static_cast<Tick>(last));
    for (int i = 0; i < 30; ++i) often.advance_to(static_cast<Tick>(script.positive(last)));
    often.advance_to(static_cast<Tick>(last));
    ASSERT_TRUE(once == often) << last;
  }
}

struct Move {
  Parameters parameters;
  Mc1451a axis;
  Tick end;
};

Move random_move(Script& script) {
  Move move{script.parameters(), {}, 0};
  write(move.axis, move.parameters);
  move.end = arrival(move.axis, forever).value();
  return move;
}

TEST(Mc1451aProperty, KeepsItsLimitsAndNeverTurnsBack) {
  for (std::uint64_t seed = test::seed(); seed < test::seed() + 20'000; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Script script(seed);
    auto [parameters, axis, end] = random_move(script);
    auto before = axis.motion();
    for (int i = 0; i < 30 && !axis.arrived(); ++i) {
      const auto from = axis.tick();
      axis.advance_to(std::min(axis.next_change(),
                               from + static_cast<Tick>(script.positive(std::max<std::int64_t>(
                                          1, static_cast<std::int64_t>(end / 4))))));
      const auto now = axis.motion();
      ASSERT_LE(std::abs(now.velocity), parameters.velocity);
      ASSERT_LE(std::abs(now.acceleration), parameters.acceleration);
      const double ticks = static_cast<double>(axis.tick() - from);
      if (parameters.profile == 0) {
        ASSERT_LE(static_cast<double>(std::abs(now.acceleration - before.acceleration)),
                  static_cast<double>(parameters.jerk) * 0x1p-20 * ticks * (1 + 1e-9) + 1);
      }
      const auto forward = parameters.position < 0 ? -1 : 1;
      ASSERT_GE(now.position * forward, before.position * forward);
      ASSERT_GE(now.velocity * forward, 0);
      before = now;
    }
  }
}

TEST(Mc1451aProperty, ReachesEveryTargetExactlyAndStaysThere) {
  for (std::uint64_t seed = test::seed(); seed < test::seed() + 20'000; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Script script(seed);
    auto [parameters, axis, end] = random_move(script);
    if (end > 0) {
      axis.advance_to(end - 1);
      ASSERT_FALSE(axis.arrived());
    }
    axis.advance_to(end);
    ASSERT_TRUE(axis.arrived());
    const Motion there{parameters.position, 0, 0};
    ASSERT_EQ(axis.motion(), there);
    axis.advance_to(end + 1'000'000);
    ASSERT_EQ(axis.motion(), there);
    ASSERT_EQ(axis.next_change(), forever);
  }
}

/// A trapezoid that gets other parameters on its way.
class ChangedTrapezoid {
 public:
  explicit ChangedTrapezoid(Script& script) : script_(script) {
    auto parameters = script.quick();
    parameters.profile = 1;
    write(axis_, parameters);
  }
  void change() {
    const auto other = script_.quick();
    switch (script_.between(0, 2)) {
      case 0: ASSERT_TRUE(axis_.write(R::position, other.position)); break;
      case 1: ASSERT_TRUE(axis_.write(R::velocity, other.velocity)); break;
      default: ASSERT_TRUE(axis_.write(R::acceleration, other.acceleration));
    }
    ASSERT_FALSE(axis_.motion().velocity != 0 && axis_.write(R::profile, 0));
  }
  // Never faster than it may be, unless it was and slows down; the speed changes by as much as the
  // acceleration allows, and nothing jumps.
  void advance(Tick ticks) {
    for (Tick i = 0; i < ticks && !axis_.arrived(); ++i) {
      const auto before = axis_.motion();
      axis_.advance_to(axis_.tick() + 1);
      const auto now = axis_.motion();
      const auto most = std::max(axis_.read(R::velocity), std::abs(before.velocity));
      ASSERT_LE(std::abs(now.velocity), most + 1) << axis_.tick();
      const auto a = axis_.read(R::acceleration);
      ASSERT_LE(std::abs(now.acceleration), a) << axis_.tick();
      ASSERT_LE(std::abs(now.velocity - before.velocity), a / 16 + 2) << axis_.tick();
      ASSERT_LE(std::abs(now.position - before.position), (most >> 20) + 2) << axis_.tick();
    }
  }
  void expect_end() {
    const auto end = arrival(axis_, forever);
    ASSERT_TRUE(end);
    axis_.advance_to(*end);
    const Motion there{axis_.read(R::position), 0, 0};
    ASSERT_EQ(axis_.motion(), there);
    axis_.advance_to(*end + 1000);
    ASSERT_EQ(axis_.motion(), there);
  }

 private:
  Script& script_;
  Mc1451a axis_;
};

TEST(Mc1451aProperty, AChangedTrapezoidKeepsItsLimitsAndEndsAtItsTarget) {
  for (std::uint64_t seed = test::seed(); seed < test::seed() + 2'000; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Script script(seed);
    ChangedTrapezoid axis(script);
    for (int i = 0; i < 6; ++i) {
      axis.advance(static_cast<Tick>(script.positive(2'000)));
      axis.change();
      if (testing::Test::HasFailure()) return;
    }
    axis.expect_end();
    if (HasFatalFailure()) return;
  }
}

// However little of a tick they last.
TEST(Mc1451aProperty, HasItsPhasesInTheirOrder) {
  static constexpr std::array<std::string_view, 7> order{"I", "II", "III", "IV", "V", "VI", "VII"};
  int tiny = 0;
  for (std::uint64_t seed = test::seed(); seed < test::seed() + 50'000; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Script script(seed);
    auto parameters = script.parameters();
    parameters.profile = 0;
    if (script.between(0, 1) == 0) parameters.velocity = script.between(1, 20);
    Mc1451a axis;
    write(axis, parameters);
    std::size_t last = 0;
    for (bool first = true; !axis.settled(); first = false) {
      const auto* const phase = std::ranges::find(order, axis.phase());
      ASSERT_NE(phase, order.end()) << axis.phase();
      const auto place = static_cast<std::size_t>(phase - order.begin());
      ASSERT_TRUE(first || place >= last) << axis.phase() << " after " << order[last];
      last = place;
      axis.advance_to(axis.next_change());
    }
    tiny += axis.tick() < 16 ? 1 : 0;
  }
  EXPECT_GT(tiny, 0);
}

// The end falls between two ticks, so the mirror image may be off by the way of one.
TEST(Mc1451aProperty, SlowsDownAsItHasSpedUp) {
  for (std::uint64_t seed = test::seed(); seed < test::seed() + 20'000; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Script script(seed);
    auto [parameters, early, end] = random_move(script);
    auto late = early;
    const auto tick = static_cast<Tick>(script.between(0, static_cast<std::int64_t>(end / 2)));
    early.advance_to(tick);
    late.advance_to(end - tick);
    const auto way_of_a_tick = static_cast<double>(std::abs(early.motion().velocity)) * 0x1p-20;
    const auto off = early.motion().position + late.motion().position - parameters.position;
    // One for rounding, and what the acceleration adds within the tick.
    ASSERT_LE(static_cast<double>(std::abs(off)),
              way_of_a_tick + 1 + static_cast<double>(parameters.acceleration) * 0x1p-23)
        << "tick " << tick << " of " << end;
  }
}

}  // namespace
}  // namespace tmcl::ramp
