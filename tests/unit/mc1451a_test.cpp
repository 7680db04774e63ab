#include "tmcl/ramp/mc1451a.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iterator>
#include <map>
#include <string>
#include <utility>

namespace tmcl::ramp {
namespace {

static_assert(Generator<Mc1451a>);
static_assert(sizeof(Mc1451a) <= 256);

using R = Mc1451a::Register;

struct Parameters {
  std::int64_t position;
  std::int64_t velocity;
  std::int64_t acceleration;
  std::int64_t jerk;
  std::int64_t profile = 0;
};

Mc1451a axis_with(const Parameters& parameters) {
  Mc1451a axis;
  EXPECT_TRUE(axis.write(R::profile, parameters.profile));
  EXPECT_TRUE(axis.write(R::velocity, parameters.velocity));
  EXPECT_TRUE(axis.write(R::acceleration, parameters.acceleration));
  EXPECT_TRUE(axis.write(R::jerk, parameters.jerk));
  EXPECT_TRUE(axis.write(R::position, parameters.position));
  return axis;
}

double cycles(Tick ticks) { return static_cast<double>(ticks) / Mc1451a::ticks_per_cycle; }

// How many cycles each phase takes, and the whole movement under "".
std::map<std::string, double> durations(Mc1451a axis) {
  std::map<std::string, double> result;
  while (!axis.settled()) {
    const Tick begin = axis.tick();
    const std::string phase(axis.phase());
    axis.advance_to(axis.next_change());
    result[phase] += cycles(axis.tick() - begin);
    result[""] = cycles(axis.tick());
  }
  return result;
}

void expect_durations(const Parameters& parameters, const std::map<std::string, double>& expected) {
  const auto measured = durations(axis_with(parameters));
  ASSERT_EQ(measured.size(), expected.size());
  for (const auto& [phase, duration] : expected) {
    ASSERT_TRUE(measured.contains(phase)) << phase;
    EXPECT_NEAR(measured.at(phase), duration, phase.empty() ? 0.07 : 0.13) << phase;
  }
}

TEST(Mc1451a, GoesThroughAllSevenPhases) {
  expect_durations({100'000, 180'224, 66, 42'950}, {{"I", 100.707},
                                                    {"II", 2629.959},
                                                    {"III", 100.707},
                                                    {"IV", 33532.262},
                                                    {"V", 100.707},
                                                    {"VI", 2629.959},
                                                    {"VII", 100.707},
                                                    {"", 39195.010}});
}

// .175 steps/cycle^2 are reached with .0075 steps/cycle^3, which the page prints too great.
TEST(Mc1451a, TakesAJerkInPartsOf2To32) {
  const auto acceleration = std::llround(.175 * 0x1p16);
  const auto jerk = std::llround(.0075 * 0x1p32);
  EXPECT_EQ(acceleration, 0x2ccd);
  EXPECT_EQ(jerk, 0x1eb851f);
  const auto phases = durations(axis_with({100'000, 20 << 16, acceleration, jerk}));
  EXPECT_NEAR(phases.at("I"), .175 / .0075, 0.13);
  EXPECT_NEAR(phases.at("II"), (20 - .175 * .175 / .0075) / .175, 0.13);
}

TEST(Mc1451a, LeavesOutConstantAccelerationThatItDoesNotReach) {
  expect_durations({100'000, 65'536, 16'384, 42'950}, {{"I", 316.227},
                                                       {"III", 316.227},
                                                       {"IV", 99367.547},
                                                       {"V", 316.227},
                                                       {"VII", 316.227},
                                                       {"", 100632.453}});
}

TEST(Mc1451a, LeavesOutConstantVelocityThatItDoesNotReach) {
  const Parameters parameters{2000, 1 << 20, 66, 42'950};
  expect_durations(parameters, {{"I", 100.707},
                                {"II", 1259.072},
                                {"III", 100.707},
                                {"V", 100.707},
                                {"VI", 1259.072},
                                {"VII", 100.707},
                                {"", 2920.973}});
  auto axis = axis_with(parameters);
  axis.advance_to(static_cast<Tick>(2920.973 / 2 * Mc1451a::ticks_per_cycle));
  EXPECT_NEAR(static_cast<double>(axis.motion().velocity) / 65536, 1.36941, 1e-4);
}

TEST(Mc1451a, ConsistsOfJerkAloneOnAShortWay) {
  const Parameters parameters{50, 1 << 20, 16'384, 42'950};
  expect_durations(
      parameters,
      {{"I", 135.721}, {"III", 135.721}, {"V", 135.721}, {"VII", 135.721}, {"", 542.882}});
  auto axis = axis_with(parameters);
  axis.advance_to(static_cast<Tick>(542.882 / 2 * Mc1451a::ticks_per_cycle));
  EXPECT_NEAR(static_cast<double>(axis.motion().velocity) / 65536, 0.184202, 1e-4);
  EXPECT_EQ(axis.motion().position, 25);
}

TEST(Mc1451a, MovesInATrapezoidWithoutJerk) {
  // 1 step/cycle at 1/256 step/cycle^2: 256 cycles and 128 steps for each side.
  const Parameters parameters{1000, 65'536, 256, 0, 1};
  expect_durations(parameters,
                   {{"accelerate", 256}, {"cruise", 744}, {"decelerate", 256}, {"", 1256}});
  auto axis = axis_with(parameters);
  EXPECT_EQ(axis.motion(), (Motion{0, 0, 256}));
  axis.advance_to(128 * 16);
  EXPECT_EQ(axis.motion(), (Motion{32, 32'768, 256}));
  axis.advance_to(600 * 16);
  EXPECT_EQ(axis.motion(), (Motion{472, 65'536, 0}));
  axis.advance_to(1128 * 16);
  EXPECT_EQ(axis.motion(), (Motion{968, 32'768, -256}));
  axis.advance_to(1256 * 16);
  EXPECT_EQ(axis.motion(), (Motion{1000, 0, 0}));
  EXPECT_EQ(axis.phase(), "rest");
}

TEST(Mc1451a, MovesInATriangleOnAShortWay) {
  expect_durations({-64, 65'536, 256, 0, 1}, {{"accelerate", 128}, {"decelerate", 128}, {"", 256}});
}

TEST(Mc1451a, RefusesEveryParameterInMotionAndGoesOn) {
  auto axis = axis_with({100'000, 180'224, 66, 42'950});
  auto undisturbed = axis;
  axis.advance_to(5000);
  for (const auto name : {R::profile, R::position, R::velocity, R::acceleration, R::jerk}) {
    const auto before = axis.read(name);
    const auto written = axis.write(name, 1);
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().reason, RegisterError::Reason::in_motion);
    EXPECT_EQ(axis.read(name), before);
  }
  EXPECT_EQ(describe(axis.write(R::jerk, 1).error()), "jerk cannot be changed in motion");
  axis.advance_to(1'000'000);
  undisturbed.advance_to(1'000'000);
  EXPECT_TRUE(axis == undisturbed);
  EXPECT_TRUE(axis.write(R::jerk, 1));
}

TEST(Mc1451a, TakesParametersOfATrapezoidInMotionButNoOtherProfile) {
  auto axis = axis_with({1000, 65'536, 256, 0, 1});
  axis.advance_to(600 * 16);
  EXPECT_FALSE(axis.write(R::profile, 0));
  EXPECT_TRUE(axis.write(R::position, 2000));
  EXPECT_TRUE(axis.write(R::jerk, 5));
  axis.advance_to(1128 * 16);
  EXPECT_EQ(axis.phase(), "cruise") << "where the first position let it slow down";
  axis.advance_to(2256 * 16);
  EXPECT_EQ(axis.motion(), (Motion{2000, 0, 0}));
  EXPECT_TRUE(axis.write(R::profile, 0));
}

// From 1 to 1/2 step/cycle at 1/256 step/cycle^2: 128 cycles, 96 steps.
TEST(Mc1451a, SlowsDownToALowerVelocity) {
  auto axis = axis_with({1000, 65'536, 256, 0, 1});
  axis.advance_to(400 * 16);
  ASSERT_TRUE(axis.write(R::velocity, 32'768));
  EXPECT_EQ(axis.motion(), (Motion{272, 65'536, -256}));
  axis.advance_to(464 * 16);
  EXPECT_EQ(axis.motion().velocity, 49'152);
  EXPECT_EQ(axis.phase(), "decelerate");
  axis.advance_to(528 * 16);
  EXPECT_EQ(axis.motion(), (Motion{368, 32'768, 0}));
  EXPECT_EQ(axis.phase(), "cruise");
  EXPECT_EQ(cycles(arrival(axis, forever).value()), 528 + (1000 - 368 - 32) * 2 + 128);
}

// It stands 128 steps beyond where it is told to turn, and needs as long for the way back.
TEST(Mc1451a, TurnsRoundToATargetBehindIt) {
  auto axis = axis_with({1000, 65'536, 256, 0, 1});
  axis.advance_to(400 * 16);
  ASSERT_TRUE(axis.write(R::position, 272));
  axis.advance_to(656 * 16);
  EXPECT_EQ(axis.motion().position, 400);
  EXPECT_EQ(axis.motion().velocity, 0);
  axis.advance_to(arrival(axis, forever).value());
  EXPECT_EQ(axis.motion(), (Motion{272, 0, 0}));
}

TEST(Mc1451a, StopsAtAVelocityOfNothing) {
  auto axis = axis_with({1000, 65'536, 256, 0, 1});
  axis.advance_to(400 * 16);
  ASSERT_TRUE(axis.write(R::velocity, 0));
  axis.advance_to(1'000'000);
  EXPECT_EQ(axis.motion(), (Motion{400, 0, 0}));
  EXPECT_TRUE(axis.settled());
  EXPECT_FALSE(axis.arrived());
}

TEST(Mc1451a, PassesItsTargetWithoutAnAccelerationAndIsNotThere) {
  auto axis = axis_with({1000, 65'536, 256, 0, 1});
  axis.advance_to(400 * 16);
  ASSERT_TRUE(axis.write(R::acceleration, 0));
  axis.advance_to(1128 * 16);
  EXPECT_EQ(axis.motion(), (Motion{1000, 65'536, 0}));
  EXPECT_TRUE(axis.settled()) << "nothing will change any more";
  EXPECT_FALSE(axis.arrived());
  EXPECT_FALSE(arrival(axis, forever));
  EXPECT_TRUE(axis.write(R::acceleration, 256));
  EXPECT_TRUE(arrival(axis, forever));
}

TEST(Mc1451a, TakesItsParametersInAnyOrderBeforeItStarts) {
  Mc1451a axis;
  EXPECT_TRUE(axis.write(R::position, 50));
  axis.advance_to(1000);
  EXPECT_TRUE(axis.settled());
  EXPECT_FALSE(axis.arrived());
  EXPECT_TRUE(axis.write(R::velocity, 1 << 20));
  EXPECT_EQ(axis.next_change(), forever);
  EXPECT_TRUE(axis.write(R::acceleration, 16'384));
  axis.advance_to(2000);
  EXPECT_EQ(axis.motion(), Motion{});
  EXPECT_TRUE(axis.write(R::jerk, 42'950));
  EXPECT_NE(axis.next_change(), forever);
  EXPECT_EQ(arrival(axis, forever), 2000 + 8687);
}

TEST(Mc1451a, RefusesWhatIsOutOfRange) {
  Mc1451a axis;
  const auto refused = [&](R name, std::int64_t value) {
    const auto written = axis.write(name, value);
    return !written && written.error().reason == RegisterError::Reason::out_of_range;
  };
  const auto infos = Mc1451a::registers();
  for (std::size_t i = 0; i < infos.size(); ++i) {
    const auto name = static_cast<R>(i);
    EXPECT_TRUE(refused(name, infos[i].minimum - 1)) << infos[i].name;
    EXPECT_TRUE(refused(name, infos[i].maximum + 1)) << infos[i].name;
    EXPECT_TRUE(axis.write(name, infos[i].minimum)) << infos[i].name;
  }
  for (std::size_t i = 0; i < infos.size(); ++i) {
    const auto name = static_cast<R>(i);
    EXPECT_TRUE(axis.write(name, infos[i].maximum)) << infos[i].name;
    EXPECT_EQ(axis.read(name), infos[i].maximum) << infos[i].name;
  }
  // Those of the manual's table.
  const std::pair<std::int64_t, std::int64_t> ranges[] = {
      {-1'073'741'824, 1'073'741'823}, {0, 1'073'741'823}, {0, 32'767}, {0, 2'147'483'647}};
  for (std::size_t i = 0; i < std::size(ranges); ++i)
    EXPECT_EQ(std::pair(infos[i + 1].minimum, infos[i + 1].maximum), ranges[i]);
}

TEST(Mc1451a, CrossesTheWholeRangeAtTheLeastVelocity) {
  auto axis = axis_with({-1'073'741'824, 1'073'741'823, 32'767, 2'147'483'647});
  axis.advance_to(arrival(axis, forever).value());
  ASSERT_TRUE(axis.write(R::velocity, 1));
  ASSERT_TRUE(axis.write(R::position, 1'073'741'823));
  const Tick begin = axis.tick();
  const auto end = arrival(axis, forever);
  ASSERT_TRUE(end);
  // 2^31 - 1 steps at 2^-16 steps a cycle.
  EXPECT_NEAR(cycles(*end - begin), 2147483647.0 * 65536, 10);
  axis.advance_to(*end);
  EXPECT_EQ(axis.motion(), (Motion{1'073'741'823, 0, 0}));
}

// Speeding up takes less than two ticks; each of its halves ends within one.
TEST(Mc1451a, HasThePhasesOfLargeMovesInTinyOnes) {
  for (std::int64_t velocity = 1; velocity <= 5; ++velocity) {
    SCOPED_TRACE(velocity);
    auto axis = axis_with({10, velocity, 11'469, 32'212'255});
    std::vector<std::string> phases;
    while (!axis.settled()) {
      phases.emplace_back(axis.phase());
      axis.advance_to(axis.next_change());
    }
    EXPECT_EQ(phases, (std::vector<std::string>{"I", "III", "IV", "V", "VII"}));
  }
}

TEST(Mc1451a, NamesWhatKeepsItFromMoving) {
  const auto messages = [](const Mc1451a& axis) {
    std::string all;
    for (const auto& warning : warnings_of(axis)) all += warning + "; ";
    return all;
  };
  EXPECT_EQ(messages(axis_with({1, 1, 1, 1})), "");
  EXPECT_EQ(messages(axis_with({1, 0, 1, 1})), "velocity 0: the axis cannot move; ");
  EXPECT_EQ(messages(axis_with({1, 1, 0, 0})),
            "acceleration 0: the axis cannot move; jerk 0: the axis cannot move; ");
  EXPECT_EQ(messages(axis_with({1, 1, 1, 0, 1})), "");
}

TEST(Mc1451a, IgnoresAnEarlierTickAndBearsTheLastOne) {
  auto axis = axis_with({50, 1 << 20, 16'384, 42'950});
  axis.advance_to(100);
  axis.advance_to(50);
  EXPECT_EQ(axis.tick(), 100U);
  axis.advance_to(forever);
  EXPECT_TRUE(axis.arrived());
  EXPECT_EQ(axis.motion().position, 50);
}

}  // namespace
}  // namespace tmcl::ramp
