#include "tmcl/ramp/tmc4361.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <string>

#include "tmcl/ramp/passing.hpp"

namespace tmcl::ramp {
namespace {

static_assert(Generator<Tmc4361>);
static_assert(sizeof(Tmc4361) <= 272);

using R = Tmc4361::Register;
using Mode = Tmc4361::Mode;

const double per_second = Tmc4361::ticks_per_second(16e6);

double seconds(Tick ticks) { return static_cast<double>(ticks) / per_second; }
Tick ticks(double seconds) { return static_cast<Tick>(std::llround(seconds * per_second)); }

// In microsteps and seconds.
struct Settings {
  double v = 100'000;
  double a = 200'000;
  double d = 100'000;
  std::array<double, 4> bows{1'000'000, 2'000'000, 500'000, 400'000};
};

void write(Tmc4361& axis, R name, std::int64_t value) { ASSERT_TRUE(axis.write(name, value)); }

Tmc4361 axis_with(const Settings& settings = {}) {
  Tmc4361 axis;
  write(axis, R::vmax, std::llround(settings.v * 256));
  write(axis, R::amax, std::llround(settings.a * 4));
  write(axis, R::dmax, std::llround(settings.d * 4));
  constexpr R bows[] = {R::bow1, R::bow2, R::bow3, R::bow4};
  for (std::size_t i = 0; i < 4; ++i) write(axis, bows[i], std::llround(settings.bows[i]));
  return axis;
}

double pps(const Tmc4361& axis) { return static_cast<double>(axis.motion().velocity) / 256; }
double pps2(const Tmc4361& axis) { return static_cast<double>(axis.motion().acceleration) / 4; }

// The phases in their order, with a space after each, and how many seconds each takes.
struct Course {
  std::string order;
  std::map<std::string, double> lasts;
};

Course course(Tmc4361 axis) {
  Course result;
  while (!axis.settled()) {
    const std::string phase(axis.phase());
    const Tick begin = axis.tick();
    axis.advance_to(axis.next_change());
    result.order += phase + ' ';
    result.lasts[phase] += seconds(axis.tick() - begin);
  }
  return result;
}

// As fast as VMAX, that way, without acceleration.
Tmc4361 turning(const Settings& settings, int way = 1) {
  auto axis = axis_with(settings);
  EXPECT_TRUE(axis.write(Mode::velocity));
  write(axis, R::vmax, way * axis.read(R::vmax));
  axis.advance_to(ticks(60));
  EXPECT_TRUE(axis.settled());
  return axis;
}

TEST(Tmc4361, StandsAfterPowerUp) {
  Tmc4361 axis;
  EXPECT_TRUE(axis.settled());
  EXPECT_TRUE(axis.arrived());
  write(axis, R::xtarget, 1000);
  EXPECT_EQ(axis.next_change(), forever);
  EXPECT_FALSE(axis.arrived());
}

// Every phase in the closed form of a constant bow: a = bow t, v = bow t^2 / 2.
TEST(Tmc4361, GoesThroughAllSevenPhases) {
  auto axis = axis_with();
  write(axis, R::xtarget, 300'000);
  auto [order, lasts] = course(axis);
  EXPECT_EQ(order, "B1 B12 B2 B23 B3 B34 B4 ");
  const double tick = 1.001 * seconds(1);
  EXPECT_NEAR(lasts["B1"], 0.2, tick);
  EXPECT_NEAR(lasts["B12"], (100'000 - 20'000 - 10'000) / 200'000.0, tick);
  EXPECT_NEAR(lasts["B2"], 0.1, tick);
  EXPECT_NEAR(lasts["B3"], 0.2, tick);
  EXPECT_NEAR(lasts["B34"], (100'000 - 10'000 - 12'500) / 100'000.0, tick);
  EXPECT_NEAR(lasts["B4"], 0.25, tick);
}

TEST(Tmc4361, HasTheVelocitiesOfTheClosedFormBetweenItsPhases) {
  auto axis = axis_with();
  write(axis, R::xtarget, 300'000);
  axis.advance_to(ticks(0.2));
  EXPECT_NEAR(pps(axis), 20'000, 1);
  EXPECT_NEAR(pps2(axis), 200'000, 1);
  EXPECT_NEAR(static_cast<double>(axis.motion().position), 1'000'000 * 0.008 / 6, 1);
  axis.advance_to(ticks(0.55));
  EXPECT_NEAR(pps(axis), 90'000, 1);
  EXPECT_NEAR(pps2(axis), 200'000, 1);
  axis.advance_to(ticks(0.65));
  EXPECT_NEAR(pps(axis), 100'000, 1);
  EXPECT_NEAR(pps2(axis), 0, 10);
  const auto end = arrival(axis, last_tick).value();
  axis.advance_to(end - ticks(0.25));
  EXPECT_NEAR(pps(axis), 12'500, 1);
  EXPECT_NEAR(pps2(axis), -100'000, 10);
  axis.advance_to(end);
  EXPECT_EQ(axis.motion(), (Motion{300'000, 0, 0}));
  EXPECT_TRUE(axis.arrived());
}

TEST(Tmc4361, LeavesOutPhasesThatItDoesNotReach) {
  auto axis = axis_with();
  write(axis, R::xtarget, 1'000);
  EXPECT_EQ(course(axis).order, "B1 B2 B3 B4 ");
  write(axis, R::xtarget, -1'000);
  EXPECT_EQ(course(axis).order, "B1 B2 B3 B4 ");
  write(axis, R::vmax, 1'000 * 256);
  EXPECT_EQ(course(axis).order, "B1 B2 B23 B3 B4 ");
  write(axis, R::xtarget, 60'000);
  write(axis, R::vmax, 200'000 * 256);
  EXPECT_EQ(course(axis).order, "B1 B12 B2 B3 B34 B4 ");
}

// The time-optimal durations were calculated with the library Ruckig, which shares nothing with
// this one. All four bows are the same, and so are acceleration and deceleration. The unit of
// length is 100,000 microsteps.
TEST(Tmc4361, IsAsFastAsAnIndependentSolutionWhereItsLimitsAreSymmetric) {
  struct Case {
    double v, distance, v_max, a_max, bow, duration;
  };
  constexpr Case cases[] = {
      {0, -1, 1.25, 2, 11.75, 1.59521276596},      {0, -2, 1.5, 1.75, 2, 3.17480210394},
      {0, -4, 0.5, 2.75, 10.5, 8.43643578047},     {0, 4.75, 2, 3.5, 8.5, 3.35819327731},
      {0, 6, 1.75, 4.75, 4, 4.7514470841},         {0, 7, 1.5, 4.25, 3, 6.08088022904},
      {-1, -7.25, 3.75, 2.5, 5.25, 3.5063223962},  {0.75, -3.75, 0.75, 2.75, 7.75, 6.21137876355},
      {-1, -8.5, 1.5, 2.5, 11.5, 6.14486712353},   {-0.25, 10, 0.75, 3, 4.5, 14.3701209849},
      {1.25, -3.75, 2, 2.5, 11.75, 3.61050531915}, {0.5, -5.75, 1.5, 2.75, 7.75, 5.00488758553},
      {1.25, 4.5, 2, 3.5, 5.75, 2.97520190934},    {-2, 3.5, 3, 2.75, 11.5, 3.54611330698},
      {-0.25, 3.75, 2.5, 4.5, 2.5, 3.78194138322}, {-2.5, -9.75, 2.75, 4.25, 6.75, 4.20129423474},
  };
  constexpr double unit = 100'000;
  for (const auto& c : cases) {
    const double bow = c.bow * unit;
    const Settings settings{
        std::abs(c.v) * unit, c.a_max * unit, c.a_max * unit, {bow, bow, bow, bow}};
    auto axis = c.v == 0 ? axis_with(settings) : turning(settings, c.v < 0 ? -1 : 1);
    write(axis, R::vmax, std::llround(c.v_max * unit * 256));
    write(axis, R::xactual, 0);
    write(axis, R::xtarget, std::llround(c.distance * unit));
    EXPECT_TRUE(axis.write(Mode::position));
    const auto begin = axis.tick();
    const auto end = arrival(axis, last_tick);
    ASSERT_TRUE(end);
    // Where it is at first is half a microstep off at most.
    EXPECT_NEAR(seconds(*end - begin), c.duration, 20e-6) << c.distance;
  }
}

// BOW2 and BOW4 alone say whether it stands when it turns round.
TEST(Tmc4361, TurnsRoundWithoutAPauseIfBow2EqualsBow4) {
  Settings settings;
  settings.bows = {1'000'000, 400'000, 500'000, 400'000};
  auto axis = turning(settings);
  write(axis, R::vmax, -axis.read(R::vmax));
  axis.advance_to(ramp::turning(axis).tick);
  EXPECT_NEAR(pps(axis), 0, 1);
  EXPECT_NEAR(pps2(axis), -100'000, 10);
}

TEST(Tmc4361, TurnsRoundThroughStandstillIfBow2AndBow4Differ) {
  auto axis = turning(Settings{});
  write(axis, R::vmax, -axis.read(R::vmax));
  EXPECT_EQ(course(axis).order, "B3 B34 B4 B1 B12 B2 ");
  const auto turned = ramp::turning(axis);
  ASSERT_TRUE(turned.passed);
  axis.advance_to(turned.tick);
  EXPECT_NEAR(pps(axis), 0, 1);
  EXPECT_NEAR(pps2(axis), 0, 20);
}

TEST(Tmc4361, StopsAPositioningWithAVmaxOf0AndProceeds) {
  auto axis = axis_with();
  write(axis, R::xtarget, 300'000);
  axis.advance_to(ticks(1));
  write(axis, R::vmax, 0);
  EXPECT_EQ(course(axis).order, "B3 B34 B4 ");
  axis.advance_to(ticks(3));
  EXPECT_EQ(axis.heading(), 0);
  EXPECT_FALSE(axis.arrived());
  write(axis, R::vmax, 50'000 * 256);
  axis.advance_to(ticks(60));
  EXPECT_EQ(axis.motion().position, 300'000);
  EXPECT_TRUE(axis.arrived());
}

TEST(Tmc4361, TakesANewTargetAndVelocityInTheMiddleOfABow) {
  auto axis = axis_with();
  write(axis, R::xtarget, 300'000);
  axis.advance_to(ticks(0.1));
  EXPECT_EQ(axis.phase(), "B1");
  const auto before = axis.motion();
  write(axis, R::xtarget, -5'000);
  write(axis, R::vmax, 20'000 * 256);
  EXPECT_EQ(axis.motion(), before);
  EXPECT_EQ(course(axis).order, "B2 B3 B4 B1 B2 B23 B3 B4 ");
  axis.advance_to(arrival(axis, last_tick).value());
  EXPECT_EQ(axis.motion(), (Motion{-5'000, 0, 0}));
}

// 4,194,303 pps/s in 1024 clocks: 200,000 pps/s in 3 us.
TEST(Tmc4361, MovesNearlyInATrapezoidWithoutBows) {
  Settings settings;
  settings.bows = {0, 0, 0, 0};
  auto axis = axis_with(settings);
  write(axis, R::xtarget, 300'000);
  auto [order, lasts] = course(axis);
  EXPECT_NEAR(lasts["B12"], 0.5, 10e-6);
  EXPECT_NEAR(lasts["B34"], 1, 10e-6);
  EXPECT_NEAR(seconds(arrival(axis, last_tick).value()), 3 + 0.25 + 0.5, 20e-6);
}

TEST(Tmc4361, StopsAtASwitchAtOnceOrLinearly) {
  for (const bool soft : {false, true}) {
    auto axis = turning(Settings{});
    write(axis, R::stop_right_en, 1);
    write(axis, R::soft_stop_en, soft ? 1 : 0);
    write(axis, R::dstop, 400'000 * 4);
    axis.set_switches(false, true);
    EXPECT_EQ(axis.phase(), soft ? "stop" : "rest");
    const auto begin = axis.tick();
    axis.advance_to(begin + ticks(0.125));
    EXPECT_NEAR(pps(axis), soft ? 50'000 : 0, 1);
    axis.advance_to(begin + ticks(1));
    EXPECT_EQ(axis.heading(), 0);
    write(axis, R::vmax, -1'000 * 256);
    axis.advance_to(begin + ticks(5));
    EXPECT_EQ(pps(axis), -1'000);
  }
}

TEST(Tmc4361, StopsDeadWhenItIsHalted) {
  auto axis = turning(Settings{});
  const auto position = axis.motion().position;
  axis.halt();
  axis.advance_to(axis.tick() + 1000);
  EXPECT_EQ(axis.motion(), (Motion{position, 0, 0}));
}

TEST(Tmc4361, CountsInMicrostepsPerSecondOfItsOwnClock) {
  auto axis = axis_with();
  write(axis, R::clk_freq, 8'000'000);
  EXPECT_TRUE(axis.write(Mode::velocity));
  axis.advance_to(static_cast<Tick>(Tmc4361::ticks_per_second(8e6) * 10));
  const auto position = axis.motion().position;
  axis.advance_to(axis.tick() + static_cast<Tick>(Tmc4361::ticks_per_second(8e6)));
  EXPECT_NEAR(static_cast<double>(axis.motion().position - position), 100'000, 1);
}

TEST(Tmc4361, RefusesWhatIsOutOfRange) {
  Tmc4361 axis;
  EXPECT_FALSE(axis.write(R::rampmode, 1));
  EXPECT_FALSE(axis.write(R::rampmode, 5));
  EXPECT_FALSE(axis.write(R::bow1, 1 << 24));
  EXPECT_FALSE(axis.write(R::bow4, -1));
  EXPECT_FALSE(axis.write(R::amax, 1 << 24));
  EXPECT_FALSE(axis.write(R::vmax, std::int64_t{1} << 31));
  EXPECT_TRUE(axis.write(R::vmax, -(std::int64_t{1} << 31) + 1));
}

TEST(Tmc4361, NamesWhatDoesNotGoTogether) {
  const auto messages = [](const Tmc4361& axis) {
    std::string all;
    for (const auto& warning : warnings_of(axis)) all += warning + "; ";
    return all;
  };
  auto axis = axis_with();
  EXPECT_EQ(messages(axis), "");
  write(axis, R::bow3, 0);
  EXPECT_EQ(messages(axis), "bow3 0: taken as none, where the data sheet wants at least 1; ");
  write(axis, R::bow3, 1'000'000);
  write(axis, R::amax, 40);
  write(axis, R::dmax, 40);
  EXPECT_THAT(messages(axis),
              testing::StartsWith(
                  "bow1 1000000 is more than the greater of amax 40 and dmax 40 allows; bow2"));
  axis = axis_with();
  write(axis, R::vmax, 5'000'000LL * 256);
  EXPECT_EQ(messages(axis), "vmax 1280000000 is more than 1/4 microstep a clock; ");
  EXPECT_TRUE(axis.write(Mode::velocity));
  EXPECT_EQ(messages(axis), "");
}

}  // namespace
}  // namespace tmcl::ramp
