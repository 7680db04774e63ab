// Shaped paths on simulated motors, and the loads that swing behind them.
#include <gtest/gtest.h>

#include <utility>

#include "support/stream_bench.hpp"
#include "tmcl/plan/shaping_report.hpp"

namespace tmcl::plan {
namespace {

constexpr ramp::Resonance load_of_x{12, 0.02};

/// A way of X after which a load of 12 Hz swings much; how much, depends on how long it is.
path_file::Path there_and_back(double length) {
  path_file::Path path{{"X", "Y"}, {}, {}};
  path.elements.push_back(path_file::LineTo{{length, 0}, {}, {}, 1});
  path.elements.push_back(path_file::LineTo{{length, 6}, {}, {}, 2});
  path.elements.push_back(path_file::LineTo{{1, 3}, {}, {}, 3});
  return path;
}

constexpr double no_jerk_limit = std::numeric_limits<double>::infinity();
/// The acceleration takes as long as a swing then, which undoes what it does to the load.
constexpr double jerk_of_a_swing = 400 * 12;

/// What is done for the load.
struct Care {
  std::optional<Shaping> shaping{};
  double jerk = no_jerk_limit;
};

/// How far the load of X swings after the path, in mm, by where its motor is each millisecond.
double swing_after(double length, const Care& care, StreamMode mode) {
  constexpr double look_s = 1e-3;
  test::StreamBench bench;
  bench.limit(20, 400);
  bench.shaping = care.shaping;
  bench.jerk = care.jerk;
  ramp::ResonantLoad load(load_of_x);
  double position = 0, speed = 0;
  bench.every_ms = [&] {
    const double now = (bench.mm(0) - position) / look_s;
    load.advance(look_s, (now - speed) / look_s);
    position = bench.mm(0);
    speed = now;
  };
  const auto report = bench.pass(there_and_back(length), mode);
  EXPECT_FALSE(report.fault) << report.fault->message;
  EXPECT_NEAR(bench.mm(0), 1, 0.001);
  EXPECT_NEAR(bench.mm(1), 3, 0.001);
  return load.swing();
}

/// The mean of ways of many lengths.
double mean_swing(const Care& care, StreamMode mode) {
  double sum = 0;
  constexpr int ways = 16;
  for (int way = 0; way < ways; ++way) sum += swing_after(8 + 0.25 * way, care, mode);
  return sum / ways;
}

// zv is hurt most by what an axis is off its course: by velocities, a third of the swing is left.
TEST(StreamShaping, LetsTheLoadHardlySwingAfterThePath) {
  for (const auto mode : {StreamMode::velocity, StreamMode::segments}) {
    const double unshaped = mean_swing({}, mode);
    EXPECT_GT(unshaped, 0.1) << name_of(mode);
    const double zv_part = mode == StreamMode::velocity ? 0.33 : 0.2;
    for (const auto& [shaper, part] : {std::pair(Shaper::zv, zv_part), std::pair(Shaper::zvd, 0.2),
                                       std::pair(Shaper::ei, 0.2)}) {
      EXPECT_LT(mean_swing({Shaping{shaper, load_of_x}}, mode), part * unshaped)
          << name_of(shaper) << " by " << name_of(mode);
    }
  }
}

TEST(StreamShaping, LetsTheLoadSwingLessWithAJerk) {
  for (const auto mode : {StreamMode::velocity, StreamMode::segments}) {
    const double unlimited = mean_swing({}, mode);
    EXPECT_LT(mean_swing({{}, jerk_of_a_swing}, mode), 0.5 * unlimited) << name_of(mode);
    EXPECT_LT(mean_swing({Shaping{Shaper::zvd, load_of_x}, jerk_of_a_swing}, mode), 0.2 * unlimited)
        << name_of(mode);
  }
}

TEST(StreamShaping, JerksAreNotForPositionMode) {
  test::StreamBench bench;
  bench.jerk = 1000;
  const auto report = bench.pass(there_and_back(10), StreamMode::position);
  ASSERT_TRUE(report.fault);
  EXPECT_EQ(report.fault->kind, DriveFault::Kind::unsuited);
  EXPECT_EQ(report.fault->message,
            "position mode cannot limit a jerk; use velocity mode, or segments");
}

TEST(StreamShaping, IsNotForPositionMode) {
  test::StreamBench bench;
  bench.shaping = Shaping{Shaper::zv, load_of_x};
  const auto report = bench.pass(there_and_back(10), StreamMode::position);
  ASSERT_TRUE(report.fault);
  EXPECT_EQ(report.fault->kind, DriveFault::Kind::unsuited);
  EXPECT_EQ(report.fault->message,
            "position mode cannot shape a path; use velocity mode, or segments");
}

TEST(ShapingReport, SaysWhatTheShaperCostsAndGains) {
  PathLimits limits;
  limits.axes = 2;
  limits.axis.fill({20, 400, 5});
  limits.corner_tolerance = 0.025;
  const Shaping shaping{Shaper::zvd, load_of_x};
  const auto course =
      Course::of(there_and_back(10.7), limits, std::numeric_limits<double>::infinity(), shaping);
  ASSERT_TRUE(course);
  const auto report = report_on_shaping(*course, load_of_x);
  EXPECT_NEAR(report.longer_s, 1 / 12.0, 0.001);
  EXPECT_GT(report.unshaped[0], 0.05);
  EXPECT_LT(report.swing[0], 0.001);
  // It cuts the corners, by some hundredths of a mm, in one of the two.
  EXPECT_GT(report.farthest, 0.01);
  EXPECT_LT(report.farthest, 0.5);
  EXPECT_LT(test::off(there_and_back(10.7), course->at(report.at_s).position[0],
                      course->at(report.at_s).position[1]),
            report.farthest + 0.001);
}

}  // namespace
}  // namespace tmcl::plan
