#include "motion/ramp/s_curve.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "support/seed.hpp"

namespace tmcl::ramp {
namespace {

// Lengths are far above the distance that counts as nothing.
constexpr double scale = 1e6;
constexpr double no_jerk_limit = std::numeric_limits<double>::infinity();

struct State {
  double x = 0, v = 0, a = 0;
};

double force_of(const Course& course, const Forces& forces) {
  const double sign = course.negative ? -1 : 1;
  if (course.force == Course::Force::acceleration) return sign * forces.acceleration;
  if (course.force == Course::Force::deceleration) return sign * forces.deceleration;
  return 0;
}

// The state at the end of each stretch, after that at the beginning.
std::vector<State> nodes(const Profile& profile, Moving from, const Forces& forces) {
  std::vector<State> result{{0, from.velocity, from.acceleration}};
  for (std::size_t i = 0; i < profile.count; ++i) {
    auto [x, v, a] = result.back();
    const double t = profile.ticks[i];
    const auto& course = profile.courses[i];
    double jerk = 0;
    if (const double bow = forces.bows.of(course.force); bow > 0) {
      jerk = course.negative ? -bow : bow;
    } else {
      a = force_of(course, forces);
    }
    result.push_back(
        {x + t * (v + t * (a / 2 + t * jerk / 6)), v + t * (a + t * jerk / 2), a + t * jerk});
  }
  return result;
}

struct Side {
  double duration;
  double distance;
};

// From rest to a velocity, or back, in the closed form that data sheets and application notes give.
Side side(double v, double a, double j) {
  const double t = std::isinf(j) ? v / a : a * a / j <= v ? v / a + a / j : 2 * std::sqrt(v / j);
  return {t, v * t / 2};
}

double rest_to_rest(double distance, double v_max, const Forces& forces) {
  const auto both = [&](double v) {
    const auto up = side(v, forces.acceleration, forces.bows.first);
    const auto down = side(v, forces.deceleration, forces.bows.first);
    return Side{up.duration + down.duration, up.distance + down.distance};
  };
  if (const auto full = both(v_max); full.distance <= distance) {
    return full.duration + (distance - full.distance) / v_max;
  }
  double low = 0, high = v_max;
  for (int i = 0; i < 200; ++i) {
    const double middle = (low + high) / 2;
    (both(middle).distance < distance ? low : high) = middle;
  }
  return both(high).duration;
}

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : random_(seed) {}
  double between(double low, double high) {
    return std::uniform_real_distribution<>(low, high)(random_);
  }
  double any_size(double low, double high) {
    return std::exp(between(std::log(low), std::log(high)));
  }
  bool coin() { return between(0, 1) < 0.5; }

  Forces forces() {
    const double acceleration = scale * any_size(0.1, 10);
    return {acceleration,
            coin() ? acceleration : scale * any_size(0.1, 10),
            {scale * any_size(0.1, 10)}};
  }

 private:
  std::mt19937_64 random_;
};

TEST(SCurve, TakesTheTimeOfTheClosedFormFromRestToRest) {
  for (std::uint64_t seed = test::seed(); seed < test::seed() + 20'000; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Dice dice(seed);
    auto forces = dice.forces();
    if (dice.between(0, 5) < 1) forces.bows = {no_jerk_limit};
    const double v_max = scale * dice.any_size(0.1, 10);
    const double distance = scale * dice.any_size(0.01, 100);
    const auto profile = plan_move({0, 0}, distance, {v_max, 0}, forces);
    const double expected = rest_to_rest(distance, v_max, forces);
    ASSERT_NEAR(profile.duration(), expected, 1e-9 * expected);
    ASSERT_TRUE(profile.arrives);
    const auto back = plan_move({0, 0}, -distance, {0, v_max}, forces);
    ASSERT_EQ(back.duration(), profile.duration());
  }
}

// The time-optimal durations were calculated with the library Ruckig, which shares nothing with
// this one. Acceleration and deceleration are the same.
TEST(SCurve, IsAsFastAsAnIndependentSolutionFromAnyState) {
  struct Case {
    double v, a, distance, v_max, a_max, jerk, duration;
  };
  constexpr Case cases[] = {
      {0, 0, -3.25, 2.75, 1.25, 5, 3.48457879793},
      {0, 0, 2.25, 3.25, 2, 5.75, 2.49747326423},
      {-2, -2.25, -10.25, 4, 2.25, 3.25, 4.03099831525},
      {-0.875, 0.375, 1, 3.5, 1.5, 3, 2.95795736815},
      {0, 0.6875, 9.25, 1, 2.75, 2.25, 10.3641281366},
      {-0.8125, 0.75, 3.25, 3.25, 0.75, 7.25, 5.57274162996},
      {0.75, 2.0625, 2.75, 3, 2.75, 3.5, 2.33882678762},
      {2.4375, -3, 9.75, 3.25, 4, 3, 5.22323554598},
      {-2.8125, 0, 6.5, 3.75, 3.75, 6.25, 4.58958333333},
      {0.3125, 0.375, -7.25, 1.25, 1.5, 1.75, 8.15204732446},
      {0, -1.125, 2, 3, 2.25, 4.5, 2.79177631275},
      {1.75, -1, 3, 3.5, 4, 7.75, 1.91740980606},
      {0.3125, -1.125, -1.5, 1.25, 2.25, 3.25, 2.38708791522},
      {3.25, 0, -6.25, 3.25, 4, 4.25, 5.36372802586},
  };
  for (const auto& c : cases) {
    const Forces forces{c.a_max * scale, c.a_max * scale, {c.jerk * scale}};
    const auto profile = plan_move({c.v * scale, c.a * scale}, c.distance * scale,
                                   {c.v_max * scale, c.v_max * scale}, forces);
    EXPECT_NEAR(profile.duration(), c.duration, 1e-11 * c.duration) << c.distance;
  }
}

TEST(SCurve, EndsOnTheTargetWithinItsLimitsFromAnyState) {
  for (std::uint64_t seed = test::seed(); seed < test::seed() + 50'000; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Dice dice(seed);
    auto forces = dice.forces();
    if (dice.between(0, 5) < 1) forces.bows = {no_jerk_limit};
    const double v_max = scale * dice.any_size(0.1, 10);
    const double distance = scale * dice.between(-10, 10);
    // Some are too fast, and some have more acceleration than they may.
    const Moving from{
        v_max * dice.between(-1.5, 1.5),
        std::isinf(forces.bows.first) ? 0 : forces.acceleration * dice.between(-1.5, 1.5)};
    const auto profile = plan_move(from, distance, {v_max, v_max}, forces);
    const auto path = nodes(profile, from, forces);
    ASSERT_TRUE(profile.arrives);
    const double most = std::isinf(forces.bows.first)
                            ? 0
                            : from.acceleration * from.acceleration / 2 / forces.bows.first;
    const double v_bound = std::max(v_max, std::abs(from.velocity) + most) * (1 + 1e-9);
    const double a_bound =
        std::max({std::abs(from.acceleration), forces.acceleration, forces.deceleration}) *
        (1 + 1e-9);
    const double size = profile.duration() * v_bound;
    for (const auto& node : path) {
      ASSERT_LE(std::abs(node.v), v_bound);
      ASSERT_LE(std::abs(node.a), a_bound);
    }
    ASSERT_NEAR(path.back().x, distance, unseen + 1e-12 * size);
    ASSERT_NEAR(path.back().v, 0, 1e-9 * v_bound);
    for (std::size_t i = 0; i < profile.count; ++i) ASSERT_GT(profile.ticks[i], 0);
  }
}

// Speeding up is limited by one of the two, slowing down by the other, in either direction.
TEST(SCurve, KeepsAccelerationAndDecelerationApartWhenItTurns) {
  const Forces forces{scale * 3, scale * 1, {scale * 10}};
  const Moving from{scale * 4, 0};
  const auto profile = plan_move(from, -10 * scale, {5 * scale, 5 * scale}, forces);
  const auto path = nodes(profile, from, forces);
  double greatest = 0, least = 0;
  for (const auto& node : path) {
    if (node.v > 1e-6 * scale) least = std::min(least, node.a);
    if (node.v < -1e-6 * scale) greatest = std::min(greatest, node.a);
  }
  EXPECT_NEAR(least, -scale, 1e-9 * scale);
  EXPECT_NEAR(greatest, -3 * scale, 1e-9 * scale);
}

TEST(SCurve, ChangesVelocityInTheTimeOfTheClosedForm) {
  const Forces forces{2, 1, {4}};
  const auto duration = [&](double from, double to) {
    return plan_velocity({from, 0}, to, forces).duration();
  };
  EXPECT_DOUBLE_EQ(duration(0, 3), 3.0 / 2 + 2.0 / 4);
  EXPECT_DOUBLE_EQ(duration(0, -3), 3.0 / 2 + 2.0 / 4);
  EXPECT_DOUBLE_EQ(duration(3, 0), 3.0 / 1 + 1.0 / 4);
  EXPECT_DOUBLE_EQ(duration(2, 2.25), 2 * std::sqrt(0.25 / 4));
  // Slows down with 1 until it stands, goes on to 2, and takes that back.
  EXPECT_DOUBLE_EQ(duration(3, -3), (3 + 0.125) + 0.25 + (3 - 0.375 - 0.5) / 2 + 0.5);
}

TEST(SCurve, TakesBackTheAccelerationThatItHas) {
  const Forces forces{2, 2, {4}};
  const auto profile = plan_velocity({1, 2}, 1.5, forces);
  EXPECT_EQ(profile.count, 1);
  EXPECT_DOUBLE_EQ(profile.duration(), 0.5);
  EXPECT_EQ(profile.end_velocity, 1.5);
}

TEST(SCurve, DoesWhatItCanWithoutAForce) {
  const Moving from{3 * scale, 0};
  const Speeds limits{5 * scale, 5 * scale};
  const auto weak = plan_move(from, 100 * scale, limits, {0, scale, {scale}});
  EXPECT_TRUE(weak.arrives);  // at the velocity that it has
  const auto turning = plan_move(from, -100 * scale, limits, {0, scale, {scale}});
  EXPECT_FALSE(turning.arrives);
  EXPECT_EQ(turning.end_velocity, 0);
  const auto brakeless = plan_move(from, 100 * scale, limits, {scale, 0, {scale}});
  EXPECT_FALSE(brakeless.arrives);
  EXPECT_EQ(brakeless.end_velocity, 3 * scale);
  EXPECT_EQ(plan_move({0, 0}, scale, limits, {scale, 0, {scale}}).count, 0);
  const auto barred = plan_move({0, 0}, -scale, {5 * scale, 0}, {scale, scale, {scale}});
  EXPECT_EQ(barred.count, 0);
  EXPECT_FALSE(barred.arrives);
}

TEST(SCurve, NeedsNoMovementForWhatNobodySees) {
  const auto profile = plan_move({0, 0}, unseen / 2, {1, 1}, {1, 1, {1}});
  EXPECT_TRUE(profile.arrives);
  EXPECT_EQ(profile.count, 0);
  EXPECT_GT(plan_move({0, 0}, unseen * 2, {1, 1}, {1, 1, {1}}).count, 0);
}

}  // namespace
}  // namespace tmcl::ramp
