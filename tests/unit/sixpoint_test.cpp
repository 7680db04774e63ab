#include "tmcl/ramp/sixpoint.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace tmcl::ramp {
namespace {

static_assert(Generator<SixPoint>);
static_assert(sizeof(SixPoint) <= 256);

using Register = SixPoint::Register;
using Mode = SixPoint::Mode;

constexpr double clock_hz = 16e6;
constexpr double tick_seconds = 512 / clock_hz;

double seconds(Tick ticks) { return static_cast<double>(ticks) * tick_seconds; }
Tick ticks(double seconds) { return static_cast<Tick>(std::llround(seconds / tick_seconds)); }
double pps(std::int64_t v) { return static_cast<double>(v) * clock_hz / std::exp2(24); }
std::int64_t velocity(double pps) { return std::llround(pps * std::exp2(24) / clock_hz); }
std::int64_t acceleration(double pps2) {
  return std::llround(pps2 * std::exp2(41) / (clock_hz * clock_hz));
}

void set(SixPoint& axis, std::initializer_list<std::pair<Register, std::int64_t>> values) {
  for (const auto& [name, value] : values) ASSERT_TRUE(axis.write(name, value));
}

// 25 kHz at 1000 units an acceleration of 116 kHz/s; a whole ramp takes 0.21 s.
SixPoint axis_with(std::initializer_list<std::pair<Register, std::int64_t>> values = {}) {
  SixPoint axis;
  set(axis, {{Register::vmax, 26'214},
             {Register::amax, 1'000},
             {Register::dmax, 1'000},
             {Register::d1, 1'000},
             {Register::vstop, 100}});
  set(axis, values);
  return axis;
}

SixPoint after(SixPoint axis, double time) {
  axis.advance_to(axis.tick() + ticks(time));
  return axis;
}

double arrival_time(const SixPoint& axis) {
  const auto there = arrival(axis, last_tick);
  EXPECT_TRUE(there);
  return there ? seconds(*there - axis.tick()) : std::numeric_limits<double>::quiet_NaN();
}

struct Part {
  std::string phase;
  double begin;
};

// One by one, until nothing happens any more.
std::vector<Part> parts_of(SixPoint axis) {
  std::vector<Part> parts;
  while (axis.next_change() != forever) {
    axis.advance_to(axis.next_change());
    if (!parts.empty() && axis.phase() == parts.back().phase) continue;
    parts.push_back({std::string(axis.phase()), seconds(axis.tick())});
  }
  return parts;
}

std::vector<std::string> phases_of(const SixPoint& axis) {
  std::vector<std::string> phases;
  for (const auto& part : parts_of(axis)) phases.push_back(part.phase);
  return phases;
}

bool warns(const SixPoint& axis, const std::string& text) {
  const auto warnings = warnings_of(axis);
  return std::ranges::any_of(
      warnings, [&](const auto& warning) { return warning.find(text) != std::string::npos; });
}

// ---- Against the formulas of the application note AN-035

SixPoint axis_of_an035(double vstart, double vstop, std::int64_t way) {
  return axis_with({{Register::vmax, velocity(256'000)},
                    {Register::amax, acceleration(349'246)},
                    {Register::dmax, acceleration(349'246)},
                    {Register::vstart, velocity(vstart)},
                    {Register::vstop, velocity(vstop)},
                    {Register::xtarget, way}});
}

TEST(SixPoint, TakesTheTimesOfTheTrapezoid) {
  const auto axis = axis_of_an035(100, 200, 512'000);
  EXPECT_TRUE(axis.findings().empty());
  const auto parts = parts_of(axis);
  ASSERT_EQ(phases_of(axis), (std::vector<std::string>{"AMAX", "VMAX", "DMAX", "rest"}));
  const double bound = 4 * tick_seconds;
  EXPECT_NEAR(parts[1].begin, 0.73272, bound);
  EXPECT_NEAR(parts[2].begin - parts[1].begin, 1.26699, bound);
  EXPECT_NEAR(arrival_time(axis), 2.73215, 10 * tick_seconds);
}

/// Figure 2 of AN-035: t2 - t1 from VSTART to VMAX, t4 - t3 from there to VSTOP.
TEST(SixPoint, TakesTheTimesBetweenItsStartAndStopVelocity) {
  for (const double vstart : {100.0, 20'000.0, 60'000.0}) {
    for (const double vstop : {vstart, 70'000.0}) {
      const auto axis = axis_of_an035(vstart, vstop, 512'000);
      const auto parts = parts_of(axis);
      ASSERT_EQ(phases_of(axis), (std::vector<std::string>{"AMAX", "VMAX", "DMAX", "rest"}));
      const double vmax = pps(axis.read(Register::vmax));
      const double a = 349'246;
      const double bound = 20 * tick_seconds;
      EXPECT_NEAR(parts[1].begin, (vmax - vstart) / a, bound);
      EXPECT_NEAR(parts[3].begin - parts[2].begin, (vmax - vstop) / a, bound);
    }
  }
}

TEST(SixPoint, TakesTheTimesOfTheTriangle) {
  // 18,688 pps at its peak, which lies in the middle.
  const auto axis = axis_of_an035(0, 10, 1'000);
  EXPECT_NEAR(arrival_time(axis), 0.10702, 1e-3);
  EXPECT_NEAR(pps(after(axis, 0.10702 / 2).motion().velocity), 18'688, 20);
  // Start and stop velocities save their share: (18688 - 100) / a + (18688 - 200) / a.
  EXPECT_NEAR(arrival_time(axis_of_an035(100, 200, 1'000)), 0.10616, 5e-4);
}

TEST(SixPoint, FollowsTheParabolaExactly) {
  // After n ticks from standstill the sum 1 + 2 + ... + n of a, in 2^-23 microsteps.
  auto axis = axis_with({{Register::xtarget, 100'000}});
  for (Tick n = 1; n < 6'000; ++n) {
    axis.advance_to(n);
    ASSERT_EQ(axis.exact().position, static_cast<std::int64_t>(n * (n + 1) / 2 * 1'000));
    ASSERT_EQ(axis.motion().velocity, static_cast<std::int64_t>(n * 1'000 / 256));
  }
}

TEST(SixPoint, TurnsAtTheRateOfTheUnits) {
  auto axis = axis_with();
  ASSERT_TRUE(axis.write(Mode::velocity_negative));
  axis = after(axis, 1);
  const auto start = axis.motion().position;
  EXPECT_NEAR(static_cast<double>(start - after(axis, 10).motion().position), 10 * pps(26'214), 1);
}

// ---- The six points

TEST(SixPoint, GoesThroughAllOfItsPhases) {
  const auto axis = axis_with({{Register::v1, 10'000},
                               {Register::a1, 2'000},
                               {Register::d1, 3'000},
                               {Register::xtarget, 20'000}});
  EXPECT_EQ(phases_of(axis),
            (std::vector<std::string>{"A1", "AMAX", "VMAX", "DMAX", "D1", "rest"}));
  const auto parts = parts_of(axis);
  const auto expect_part = [&](std::size_t i, double v, double a) {
    EXPECT_NEAR(parts[i + 1].begin - parts[i].begin, v * 256 / a * tick_seconds, 4 * tick_seconds)
        << parts[i].phase;
  };
  expect_part(0, 10'000, 2'000);
  expect_part(1, 16'214, 1'000);
  expect_part(3, 16'214, 1'000);
  expect_part(4, 9'900, 3'000);
}

TEST(SixPoint, UsesNeitherA1NorD1WithoutV1) {
  const auto axis = axis_with({{Register::a1, 7}, {Register::d1, 7}, {Register::xtarget, 20'000}});
  const auto phases = phases_of(axis);
  EXPECT_GE(phases.size(), 2U);
  for (const auto& phase : phases) EXPECT_TRUE(phase != "A1" && phase != "D1");
  const auto other =
      axis_with({{Register::a1, 60'000}, {Register::d1, 60'000}, {Register::xtarget, 20'000}});
  ASSERT_TRUE(arrival(axis, last_tick));
  EXPECT_EQ(arrival(axis, last_tick), arrival(other, last_tick));
}

TEST(SixPoint, ShowsTheAccelerationInUse) {
  auto axis = axis_with({{Register::v1, 10'000}, {Register::a1, 2'000}, {Register::d1, 3'000}});
  EXPECT_EQ(axis.motion().acceleration, 0);
  set(axis, {{Register::xtarget, -20'000}});
  std::vector<std::int64_t> seen;
  for (Tick n = 1; !axis.arrived(); ++n) {
    axis.advance_to(n);
    const auto a = axis.motion().acceleration;
    if (a != 0 && (seen.empty() || seen.back() != a)) seen.push_back(a);
  }
  EXPECT_EQ(seen, (std::vector<std::int64_t>{-2'000, -1'000, 1'000, 3'000}));
}

TEST(SixPoint, StartsWithVstartAndStopsFromVstop) {
  auto axis = axis_with({{Register::vstart, 500}, {Register::vstop, 800}});
  set(axis, {{Register::xtarget, 10'000}});
  axis.advance_to(1);
  EXPECT_EQ(axis.motion().velocity, 500);
  const auto there = arrival(axis, last_tick);
  ASSERT_TRUE(there);
  axis.advance_to(*there - 1);
  EXPECT_NEAR(static_cast<double>(axis.motion().velocity), 800, 1'000 / 256);
  axis.advance_to(*there);
  EXPECT_EQ(axis.motion(), (Motion{10'000, 0, 0}));
}

TEST(SixPoint, CreepsWithVstopWhereVstartIsTooFast) {
  auto axis = axis_with({{Register::vstart, 200'000}, {Register::vmax, 200'000}});
  set(axis, {{Register::xtarget, 3}});
  axis.advance_to(1);
  EXPECT_EQ(axis.phase(), "VSTOP");
  EXPECT_EQ(axis.motion().velocity, 100);
  EXPECT_NEAR(arrival_time(axis), 2.5 / pps(100), 1e-3);
}

TEST(SixPoint, DoesNotCreepLong) {
  for (std::int64_t way = 1; way < 20'000; way = way * 9 / 8 + 1) {
    const auto axis = axis_with({{Register::vstop, 10}, {Register::xtarget, way}});
    const double v = std::min(pps(26'214), std::sqrt(static_cast<double>(way) * 116'415));
    const double ideal = static_cast<double>(way) / v + v / 116'415;
    EXPECT_NEAR(arrival_time(axis), ideal, way == 1 ? 0.06 : 0.01) << way;
  }
}

TEST(SixPoint, CannotCreepWithoutVstop) {
  auto axis = axis_with({{Register::vstart, 200'000}, {Register::vmax, 200'000}});
  set(axis, {{Register::vstop, 0}, {Register::xtarget, 3}});
  axis.advance_to(ticks(10));
  EXPECT_EQ(axis.motion(), Motion{});
  EXPECT_TRUE(axis.settled());
}

TEST(SixPoint, StandsAfterPowerUpWhateverItsTarget) {
  SixPoint axis;
  set(axis, {{Register::xtarget, 1'000}});
  axis.advance_to(ticks(10));
  EXPECT_EQ(axis.motion(), Motion{});
  EXPECT_TRUE(axis.settled());
  EXPECT_FALSE(axis.arrived());
  EXPECT_FALSE(arrival(axis, last_tick));
}

TEST(SixPoint, WorksOutAMoveInAFewSteps) {
  auto axis =
      axis_with({{Register::v1, 10'000}, {Register::a1, 2'000}, {Register::xtarget, 200'000}});
  int changes = 0;
  for (; axis.next_change() != forever; ++changes) axis.advance_to(axis.next_change());
  EXPECT_LT(changes, 30);
  EXPECT_TRUE(axis.arrived());
}

// ---- Changes in motion

TEST(SixPoint, TurnsRoundWhenTheTargetChangesSides) {
  auto axis = axis_with({{Register::tzerowait, 1'000}, {Register::xtarget, 100'000}});
  axis = after(axis, 0.5);
  set(axis, {{Register::xtarget, -1'000}});
  const auto phases = phases_of(axis);
  ASSERT_GE(phases.size(), 3U);
  EXPECT_EQ(phases[0], "DMAX");
  EXPECT_EQ(phases[1], "TZEROWAIT");
  EXPECT_EQ(phases[2], "rest");
  EXPECT_EQ(phases[3], "AMAX");
  EXPECT_FALSE(axis.status().second_move);
  axis.advance_to(*arrival(axis, last_tick));
  EXPECT_EQ(axis.motion().position, -1'000);
  EXPECT_TRUE(axis.take_events().second_move);
  EXPECT_FALSE(axis.status().second_move);
}

TEST(SixPoint, ComesBackToATargetThatIsTooNear) {
  auto axis = after(axis_with({{Register::xtarget, 100'000}}), 0.5);
  const auto near = axis.motion().position + 10;
  set(axis, {{Register::xtarget, near}});
  std::int64_t farthest = 0;
  while (!axis.arrived()) {
    axis.advance_to(axis.tick() + 1);
    farthest = std::max(farthest, axis.motion().position);
  }
  // v^2 / 2 d
  EXPECT_NEAR(static_cast<double>(farthest - near + 10), std::pow(pps(26'214), 2) / 2 / 116'415,
              10);
  EXPECT_EQ(axis.motion().position, near);
  EXPECT_TRUE(axis.status().second_move);
}

TEST(SixPoint, StandsForTzerowaitAfterAStop) {
  auto axis = axis_with({{Register::tzerowait, 1'000}, {Register::xtarget, 1'000}});
  const auto there = arrival(axis, last_tick);
  ASSERT_TRUE(there);
  axis.advance_to(*there);
  set(axis, {{Register::xtarget, 0}});
  for (const Tick waited : {0U, 999U}) {
    axis.advance_to(*there + waited);
    EXPECT_TRUE(axis.status().t_zerowait_active);
    EXPECT_EQ(axis.phase(), "TZEROWAIT");
    EXPECT_EQ(axis.motion(), (Motion{1'000, 0, 0}));
  }
  axis.advance_to(*there + 1'000);
  EXPECT_FALSE(axis.status().t_zerowait_active);
  EXPECT_EQ(axis.phase(), "rest");
  axis.advance_to(*there + 1'001);
  EXPECT_EQ(axis.phase(), "AMAX");
}

TEST(SixPoint, SlowsDownByAmaxWhenVmaxIsLowered) {
  auto axis = after(axis_with({{Register::dmax, 5'000}, {Register::xtarget, 100'000}}), 0.5);
  set(axis, {{Register::vmax, 10'000}});
  EXPECT_EQ(axis.motion().velocity, 26'214);
  axis.advance_to(axis.tick() + 1);
  EXPECT_EQ(axis.exact().velocity, 26'214 * 256 - 1'000);
  EXPECT_EQ(axis.motion().acceleration, -1'000);
  axis = after(axis, 0.5);
  EXPECT_EQ(axis.motion().velocity, 10'000);
  EXPECT_TRUE(axis.status().velocity_reached);
  axis.advance_to(*arrival(axis, last_tick));
  EXPECT_EQ(axis.motion().position, 100'000);
}

TEST(SixPoint, StandsWhereItIsWithoutVmaxAndGoesOnWithIt) {
  auto axis = after(axis_with({{Register::xtarget, 100'000}}), 0.5);
  set(axis, {{Register::vmax, 0}});
  axis = after(axis, 1);
  EXPECT_EQ(axis.motion().velocity, 0);
  EXPECT_LT(axis.motion().position, 50'000);
  EXPECT_TRUE(axis.settled());
  set(axis, {{Register::vmax, 26'214}});
  axis.advance_to(*arrival(axis, last_tick));
  EXPECT_EQ(axis.motion().position, 100'000);
}

TEST(SixPoint, BrakesOnUntilXtargetIsWrittenAgain) {
  auto axis = axis_with({{Register::xtarget, 20'000}});
  while (axis.phase() != "DMAX") axis.advance_to(axis.next_change());
  axis = after(axis, 0.05);
  const auto v = axis.motion().velocity;
  set(axis, {{Register::dmax, 20'000}});
  const auto patient = after(axis, 0.01);
  EXPECT_EQ(patient.motion().velocity, v);  // holds, but does not speed up
  set(axis, {{Register::xtarget, 20'000}});
  EXPECT_GT(after(axis, 0.01).motion().velocity, v);
}

TEST(SixPoint, MovesWhenItsPositionIsOverwritten) {
  auto axis = axis_with({{Register::xactual, 500}});
  EXPECT_EQ(axis.read(Register::xactual), 500);
  EXPECT_FALSE(axis.arrived());
  axis = after(axis, 2);
  EXPECT_EQ(axis.motion().position, 0);
}

// ---- Velocity and hold mode

TEST(SixPoint, SlewsThroughZeroWithAmaxOnly) {
  auto axis = axis_with({{Register::v1, 10'000},
                         {Register::a1, 9},
                         {Register::d1, 9},
                         {Register::dmax, 9},
                         {Register::vstart, 90},
                         {Register::tzerowait, 100}});
  ASSERT_TRUE(axis.write(Mode::velocity_positive));
  EXPECT_EQ(parts_of(axis).back().phase, "VMAX");
  // v / a = 0.2147 s
  axis = after(axis, 0.215);
  EXPECT_EQ(axis.motion().velocity, 26'214);
  EXPECT_TRUE(axis.status().velocity_reached);
  EXPECT_TRUE(after(axis, 1).settled());
  ASSERT_TRUE(axis.write(Mode::velocity_negative));
  axis = after(axis, 0.215);
  EXPECT_EQ(axis.motion().velocity, 0);
  EXPECT_EQ(axis.phase(), "TZEROWAIT");
  axis = after(axis, 0.215 + seconds(100));
  EXPECT_EQ(axis.motion().velocity, -26'214);
}

TEST(SixPoint, StopsInVelocityModeWithoutVmax) {
  auto axis = axis_with();
  ASSERT_TRUE(axis.write(Mode::velocity_positive));
  axis = after(axis, 1);
  set(axis, {{Register::vmax, 0}});
  EXPECT_FALSE(after(axis, 0.2).status().vzero);
  axis = after(axis, 0.215);
  EXPECT_TRUE(axis.status().vzero);
  EXPECT_TRUE(axis.status().velocity_reached);
  EXPECT_TRUE(axis.settled());
}

TEST(SixPoint, KeepsItsVelocityInHoldMode) {
  auto axis = after(axis_with({{Register::xtarget, 100'000}}), 0.1);
  const auto v = axis.motion().velocity;
  ASSERT_TRUE(axis.write(Mode::hold));
  axis = after(axis, 100);
  EXPECT_EQ(axis.motion().velocity, v);
  EXPECT_EQ(axis.phase(), "hold");
  EXPECT_TRUE(axis.settled());
}

// ---- Events

TEST(SixPoint, RaisesThePositionEventOnceUntilItIsTaken) {
  auto axis = axis_with({{Register::xtarget, 1'000}});
  EXPECT_FALSE(axis.status().event_pos_reached);
  EXPECT_FALSE(axis.status().position_reached);
  axis = after(axis, 2);
  EXPECT_TRUE(axis.status().event_pos_reached);
  EXPECT_TRUE(axis.take_events().event_pos_reached);
  EXPECT_FALSE(axis.status().event_pos_reached);
  EXPECT_TRUE(axis.status().position_reached);
}

TEST(SixPoint, RaisesThePositionEventInPassingAtEveryTurn) {
  // Eight microsteps a tick and more: at hardly any target would a tick end.
  auto axis = axis_with(
      {{Register::vmax, 8'388'096}, {Register::amax, 65'535}, {Register::xtarget, 1'000'003}});
  ASSERT_TRUE(axis.write(Mode::velocity_positive));
  axis = after(axis, 1);
  EXPECT_GT(axis.motion().position, 1'000'003);
  EXPECT_TRUE(axis.take_events().event_pos_reached);
  const double turn = std::exp2(32) / pps(8'388'096);
  EXPECT_FALSE(after(axis, turn - 1.1).status().event_pos_reached);
  EXPECT_TRUE(after(axis, turn).status().event_pos_reached);
}

// ---- Stop switches

constexpr std::int64_t stop_both = SixPoint::stop_l_enable | SixPoint::stop_r_enable;

SixPoint moving_right(std::int64_t sw_mode) {
  return after(axis_with({{Register::xtarget, 100'000}, {Register::sw_mode, sw_mode}}), 0.5);
}

TEST(SixPoint, StopsHardAtASwitch) {
  auto axis = moving_right(stop_both);
  axis.set_switches(false, true);
  EXPECT_TRUE(axis.status().status_stop_r);
  EXPECT_TRUE(axis.status().event_stop_r);
  const auto x = axis.motion().position;
  axis.advance_to(axis.tick() + 1);
  EXPECT_EQ(axis.motion(), (Motion{x, 0, 0}));
  axis = after(axis, 10);
  EXPECT_EQ(axis.motion(), (Motion{x, 0, 0}));
  EXPECT_TRUE(axis.status().event_stop_r);  // it still wants to go there
}

TEST(SixPoint, StopsSoftlyAtASwitch) {
  auto axis = moving_right(stop_both | SixPoint::en_softstop);
  axis.set_switches(false, true);
  const auto x = axis.motion().position;
  EXPECT_EQ(after(axis, 0.01).phase(), "DMAX");
  axis = after(axis, 1);
  EXPECT_EQ(axis.motion().velocity, 0);
  EXPECT_NEAR(static_cast<double>(axis.motion().position - x),
              std::pow(pps(26'214), 2) / 2 / 116'415, 5);
}

TEST(SixPoint, GoesAwayFromASwitchAndOnWhenItOpens) {
  auto axis = moving_right(stop_both);
  axis.set_switches(false, true);
  axis = after(axis, 1);
  auto away = axis;
  set(away, {{Register::xtarget, 0}});
  EXPECT_FALSE(away.status().event_stop_r);
  EXPECT_TRUE(after(away, 5).arrived());
  axis.set_switches(false, false);
  axis = after(axis, 10);
  EXPECT_EQ(axis.motion().position, 100'000);
}

TEST(SixPoint, HeedsNeitherTheOtherSwitchNorOneThatIsNotEnabled) {
  for (const auto& [sw_mode, left, right] :
       {std::tuple{stop_both, true, false}, {SixPoint::stop_l_enable + 0L, false, true}}) {
    auto axis = moving_right(sw_mode);
    axis.set_switches(left, right);
    EXPECT_FALSE(axis.status().event_stop_l || axis.status().event_stop_r);
    EXPECT_TRUE(after(axis, 10).arrived());
  }
}

TEST(SixPoint, StopsInEveryMode) {
  for (const auto mode : {Mode::velocity_negative, Mode::hold}) {
    auto axis = axis_with({{Register::sw_mode, stop_both}});
    ASSERT_TRUE(axis.write(Mode::velocity_negative));
    axis = after(axis, 1);
    ASSERT_TRUE(axis.write(mode));
    axis.set_switches(true, false);
    EXPECT_TRUE(axis.status().event_stop_l);
    axis.advance_to(axis.tick() + 1);
    EXPECT_TRUE(axis.status().vzero);
    // Hold mode wants to go nowhere any more.
    EXPECT_EQ(axis.status().event_stop_l, mode != Mode::hold);
  }
}

TEST(SixPoint, LatchesItsPositionAtTheEdgesItIsToldTo) {
  auto axis = moving_right(SixPoint::latch_r_active | SixPoint::latch_l_inactive);
  const auto first = axis.motion().position;
  axis.set_switches(true, true);
  EXPECT_EQ(axis.xlatch(), first);
  EXPECT_TRUE(axis.status().status_latch_r);
  EXPECT_FALSE(axis.take_events().status_latch_l);
  EXPECT_FALSE(axis.status().status_latch_r);
  axis = after(axis, 0.1);
  axis.set_switches(true, false);
  EXPECT_EQ(axis.xlatch(), first);
  axis.set_switches(false, false);
  EXPECT_EQ(axis.xlatch(), axis.motion().position);
  EXPECT_GT(axis.xlatch(), first);
  EXPECT_TRUE(axis.status().status_latch_l);
}

// ---- Numbers at their ends

TEST(SixPoint, TakesTheShortWayAcrossTheEndOfItsCounter) {
  auto axis = axis_with({{Register::xactual, INT32_MAX - 10}, {Register::xtarget, INT32_MIN + 10}});
  axis.advance_to(*arrival(axis, last_tick));
  EXPECT_LT(seconds(axis.tick()), 1);
  EXPECT_EQ(axis.motion().position, INT32_MIN + 10);
}

TEST(SixPoint, LetsAgesPassAtOnce) {
  auto axis = axis_with();
  axis.advance_to(forever);
  EXPECT_EQ(axis.tick(), last_tick);
  axis = axis_with();
  ASSERT_TRUE(axis.write(Mode::velocity_positive));
  axis = after(axis, 1e6);
  const auto start = axis.motion().position;
  const double way = pps(26'214) * 1e7;
  const auto expected = static_cast<std::int32_t>(static_cast<std::int64_t>(way) + start);
  EXPECT_NEAR(static_cast<double>(after(axis, 1e7).motion().position), expected, 2);
}

TEST(SixPoint, IgnoresAnEarlierTick) {
  auto axis = axis_with();
  axis.advance_to(100);
  axis.advance_to(50);
  EXPECT_EQ(axis.tick(), 100U);
}

TEST(SixPoint, TakesWhatFitsARegisterAndNothingElse) {
  const auto registers = SixPoint::registers();
  for (std::size_t i = 0; i < registers.size(); ++i) {
    const auto name = static_cast<Register>(i);
    const auto& info = registers[i];
    SixPoint axis;
    for (const auto fits : {info.minimum, info.maximum}) {
      EXPECT_TRUE(axis.write(name, fits)) << info.name;
      EXPECT_EQ(axis.read(name), fits) << info.name;
    }
    const auto before = axis;
    for (const auto wrong : {info.minimum - 1, info.maximum + 1, INT64_MIN, INT64_MAX}) {
      const auto written = axis.write(name, wrong);
      ASSERT_FALSE(written) << info.name;
      EXPECT_EQ(written.error().reason, RegisterError::Reason::out_of_range);
      EXPECT_EQ(written.error().value, wrong);
      EXPECT_EQ(written.error().info->name, info.name);
    }
    EXPECT_TRUE(axis == before);
  }
  EXPECT_EQ(describe(SixPoint().write(Register::vmax, 8'388'097).error()),
            "vmax is 0..8388096, not 8388097");
}

// ---- Contradictions

TEST(SixPoint, HasNothingAgainstSensibleSettings) {
  EXPECT_TRUE(axis_with().findings().empty());
  EXPECT_TRUE(axis_with({{Register::v1, 5'000}, {Register::a1, 10}}).findings().empty());
}

TEST(SixPoint, NamesContradictions) {
  EXPECT_TRUE(warns(axis_with({{Register::vstart, 101}}), "vstop 100 is below vstart 101"));
  EXPECT_TRUE(warns(axis_with({{Register::vstop, 0}}), "vstop 0"));
  EXPECT_TRUE(warns(axis_with({{Register::vstop, 9}}), "vstop 9 is below 10"));
  EXPECT_TRUE(warns(axis_with({{Register::amax, 0}}), "amax 0"));
  EXPECT_TRUE(warns(axis_with({{Register::dmax, 0}}), "dmax 0"));
  EXPECT_TRUE(warns(axis_with({{Register::v1, 50}}), "a1 0"));
  EXPECT_TRUE(warns(axis_with({{Register::v1, 50}, {Register::d1, 0}}), "d1 0"));
  EXPECT_TRUE(warns(axis_with({{Register::d1, 0}}),
                    "d1 0 is not to be set for positioning, not even while v1 is 0"));
  EXPECT_TRUE(warns(axis_with({{Register::vmax, 50}, {Register::vstart, 60}}),
                    "vmax 50 is below vstart 60"));
}

TEST(SixPoint, WarnsThatItWillNotMove) {
  EXPECT_TRUE(warns(SixPoint(), "vmax 0"));
  EXPECT_TRUE(warns(axis_with({{Register::vmax, 0}, {Register::vstart, 101}}),
                    "vstop 100 is below vstart 101"));
}

TEST(SixPoint, AsksLessInVelocityMode) {
  auto axis = axis_with({{Register::vstop, 0}, {Register::dmax, 0}});
  ASSERT_TRUE(axis.write(Mode::velocity_positive));
  EXPECT_TRUE(axis.findings().empty());
  set(axis, {{Register::amax, 0}});
  EXPECT_TRUE(warns(axis, "amax 0"));
}

}  // namespace
}  // namespace tmcl::ramp
