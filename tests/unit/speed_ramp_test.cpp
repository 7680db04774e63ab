#include "motion/drive/speed_ramp.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/random.hpp"
#include "support/rounds.hpp"
#include "support/seed.hpp"
#include "tmcl/parameter_number.hpp"
#include "tmcl/plan/axis_twin.hpp"

namespace tmcl::plan {
namespace {

using std::chrono::milliseconds;
using Random = tmcl::test::Random<>;

TimePoint at(int ms) { return TimePoint{} + milliseconds(ms); }

TEST(SpeedRamp, GoesEvenlyToAnotherSpeedAndKeepsIt) {
  const SpeedRamp ramp{at(1000), 500, 100, 300, 1000};
  EXPECT_DOUBLE_EQ(ramp.ramp_s(), 0.2);
  EXPECT_DOUBLE_EQ(ramp.speed_at(at(900)), 100);
  EXPECT_DOUBLE_EQ(ramp.position_at(at(900)), 490);
  EXPECT_DOUBLE_EQ(ramp.speed_at(at(1100)), 200);
  EXPECT_DOUBLE_EQ(ramp.position_at(at(1100)), 515);
  EXPECT_DOUBLE_EQ(ramp.speed_at(at(1500)), 300);
  EXPECT_DOUBLE_EQ(ramp.position_at(at(1500)), 500 + 40 + 90);
}

TEST(SpeedRamp, IsTheSameSeenFromLater) {
  const SpeedRamp ramp{at(0), 0, 500, -100, 2000};
  for (const int from : {0, 100, 250, 400}) {
    const auto later = ramp.from(at(from));
    for (int ms = from; ms < 600; ms += 50) {
      EXPECT_NEAR(later.speed_at(at(ms)), ramp.speed_at(at(ms)), 1e-9) << from << ' ' << ms;
      EXPECT_NEAR(later.position_at(at(ms)), ramp.position_at(at(ms)), 1e-9) << from << ' ' << ms;
    }
  }
}

TEST(SpeedRamp, BrakesForItsTargetInTime) {
  const SpeedRamp even{at(0), 0, 1000, 1000, 2000};
  const auto is = [&](int ms) { return even.to_target(1000, 2000, at(ms)); };
  EXPECT_DOUBLE_EQ(is(700).position, 700);
  EXPECT_NEAR(is(750).speed, 1000, 1e-6);  // so far it needs 0.5 s and 250 microsteps
  EXPECT_NEAR(is(1000).speed, 500, 1e-2);
  EXPECT_NEAR(is(1000).position, 937.5, 1e-2);
  EXPECT_NEAR(is(1250).position, 1000, 1e-2);
  EXPECT_EQ(is(1300).speed, 0);
  EXPECT_NEAR(is(1300).position, 1000, 1e-2);
  EXPECT_EQ(is(1250).end_speed, 1000) << "what it was told";
}

TEST(SpeedRamp, WithATargetIsWhatARampGeneratorDoes) {
  Random random(tmcl::test::seed());
  for (int round = 0; round < tmcl::test::rounds(200); ++round) {
    auto twin = *AxisTwin::of(*find_model(6212));
    const auto units = initial_units(*find_model(6212));
    const auto speed = random.between(1000, 300'000);
    const auto slope = random.between(500'000, 5'000'000);
    const auto braking = random.between(500'000, 5'000'000);
    for (const auto& [number, value] : std::initializer_list<std::pair<std::uint8_t, std::int64_t>>{
             {number_of("max_velocity"), speed},
             {number_of("max_acceleration"), slope},
             {number_of("max_deceleration"), braking},
             {number_of("velocity_v1"), 0},
             {number_of(Family::sixpoint, "start_velocity"), 0}})
      ASSERT_TRUE(twin.set({number, static_cast<std::int32_t>(value)})) << int{number};
    const auto target = random.either_way(random.any_size(200'000));
    twin.move_to(Microsteps{static_cast<std::int32_t>(target)});
    const double sense = target < 0 ? -1 : 1;
    const SpeedRamp ramp{at(0), 0, 0, sense * static_cast<double>(speed) * units.velocity.value,
                         static_cast<double>(slope) * units.acceleration.value};
    SCOPED_TRACE(std::to_string(speed) + ", " + std::to_string(slope) + ", " +
                 std::to_string(braking) + ", to " + std::to_string(target));
    for (int ms = 1; ms < 1000; ++ms) {
      twin.advance(milliseconds(1));
      const auto there =
          ramp.to_target(static_cast<double>(target),
                         static_cast<double>(braking) * units.acceleration.value, at(ms));
      ASSERT_NEAR(there.position, twin.motion().position.value, 20) << ms;
    }
  }
}

double way_of(const Segment& segment, const SegmentTask& task) {
  const double slope = std::abs(segment.speed - task.speed) / segment.ramp_s;
  const SpeedRamp ramp{TimePoint{}, 0, task.speed, segment.speed, slope};
  return ramp.position_at(TimePoint{} + std::chrono::duration_cast<Duration>(
                                            std::chrono::duration<double>(task.time_s)));
}

// From t1 to t3 of AN-035: speeding up for 0.1 s and going on evenly for 0.4 s.
TEST(Segment, IsTheRampOfATrapezoid) {
  const SegmentTask task{0, 1000, 50 + 400, 0.5, 0.01};
  const auto segment = segment_for(task);
  EXPECT_DOUBLE_EQ(segment.speed, 1000);
  EXPECT_NEAR(segment.ramp_s, 0.1, 1e-12);
}

TEST(Segment, ToRestEndsWhereItShould) {
  const auto segment = segment_for({1000, 0, 55, 0.1, 0.01});
  EXPECT_EQ(segment.speed, 0);
  EXPECT_NEAR(segment.ramp_s * 1000 / 2, 55, 1e-9);
}

TEST(Segment, WithoutAChangeOfSpeedItMakesUpForADifference) {
  const auto segment = segment_for({1000, 1000, 110, 0.1, 0.01});
  EXPECT_GT(segment.speed, 1100);
  EXPECT_NEAR(way_of(segment, {1000, 1000, 110, 0.1, 0.01}), 110, 1e-5);
}

TEST(Segment, MakesItsWayInTime) {
  Random random(tmcl::test::seed());
  for (int round = 0; round < tmcl::test::rounds(20'000); ++round) {
    const auto speed = [&] { return static_cast<double>(random.between(-50'000, 50'000)); };
    SegmentTask task{speed(), speed(), 0, static_cast<double>(random.between(5, 2000)) / 1e3, 0};
    task.shortest_ramp_s = task.time_s / static_cast<double>(random.between(2, 50));
    task.way = speed() * task.time_s;
    const auto segment = segment_for(task);
    ASSERT_GT(segment.ramp_s, 0);
    if (task.end_speed == 0 && segment.speed == 0) continue;  // exactly to its end, then
    const double rounding = 1e-6 * (std::abs(task.speed) + std::abs(segment.speed) + 1);
    ASSERT_NEAR(way_of(segment, task), task.way, rounding)
        << task.speed << ' ' << task.end_speed << ' ' << task.time_s << ' ' << segment.ramp_s;
  }
}

TEST(Segment, WithAnotherSlopeAnotherSpeedMakesTheSameWay) {
  const SegmentTask task{100, 400, 50, 0.2, 0.01};
  for (const double slope : {3000., 10'000., 1e6}) {
    const auto speed = speed_by(slope, task);
    ASSERT_TRUE(speed) << slope;
    EXPECT_NEAR(way_of({*speed, std::abs(*speed - task.speed) / slope}, task), task.way, 1e-5);
  }
  EXPECT_FALSE(speed_by(100, task));
}

}  // namespace
}  // namespace tmcl::plan
