// Random scripts against additions tick by tick, what is true of all movements, and how fast they
// are.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>

#include "support/plain_track.hpp"
#include "support/random.hpp"
#include "support/rounds.hpp"
#include "support/seed.hpp"
#include "tmcl/plan/trajectory.hpp"
#include "tmcl/ramp/tmc4361.hpp"

namespace tmcl::ramp {
namespace {

using R = Tmc4361::Register;
using Mode = Tmc4361::Mode;

constexpr std::int64_t v_greatest = INT32_MAX;
constexpr std::int64_t a_greatest = (1 << 24) - 1;
constexpr std::int64_t bow_greatest = (1 << 24) - 1;
constexpr std::array bow_names{R::bow1, R::bow2, R::bow3, R::bow4};

const double per_second = Tmc4361::ticks_per_second(16e6);

// In microsteps and ticks.
double speed_of(std::int64_t vmax) { return static_cast<double>(vmax) / 256 / per_second; }
double force_of(std::int64_t amax) {
  return static_cast<double>(amax) / 4 / per_second / per_second;
}
double bow_of(std::int64_t bow) { return static_cast<double>(bow) / std::pow(per_second, 3); }

class Script : public test::Random<> {
 public:
  using Random::Random;

  // Forces so great that movements take some thousand ticks.
  std::int64_t strong() { return between(1 << 21, a_greatest); }
  std::int64_t strong_bow() { return between(1 << 22, bow_greatest); }
  std::int64_t any_bow() {
    return one_in(6) ? 0 : one_in(3) ? positive(bow_greatest) : strong_bow();
  }
};

// Something that is done to an axis.
using Change = std::function<void(Tmc4361&)>;

Change writing(R name, std::int64_t value) {
  return [=](Tmc4361& axis) { ASSERT_TRUE(axis.write(name, value)); };
}

Change beginning(Script& script) {
  const bool strong = !script.one_in(3);
  const auto v = strong ? script.between(1 << 18, 1 << 23) : script.positive(v_greatest);
  const auto a = strong ? script.strong() : script.positive(a_greatest);
  const auto d = strong ? script.strong() : script.positive(a_greatest);
  std::array<std::int64_t, 4> bows{};
  for (auto& bow : bows) bow = script.any_bow();
  if (script.one_in(2)) bows[3] = bows[1];
  return [=](Tmc4361& axis) {
    writing(R::vmax, v)(axis);
    writing(R::amax, a)(axis);
    writing(R::dmax, d)(axis);
    writing(R::dstop, a)(axis);
    for (std::size_t i = 0; i < bows.size(); ++i) writing(bow_names[i], bows[i])(axis);
  };
}

Change switching(Script& script) {
  const auto enable_l = script.between(0, 1), enable_r = script.between(0, 1);
  const auto soft = script.between(0, 1);
  const bool left = script.one_in(3), right = script.one_in(3);
  return [=](Tmc4361& axis) {
    writing(R::stop_left_en, enable_l)(axis);
    writing(R::stop_right_en, enable_r)(axis);
    writing(R::soft_stop_en, soft)(axis);
    axis.set_switches(left, right);
  };
}

Change retargeting(Script& script, std::int64_t position) {
  const auto far = script.one_in(8) ? script.positive(1LL << 31) - 1 : script.positive(3000);
  return writing(R::xtarget,
                 std::clamp<std::int64_t>(position + script.either_way(far), INT32_MIN, INT32_MAX));
}

Change anything(Script& script, std::int64_t position) {
  const auto force = script.one_in(4) ? script.any_size(a_greatest) : script.strong();
  const auto bow = bow_names[static_cast<std::size_t>(script.between(0, 3))];
  switch (script.between(0, 15)) {
    case 0: return writing(R::vmax, script.either_way(script.any_size(v_greatest)));
    case 1: return writing(R::vmax, script.either_way(script.between(1 << 18, 1 << 23)));
    case 2: return writing(R::amax, force);
    case 3: return writing(R::dmax, force);
    case 4:
    case 5: return writing(bow, script.any_bow());
    case 6: return writing(R::xactual, script.either_way(script.positive(1LL << 31) - 1));
    case 7: return writing(R::rampmode, script.one_in(2) ? 2 : 6);
    case 8: return switching(script);
    case 9: return [](Tmc4361& axis) { axis.halt(); };
    default: return retargeting(script, position);
  }
}

// The most that the acceleration may change in a tick while nothing is written: of a bow of 0, the
// greatest acceleration within 16 ticks. Any amount at switches.
double jerk_of(const Tmc4361& axis) {
  double most = 0;
  for (const auto name : bow_names) {
    const auto bow = axis.read(name);
    most = std::max(most, bow == 0 ? force_of(a_greatest) / 16 : bow_of(bow));
  }
  const bool jumps = axis.read(R::stop_left_en) != 0 || axis.read(R::stop_right_en) != 0;
  return jumps ? 100 : most;
}

// One by jumps, the other by additions.
class Pair {
 public:
  const Tmc4361& chip() const { return chip_; }

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
    auto& planner = plain_.planner();
    ASSERT_EQ(chip_.motion(), planner.motion());
    ASSERT_EQ(chip_.phase(), planner.phase());
    ASSERT_EQ(chip_.arrived(), planner.arrived());
    ASSERT_EQ(chip_.settled(), planner.settled());
    ASSERT_EQ(chip_.next_change(), planner.next_change());
  }

 private:
  Tmc4361 chip_;
  test::PlainTrack<Tmc4361> plain_;
};

// What has been seen in a script, or in how many scripts.
struct Seen {
  int arrival = 0, reversal = 0, replan = 0, stop = 0;

  void watch(const Motion& before, bool stood, const Tmc4361& now) {
    const auto velocity = now.motion().velocity;
    arrival |= now.arrived() && !stood;
    reversal |= (before.velocity > 0 && velocity < 0) || (before.velocity < 0 && velocity > 0);
    stop |= now.phase() == "stop";
  }
  void add(const Seen& other) {
    arrival += other.arrival;
    reversal += other.reversal;
    replan += other.replan;
    stop += other.stop;
  }
};

// Often to the end of the stretch, so that movements come to their end.
Tick pause(Script& script, Tmc4361 axis) {
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

TEST(Tmc4361Property, JumpingEqualsTicking) {
  const int scripts = test::rounds(100'000);
  Seen all;
  for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(scripts); ++i) {
    const auto seed = test::seed() + i;
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Seen seen;
    ASSERT_NO_FATAL_FAILURE(run_script(seed, seen));
    all.add(seen);
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(all.arrival, scripts / 12);
  EXPECT_GT(all.reversal, scripts / 12);
  EXPECT_GT(all.replan, scripts / 2);
  EXPECT_GT(all.stop, scripts / 500);
}

TEST(Tmc4361Property, ManyShortAdvancesEqualOneLong) {
  for (std::uint64_t seed = test::seed(); seed < test::seed() + 10'000; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Script script(seed);
    Tmc4361 once;
    beginning(script)(once);
    for (int step = 0; step < 10; ++step) {
      anything(script, once.motion().position)(once);
      auto often = once;
      const auto pause = script.positive(1 << 20);
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

// Registers that go together.
Tmc4361 sound_axis(Script& script) {
  Tmc4361 axis;
  writing(R::vmax, script.between(256, v_greatest / 4))(axis);
  writing(R::amax, script.between(1 << 10, a_greatest))(axis);
  writing(R::dmax, script.between(1 << 10, a_greatest))(axis);
  for (const auto name : bow_names) writing(name, script.between(1 << 10, bow_greatest))(axis);
  if (script.one_in(2)) writing(R::bow4, axis.read(R::bow2))(axis);
  return axis;
}

std::int64_t random_target(Script& script) { return script.either_way(script.positive(1LL << 30)); }

// Somewhere in the present stretch, or its end.
void advance_a_little(Tmc4361& axis, Script& script) {
  const auto left = std::min<Tick>(axis.next_change() - axis.tick(), Tick{1} << 62);
  axis.advance_to(axis.tick() +
                  static_cast<Tick>(script.positive(static_cast<std::int64_t>(left))));
}

// What acts in this stretch, told by the state at its ends and nothing else.
void expect_within_limits(const Tmc4361& axis, const Cubic& before, Tick ticks) {
  const auto now = axis.track().at(axis.tick());
  const double v = to_double(now.v), a = to_double(2 * now.h);
  const double v0 = to_double(before.v), a0 = to_double(2 * before.h);
  constexpr double more = 1 + 1e-9;
  ASSERT_LE(std::abs(v), speed_of(axis.read(R::vmax)) * more);
  const double amax = force_of(axis.read(R::amax)), dmax = force_of(axis.read(R::dmax));
  const bool slows = v * a < 0;
  const bool stands = std::abs(v) < 1e-6 * speed_of(axis.read(R::vmax));
  ASSERT_LE(std::abs(a), (stands ? std::max(amax, dmax) : slows ? dmax : amax) * more);
  if (v0 * v <= 0 || a0 * a < 0 || a == a0) return;  // more than one bow
  const bool falls = std::abs(a) < std::abs(a0);
  const bool slowed = v * (a + a0) < 0;
  const auto bow = slowed ? falls ? R::bow4 : R::bow3 : falls ? R::bow2 : R::bow1;
  ASSERT_LE(std::abs(a - a0), bow_of(axis.read(bow)) * static_cast<double>(ticks) * (1 + 1e-6))
      << axis.phase();
}

// The bow is told apart as long as no phase ends meanwhile.
TEST(Tmc4361Property, KeepsItsLimitsAndReachesEveryTarget) {
  int turned = 0;
  const int scripts = test::rounds(30'000);
  for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(scripts); ++i) {
    const auto seed = test::seed() + i;
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Script script(seed);
    auto axis = sound_axis(script);
    bool turns = false;
    for (int target = 0; target < 4; ++target) {
      writing(R::xtarget, random_target(script))(axis);
      const auto end = arrival(axis, forever);
      ASSERT_TRUE(end);
      const bool stops_here = target == 3;
      for (int step = 0; !axis.arrived() && (step < 6 || stops_here); ++step) {
        ASSERT_LT(step, 1000);
        axis.next_change();
        const auto before = axis.track().at(axis.tick());
        const auto tick = axis.tick();
        const auto heading = axis.heading();
        if (step > 20) {
          axis.advance_to(axis.next_change());
        } else {
          advance_a_little(axis, script);
        }
        ASSERT_NO_FATAL_FAILURE(expect_within_limits(axis, before, axis.tick() - tick));
        turns |= heading * axis.heading() < 0;
      }
      if (!stops_here) continue;
      ASSERT_EQ(axis.tick(), *end);
      const Motion there{axis.read(R::xtarget), 0, 0};
      ASSERT_EQ(axis.motion(), there);
      axis.advance_to(*end + 1'000'000);
      ASSERT_EQ(axis.motion(), there);
      ASSERT_TRUE(axis.settled());
    }
    turned += turns;
  }
  EXPECT_GT(turned, scripts / 8);
}

TEST(Tmc4361Property, NeverTurnsBackOnItsWayFromRest) {
  for (std::uint64_t seed = test::seed(); seed < test::seed() + 30'000; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Script script(seed);
    auto axis = sound_axis(script);
    const auto target = random_target(script);
    writing(R::xtarget, target)(axis);
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

// One side of a movement from rest to rest, by the sums of its three phases and nothing else.
struct Side {
  double duration = 0, distance = 0, velocity = 0, acceleration = 0;

  void phase(double t, double jerk) {
    distance += t * (velocity + t * (acceleration / 2 + t * jerk / 6));
    velocity += t * (acceleration + t * jerk / 2);
    acceleration += t * jerk;
    duration += t;
  }
};

Side side(double v, double limit, double up, double down) {
  const double steepest = std::sqrt(2 * v / (1 / up + 1 / down));
  const double a = std::min(limit, steepest);
  Side result;
  result.phase(a / up, up);
  result.phase((v - a * a / 2 / up - a * a / 2 / down) / a, 0);
  result.phase(a / down, -down);
  return result;
}

double rest_to_rest(const Tmc4361& axis, double distance) {
  const auto bow = [&](R name) { return bow_of(axis.read(name)); };
  const auto both = [&](double v) {
    const auto rise = side(v, force_of(axis.read(R::amax)), bow(R::bow1), bow(R::bow2));
    // A falling slope is a rising one that runs backwards.
    const auto fall = side(v, force_of(axis.read(R::dmax)), bow(R::bow4), bow(R::bow3));
    return Side{rise.duration + fall.duration, rise.distance + fall.distance};
  };
  double low = 0, high = speed_of(axis.read(R::vmax));
  if (const auto full = both(high); full.distance <= distance) {
    return full.duration + (distance - full.distance) / high;
  }
  for (int i = 0; i < 200; ++i) {
    const double middle = (low + high) / 2;
    (both(middle).distance < distance ? low : high) = middle;
  }
  return both(high).duration;
}

TEST(Tmc4361Property, TakesTheTimeOfTheSevenPhasesFromRestToRest) {
  const int scripts = test::rounds(20'000);
  for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(scripts); ++i) {
    const auto seed = test::seed() + i;
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Script script(seed);
    auto axis = sound_axis(script);
    const auto target = random_target(script);
    writing(R::xtarget, target)(axis);
    const double expected = rest_to_rest(axis, static_cast<double>(std::abs(target)));
    const auto end = static_cast<double>(arrival(axis, forever).value());
    ASSERT_NEAR(end, expected, 1 + 1e-9 * expected);
  }
}

// The library's planner of trajectories shares no code with the generator. Both are the fastest
// where the limits are symmetric; then they are as fast as each other, from any state.
TEST(Tmc4361Property, IsAsFastAsThePlannerWhereItsLimitsAreSymmetric) {
  constexpr double rounded = 0.01;  // microsteps
  const int scripts = test::rounds(20'000);
  for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(scripts); ++i) {
    const auto seed = test::seed() + i;
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Script script(seed);
    auto axis = sound_axis(script);
    writing(R::dmax, axis.read(R::amax))(axis);
    for (const auto name : bow_names) writing(name, axis.read(R::bow1))(axis);
    writing(R::xtarget, random_target(script))(axis);
    for (auto steps = script.between(0, 6); steps > 0; --steps) advance_a_little(axis, script);
    const auto now = axis.track().at(axis.tick());
    const plan::State start{0, to_double(now.v), to_double(2 * now.h)};
    const auto from = axis.motion().position;
    const auto target = std::clamp<std::int64_t>(
        from + script.either_way(script.positive(1LL << 29)), INT32_MIN, INT32_MAX);
    writing(R::xtarget, target)(axis);
    const double distance = static_cast<double>(target) - to_double(now.x);
    const auto acceleration = force_of(axis.read(R::amax));
    const plan::Limits limits{speed_of(axis.read(R::vmax)), acceleration, acceleration,
                              bow_of(axis.read(R::bow1))};
    const auto ticks_to = [&](double position) {
      return plan::plan_move(start, {position, 0, 0}, limits).value().duration();
    };
    auto least = ticks_to(distance);
    auto greatest = least;
    // Near the place where the axis comes to rest by itself, the time goes by the cube root of the
    // distance: what is rounded to whole ticks and positions is worth many ticks there.
    const auto rest = plan::plan_velocity(start, 0, limits).value();
    if (std::abs(rest.at(rest.duration()).position - distance) < rounded) {
      least = rest.duration();
      greatest = std::max({greatest, ticks_to(distance - rounded), ticks_to(distance + rounded)});
    }
    const auto ticks = static_cast<double>(arrival(axis, forever).value() - axis.tick());
    ASSERT_GE(ticks, least - 1.5 - 1e-7 * least);
    ASSERT_LE(ticks, greatest + 1.5 + 1e-7 * greatest);
  }
}

}  // namespace
}  // namespace tmcl::ramp
