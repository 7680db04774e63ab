#include "tmcl/ramp/tmc429.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string_view>
#include <vector>

#include "tmcl/units.hpp"

namespace tmcl::ramp {
namespace {

using Mode = Tmc429::Mode;
using R = Tmc429::Register;

static_assert(Generator<Tmc429>);
static_assert(sizeof(Tmc429) <= 256);

constexpr double ticks_per_second = 500e3;

struct Settings {
  Tmc429Dividers dividers{2, 3};
  std::int32_t v_max = 1000;
  std::int32_t a_max = 500;
};

// What the firmware of a module writes at its start.
Tmc429 axis_with(Settings settings) {
  Tmc429 axis;
  axis.write(R::v_min, 1);
  axis.write(R::v_max, settings.v_max);
  axis.write(R::pulse_div, settings.dividers.pulse);
  axis.write(R::ramp_div, settings.dividers.ramp);
  axis.write(R::a_max, settings.a_max);
  return axis;
}

// What axis_with({}) makes of it: microsteps a second of one unit of speed, and how long it takes
// from standstill to 1000 of them.
constexpr double pps_of_unit = tmc429_clock_hz / 0x1p18;
constexpr double time_to_speed = 1000 * 0x1p16 / (tmc429_clock_hz * 500);

double seconds(Tick ticks) { return static_cast<double>(ticks) / ticks_per_second; }
Tick ticks(double seconds) { return static_cast<Tick>(std::llround(seconds * ticks_per_second)); }

// "Should be greater than 1", says the application note; the data sheet does with 1.
TEST(Tmc429, NeedsAMinimumVelocityOf1ToArrive) {
  for (const auto& [v_min, end] : {std::pair{0, 4999}, {1, 5000}, {2, 5000}, {20, 5000}}) {
    auto axis = axis_with({});
    axis.write(R::v_min, v_min);
    axis.write(R::x_target, 5000);
    axis.advance_to(ticks(10));
    EXPECT_EQ(axis.x_actual(), end) << v_min;
  }
}

TEST(Tmc429, StandsAfterPowerUpWhateverItsTarget) {
  Tmc429 axis;
  axis.write(R::x_target, 1000);
  axis.advance_to(ticks(10));
  EXPECT_EQ(axis.x_actual(), 0);
  EXPECT_EQ(axis.tick(), ticks(10));
}

/// In modes 0 and 1 it goes to its target, in the two others it keeps a speed; it begins in 0.
TEST(Tmc429, HasFourModesOfWhichRampIsTheFirst) {
  const auto after_a_minute = [](std::optional<int> mode) {
    auto axis = axis_with({});
    if (mode) axis.write(R::mode, *mode);
    axis.write(R::v_target, 100);
    axis.write(R::v_actual, 100);
    axis.write(R::x_target, 5000);
    axis.advance_to(ticks(60));
    return axis.x_actual();
  };
  EXPECT_EQ(Tmc429().read(R::mode), 0);
  EXPECT_EQ(after_a_minute(std::nullopt), 5000);
  EXPECT_EQ(after_a_minute(0), 5000);
  EXPECT_NEAR(after_a_minute(1), 5000, 1);
  EXPECT_GT(after_a_minute(2), 100 * pps_of_unit * 59);
  EXPECT_GT(after_a_minute(3), 100 * pps_of_unit * 59);
}

TEST(Tmc429, DerivesTheFactorLessOnePerCent) {
  // p = 500 / (128 * 2) = 1.953; 0.99 p * 8 * 2^4 = 247.5
  const auto axis = axis_with({});
  EXPECT_EQ(axis.read(R::pmul), 247 - 128);
  EXPECT_EQ(axis.read(R::pdiv), 4);
}

TEST(Tmc429, FollowsDividersAndAccelerationWithTheFactor) {
  auto axis = axis_with({{2, 3}, 1000, 500});
  axis.write(R::pulse_div, 5);
  const auto other = axis_with({{5, 3}, 1000, 500});
  EXPECT_EQ(axis.read(R::pmul), other.read(R::pmul));
  EXPECT_EQ(axis.read(R::pdiv), other.read(R::pdiv));
  EXPECT_NE(axis.read(R::pdiv), axis_with({}).read(R::pdiv));
}

TEST(Tmc429, KeepsTheFactorWithinTwoPerCentBelowTheIdeal) {
  for (std::uint8_t pulse = 0; pulse <= 13; ++pulse) {
    for (std::uint8_t ramp = 0; ramp <= 13; ++ramp) {
      for (std::int32_t a = 1; a <= 2047; ++a) {
        const auto axis = axis_with({{pulse, ramp}, 1000, a});
        const double ideal = a / 128.0 * std::exp2(pulse - ramp);
        const double factor = (128 + static_cast<double>(axis.read(R::pmul))) /
                              std::exp2(3 + static_cast<double>(axis.read(R::pdiv)));
        if (ideal * 0.99 < 128 / 65536.0 || ideal * 0.99 >= 32) continue;  // not representable
        ASSERT_LE(factor, ideal * 0.99);
        ASSERT_GT(factor, ideal * 0.99 * (1 - 1.0 / 128));
      }
    }
  }
}

TEST(Tmc429, TakesTheTimeToSpeedThatTheDataSheetGives) {
  auto axis = axis_with({});
  axis.write(Mode::velocity);
  axis.write(R::v_target, 1000);
  // dv/dt = f * a / 2^(ramp_div + 13), which makes 8.192 ms here.
  const double ideal = 1000 * std::exp2(3 + 13) / (tmc429_clock_hz * 500);
  const Tick ramp_tick = 8;
  axis.advance_to(ticks(ideal) - ramp_tick);
  EXPECT_LT(axis.v_actual(), 1000);
  EXPECT_EQ(axis.a_actual(), 500);
  axis.advance_to(ticks(ideal) + ramp_tick);
  EXPECT_EQ(axis.v_actual(), 1000);
  EXPECT_EQ(axis.a_actual(), 0);
}

TEST(Tmc429, TurnsAtTheRateThatTheDataSheetGives) {
  auto axis = axis_with({});
  axis.write(Mode::velocity);
  axis.write(R::v_target, -1000);
  axis.advance_to(ticks(1));
  const auto start = axis.x_actual();
  axis.advance_to(ticks(11));
  EXPECT_NEAR(start - axis.x_actual(), 10 * to_pps({1000}, Tmc429Dividers{2, 3}).value,
              1);  // 61035 a second
}

TEST(Tmc429, LimitsVelocityModeToVMax) {
  auto axis = axis_with({});
  axis.write(Mode::velocity);
  axis.write(R::v_target, 2000);
  axis.advance_to(ticks(1));
  EXPECT_EQ(axis.v_actual(), 1000);
  EXPECT_EQ(axis.v_target(), 2000);
}

TEST(Tmc429, FollowsTheClosedFormWhileAcceleratingAndCruising) {
  auto axis = axis_with({});
  axis.write(R::x_target, 100'000);
  const double v = to_pps({1000}, Tmc429Dividers{2, 3}).value;
  const double a = to_pps2({500}, Tmc429Dividers{2, 3}).value;
  const double t_acceleration = v / a;
  const double bound = v * seconds(1 << 3) + 2;
  for (Tick t = 0; t < ticks(1.6); t += 50) {
    axis.advance_to(t);
    const double s = seconds(t);
    const double ideal = s < t_acceleration ? a * s * s / 2 : v * (s - t_acceleration / 2);
    ASSERT_NEAR(axis.x_actual(), ideal, bound) << "at tick " << t;
  }
}

// The arrival is a little later than a trapezoid says: one per cent less deceleration, the grid of
// ramp ticks, and the last step at v_min.
TEST(Tmc429, ArrivesCloseToTheTrapezoid) {
  for (const auto& settings : {Settings{}, Settings{{5, 7}, 1000, 200},
                               Settings{{0, 0}, 2047, 2047}, Settings{{5, 5}, 300, 100}}) {
    for (const std::int32_t target : {500'000, -50'000, 2'000}) {
      auto axis = axis_with(settings);
      axis.write(R::x_target, target);
      const double distance = std::abs(target);
      const double a = to_pps2({settings.a_max}, settings.dividers).value;
      const double v =
          std::min(to_pps({settings.v_max}, settings.dividers).value, std::sqrt(distance * a));
      const double ideal = distance / v + v / a;
      const double late = 0.02 * v / a + 3 * seconds(1ULL << settings.dividers.ramp) +
                          1 / to_pps({1}, settings.dividers).value + 1 / v;
      const auto arrival = ramp::arrival(axis, ticks(1000));
      ASSERT_TRUE(arrival);
      EXPECT_GE(seconds(*arrival) - ideal, -1.0 / settings.a_max) << target;
      EXPECT_LE(seconds(*arrival) - ideal, late) << target;
    }
  }
}

TEST(Tmc429, StandsOnTheTargetExactlyWhenPredicted) {
  auto axis = axis_with({});
  axis.write(R::x_target, 12'345);
  const auto arrival = ramp::arrival(axis, ticks(10));
  ASSERT_TRUE(arrival);
  axis.advance_to(*arrival - 1);
  EXPECT_FALSE(axis.arrived());
  axis.advance_to(*arrival);
  EXPECT_TRUE(axis.arrived());
  axis.advance_to(*arrival + ticks(100));
  EXPECT_EQ(axis.x_actual(), 12'345);
  EXPECT_TRUE(axis.settled());
}

TEST(Tmc429, PredictsNothingBeyondTheLimitOrWithoutATarget) {
  auto axis = axis_with({});
  axis.write(R::x_target, 1'000'000);
  EXPECT_FALSE(arrival(axis, ticks(1)));
  axis.write(R::v_max, 0);
  EXPECT_FALSE(arrival(axis, ticks(1e9)));  // and does not try for that long
  axis.write(Mode::velocity);
  EXPECT_FALSE(arrival(axis, ticks(1e9)));
}

TEST(Tmc429, NeedsOneStepTimeAtVMinForTheLastStep) {
  auto axis = axis_with({{5, 5}, 1000, 500});
  axis.write(R::x_target, 1);
  const auto arrival = ramp::arrival(axis, ticks(1));
  ASSERT_TRUE(arrival);
  EXPECT_NEAR(seconds(*arrival), 0.131, 0.001);
}

TEST(Tmc429, StopsOnItsTargetFromTheMinimumVelocity) {
  auto axis = axis_with({{5, 5}, 1000, 500});
  axis.write(R::v_min, 200);
  axis.write(R::x_target, 4000);
  const auto there = ramp::arrival(axis, ticks(10));
  ASSERT_TRUE(there);
  axis.advance_to(*there - 1);
  EXPECT_EQ(axis.v_actual(), 200);
  axis.advance_to(*there);
  EXPECT_EQ(axis.v_actual(), 0);
  EXPECT_EQ(axis.x_actual(), 4000);
}

TEST(Tmc429, SlowsDownExponentiallyInSoftMode) {
  auto axis = axis_with({{4, 4}, 1000, 100});
  axis.write(Mode::soft);
  axis.write(R::x_target, 20'000);
  // dx(t) falls by exp(-p * f_pulse / 2048 * t) once the speed is p * dx.
  const double p = (128 + static_cast<double>(axis.read(R::pmul))) /
                   std::exp2(3 + static_cast<double>(axis.read(R::pdiv)));
  const double rate = p * ticks_per_second / 16 / 2048;
  const auto left = [&] { return static_cast<double>(axis.x_target() - axis.x_actual()); };
  Tick t = 0;
  while (left() > 900 / p) axis.advance_to(t += 16);
  const double begin = left();
  const Tick start = axis.tick();
  while (left() > 100 / p) axis.advance_to(t += 16);
  EXPECT_NEAR(std::log(begin / left()), rate * seconds(axis.tick() - start), 0.05);
}

TEST(Tmc429, IsSlowerInSoftModeThanInRampMode) {
  auto ramp = axis_with({});
  auto soft = axis_with({});
  soft.write(Mode::soft);
  ramp.write(R::x_target, 50'000);
  soft.write(R::x_target, 50'000);
  // Its last step waits for v_min, and so does that of the soft mode.
  const double last_step = 1 / pps_of_unit;
  const double at_speed = 50'000 / (1000 * pps_of_unit);
  EXPECT_NEAR(seconds(arrival(ramp, ticks(100)).value()), at_speed + time_to_speed, last_step);
  // In soft mode the speed is p times the way that is left, in whole units, once that is less than
  // v_max; before, speeding up costs half of its time.
  const double p = (128 + static_cast<double>(soft.read(R::pmul))) /
                   std::exp2(3 + static_cast<double>(soft.read(R::pdiv)));
  double expected = time_to_speed / 2;
  for (int left = 1; left <= 50'000; ++left)
    expected += 1 / (pps_of_unit * std::clamp(std::floor(p * left), 1.0, 1000.0));
  EXPECT_NEAR(seconds(arrival(soft, ticks(100)).value()), expected, last_step);
  EXPECT_GT(expected, at_speed + time_to_speed + 3 * last_step) << "the difference is seen";
}

TEST(Tmc429, ReversesThroughZeroWhenTheTargetChangesSides) {
  auto axis = axis_with({});
  axis.write(R::x_target, 100'000);
  axis.advance_to(ticks(0.5));
  axis.write(R::x_target, -1'000);
  EXPECT_EQ(axis.v_target(), -1000);
  EXPECT_EQ(axis.a_actual(), -500);
  axis.advance_to(ticks(0.501));
  EXPECT_GT(axis.v_actual(), 0);
  axis.advance_to(ticks(3));
  EXPECT_EQ(axis.x_actual(), -1'000);
}

TEST(Tmc429, ShowsTheSpeedThatTheRampAsksFor) {
  auto axis = axis_with({});
  axis.write(R::x_target, 100'000);
  EXPECT_EQ(axis.v_target(), 1000);
  EXPECT_EQ(axis.v_actual(), 0);
  axis.advance_to(arrival(axis, ticks(10)).value());
  EXPECT_EQ(axis.v_target(), 0);
}

TEST(Tmc429, KeepsTheRampsSpeedWhenItLeavesForVelocityMode) {
  auto axis = axis_with({});
  axis.write(R::x_target, 100'000);
  axis.advance_to(ticks(0.5));
  axis.write(Mode::velocity);
  axis.advance_to(ticks(5));
  EXPECT_EQ(axis.v_actual(), 1000);
}

TEST(Tmc429, MovesWhenItsPositionIsOverwrittenInRampMode) {
  auto axis = axis_with({});
  axis.write(R::x_actual, 500);
  axis.advance_to(ticks(1));
  EXPECT_EQ(axis.x_actual(), 0);
}

TEST(Tmc429, StandsWhenItsPositionIsOverwrittenInVelocityMode) {
  auto axis = axis_with({});
  axis.write(Mode::velocity);
  axis.write(R::x_actual, 500);
  axis.advance_to(ticks(1));
  EXPECT_EQ(axis.x_actual(), 500);
}

TEST(Tmc429, SlowsDownByAMaxWhenVMaxIsLoweredInMotion) {
  auto axis = axis_with({});
  axis.write(R::x_target, 1'000'000);
  axis.advance_to(ticks(0.1));
  axis.write(R::v_max, 500);
  EXPECT_EQ(axis.v_actual(), 1000);
  axis.advance_to(ticks(0.102));
  EXPECT_LT(axis.v_actual(), 1000);
  EXPECT_GT(axis.v_actual(), 500);
  axis.advance_to(ticks(0.2));
  EXPECT_EQ(axis.v_actual(), 500);
}

TEST(Tmc429, CannotStopWithoutAcceleration) {
  auto axis = axis_with({});
  axis.write(R::x_target, 10'000);
  axis.advance_to(ticks(0.05));
  axis.write(R::a_max, 0);
  axis.advance_to(ticks(1));
  EXPECT_EQ(axis.v_actual(), 1000);
  EXPECT_GT(axis.x_actual(), 50'000);
}

TEST(Tmc429, StopsDeadInHoldModeAndObeysNoLimit) {
  auto axis = axis_with({});
  axis.write(Mode::hold);
  axis.write(R::v_actual, 2000);
  axis.advance_to(ticks(0.1));
  EXPECT_EQ(axis.v_actual(), 2000);
  axis.write(R::v_actual, 0);
  const auto x = axis.x_actual();
  EXPECT_NEAR(x, 2000 * pps_of_unit * 0.1, 1);
  axis.advance_to(ticks(1));
  EXPECT_EQ(axis.x_actual(), x);
}

TEST(Tmc429, ReadsZeroBelowOneUnitOfSpeed) {
  auto axis = axis_with({{2, 3}, 1000, 100});
  axis.write(Mode::velocity);
  axis.write(R::v_target, 1000);
  axis.advance_to(16);
  EXPECT_EQ(axis.v_actual(), 0);
  axis.advance_to(24);
  EXPECT_EQ(axis.v_actual(), 1);
}

TEST(Tmc429, WrapsItsPositionAt24Bit) {
  auto axis = axis_with({});
  axis.write(Mode::velocity);
  axis.write(R::x_actual, (1 << 23) - 10);
  axis.write(R::v_target, 1000);
  axis.advance_to(ticks(0.1));
  // 1000 units for 0.1 s, less half of the time in which it got so fast.
  const double way = 1000 * pps_of_unit * (0.1 - time_to_speed / 2);
  EXPECT_NEAR(axis.x_actual(), -(1 << 23) - 10 + way, 2);
}

TEST(Tmc429, GoesTheWrongWayToATargetTooFarAway) {
  auto axis = axis_with({});
  axis.write(Mode::velocity);
  axis.write(R::x_actual, -(1 << 23));
  axis.write(R::x_target, (1 << 23) - 100);
  axis.write(Mode::ramp);
  axis.advance_to(ticks(1));
  EXPECT_EQ(axis.x_actual(), (1 << 23) - 100);
  EXPECT_TRUE(axis.arrived());
}

TEST(Tmc429, LetsHoursPassAtOnceAtStandstillAndWhileTurning) {
  auto axis = axis_with({});
  axis.advance_to(ticks(1e6));
  EXPECT_TRUE(axis.settled());
  axis.write(Mode::velocity);
  axis.write(R::v_target, 1);
  axis.advance_to(ticks(1e6 + 1));
  const auto start = axis.x_actual();
  axis.advance_to(ticks(1e6 + 1 + 3600));
  EXPECT_NEAR(axis.x_actual() - start, 3600 * to_pps({1}, Tmc429Dividers{2, 3}).value, 1);
}

TEST(Tmc429, StopsDeadAtAClosedSwitch) {
  auto axis = axis_with({});
  axis.write(R::x_target, 100'000);
  axis.advance_to(ticks(0.5));
  axis.set_switches(true, false);  // the other side
  axis.advance_to(ticks(0.6));
  EXPECT_EQ(axis.v_actual(), 1000);
  axis.set_switches(false, true);
  const auto x = axis.x_actual();
  axis.advance_to(ticks(0.6) + 8);
  EXPECT_EQ(axis.v_actual(), 0);
  axis.advance_to(ticks(2));
  EXPECT_LE(axis.x_actual() - x, 1);
  EXPECT_TRUE(axis.settled());
  EXPECT_FALSE(axis.arrived());
}

TEST(Tmc429, SlowsDownAtASwitchIfToldSoAndLeavesItTheOtherWay) {
  auto axis = axis_with({});
  axis.write(R::soft_stop, 1);
  axis.write(R::x_target, 100'000);
  axis.advance_to(ticks(0.5));
  axis.set_switches(false, true);
  axis.advance_to(ticks(0.504));
  // A step of the ramp takes 16 ticks and more; one of speed is as much of time_to_speed.
  EXPECT_NEAR(axis.v_actual(), 1000 * (1 - 0.004 / time_to_speed), 4);
  EXPECT_EQ(axis.a_actual(), -500);
  axis.advance_to(ticks(1));
  EXPECT_EQ(axis.v_actual(), 0);
  // What it lost while it sped up it gains while it slows down.
  EXPECT_NEAR(axis.x_actual(), 1000 * pps_of_unit * 0.5, 10);
  axis.write(R::x_target, 0);
  axis.advance_to(ticks(2));
  EXPECT_EQ(axis.x_actual(), 0);
  EXPECT_TRUE(axis.arrived());
}

TEST(Tmc429, GoesThroughASwitchThatIsDisabled) {
  auto axis = axis_with({});
  axis.write(R::disable_stop_l, 1);
  axis.set_switches(true, false);
  axis.write(R::x_target, -5'000);
  axis.advance_to(ticks(1));
  EXPECT_TRUE(axis.arrived());
}

TEST(Tmc429, StopsInHoldModeToo) {
  auto axis = axis_with({});
  axis.write(Mode::hold);
  axis.write(R::v_actual, -700);
  axis.advance_to(ticks(0.1));
  axis.set_switches(true, false);
  axis.advance_to(ticks(0.2));
  EXPECT_EQ(axis.v_actual(), 0);
}

TEST(Tmc429, LatchesThePositionOnceWhenTheSwitchCloses) {
  auto axis = axis_with({});
  axis.write(R::ref_rnl, 1);
  axis.arm_latch();
  axis.write(R::x_target, 10'000);
  axis.advance_to(ticks(0.05));
  axis.set_switches(true, false);  // not the one
  EXPECT_TRUE(axis.latch_armed());
  const auto x = axis.x_actual();
  axis.set_switches(true, true);
  EXPECT_EQ(axis.x_latched(), x);
  EXPECT_FALSE(axis.latch_armed());
  axis.set_switches(false, false);
  axis.advance_to(ticks(0.1));
  axis.set_switches(false, true);
  EXPECT_EQ(axis.x_latched(), x);
}

TEST(Tmc429, RefusesWhatDoesNotFitARegisterAndNamesIt) {
  auto axis = axis_with({});
  const auto before = axis;
  const auto written = axis.write(R::v_max, 2048);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().reason, RegisterError::Reason::out_of_range);
  EXPECT_EQ(describe(written.error()), "v_max is 0..2047, not 2048");
  EXPECT_FALSE(axis.write(R::x_target, 1 << 23));
  EXPECT_FALSE(axis.write(R::mode, -1));
  EXPECT_FALSE(axis.write(R::pulse_div, 14));
  EXPECT_TRUE(axis == before);
}

TEST(Tmc429, ReadsBackWhatWasWritten) {
  Tmc429 axis;
  const auto registers = Tmc429::registers();
  for (std::size_t i = 0; i < registers.size(); ++i) {
    const auto name = static_cast<R>(i);
    const auto value = registers[i].maximum;
    ASSERT_TRUE(axis.write(name, value)) << registers[i].name;
    EXPECT_EQ(axis.read(name), name == R::pmul ? value - 128 : value) << registers[i].name;
  }
}

TEST(Tmc429, KeepsAFactorThatWasWritten) {
  auto axis = axis_with({});
  axis.write(R::pmul, 128 + 7);  // the chip sets bit 7 by itself
  axis.write(R::pdiv, 3);
  axis.write(R::a_max, 100);
  EXPECT_EQ(axis.read(R::pmul), 7);
  EXPECT_EQ(axis.read(R::pdiv), 3);
}

// As on silicon: below the valid range of a_max the motor swings.
TEST(Tmc429, OscillatesForEverWithTooSmallAnAcceleration) {
  auto axis = axis_with({{2, 13}, 1000, 1});
  EXPECT_EQ(warnings_of(axis),
            std::vector<std::string>{"a_max 1 is outside its valid range for pulse_div 2 and "
                                     "ramp_div 13: the motor may oscillate around its target"});
  axis.write(R::x_target, 10'000);
  EXPECT_FALSE(ramp::arrival(axis, ticks(3600)));
  axis.advance_to(ticks(3600));
  EXPECT_NE(axis.v_actual(), 0);
}

// As after a firmware that forgets the factor when a divider changes.
TEST(Tmc429, OvershootsWithAStaleFactor) {
  auto axis = axis_with({});
  axis.write(R::pmul, axis.read(R::pmul));
  axis.write(R::ramp_div, 6);
  ASSERT_EQ(axis.findings().size(), 1U);
  axis.write(R::x_target, 10'000);
  std::int64_t farthest = 0;
  while (!axis.arrived()) {
    axis.advance_to(axis.next_change());
    farthest = std::max(farthest, axis.motion().position);
  }
  EXPECT_GT(farthest, 11'000);
  EXPECT_EQ(axis.x_actual(), 10'000);
}

TEST(Tmc429, WarnsOfSettingsThatDoNotGoTogether) {
  EXPECT_TRUE(axis_with({}).findings().empty());
  EXPECT_EQ(axis_with({{2, 9}, 1000, 50}).findings().size(), 1U);   // a_max below 64
  EXPECT_EQ(axis_with({{13, 3}, 1000, 50}).findings().size(), 1U);  // above 3
  EXPECT_EQ(Tmc429().findings().size(), 3U);                        // v_min, v_max, a_max
  Tmc429 held;
  held.write(Mode::hold);
  EXPECT_TRUE(held.findings().empty());
}

TEST(Tmc429, OpenPointsOfTheDataSheetMakeADifference) {
  const auto last_step = [](Tmc429::LastStep law) {
    auto axis = axis_with({{5, 5}, 1000, 500});
    axis.write(R::last_step, static_cast<int>(law));
    axis.write(R::x_target, 1);
    return seconds(ramp::arrival(axis, ticks(1)).value());
  };
  EXPECT_NEAR(last_step(Tmc429::LastStep::r3), 0.131, 0.001);
  EXPECT_LT(last_step(Tmc429::LastStep::r2), 0.02);
  EXPECT_LT(last_step(Tmc429::LastStep::r1), 0.02);
}

TEST(Tmc429, NamesItsPhases) {
  auto axis = axis_with({});
  EXPECT_EQ(axis.phase(), "rest");
  axis.write(R::x_target, 100'000);
  std::vector<std::string_view> phases;
  while (!axis.arrived()) {
    if (phases.empty() || phases.back() != axis.phase()) phases.push_back(axis.phase());
    axis.advance_to(axis.next_change());
  }
  EXPECT_EQ(phases, (std::vector<std::string_view>{"accelerate", "cruise", "decelerate"}));
}

TEST(Tmc429, IgnoresAnEarlierTick) {
  auto axis = axis_with({});
  axis.advance_to(100);
  axis.advance_to(50);
  EXPECT_EQ(axis.tick(), 100U);
}

}  // namespace
}  // namespace tmcl::ramp
