// Random paths of straight legs: limits, corners, and that speeds could not be greater.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "support/rounds.hpp"
#include "support/seed.hpp"
#include "tmcl/plan/path.hpp"
#include "tmcl/plan/trajectory.hpp"

namespace tmcl::plan {
namespace {

constexpr int usual_rounds = 3'000;
constexpr double a_little = 1 + 1e-9;

class Numbers {
 public:
  explicit Numbers(std::uint64_t seed) : random_(seed) {}

  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  std::size_t count(std::size_t low, std::size_t high) {
    return std::uniform_int_distribution<std::size_t>(low, high)(random_);
  }
  bool one_in(std::size_t n) { return count(1, n) == 1; }
  double magnitude() { return std::pow(10, between(-1.5, 1.5)); }

 private:
  std::mt19937_64 random_;
};

PathLimits any_limits(Numbers& random) {
  PathLimits limits{random.count(1, most_path_axes), {}, 0};
  for (auto& axis : limits.axis) axis = {random.magnitude(), random.magnitude()};
  if (!random.one_in(5)) limits.corner_tolerance = random.magnitude() / 10;
  return limits;
}

// Sharp corners, slight ones, straight on, back, along single axes, and nowhere.
std::vector<Leg> any_legs(Numbers& random, std::size_t axes) {
  std::vector<Leg> legs(random.count(1, 40));
  AxisValues at{}, step{};
  for (auto& leg : legs) {
    const double change = random.one_in(3) ? 0.01 : random.one_in(3) ? 0 : 1;
    const double size = random.one_in(8) ? 0 : random.one_in(8) ? -1 : random.magnitude();
    for (std::size_t axis = 0; axis < axes; ++axis) {
      if (!random.one_in(4)) step[axis] += change * random.between(-1, 1);
      at[axis] += size * step[axis];
    }
    leg.target = at;
    if (random.one_in(3)) leg.feed = random.magnitude();
  }
  return legs;
}

struct Case {
  PathLimits limits;
  std::vector<Leg> legs;
  PathPlan plan;

  explicit Case(Numbers& random) : Case(random, any_limits(random)) {}
  Case(Numbers& random, const PathLimits& given)
      : limits(given),
        legs(any_legs(random, limits.axes)),
        plan(plan_path({}, legs, limits).value()) {}

  AxisValues direction(std::size_t leg) const {
    AxisValues direction{};
    const auto from = leg == 0 ? AxisValues{} : legs[leg - 1].target;
    for (std::size_t axis = 0; axis < limits.axes; ++axis) {
      direction[axis] = (legs[leg].target[axis] - from[axis]) / plan.legs()[leg].length;
    }
    return direction;
  }

  // The legs that have a length.
  std::vector<std::size_t> real() const {
    std::vector<std::size_t> all;
    for (std::size_t i = 0; i < legs.size(); ++i) {
      if (plan.legs()[i].length > 0) all.push_back(i);
    }
    return all;
  }

  // What the axes and the feed allow along a leg.
  double speed(std::size_t leg) const {
    double speed = legs[leg].feed;
    const auto along = direction(leg);
    for (std::size_t axis = 0; axis < limits.axes; ++axis) {
      speed = std::min(speed, limits.axis[axis].velocity / std::abs(along[axis]));
    }
    return speed;
  }

  double corner(std::size_t before, std::size_t after) const {
    const double room = std::min(plan.legs()[before].length, plan.legs()[after].length);
    return corner_speed(direction(before), direction(after), room, limits);
  }
};

TEST(PathProperty, NoLimitIsExceeded) {
  Numbers random(tmcl::test::seed());
  for (int round = 0; round < tmcl::test::rounds(usual_rounds); ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    const Case c(random);
    for (int i = 0; i < 50; ++i) {
      const auto state = c.plan.at(random.between(0, c.plan.duration()));
      for (std::size_t axis = 0; axis < c.limits.axes; ++axis) {
        EXPECT_LE(std::abs(state.velocity[axis]), c.limits.axis[axis].velocity * a_little);
      }
    }
    for (const auto leg : c.real()) {
      EXPECT_LE(c.plan.legs()[leg].peak_speed, c.legs[leg].feed * a_little);
      for (std::size_t axis = 0; axis < c.limits.axes; ++axis) {
        const auto ramp = c.plan.ramp(leg, axis);
        EXPECT_LE(ramp.vmax, c.limits.axis[axis].velocity * a_little);
        EXPECT_LE(ramp.amax, c.limits.axis[axis].acceleration * a_little);
        EXPECT_LE(ramp.dmax, c.limits.axis[axis].acceleration * a_little);
        EXPECT_LE(std::max(ramp.vstart, ramp.vstop), ramp.vmax);
      }
    }
    if (testing::Test::HasFailure()) return;
  }
}

TEST(PathProperty, NoCornerChangesASpeedByMoreThanItsAxisMay) {
  Numbers random(tmcl::test::seed());
  double nearest = 0;
  for (int round = 0; round < tmcl::test::rounds(usual_rounds); ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    auto limits = any_limits(random);
    for (auto& axis : limits.axis)
      if (random.one_in(2)) axis.corner_jump = random.magnitude() / 10;
    const Case c(random, limits);
    const auto real = c.real();
    for (std::size_t i = 1; i < real.size(); ++i) {
      const auto before = c.direction(real[i - 1]), after = c.direction(real[i]);
      const double speed = c.plan.legs()[real[i]].start_speed;
      for (std::size_t axis = 0; axis < limits.axes; ++axis) {
        const double jump = std::abs(after[axis] - before[axis]) * speed;
        ASSERT_LE(jump, limits.axis[axis].corner_jump * a_little);
        nearest = std::max(nearest, jump / limits.axis[axis].corner_jump);
      }
    }
  }
  EXPECT_GT(nearest, 0.99) << "they were not tried";
}

TEST(PathProperty, SpeedsAndPositionsAreContinuousAlongThePath) {
  Numbers random(tmcl::test::seed());
  for (int round = 0; round < tmcl::test::rounds(usual_rounds); ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    const Case c(random);
    double speed = 0, time = 0;
    for (const auto i : c.real()) {
      const auto& leg = c.plan.legs()[i];
      EXPECT_EQ(leg.start_speed, speed);
      EXPECT_NEAR(leg.begin, time, 1e-9 * c.plan.duration());
      const double way = (leg.start_speed + leg.peak_speed) / 2 * leg.up +
                         leg.peak_speed * leg.even +
                         (leg.peak_speed + leg.end_speed) / 2 * leg.down;
      EXPECT_NEAR(way, leg.length, 1e-9 * leg.length);
      EXPECT_NEAR(leg.way_after(0), 0, 1e-9 * leg.length);
      EXPECT_NEAR(leg.speed_after(leg.up + leg.even), leg.peak_speed, 1e-9 * leg.peak_speed);
      const auto corner = c.plan.at(leg.end()).position;
      for (std::size_t axis = 0; axis < c.limits.axes; ++axis) {
        EXPECT_NEAR(corner[axis], c.legs[i].target[axis], 1e-9 * (1 + std::abs(corner[axis])));
      }
      speed = leg.end_speed;
      time = leg.end();
    }
    EXPECT_EQ(speed, 0);
    if (testing::Test::HasFailure()) return;
  }
}

// Each speed between two legs is the greatest that the corner, the legs and the speeds beside it
// allow.
TEST(PathProperty, NoSpeedCouldBeGreater) {
  Numbers random(tmcl::test::seed());
  for (int round = 0; round < tmcl::test::rounds(usual_rounds); ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    const Case c(random);
    const auto real = c.real();
    for (std::size_t i = 1; i < real.size(); ++i) {
      const auto& before = c.plan.legs()[real[i - 1]];
      const auto& after = c.plan.legs()[real[i]];
      const auto reach = [](double speed, const LegPlan& leg) {
        return std::sqrt(speed * speed + 2 * leg.acceleration * leg.length);
      };
      const double most =
          std::min({c.corner(real[i - 1], real[i]), c.speed(real[i - 1]), c.speed(real[i]),
                    reach(before.start_speed, before), reach(after.end_speed, after)});
      EXPECT_NEAR(before.end_speed, most, 1e-9 * most);
    }
    for (const auto i : real) {
      const auto& leg = c.plan.legs()[i];
      if (leg.even > 0) {
        EXPECT_NEAR(leg.peak_speed, c.speed(i), 1e-9 * leg.peak_speed);
      }
    }
    if (testing::Test::HasFailure()) return;
  }
}

// What an arc with this radius asks of the axes, in shares of their limits: the greatest one.
double effort(const AxisValues& from, const AxisValues& to, double angle, double radius,
              double speed, const PathLimits& limits) {
  constexpr int points = 400;
  double most = 0;
  for (int i = 0; i <= points; ++i) {
    const double turned = angle * i / points;
    for (std::size_t axis = 0; axis < limits.axes; ++axis) {
      const double across = (to[axis] - std::cos(angle) * from[axis]) / std::sin(angle);
      const double velocity = std::cos(turned) * from[axis] + std::sin(turned) * across;
      const double inward = std::cos(turned) * across - std::sin(turned) * from[axis];
      most = std::max({most, speed * std::abs(velocity) / limits.axis[axis].velocity,
                       speed * speed / radius * std::abs(inward) / limits.axis[axis].acceleration});
    }
  }
  return most;
}

TEST(PathProperty, AxesCouldFollowTheArcOfACornerAndNoFaster) {
  Numbers random(tmcl::test::seed());
  for (int round = 0; round < tmcl::test::rounds(usual_rounds); ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    const Case c(random);
    const auto real = c.real();
    for (std::size_t i = 1; i < real.size(); ++i) {
      const auto from = c.direction(real[i - 1]), to = c.direction(real[i]);
      double cosine = 0;
      for (std::size_t axis = 0; axis < c.limits.axes; ++axis) cosine += from[axis] * to[axis];
      const double angle = std::acos(std::clamp(cosine, -1.0, 1.0));
      if (angle < 1e-3 || angle > 3.1 || c.limits.corner_tolerance == 0) continue;
      const double room =
          std::min(c.plan.legs()[real[i - 1]].length, c.plan.legs()[real[i]].length);
      const double radius = std::min(c.limits.corner_tolerance / (1 / std::cos(angle / 2) - 1),
                                     room / 2 / std::tan(angle / 2));
      const double speed = c.corner(real[i - 1], real[i]);
      EXPECT_LE(effort(from, to, angle, radius, speed, c.limits), 1 + 1e-4);
      EXPECT_GE(effort(from, to, angle, radius, speed, c.limits), 1 - 1e-3);

      const double passed = c.plan.legs()[real[i]].start_speed;
      if (passed == 0) continue;
      for (std::size_t axis = 0; axis < c.limits.axes; ++axis) {
        const double change = passed * std::abs(to[axis] - from[axis]);
        const double time = angle * radius / passed;
        EXPECT_LE(change, c.limits.axis[axis].acceleration * time * (1 + 1e-4));
      }
    }
    if (testing::Test::HasFailure()) return;
  }
}

TEST(PathProperty, NeverSlowerThanWithAStopAtEachCorner) {
  Numbers random(tmcl::test::seed());
  for (int round = 0; round < tmcl::test::rounds(usual_rounds); ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    const Case c(random);
    double stopping = 0;
    for (const auto i : c.real()) {
      const auto& leg = c.plan.legs()[i];
      const Limits limits{c.speed(i), leg.acceleration, leg.acceleration};
      stopping += plan_move({}, {leg.length, 0, 0}, limits)->duration();
    }
    EXPECT_LE(c.plan.duration(), stopping * a_little);
    if (testing::Test::HasFailure()) return;
  }
}

TEST(PathProperty, AStraightLineTakesTheSameTimeHoweverItIsCut) {
  Numbers random(tmcl::test::seed());
  for (int round = 0; round < tmcl::test::rounds(usual_rounds); ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    const auto limits = any_limits(random);
    Leg whole;
    for (auto& value : whole.target) value = random.between(-10, 10);
    if (random.one_in(2)) whole.feed = random.magnitude();
    // Legs that are not so short that the last bits of the coordinates turn them.
    std::vector<double> cuts(random.count(1, 100));
    const double pieces = static_cast<double>(cuts.size());
    for (std::size_t i = 0; i < cuts.size(); ++i) {
      cuts[i] = (static_cast<double>(i) + random.between(0.001, 0.999)) / pieces;
    }
    cuts.push_back(1);
    std::vector<Leg> legs;
    for (const double cut : cuts) {
      legs.push_back(whole);
      for (auto& value : legs.back().target) value *= cut;
    }
    const auto once = plan_path({}, std::vector<Leg>{whole}, limits);
    const auto cut = plan_path({}, legs, limits);
    ASSERT_TRUE(once && cut);
    EXPECT_NEAR(cut->duration(), once->duration(), 1e-9 * once->duration());
    const double t = random.between(0, once->duration());
    EXPECT_NEAR(cut->at(t).position[0], once->at(t).position[0], 1e-7);
    if (testing::Test::HasFailure()) return;
  }
}

}  // namespace
}  // namespace tmcl::plan
