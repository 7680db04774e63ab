#include "motion/drive/speed_ramp.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/random.hpp"
#include "support/rounds.hpp"
#include "support/seed.hpp"

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
