// Time-optimal movements along one axis: the numbers of the application notes, and what is special.
#include "tmcl/plan/trajectory.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace tmcl::plan {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::vector<double> durations(const Trajectory& trajectory) {
  std::vector<double> all;
  for (std::size_t i = 0; i < trajectory.phases(); ++i) {
    all.push_back(trajectory.phase(i).duration);
  }
  return all;
}

void expect_durations(const Trajectory& trajectory, const std::vector<double>& expected,
                      double tolerance) {
  const auto found = durations(trajectory);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], tolerance);
}

void expect_state(const State& found, const State& expected, double tolerance = 1e-9) {
  EXPECT_NEAR(found.position, expected.position, tolerance);
  EXPECT_NEAR(found.velocity, expected.velocity, tolerance);
  EXPECT_NEAR(found.acceleration, expected.acceleration, tolerance);
}

Trajectory move(const State& start, const State& target, const Limits& limits) {
  const auto plan = plan_move(start, target, limits);
  EXPECT_TRUE(plan.has_value()) << (plan ? "" : describe(plan.error()));
  return plan.value_or(Trajectory{});
}

Fault fault(const State& start, const State& target, const Limits& limits) {
  const auto plan = plan_move(start, target, limits);
  EXPECT_FALSE(plan.has_value());
  return plan ? Fault::magnitude : plan.error();
}

TEST(Trapezoid, PhaseTimesOfAn035) {
  const auto plan = move({0, 100, 0}, {512'000, 200, 0}, {256'000, 349'246, 349'246});
  expect_durations(plan, {.73272, 1.26699, .73244}, 1e-5);
  EXPECT_NEAR(plan.duration(), 2.73215, 1e-5);
}

TEST(Trapezoid, TriangleOfAn035) {
  const auto plan = move({0, 0, 0}, {1000, 0, 0}, {256'000, 349'246, 349'246});
  ASSERT_EQ(plan.phases(), 2U);
  EXPECT_NEAR(plan.at(plan.duration() / 2).velocity, 18'688, 1);
  EXPECT_NEAR(plan.duration(), .10702, 1e-5);
}

TEST(Trapezoid, LongestAxisOfAn035) {
  EXPECT_NEAR(move({}, {40'000, 0, 0}, {50'000, 200'000, 200'000}).duration(), 1.05, 1e-12);
  EXPECT_NEAR(move({}, {40'000, 0, 0}, {20'000, 32'000, 32'000}).duration(), 2.625, 1e-12);
}

TEST(Trapezoid, HasTheRampsOfBothLimits) {
  const auto plan = move({}, {12, 0, 0}, {8, 16, 8});
  expect_durations(plan, {.5, 0.75, 1}, 1e-12);
  EXPECT_DOUBLE_EQ(plan.phase(0).start.acceleration, 16);
  EXPECT_DOUBLE_EQ(plan.phase(1).start.acceleration, 0);
  EXPECT_DOUBLE_EQ(plan.phase(2).start.acceleration, -8);
}

TEST(Trapezoid, TriangleReachesTheSpeedOfItsFormula) {
  const double s = 3, a = 5, d = 2;
  const auto plan = move({}, {s, 0, 0}, {100, a, d});
  EXPECT_NEAR(plan.phase(1).start.velocity, std::sqrt(2 * s * a * d / (a + d)), 1e-12);
}

TEST(Trapezoid, ComesDownFirstFromASpeedAboveTheLimit) {
  const auto plan = move({0, 6, 0}, {20, 0, 0}, {2, 4, 4});
  expect_durations(plan, {1, 7.75, .5}, 1e-12);
}

TEST(Trapezoid, OvershootsAndComesBack) {
  const auto plan = move({0, 10, 0}, {1, 0, 0}, {100, 10, 10});
  EXPECT_DOUBLE_EQ(plan.phase(0).start.acceleration, -10);
  EXPECT_NEAR(plan.at(1).velocity, 0, 1e-12);
  EXPECT_NEAR(plan.duration(), 1 + 2 * std::sqrt(4.0 / 10), 1e-12);
}

TEST(Trapezoid, GathersSpeedForTheWayBackWithTheDeceleration) {
  const auto plan = move({0, 10, 0}, {1, 0, 0}, {100, 20, 10});
  EXPECT_DOUBLE_EQ(plan.phase(0).start.acceleration, -10);
  EXPECT_DOUBLE_EQ(plan.phase(plan.phases() - 1).start.acceleration, 20);
}

TEST(Trapezoid, EndsAtTheTargetVelocity) {
  const auto plan = move({0, 0, 0}, {8, 4, 0}, {10, 1, 1});
  expect_durations(plan, {4}, 1e-12);
}

TEST(Trapezoid, TurnsToComeThroughTheTargetBackwards) {
  const auto plan = move({0, 0, 0}, {1, -2, 0}, {10, 1, 1});
  expect_state(plan.reached(), {1, -2, -1});
  // It gathers speed up to p, and slows down from p to -2: p^2/2 + (p^2 - 4)/2 is the way of 1.
  const double p = std::sqrt(3.0);
  expect_durations(plan, {p, p + 2}, 1e-12);
  expect_state(plan.at(2 * p), {p * p, 0, -1});
}

TEST(Trapezoid, AcceleratesAtOnceWhateverTheStartSays) {
  const auto plan = move({0, 0, 99}, {12, 0, 0}, {8, 16, 8});
  EXPECT_DOUBLE_EQ(plan.duration(), move({}, {12, 0, 0}, {8, 16, 8}).duration());
}

// Registers of an MC1451A: steps and cycles.
Limits registers(double v, double a, double j) {
  return {v / 0x1p16, a / 0x1p16, a / 0x1p16, j / 0x1p32};
}

TEST(SCurve, WithAllSevenPhases) {
  const auto plan = move({}, {100'000, 0, 0}, registers(180'224, 66, 42'950));
  expect_durations(plan, {100.707, 2629.959, 100.707, 33532.262, 100.707, 2629.959, 100.707}, 1e-3);
  EXPECT_NEAR(plan.duration(), 39195.010, 1e-3);
}

TEST(SCurve, WithoutReachingTheAcceleration) {
  const auto plan = move({}, {100'000, 0, 0}, registers(65'536, 16'384, 42'950));
  expect_durations(plan, {316.227, 316.227, 99367.547, 316.227, 316.227}, 1e-3);
  EXPECT_NEAR(plan.duration(), 100632.453, 1e-3);
}

TEST(SCurve, WithoutReachingTheVelocity) {
  const auto plan = move({}, {2000, 0, 0}, registers(1 << 20, 66, 42'950));
  EXPECT_NEAR(durations(plan).at(1), 1259.072, 1e-3);
  EXPECT_NEAR(plan.at(plan.duration() / 2).velocity, 1.36941, 1e-5);
  EXPECT_NEAR(plan.duration(), 2920.973, 1e-3);
}

TEST(SCurve, WithoutReachingEither) {
  const auto plan = move({}, {50, 0, 0}, registers(1 << 20, 16'384, 42'950));
  expect_durations(plan, {135.721, 271.441, 135.721}, 2e-3);
  EXPECT_NEAR(plan.at(plan.duration() / 2).velocity, .184202, 1e-6);
  EXPECT_NEAR(plan.duration(), 542.882, 1e-2);
}

TEST(SCurve, HasDifferentRampsOnBothSides) {
  const auto plan = move({}, {100, 0, 0}, {10, 4, 2, 2});
  EXPECT_NEAR(plan.duration(), (10. / 4 + 4. / 2) + (10. / 2 + 2. / 2) + (100 - 22.5 - 30) / 10,
              1e-12);
}

TEST(SCurve, TakesBackAnAccelerationAboveItsLimitFirst) {
  const auto plan = move({0, 0, 5}, {1000, 0, 0}, {50, 2, 2, 1});
  EXPECT_DOUBLE_EQ(plan.phase(0).jerk, -1);
  EXPECT_NEAR(plan.phase(0).duration, 3, 1e-12);
  EXPECT_NEAR(plan.phase(1).start.acceleration, 2, 1e-12);
}

TEST(SCurve, ComesDownFirstFromASpeedAboveTheLimit) {
  const auto plan = move({0, 20, 0}, {1000, 0, 0}, {10, 2, 2, 1});
  expect_durations(plan, {2, 3, 2, (1000 - 7 * 15 - 35) / 10., 2, 3, 2}, 1e-9);
}

TEST(SCurve, ComesDownFromASpeedThatWillBeAboveTheLimit) {
  const auto plan = move({0, 9.5, 2}, {1000, 0, 0}, {10, 2, 2, 1});
  EXPECT_DOUBLE_EQ(plan.phase(0).jerk, -1);
  EXPECT_NEAR(plan.at(plan.duration() / 2).velocity, 10, 1e-9);
}

TEST(SCurve, EndsWithAnAcceleration) {
  const auto plan = move({}, {10, 3, 1}, {5, 2, 2, 1});
  expect_state(plan.reached(), {10, 3, 1});
}

TEST(SCurve, KeepsToItsLimitsWhateverTheJerk) {
  for (const double jerk : {1e-9, 1e-3, 1e3, 1e15}) {
    const auto plan = move({}, {7, 0, 0}, {2, 3, 4, jerk});
    expect_state(plan.reached(), {7, 0, 0}, 1e-8);
    for (std::size_t i = 0; i < plan.phases(); ++i) {
      EXPECT_LE(plan.phase(i).start.velocity, 2 * (1 + 1e-12));
      EXPECT_LE(plan.phase(i).start.acceleration, 3 * (1 + 1e-12));
    }
  }
}

TEST(SCurve, WithAHugeJerkIsATrapezoid) {
  EXPECT_NEAR(move({}, {7, 0, 0}, {2, 3, 4, 1e15}).duration(),
              move({}, {7, 0, 0}, {2, 3, 4}).duration(), 1e-12);
}

TEST(SCurve, GoesTinyDistances) {
  const double s = 1e-15;
  EXPECT_NEAR(move({}, {s, 0, 0}, {1, 1, 1, 1}).duration(), 4 * std::cbrt(s / 2), 1e-15);
}

TEST(SCurve, OfTinySpeedNeverReachesItsAcceleration) {
  const auto plan = move({}, {1, 0, 0}, {1e-6, 10, 10, 1});
  EXPECT_EQ(plan.phases(), 5U);
  EXPECT_NEAR(plan.duration(), 1e6 + 2 * std::sqrt(1e-6), 1e-6);
}

struct Known {
  State start;
  State target;
  Limits limits;
  double duration;
};

// Durations from an independent solver, Ruckig 0.17.3.
TEST(Trajectory, TakesAsLongAsAnIndependentSolverSays) {
  // clang-format off
  const Known known[] = {
      {{0, 0, 0}, {5.36, 0, 0}, {2.31, 2.86, 2.86, 0.97}, 5.612818660907},
      {{0, 0.26, -0.35}, {1.62, 0, 0}, {0.6, 0.35, 2.53, 5.43}, 3.382416980549},
      {{0, -0.52, 0.86}, {0.21, -0.15, 0}, {1.13, 2.07, 2, 3.15}, 1.804577304111},
      {{0, 1.55, -1.47}, {1.05, 0.34, 0.39}, {2.72, 2.07, 2.07, 1.89}, 1.478143397865},
      {{0, 0, 0}, {0.85, 0, 0}, {1.18, 0.32, 1.8, 2.18}, 2.964555851109},
      {{0, 0.25, 0}, {3.34, 0, 0}, {2.03, 2.9, 0.75}, 3.267340807556},
      {{0, -1.7, -0.45}, {4.33, -1.76, 0}, {2.06, 1.03, 1.03, 0.46}, 15.36804092432},
      {{0, -0.2, 0.09}, {4.68, -0.43, -1.16}, {0.43, 2.14, 1.62, 3.83}, 12.03599322333},
      {{0, 0, 0}, {3.95, 0, 0}, {1.01, 0.47, 2.12, 2.84}, 5.664456055802},
      {{0, 0.01, -0.66}, {0.36, 0, 0}, {0.52, 1.26, 1.26, 5.3}, 1.503960064697},
      {{0, 1.95, 0.65}, {0.15, -0.73, 0}, {2.91, 1.37, 0.42, 0.56}, 15.26965716592},
      {{0, -0.18, 0}, {2.32, 0.22, 0}, {0.23, 2.93, 0.97}, 10.21190240529},
      {{0, 0, 0}, {4.92, 0, 0}, {0.27, 2.01, 2.01, 3.2}, 18.80316972415},
      {{0, 0.64, -0.41}, {2.05, 0, 0}, {2.01, 1.73, 1.83, 1.55}, 3.096330116081},
      {{0, 0.91, -0.41}, {5.16, -0.08, 0}, {1.11, 0.32, 0.71, 2.9}, 5.791435821068},
      {{0, 0.33, 0.42}, {5.67, 0.18, 0.89}, {0.57, 1.14, 1.14, 4.58}, 10.44624197989},
      {{0, 0, 0}, {3.95, 0, 0}, {1.37, 0.76, 2.18, 0.89}, 5.452189469588},
      {{0, 0.74, 0}, {3.35, 0, 0}, {1.78, 2.07, 0.26}, 5.133523731454},
      {{0, 1.4, 2.17}, {2.24, -1.24, 0}, {2.58, 2.23, 2.23, 5.75}, 2.578119785589},
      {{0, -0.6, -0.17}, {0.9, -0.17, 1.28}, {1.68, 2.97, 2.76, 0.87}, 8.30399935459},
      {{0, 0, 0}, {1.93, 0, 0}, {0.91, 0.83, 2.66, 1.27}, 3.842327705471},
      {{0, -0.31, 1.48}, {0.94, 0, 0}, {2.46, 1.77, 1.77, 3.69}, 1.989216997909},
      {{0, -0.88, 1.4}, {4.91, 0.18, 0}, {1.31, 1.59, 2.32, 4.83}, 5.326008167523},
      {{0, -1.05, 0}, {2.45, 1.05, 0}, {1.88, 2.82, 2.45}, 2.187626184471},
  };
  // clang-format on
  for (const auto& [start, target, limits, duration] : known) {
    EXPECT_NEAR(move(start, target, limits).duration(), duration, 1e-11 * duration);
  }
}

TEST(Trajectory, OfNoDistanceTakesNoTime) {
  for (const double jerk : {1.0, infinity}) {
    const auto plan = move({5, 0, 0}, {5, 0, 0}, {1, 1, 1, jerk});
    EXPECT_EQ(plan.phases(), 0U);
    EXPECT_EQ(plan.duration(), 0);
    EXPECT_EQ(plan.at(0), (State{5, 0, 0}));
  }
}

TEST(Trajectory, ThatIsAlreadyThereTakesNoTime) {
  for (const double jerk : {1.0, infinity}) {
    EXPECT_EQ(move({5, 1, 0}, {5, 1, 0}, {1, 1, 1, jerk}).duration(), 0);
  }
  EXPECT_EQ(move({5, .1, .3}, {5, .1, .3}, {1, 1, 1, 1}).duration(), 0);
}

TEST(Trajectory, StartsAndEndsExactly) {
  const State start{.1, .2, .3}, target{12.3, .1, -.2};
  const auto plan = move(start, target, {1, 1, 1, 1});
  EXPECT_EQ(plan.at(-1), start);
  expect_state(plan.at(0), start, 1e-15);
  EXPECT_EQ(plan.at(plan.duration()), target);
  EXPECT_EQ(plan.at(infinity), target);
}

TEST(Trajectory, BackwardsIsTheMirrorImage) {
  const Limits limits{3, 2, 1, 4};
  const auto forward = move({0, 1, -.5}, {10, -.5, .25}, limits);
  const auto backward = move({0, -1, .5}, {-10, .5, -.25}, limits);
  EXPECT_EQ(durations(forward), durations(backward));
  for (double t = 0; t < forward.duration(); t += .1) {
    EXPECT_EQ(forward.at(t).position, -backward.at(t).position);
  }
}

TEST(Trajectory, NamesTheLimitThatIsWrong) {
  for (const double wrong : {0.0, -1.0, nan, infinity}) {
    EXPECT_EQ(fault({}, {1, 0, 0}, {wrong, 1, 1, 1}), Fault::velocity_limit);
    EXPECT_EQ(fault({}, {1, 0, 0}, {1, wrong, 1, 1}), Fault::acceleration_limit);
    EXPECT_EQ(fault({}, {1, 0, 0}, {1, 1, wrong, 1}), Fault::deceleration_limit);
  }
  for (const double wrong : {0.0, -1.0, nan}) {
    EXPECT_EQ(fault({}, {1, 0, 0}, {1, 1, 1, wrong}), Fault::jerk_limit);
  }
}

TEST(Trajectory, RefusesStatesThatAreNone) {
  for (const double wrong : {nan, infinity, -infinity}) {
    for (const auto& state : {State{wrong, 0, 0}, State{0, wrong, 0}, State{0, 0, wrong}}) {
      EXPECT_EQ(fault(state, {1, 0, 0}, {1, 1, 1, 1}), Fault::start);
      EXPECT_EQ(fault({}, state, {1, 1, 1, 1}), Fault::target);
    }
  }
}

TEST(Trajectory, RefusesTargetsBeyondTheLimits) {
  EXPECT_EQ(fault({}, {1, 1.5, 0}, {1, 1, 1, 1}), Fault::target_velocity);
  EXPECT_EQ(fault({}, {1, -1.5, 0}, {1, 1, 1}), Fault::target_velocity);
  EXPECT_EQ(fault({}, {9, 0, 2}, {9, 1, 3, 1}), Fault::target_acceleration);
  EXPECT_EQ(fault({}, {-9, 0, 2}, {9, 3, 1, 1}), Fault::target_acceleration);
  EXPECT_EQ(fault({}, {9, .9, -1}, {1, 1, 1, 1}), Fault::target_not_entered);
}

TEST(Trajectory, RefusesWhatNoDoubleHolds) {
  EXPECT_EQ(fault({}, {1e300, 0, 0}, {1e-300, 1, 1, 1}), Fault::magnitude);
  EXPECT_EQ(fault({-1e308, 0, 0}, {1e308, 0, 0}, {1, 1, 1}), Fault::magnitude);
}

TEST(Trajectory, SaysWhatIsWrongInASentence) {
  struct Wrong {
    State target;
    Limits limits;
    std::string_view said;  ///< What it is about, and what it should be or is.
  };
  const std::vector<Wrong> all{
      {{1, 0, 0}, {0, 1, 1, 1}, "limit of velocity must be greater than zero"},
      {{1, 0, 0}, {1, 0, 1, 1}, "limit of acceleration must be greater than zero"},
      {{1, 0, 0}, {1, 1, 0, 1}, "limit of deceleration must be greater than zero"},
      {{1, 0, 0}, {1, 1, 1, 0}, "limit of jerk must be greater than zero"},
      {{nan, 0, 0}, {1, 1, 1, 1}, "the target must have a finite position"},
      {{1, 1.5, 0}, {1, 1, 1, 1}, "the velocity of the target is beyond its limit"},
      {{9, 0, 2}, {9, 1, 3, 1}, "the acceleration of the target is beyond its limit"},
      {{9, .9, -1}, {1, 1, 1, 1}, "the target cannot be entered"},
      {{1e300, 0, 0}, {1e-300, 1, 1, 1}, "the movement is too long"},
  };
  for (const auto& [target, limits, said] : all)
    EXPECT_THAT(describe(fault({}, target, limits)), testing::HasSubstr(said));
  EXPECT_THAT(describe(fault({nan, 0, 0}, {}, {1, 1, 1, 1})),
              testing::HasSubstr("the start must have a finite position"));
}

TEST(VelocityPlan, TakesTheTimeOfItsFormula) {
  const double a = 4, b = 2;
  for (const double dv : {1.0, 7.9, 8.0, 20.0}) {
    const auto plan = plan_velocity({3, 1, 0}, 1 + dv, {50, a, a, b});
    ASSERT_TRUE(plan.has_value());
    const double t = dv >= a * a / b ? dv / a + a / b : 2 * std::sqrt(dv / b);
    EXPECT_NEAR(plan->duration(), t, 1e-12);
    expect_state(plan->end(), {3 + (1 + 1 + dv) / 2 * t, 1 + dv, 0});
    expect_state(plan->at(plan->duration() * (1 - 1e-15)), plan->end());
  }
}

TEST(VelocityPlan, WithoutJerkIsOneRamp) {
  const auto plan = plan_velocity({0, 5, 0}, -3, {10, 1, 2});
  ASSERT_TRUE(plan.has_value());
  expect_durations(*plan, {4}, 1e-12);
}

TEST(VelocityPlan, BringsStartsInsideTheLimitsFirst) {
  const auto plan = plan_velocity({0, 30, 9}, 2, {10, 3, 3, 1});
  ASSERT_TRUE(plan.has_value());
  expect_state(plan->end(), {plan->end().position, 2, 0});
  EXPECT_DOUBLE_EQ(plan->phase(0).jerk, -1);
}

TEST(VelocityPlan, NamesWhatIsWrong) {
  EXPECT_EQ(plan_velocity({}, 2, {1, 1, 1, 1}).error(), Fault::target_velocity);
  EXPECT_EQ(plan_velocity({}, nan, {1, 1, 1, 1}).error(), Fault::target);
  EXPECT_EQ(plan_velocity({nan, 0, 0}, 1, {1, 1, 1, 1}).error(), Fault::start);
  EXPECT_EQ(plan_velocity({}, 1, {1, 0, 1, 1}).error(), Fault::acceleration_limit);
}

}  // namespace
}  // namespace tmcl::plan
