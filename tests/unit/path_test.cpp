// Paths of straight legs: speeds looked ahead, corners, and what each axis does.
#include "tmcl/plan/path.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace tmcl::plan {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

PathLimits limits(std::size_t axes, AxisLimits each, double tolerance) {
  PathLimits limits{axes, {}, tolerance};
  limits.axis.fill(each);
  return limits;
}

PathPlan plan(const std::vector<Leg>& legs, const PathLimits& limits) {
  const auto made = plan_path({}, legs, limits);
  EXPECT_TRUE(made.has_value()) << (made ? "" : describe(made.error()));
  return made.value_or(PathPlan{});
}

PathFault fault(const std::vector<Leg>& legs, const PathLimits& limits) {
  const auto made = plan_path({}, legs, limits);
  EXPECT_FALSE(made.has_value());
  return made ? PathFault{PathFault::Kind::legs} : made.error();
}

TEST(Path, OneLegIsATrapezoid) {
  const auto path = plan({{{12}}}, limits(1, {8, 16}, 0));
  const auto& leg = path.legs()[0];
  EXPECT_DOUBLE_EQ(leg.up, .5);
  EXPECT_DOUBLE_EQ(leg.even, 1);
  EXPECT_DOUBLE_EQ(leg.down, .5);
  EXPECT_DOUBLE_EQ(path.duration(), 2);
  EXPECT_DOUBLE_EQ(path.at(.5).position[0], 2);
  EXPECT_DOUBLE_EQ(path.at(1).velocity[0], 8);
  EXPECT_DOUBLE_EQ(path.at(9).position[0], 12);
  EXPECT_DOUBLE_EQ(path.at(-9).position[0], 0);
}

TEST(Path, TheSlowestAxisLeadsTheWay) {
  // The example of application note AN-035 with limits of 50k, 5k, 50k and 200k, 200k, 2k.
  PathLimits axes{3, {{{50e3, 200e3}, {5e3, 200e3}, {50e3, 2e3}}}, 0};
  const auto path = plan({{{40e3, -10e3, 2.5e3}}}, axes);
  EXPECT_NEAR(path.duration(), 2.625, 1e-12);
  EXPECT_NEAR(path.ramp(0, 0).vmax, 20e3, 1e-6);
  EXPECT_NEAR(path.ramp(0, 1).vmax, 5e3, 1e-6);
  EXPECT_NEAR(path.ramp(0, 2).amax, 2e3, 1e-6);
  EXPECT_EQ(path.ramp(0, 1).target, -10e3);
  EXPECT_LT(path.at(1).velocity[1], 0);
}

TEST(Path, StopsAtCornersWithoutTolerance) {
  const auto path = plan({{{1, 0}}, {{1, 1}}}, limits(2, {10, 1}, 0));
  EXPECT_EQ(path.legs()[0].end_speed, 0);
  EXPECT_NEAR(path.duration(), 4, 1e-12);
}

TEST(Path, PassesACornerAsFastAsItsArcCouldBe) {
  // A right angle: radius = tolerance cos 45 / (1 - cos 45).
  const auto path = plan({{{10, 0}}, {{10, 10}}}, limits(2, {10, 2}, .1));
  const double half = std::sqrt(.5);
  const double radius = .1 * half / (1 - half);
  EXPECT_NEAR(path.legs()[0].end_speed, std::sqrt(2 * radius), 1e-12);
  EXPECT_EQ(path.legs()[1].start_speed, path.legs()[0].end_speed);
}

TEST(Path, TheArcLeavesHalfOfEachLeg) {
  const auto path = plan({{{.2, 0}}, {{.2, 10}}}, limits(2, {10, 100}, 5));
  EXPECT_NEAR(path.legs()[0].end_speed, std::min(std::sqrt(.1 * 100), std::sqrt(2 * 100 * .2)),
              1e-12);
}

TEST(Path, StopsWhereItTurnsBack) {
  const auto path = plan({{{1, 0}}, {{0, 0}}}, limits(2, {10, 1}, 1));
  EXPECT_EQ(path.legs()[0].end_speed, 0);
}

TEST(Path, AStraightLineIsOneLegHoweverItIsCut) {
  const auto axes = limits(3, {3, 2}, 0);
  std::vector<Leg> legs;
  for (int i = 1; i <= 1000; ++i) legs.push_back({{.007 * i, -.013 * i, .001 * i}});
  const auto whole = plan({legs.back()}, axes);
  EXPECT_NEAR(plan(legs, axes).duration(), whole.duration(), 1e-9 * whole.duration());
}

TEST(Path, SlowsDownInTimeForASlowLeg) {
  const auto path = plan({{{10}}, {{11}, .5}, {{20}}}, limits(1, {3, 1}, 0));
  EXPECT_DOUBLE_EQ(path.legs()[1].start_speed, .5);
  EXPECT_DOUBLE_EQ(path.legs()[1].peak_speed, .5);
  EXPECT_DOUBLE_EQ(path.legs()[1].even, 2);
  EXPECT_DOUBLE_EQ(path.legs()[0].peak_speed, 3);
}

TEST(Path, LooksFurtherAheadThanOneLeg) {
  std::vector<Leg> legs{{{100}}};
  for (int i = 1; i <= 10; ++i) legs.push_back({{100 + .1 * i}});
  const auto path = plan(legs, limits(1, {10, 1}, 0));
  EXPECT_NEAR(path.legs()[0].end_speed, std::sqrt(2.0), 1e-12);
}

TEST(Path, LegsOfNoLengthChangeNothing) {
  const auto axes = limits(2, {3, 2}, .1);
  const auto plain = plan({{{1, 0}}, {{2, 1}}}, axes);
  const auto padded = plan({{{0, 0}}, {{1, 0}}, {{1, 0}}, {{2, 1}}, {{2, 1}}}, axes);
  EXPECT_DOUBLE_EQ(padded.duration(), plain.duration());
  EXPECT_GT(plain.legs()[0].end_speed, 0);
  EXPECT_EQ(padded.legs()[2].duration(), 0);
  EXPECT_EQ(padded.ramp(2, 0).vmax, 0);
  EXPECT_EQ(padded.at(padded.duration() / 2).position, plain.at(plain.duration() / 2).position);
}

TEST(Path, OfNoLegsStaysWhereItIs) {
  const auto path = plan_path({4, 5}, {}, limits(2, {1, 1}, 0));
  ASSERT_TRUE(path.has_value());
  EXPECT_EQ(path->duration(), 0);
  EXPECT_EQ(path->at(1).position[1], 5);
}

TEST(Path, RampsJoinAtTheirSpeeds) {
  const auto path = plan({{{10, 0}}, {{20, 2}}}, limits(2, {5, 2}, .5));
  EXPECT_GT(path.ramp(0, 0).vstop, 0);
  EXPECT_EQ(path.ramp(0, 0).vstart, 0);
  EXPECT_EQ(path.ramp(0, 1).vmax, 0);
  EXPECT_LE(path.ramp(1, 0).vstart, path.ramp(0, 0).vstop);
  EXPECT_GT(path.ramp(1, 1).vstart, 0);
  EXPECT_EQ(path.ramp(1, 1).amax, path.ramp(1, 1).dmax);
}

PathLimits smooth_limits(double velocity, double acceleration, double jerk) {
  auto made = limits(1, {velocity, acceleration}, 0);
  made.jerk = jerk;
  return made;
}

// All of the acceleration and of the speed; then less of both than there is.
TEST(Path, WithAJerkOneLegIsAnSCurve) {
  const auto full = plan({{{12}}}, smooth_limits(8, 16, 64));
  EXPECT_NEAR(full.duration(), 12 / 8. + 8 / 16. + 16 / 64., 1e-6);
  EXPECT_NEAR(full.legs()[0].peak_speed, 8, 1e-9);
  EXPECT_NEAR(full.legs()[0].acceleration, 16, 1e-6);
  const auto middle = full.motion_at(full.duration() / 2);
  EXPECT_NEAR(middle.position[0], 6, 1e-9);
  EXPECT_NEAR(middle.acceleration[0], 0, 1e-9);
  EXPECT_NEAR(full.motion_at(0.125).jerk[0], 64, 1e-6);
  const auto part = plan({{{12}}}, smooth_limits(100, 1000, 64));
  EXPECT_NEAR(part.duration(), 4 * std::cbrt(12 / (2 * 64.)), 1e-3 * part.duration());
}

TEST(Path, WithAnyJerkItHasTheSameLegs) {
  for (const double jerk : {1e-9, 1.0, 1e9, 1e300}) {
    const auto path = plan({{{3}}, {{3}}, {{5}}, {{5}}, {{-2}}}, smooth_limits(8, 16, jerk));
    EXPECT_EQ(path.legs()[1].duration(), 0);
    EXPECT_NEAR(path.at(path.legs()[0].end()).position[0], 3, 1e-9) << jerk;
    EXPECT_NEAR(path.at(path.legs()[2].end()).position[0], 5, 1e-9) << jerk;
    EXPECT_EQ(path.legs()[2].end_speed, 0);
    EXPECT_EQ(path.at(path.duration()).position[0], -2);
    EXPECT_GT(path.duration(), plan({{{5}}, {{-2}}}, limits(1, {8, 16}, 0)).duration());
  }
}

TEST(Path, NamesWhatIsWrong) {
  using Kind = PathFault::Kind;
  const auto good = limits(2, {1, 1}, 0);
  EXPECT_EQ(fault({}, limits(0, {1, 1}, 0)), PathFault{Kind::axes});
  EXPECT_EQ(fault({}, limits(7, {1, 1}, 0)), PathFault{Kind::axes});
  for (const double wrong : {0.0, -1.0, nan, infinity}) {
    auto bad = good;
    bad.axis[1].velocity = wrong;
    EXPECT_EQ(fault({}, bad), (PathFault{Kind::velocity_limit, 0, 1}));
    bad = good;
    bad.axis[1].acceleration = wrong;
    EXPECT_EQ(fault({}, bad), (PathFault{Kind::acceleration_limit, 0, 1}));
    if (wrong == infinity) continue;
    bad = good;
    bad.axis[1].corner_jump = wrong;
    EXPECT_EQ(fault({}, bad), (PathFault{Kind::corner_jump, 0, 1}));
  }
  for (const double wrong : {-1.0, nan, infinity}) {
    EXPECT_EQ(fault({}, limits(2, {1, 1}, wrong)), PathFault{Kind::tolerance});
  }
  EXPECT_EQ(fault({{{1, 1}}, {{1, nan}}}, good), (PathFault{Kind::target, 1, 1}));
  EXPECT_EQ(fault({{{1, 1}}, {{1, 2}, 0}}, good), (PathFault{Kind::feed, 1}));
  EXPECT_EQ(fault({{{1, 1}}, {{1, 2}, nan}}, good), (PathFault{Kind::feed, 1}));
  EXPECT_EQ(fault({{{1e308}}, {{-1e308}}}, good), PathFault{Kind::magnitude});
  for (const double wrong : {0.0, -1.0, nan}) {
    auto bad = good;
    bad.jerk = wrong;
    EXPECT_EQ(fault({}, bad), PathFault{Kind::jerk});
  }
  auto smooth = good;
  smooth.jerk = 1;
  EXPECT_EQ(fault({{{1e308}}, {{-1e308}}}, smooth), PathFault{Kind::magnitude});
  EXPECT_EQ(fault(std::vector<Leg>(most_legs + 1), good), PathFault{Kind::legs});
  EXPECT_EQ(plan_path({0, infinity}, {}, good).error(), (PathFault{Kind::start, 0, 1}));
}

TEST(Path, WhatAnUnusedAxisSaysDoesNotMatter) {
  EXPECT_TRUE(plan_path({0, nan}, std::vector<Leg>{{{1, nan}}}, limits(1, {1, 1}, 0)).has_value());
}

TEST(Path, SaysWhatIsWrongInASentence) {
  EXPECT_EQ(describe({PathFault::Kind::target, 7, 2}),
            "leg 7: the target of axis 2 must be finite");
  EXPECT_EQ(describe({PathFault::Kind::axes}), "a path has 1 to 6 axes");
}

}  // namespace
}  // namespace tmcl::plan
