#include "tmcl/ramp/tmc457.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <tuple>
#include <vector>

namespace tmcl::ramp {
namespace {

static_assert(Generator<Tmc457>);
static_assert(sizeof(Tmc457) <= 256);

using R = Tmc457::Register;
using Mode = Tmc457::Mode;

constexpr double clock_hz = 16e6;

double in_units(double value, RegisterUnit unit) {
  return value * static_cast<double>(unit.numerator) / static_cast<double>(unit.denominator);
}
double in_pps(double velocity) { return in_units(velocity, tmc457_velocity_unit); }
double seconds(Tick ticks) { return static_cast<double>(ticks) / clock_hz; }
Tick ticks(double seconds) { return static_cast<Tick>(std::llround(seconds * clock_hz)); }

struct Settings {
  std::int64_t v_max = 5'000'000;
  std::int64_t a_max = 24'624;
  std::int64_t d_max = 24'624;
  std::int64_t bow_max = 11;
};

void write(Tmc457& axis, R name, std::int64_t value) { ASSERT_TRUE(axis.write(name, value)); }

Tmc457 axis_with(const Settings& settings) {
  Tmc457 axis;
  write(axis, R::v_max, settings.v_max);
  write(axis, R::a_max, settings.a_max);
  write(axis, R::d_max, settings.d_max);
  write(axis, R::bow_max, settings.bow_max);
  return axis;
}

Tmc457 turning_at(const Settings& settings, std::int64_t v_target) {
  auto axis = axis_with(settings);
  EXPECT_TRUE(axis.write(Mode::velocity));
  write(axis, R::v_target, v_target);
  return axis;
}

// The phases in their order, with a space after each, and how many seconds each takes.
struct Course {
  std::string order;
  std::map<std::string, double> lasts;
};

Course course(Tmc457 axis) {
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

std::string messages(const Tmc457& axis) {
  std::string all;
  for (const auto& warning : warnings_of(axis)) all += warning + "; ";
  return all;
}

TEST(Tmc457, StandsAfterPowerUp) {
  Tmc457 axis;
  EXPECT_TRUE(axis.settled());
  EXPECT_TRUE(axis.arrived());
  write(axis, R::x_target, 1000);
  axis.advance_to(ticks(10));
  EXPECT_EQ(axis.motion(), Motion{});
  EXPECT_EQ(axis.phase(), "rest");
  EXPECT_FALSE(axis.arrived());
  EXPECT_TRUE(axis.settled());
}

TEST(Tmc457, ConvertsUnitsAsTheApplicationNoteDoes) {
  EXPECT_DOUBLE_EQ(in_pps(0x7FFF0000), 2147418112.0 * 2 * 16e6 / 2147483648);
  EXPECT_DOUBLE_EQ(in_units(1, tmc457_acceleration_unit), 16e6 * 16e6 / (16 * 256) / (1 << 30));
  EXPECT_NEAR(in_units(1, tmc457_acceleration_unit), 58.21, 0.005);
}

TEST(Tmc457, TurnsAtTheRateThatTheUnitSays) {
  auto axis = turning_at({}, -5'000'000);
  axis.advance_to(ticks(1));
  EXPECT_EQ(axis.motion().velocity, -5'000'000);
  const auto begin = axis.motion().position;
  axis.advance_to(ticks(11));
  EXPECT_NEAR(static_cast<double>(begin - axis.motion().position), 10 * in_pps(5'000'000), 1);
}

// 2 v^2 / a / 2^18, as the note prints it, would be four times as much.
TEST(Tmc457, TakesHalfOfVSquaredOverAToSpeedUp) {
  auto axis = turning_at({.bow_max = 0}, 5'000'000);
  axis.advance_to(axis.next_change());
  EXPECT_EQ(axis.motion().velocity, 5'000'000);
  EXPECT_NEAR(static_cast<double>(axis.motion().position), 1936.5, 1);
  EXPECT_NEAR(seconds(axis.tick()), 5e6 / 24'624 * 4096 / clock_hz, 1 / clock_hz);
}

TEST(Tmc457, ReachesTheAccelerationInTheTimeThatTheBowGives) {
  for (const int bow : {9, 10, 11, 12}) {
    auto axis = turning_at({.v_max = 0, .a_max = 24'624, .bow_max = bow}, 0x7FFF0000);
    EXPECT_EQ(axis.phase(), "I");
    axis.advance_to(axis.next_change());
    EXPECT_EQ(axis.phase(), "II");
    EXPECT_EQ(axis.motion().acceleration, 24'624);
    EXPECT_NEAR(static_cast<double>(axis.tick()), 24'624.0 / (1 << (bow - 1)) * 1024, 1);
  }
}

TEST(Tmc457, ChangesItsVelocityInTheTimeOfTheClosedForm) {
  const double a = 24'624 / 4096.0;       // units of v in a clock
  const double b = 1024 / 4096.0 / 1024;  // of a in a clock
  const double least = a * a / b;         // below that it does not reach a
  for (const double change : {0.1 * least, 0.9 * least, 1.1 * least, 10 * least}) {
    const auto v = std::llround(change);
    const double expected = change >= least ? change / a + a / b : 2 * std::sqrt(change / b);
    auto axis = turning_at({.bow_max = 11}, v);
    while (!axis.settled()) axis.advance_to(axis.next_change());
    EXPECT_NEAR(static_cast<double>(axis.tick()), expected, 2) << change;
    EXPECT_EQ(axis.motion().velocity, v);
    EXPECT_NEAR(static_cast<double>(axis.motion().position), change / 2 * expected * 0x1p-30, 1);
  }
}

TEST(Tmc457, DeceleratesWith15SixteenthsInAnSRampOnly) {
  const auto plateau = [](std::int64_t bow) {
    auto axis = axis_with({5'000'000, 24'624, 20'000, bow});
    write(axis, R::x_target, 100'000);
    while (axis.phase() != "VI" && axis.phase() != "decelerate") {
      axis.advance_to(axis.next_change());
    }
    return static_cast<double>(-axis.motion().acceleration);
  };
  EXPECT_NEAR(plateau(11) / 20'000, 0.9375, 0.0009);
  EXPECT_EQ(plateau(0), 20'000);
}

TEST(Tmc457, GoesThroughAllSevenPhases) {
  auto axis = axis_with({});
  write(axis, R::x_target, 100'000);
  const auto result = course(axis);
  EXPECT_EQ(result.order, "I II III IV V VI VII ");
  const double t_bow = 24'624.0 / 1024 * 1024 / clock_hz;
  const double t_v = 5e6 / 24'624 * 4096 / clock_hz;  // at constant acceleration
  EXPECT_NEAR(result.lasts.at("I"), t_bow, 1e-6);
  EXPECT_NEAR(result.lasts.at("II"), t_v - t_bow, 1e-6);
  EXPECT_NEAR(result.lasts.at("V"), t_bow * 15 / 16, 1e-6);
  EXPECT_NEAR(result.lasts.at("VI"), t_v * 16 / 15 - t_bow * 15 / 16, 1e-6);
  const double sides =
      5e6 * clock_hz / (1 << 30) / 2 * (t_v + t_bow + (t_v * 16 + t_bow * 15 * 15 / 16) / 15);
  EXPECT_NEAR(result.lasts.at("IV"), (100'000 - sides) / in_pps(5'000'000), 2e-6);
}

TEST(Tmc457, LeavesOutWhatItDoesNotReach) {
  auto axis = axis_with({});
  write(axis, R::x_target, -2000);
  EXPECT_EQ(course(axis).order, "I II III V VI VII ");
  write(axis, R::x_target, -2);
  const auto result = course(axis);
  EXPECT_EQ(result.order, "I III V VII ");
  // 2 = 2 b t^3 in units of microsteps and clocks.
  const double t = std::cbrt(2 / (2 * 1024 * 0x1p-52)) / clock_hz;
  EXPECT_NEAR(result.lasts.at("I"), t, 1e-6);
}

TEST(Tmc457, MovesInATrapezoidWithoutBow) {
  auto axis = axis_with({.d_max = 12'312, .bow_max = 0});
  write(axis, R::x_target, 100'000);
  const auto result = course(axis);
  EXPECT_EQ(result.order, "accelerate cruise decelerate ");
  const double t = 5e6 / 24'624 * 4096 / clock_hz;
  EXPECT_NEAR(result.lasts.at("accelerate"), t, 1e-6);
  EXPECT_NEAR(result.lasts.at("decelerate"), 2 * t, 1e-6);
  write(axis, R::x_target, 1000);
  EXPECT_EQ(course(axis).order, "accelerate decelerate ");
}

TEST(Tmc457, StandsOnTheTargetWhenPredicted) {
  auto axis = axis_with({});
  write(axis, R::x_target, 12'345);
  const auto end = arrival(axis, forever);
  ASSERT_TRUE(end);
  axis.advance_to(*end - 1);
  EXPECT_FALSE(axis.arrived());
  axis.advance_to(*end);
  EXPECT_TRUE(axis.arrived());
  EXPECT_EQ(axis.motion(), (Motion{12'345, 0, 0}));
  axis.advance_to(*end + ticks(3600));
  EXPECT_EQ(axis.motion(), (Motion{12'345, 0, 0}));
}

TEST(Tmc457, TurnsRoundWithoutPause) {
  auto axis = axis_with({});
  write(axis, R::x_target, 100'000);
  axis.advance_to(ticks(0.5));
  write(axis, R::x_target, -5'000);
  EXPECT_EQ(course(axis).order, "V VI I II III IV V VI VII ");
  axis.advance_to(arrival(axis, forever).value());
  EXPECT_EQ(axis.motion().position, -5'000);
}

TEST(Tmc457, KeepsBrakingToATargetAtWhichItBrakesAnyway) {
  auto axis = axis_with({});
  write(axis, R::x_target, 10'000);
  const auto end = arrival(axis, forever).value();
  while (axis.phase() != "VI") axis.advance_to(axis.next_change());
  axis.advance_to(axis.tick() + 1000);
  write(axis, R::x_target, 10'000);
  EXPECT_EQ(axis.phase(), "VI");
  EXPECT_NEAR(static_cast<double>(arrival(axis, forever).value()), static_cast<double>(end), 2);
}

TEST(Tmc457, TakesBrakingBackForATargetALittleFartherOff) {
  auto axis = axis_with({});
  write(axis, R::x_target, 10'000);
  while (axis.phase() != "VI") axis.advance_to(axis.next_change());
  axis.advance_to(axis.tick() + 10'000);
  write(axis, R::x_target, 10'020);
  EXPECT_EQ(course(axis).order, "VII V VI VII ");
  axis.advance_to(arrival(axis, forever).value());
  EXPECT_EQ(axis.motion().position, 10'020);
}

TEST(Tmc457, SlowsDownWhenVMaxIsLoweredInMotion) {
  auto axis = axis_with({});
  write(axis, R::x_target, 1'000'000);
  axis.advance_to(ticks(0.5));
  write(axis, R::v_max, 2'000'000);
  EXPECT_EQ(axis.motion().velocity, 5'000'000);
  EXPECT_EQ(course(axis).order, "V VI VII IV V VI VII ");
  axis.advance_to(ticks(0.6));
  EXPECT_EQ(axis.motion().velocity, 2'000'000);
  write(axis, R::v_max, 0);
  axis.advance_to(ticks(1));
  EXPECT_TRUE(axis.settled());
  EXPECT_EQ(axis.motion().velocity, 0);
}

TEST(Tmc457, TakesANewAccelerationInMotion) {
  auto axis = axis_with({.bow_max = 0});
  write(axis, R::x_target, 1'000'000);
  axis.advance_to(ticks(0.01));
  write(axis, R::a_max_d_max, 10'000);
  EXPECT_EQ(axis.motion().acceleration, 10'000);
  EXPECT_EQ(axis.read(R::d_max), 10'000);
  EXPECT_EQ(axis.read(R::a_max_d_max), 10'000);
  axis.advance_to(arrival(axis, forever).value());
  EXPECT_EQ(axis.motion().position, 1'000'000);
}

/// In each part of a move; what a part does not depend on may stay as it was.
TEST(Tmc457, TakesEachOfItsParametersInMotion) {
  const std::vector<std::tuple<R, std::int64_t, std::vector<std::string>>> writes{
      {R::a_max, 12'000, {"I", "II"}},
      {R::d_max, 12'000, {"I", "II", "III", "IV", "V"}},
      {R::bow_max, 10, {"I", "II", "III", "IV", "V"}},
      {R::v_max, 4'000'000, {"I", "II", "III", "IV"}},
      {R::x_target, 300'000, {"I", "II", "III", "IV", "V", "VI", "VII"}}};
  for (const auto& [name, value, phases] : writes) {
    auto axis = axis_with({.a_max = 20'000, .d_max = 20'000});
    write(axis, R::x_target, 200'000);
    const auto unchanged = arrival(axis, forever).value();
    for (; !axis.settled(); axis.advance_to(axis.next_change())) {
      if (std::ranges::find(phases, axis.phase()) == phases.end()) break;
      auto other = axis;
      other.advance_to((axis.tick() + axis.next_change()) / 2);
      ASSERT_TRUE(other.write(name, value));
      const auto there = arrival(other, forever);
      ASSERT_TRUE(there) << axis.phase();
      EXPECT_GT(*there, unchanged + ticks(1e-4)) << static_cast<int>(name) << axis.phase();
      other.advance_to(*there);
      EXPECT_EQ(other.motion().position, other.read(R::x_target));
    }
  }
}

TEST(Tmc457, LimitsOnlyPositioningToVMax) {
  auto axis = turning_at({.v_max = 1000}, 2000);
  axis.advance_to(ticks(1));
  EXPECT_EQ(axis.motion().velocity, 2000);
}

TEST(Tmc457, RampsThroughZeroInVelocityMode) {
  auto axis = turning_at({}, 3'000'000);
  axis.advance_to(ticks(1));
  EXPECT_EQ(axis.phase(), "IV");
  write(axis, R::v_target, -3'000'000);
  EXPECT_EQ(course(axis).order, "V VI I II III ");
  axis.advance_to(ticks(2));
  EXPECT_EQ(axis.motion().velocity, -3'000'000);
  EXPECT_TRUE(axis.settled());
  EXPECT_FALSE(axis.arrived());
}

TEST(Tmc457, TakesTheTargetVelocityAtOnceInHoldMode) {
  Tmc457 axis;
  EXPECT_TRUE(axis.write(Mode::hold));
  write(axis, R::v_target, 0x7FFF0000);
  EXPECT_EQ(axis.motion().velocity, 0x7FFF0000);
  EXPECT_EQ(axis.phase(), "hold");
  axis.advance_to(ticks(1));
  EXPECT_EQ(axis.motion().position, 31'999'023);  // 0x7FFF0000 * 16e6 / 2^30 = 31,999,023.4
  write(axis, R::v_target, 0);
  axis.advance_to(ticks(2));
  EXPECT_EQ(axis.motion(), (Motion{31'999'023, 0, 0}));
}

TEST(Tmc457, MovesWhenItsPositionIsOverwritten) {
  auto axis = axis_with({});
  write(axis, R::x_actual, 500);
  EXPECT_EQ(axis.read(R::x_actual), 500);
  EXPECT_FALSE(axis.arrived());
  axis.advance_to(arrival(axis, forever).value());
  EXPECT_EQ(axis.motion().position, 0);
  EXPECT_TRUE(axis.write(Mode::velocity));
  write(axis, R::x_actual, 500);
  axis.advance_to(axis.tick() + ticks(1));
  EXPECT_EQ(axis.motion().position, 500);
}

TEST(Tmc457, WrapsItsPositionAt32Bit) {
  auto axis = turning_at({}, 5'000'000);
  write(axis, R::x_actual, 2'147'483'647);
  axis.advance_to(ticks(1));
  EXPECT_LT(axis.motion().position, -2'147'400'000);
  write(axis, R::x_target, 2'147'483'000);
  EXPECT_TRUE(axis.write(Mode::position));
  axis.advance_to(arrival(axis, forever).value());
  EXPECT_EQ(axis.motion().position, 2'147'483'000);
  EXPECT_LT(seconds(axis.tick()), 5);  // the short way
}

TEST(Tmc457, StandsOrGoesOnWithoutAccelerationOrDeceleration) {
  auto stands = axis_with({.a_max = 0});
  write(stands, R::x_target, 100);
  EXPECT_TRUE(stands.settled());
  stands.advance_to(ticks(1));
  EXPECT_EQ(stands.motion(), Motion{});

  for (const int bow : {0, 11}) {
    auto moving = axis_with({.bow_max = bow});
    write(moving, R::x_target, 100'000);
    moving.advance_to(ticks(0.5));
    auto coasting = moving;
    write(coasting, R::d_max, 0);
    coasting.advance_to(ticks(10));
    EXPECT_EQ(coasting.motion().velocity, 5'000'000);
    EXPECT_TRUE(coasting.settled());
    EXPECT_FALSE(arrival(coasting, forever));

    write(moving, R::a_max, 0);
    EXPECT_EQ(arrival(moving, forever).has_value(), true);
    write(moving, R::x_target, -100'000);
    moving.advance_to(ticks(10));
    EXPECT_EQ(moving.motion().velocity, 0);  // cannot speed up the other way
    EXPECT_FALSE(moving.arrived());
  }
}

TEST(Tmc457, StopsAtASwitchLinearly) {
  auto axis = axis_with({});
  write(axis, R::x_target, 100'000);
  write(axis, R::enable_stop_r, 1);
  write(axis, R::d_stop, 100'000);
  axis.advance_to(ticks(0.5));
  axis.set_switches(true, false);
  EXPECT_EQ(axis.phase(), "IV");  // the left one does not concern it
  axis.set_switches(false, true);
  EXPECT_EQ(axis.phase(), "stop");
  EXPECT_EQ(axis.motion().acceleration, -100'000);
  const auto begin = axis.motion().position;
  const Tick end = axis.next_change();
  EXPECT_NEAR(seconds(end - axis.tick()), 5e6 / 100'000 * 4096 / clock_hz, 1e-6);
  axis.advance_to(end);
  EXPECT_EQ(axis.phase(), "rest");
  EXPECT_NEAR(static_cast<double>(axis.motion().position - begin), 5e6 * 5e6 / 1e5 * 0x1p-19, 1);
  EXPECT_TRUE(axis.settled());
  EXPECT_FALSE(axis.arrived());

  auto back = axis;
  write(back, R::x_target, 0);
  back.advance_to(arrival(back, forever).value());
  EXPECT_EQ(back.motion().position, 0);

  axis.set_switches(false, false);
  axis.advance_to(arrival(axis, forever).value());
  EXPECT_EQ(axis.motion().position, 100'000);
}

TEST(Tmc457, StopsWhenTheSwitchClosesTowardsWhichItIsAboutToTurn) {
  auto axis = turning_at({}, -5'000'000);
  write(axis, R::enable_stop_r, 1);
  write(axis, R::d_stop, 100'000);
  axis.advance_to(ticks(1));
  write(axis, R::v_target, 5'000'000);
  while (axis.phase() != "VI") axis.advance_to(axis.next_change());
  axis.advance_to(axis.next_change() - 1000);
  ASSERT_LT(axis.motion().velocity, 0);
  axis.set_switches(false, true);
  EXPECT_EQ(axis.phase(), "stop");
  const auto begin = axis.motion().position;
  while (!axis.settled()) axis.advance_to(axis.tick() + 1);
  EXPECT_EQ(axis.motion().velocity, 0);
  EXPECT_LE(axis.motion().position, begin);
}

TEST(Tmc457, CutsAnAccelerationThatALoweredBowCannotTakeBackInTime) {
  auto axis = turning_at({.a_max = 0xFFFFFD, .d_max = 0xFFFFFD, .bow_max = 18}, 0x7FFF0000);
  while (axis.phase() != "II") axis.advance_to(axis.next_change());
  axis.advance_to(axis.next_change() - 1);
  EXPECT_EQ(axis.motion().acceleration, 0xFFFFFD);
  write(axis, R::bow_max, 1);
  // a^2 / 2b = 2^31 - v
  const auto v = static_cast<double>(axis.motion().velocity);
  EXPECT_NEAR(static_cast<double>(axis.motion().acceleration),
              std::sqrt(2 * (0x1p31 - v) / 1024 / 4096) * 4096, 2);
  axis.advance_to(axis.next_change());
  EXPECT_NEAR(static_cast<double>(axis.motion().velocity), 0x1p31, 100);
  while (!axis.settled()) axis.advance_to(axis.next_change());
  EXPECT_EQ(axis.motion().velocity, 0x7FFF0000);
}

TEST(Tmc457, DoesNotTurnTowardsAClosedSwitch) {
  for (const auto mode : {Mode::position, Mode::velocity, Mode::hold}) {
    auto axis = axis_with({});
    EXPECT_TRUE(axis.write(mode));
    write(axis, R::d_stop, 100'000);
    write(axis, R::enable_stop_l, 1);
    axis.set_switches(true, false);
    write(axis, R::x_target, -1000);
    write(axis, R::v_target, -1000);
    axis.advance_to(ticks(1));
    EXPECT_EQ(axis.motion(), Motion{});
    write(axis, R::enable_stop_l, 0);
    axis.advance_to(ticks(2));
    EXPECT_LT(axis.motion().position, 0);
  }
}

TEST(Tmc457, OscillatesAroundItsTargetWhenTheBowExceedsTheAcceleration) {
  auto axis = axis_with({.bow_max = 18});
  write(axis, R::x_target, 10'000);
  EXPECT_EQ(axis.phase(), "oscillate");
  axis.advance_to(ticks(10));
  EXPECT_FALSE(axis.settled());
  EXPECT_FALSE(arrival(axis, axis.tick() + ticks(1)));
  // One bow tick to speed up and one to slow down bring it 1024^2 * 2^17 / 2^42 microsteps on; at
  // the most it swings between four and five times as much.
  const double amplitude = 5 * 0x1p-5;
  for (int i = 0; i < 100; ++i) {
    axis.advance_to(axis.next_change());
    EXPECT_NEAR(to_double(axis.track().start().x), 10'000, amplitude);
    EXPECT_EQ(std::abs(axis.motion().acceleration), 131'072);
  }
  const auto before = axis.track().start().x;
  axis.advance_to(axis.tick() + 4 * 1024 * 1'000'000'000'000ULL);
  EXPECT_EQ(axis.track().start().x, before);
  write(axis, R::bow_max, 11);
  EXPECT_TRUE(arrival(axis, forever));
}

TEST(Tmc457, OscillatesAroundAVelocityThatIsNoMultipleOfTheBow) {
  auto axis = turning_at({.bow_max = 18}, 100'000);
  axis.advance_to(ticks(1) / 1024 * 1024);
  const auto v = axis.motion().velocity;
  EXPECT_TRUE(v == 131'072 || v == 98'304) << v;  // 3 or 4 times 131072 / 4
  axis.advance_to(axis.tick() + 1024);
  EXPECT_EQ(axis.motion().velocity, 131'072 + 98'304 - v);
  write(axis, R::v_target, 131'072);
  axis.advance_to(axis.tick() + 4096);
  EXPECT_TRUE(axis.settled());
  EXPECT_EQ(axis.motion().velocity, 131'072);
}

TEST(Tmc457, WarnsOfABowThatIsTooGreat) {
  const auto warning = [](std::int64_t a, std::int64_t d, std::int64_t bow) {
    return messages(axis_with({1, a, d, bow}));
  };
  EXPECT_EQ(warning(131'071, 300'000, 18),
            "bow_max 18 is 131072 and so exceeds a_max 131071: the motor oscillates; ");
  EXPECT_EQ(warning(300'000, 262'144, 18),
            "bow_max 18 is 131072, no less than half of d_max 262144: the motor may oscillate; ");
  EXPECT_EQ(warning(262'145, 262'145, 18), "");
  EXPECT_EQ(warning(1, 1, 0), "");
}

TEST(Tmc457, WarnsOfSettingsThatKeepItFromMovingOrStopping) {
  Tmc457 axis;
  EXPECT_EQ(messages(axis),
            "a_max 0: the motor cannot speed up; d_max 0: the motor cannot slow down; v_max 0: the "
            "motor cannot drive to a target; ");
  axis = axis_with({});
  EXPECT_EQ(messages(axis), "");
  write(axis, R::enable_stop_r, 1);
  EXPECT_EQ(messages(axis), "d_stop 0: a switch does not stop the motor; ");
}

TEST(Tmc457, ShowsItsStatus) {
  using Status = Tmc457::Status;
  auto axis = axis_with({});
  write(axis, R::x_target, 100'000);
  EXPECT_EQ(axis.status(), (Status{false, false, false}));
  axis.advance_to(ticks(0.5));
  EXPECT_EQ(axis.status(), (Status{false, true, false}));
  axis.advance_to(arrival(axis, forever).value());
  EXPECT_EQ(axis.status(), (Status{true, false, true}));
  EXPECT_TRUE(axis.write(Mode::velocity));
  EXPECT_EQ(axis.status(), (Status{false, true, true}));
  write(axis, R::v_target, 1000);
  EXPECT_EQ(axis.status(), (Status{false, false, false}));
  axis.advance_to(axis.tick() + ticks(1));
  EXPECT_EQ(axis.status(), (Status{false, true, false}));
}

TEST(Tmc457, RefusesWhatIsOutOfRange) {
  Tmc457 axis;
  const auto refused = [&](R name, std::int64_t value) {
    const auto written = axis.write(name, value);
    return !written && written.error().reason == RegisterError::Reason::out_of_range;
  };
  const auto infos = Tmc457::registers();
  for (std::size_t i = 0; i < infos.size(); ++i) {
    const auto name = static_cast<R>(i);
    EXPECT_TRUE(refused(name, infos[i].minimum - 1)) << infos[i].name;
    EXPECT_TRUE(refused(name, infos[i].maximum + 1)) << infos[i].name;
    for (const auto value : {infos[i].maximum, infos[i].minimum}) {
      EXPECT_TRUE(axis.write(name, value)) << infos[i].name;
      EXPECT_EQ(axis.read(name), value) << infos[i].name;
    }
  }
  EXPECT_TRUE(refused(R::mode, 1));
  EXPECT_EQ(axis.write(R::mode, 1).error().info->name, "mode");
}

TEST(Tmc457, IgnoresAnEarlierTickAndBearsTheLastOne) {
  auto axis = axis_with({});
  write(axis, R::x_target, 100);
  axis.advance_to(100);
  axis.advance_to(50);
  EXPECT_EQ(axis.tick(), 100U);
  axis.advance_to(forever);
  EXPECT_EQ(axis.motion().position, 100);
  write(axis, R::x_target, 0);
  axis.advance_to(forever);
  EXPECT_EQ(axis.tick(), forever);
}

}  // namespace
}  // namespace tmcl::ramp
