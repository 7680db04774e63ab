// Courses by segments: the phases of AN-035 told one by one, on slow buses and simulated modules.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "support/stream_bench.hpp"

namespace tmcl::plan {
namespace {

using std::chrono::microseconds;
using testing::HasSubstr;
using Bench = test::StreamBench;
namespace ap = axis_parameter;
using Kind = DriveCommand::Kind;
using FaultKind = DriveFault::Kind;

constexpr auto rs485_round_trip = microseconds(1760);  // at 115200 baud

path_file::Path line() {
  path_file::Path path{{"X", "Y"}, {}, {}};
  path.elements = {path_file::LineTo{{50, 20}, 20.0, {}, 1}};
  return path;
}

path_file::Path zigzag() {
  path_file::Path path{{"X", "Y"}, {}, {}};
  path.elements = {path_file::LineTo{{10, 2}, 20.0, {}, 1}, path_file::LineTo{{20, 0}, 10.0, {}, 2},
                   path_file::LineTo{{25, 10}, {}, {}, 3}, path_file::LineTo{{0, 12}, 15.0, {}, 4}};
  return path;
}

struct Passed {
  StreamReport report;
  double off_mm = 0;      ///< The farthest that the axes were off the lines.
  double lag_mm = 0;      ///< ... or a reading off where it was to be at that time.
  double per_second = 0;  ///< Commands.
};

Passed pass(std::uint16_t model, const path_file::Path& path, StreamMode mode,
            Duration round_trip) {
  Bench bench(model);
  bench.round_trip = round_trip;
  if (model == 6212) {
    bench.limit(24, 500);
  } else {
    bench.limit(5, 50);
  }
  Passed passed;
  bench.every_ms = [&] {
    passed.off_mm = std::max(passed.off_mm, test::off(path, bench.mm(0), bench.mm(1)));
  };
  passed.report = bench.pass(path, mode);
  EXPECT_FALSE(passed.report.fault) << passed.report.fault->message;
  for (const auto& axis : passed.report.axes) passed.lag_mm = std::max(passed.lag_mm, axis.largest);
  passed.per_second = static_cast<double>(passed.report.commands) / passed.report.passed_s;
  return passed;
}

// Such an axis would stay behind by as much as is allowed, and then brake for long.
TEST(StreamSegments, NoAxisSetsOutThatHasLessAccelerationThanThePathNeeds) {
  constexpr double planned = 500, too_little = 454, enough = 455;  // and a tenth
  const auto pass_with = [](double own) {
    Bench bench;
    bench.limit(24, planned);
    const auto pps2 = static_cast<std::int32_t>(own * test::microsteps_per_mm);
    EXPECT_TRUE(bench.ask(Command::SAP, test::ap::max_acceleration, 1, pps2));
    const auto report = bench.pass(line(), StreamMode::segments);
    EXPECT_EQ(bench.mm(0), report.fault ? 0 : 50);
    return report;
  };
  const auto report = pass_with(too_little);
  ASSERT_TRUE(report.fault);
  EXPECT_EQ(report.fault->kind, DriveFault::Kind::unsuited);
  EXPECT_EQ(report.fault->axis, 1U);
  EXPECT_EQ(report.fault->message, "has an acceleration of 454, and the path was planned with 500");
  EXPECT_FALSE(pass_with(enough).fault);
}

// t1: the speed and how to get there; t3: the speed at the end, and how.
TEST(StreamSegments, ALineIsTwoUpdates) {
  Bench bench;
  bench.limit(24, 500);
  const auto report = bench.pass(line(), StreamMode::segments);
  ASSERT_FALSE(report.fault) << report.fault->message;
  EXPECT_EQ(report.updates, 2U);
  EXPECT_LT(static_cast<double>(report.commands), 120 * report.passed_s);
  EXPECT_EQ(bench.mm(0), 50);
  EXPECT_EQ(bench.mm(1), 20);
}

TEST(StreamSegments, OnASlowBusTheyKeepToThePathWithFewerCommands) {
  for (const auto model : std::to_array<std::uint16_t>({6212, 3110})) {
    for (const auto& path : {line(), zigzag(), test::circle(20, 0.1), test::circle(20, 1)}) {
      SCOPED_TRACE(std::to_string(model) + ", " + std::to_string(path.elements.size()) + " legs");
      const auto by_segments = pass(model, path, StreamMode::segments, rs485_round_trip);
      const auto by_velocity = pass(model, path, StreamMode::velocity, rs485_round_trip);
      EXPECT_LT(by_segments.off_mm, 0.04);
      EXPECT_LT(by_segments.lag_mm, 0.1);
      EXPECT_LT(by_segments.per_second, 0.7 * by_velocity.per_second);
    }
  }
}

TEST(StreamSegments, ATableWithTimesIsForVelocityMode) {
  auto path = line();
  std::get<path_file::LineTo>(path.elements.front()).duration = 5;
  Bench bench;
  const auto report = bench.pass(path, StreamMode::segments);
  ASSERT_TRUE(report.fault);
  EXPECT_EQ(report.fault->kind, FaultKind::unsuited);
  EXPECT_THAT(report.fault->message, HasSubstr("use velocity mode"));
}

// By its own accelerations and a tenth more, but for joints.
TEST(StreamSegments, AnAxisIsToldNoSteeperRampThanItsOwn) {
  Bench bench;
  bench.limit(24, 500);
  const auto own = bench.get(0, ap::max_acceleration);
  const auto report = bench.pass(line(), StreamMode::segments);
  ASSERT_FALSE(report.fault);
  for (const auto& command : bench.commands) {
    if (command.kind == Kind::set && command.parameter == ap::max_acceleration) {
      EXPECT_LE(command.value, 1.1 * own + 1);
    }
  }
  for (std::uint8_t axis = 0; axis < 2; ++axis) {
    EXPECT_EQ(bench.get(axis, ap::max_acceleration), own);
    EXPECT_EQ(bench.get(axis, 17), own);
    EXPECT_EQ(bench.get(axis, ap::max_velocity), 245'760);
  }
}

// Whoever stops it does that by the acceleration that it has then.
TEST(StreamSegments, AnAxisCanBeStoppedInTwiceTheTimeOfItsOwnRamp) {
  for (const std::uint16_t model : std::initializer_list<std::uint16_t>{6212, 3110, 1021}) {
    SCOPED_TRACE(model);
    Bench bench(model);
    bench.round_trip = rs485_round_trip;
    bench.limit(5, 50);
    const double own_s = 5. / 50;
    const auto units = initial_units(*find_model(model));
    double longest_s = 0;
    bench.every_ms = [&] {
      for (const auto axis : bench.motors()) {
        if (bench.stream().phase() != PathStream::Phase::running) return;
        const double speed = bench.get(axis, ap::actual_velocity) * units.velocity.value;
        const double slope = bench.get(axis, ap::max_acceleration) * units.acceleration.value;
        longest_s = std::max(longest_s, std::abs(speed) / slope);
      }
    };
    path_file::Path path{{"X"}, {}, {}};
    for (const double x : {3.0, 3.5, 7.0, -2.0})
      path.elements.push_back(path_file::LineTo{{x}, 5.0, {}, 1});
    ASSERT_FALSE(bench.pass(path, StreamMode::segments).fault);
    EXPECT_LT(longest_s, 2 * own_s * 1.1);
  }
}

// They turn instead: ROR and ROL.
TEST(StreamSegments, AreForModulesWithoutAPositionStreamToo) {
  const auto passed = pass(3351, zigzag(), StreamMode::segments, rs485_round_trip);
  EXPECT_LT(passed.off_mm, 0.1);
  EXPECT_GT(passed.report.updates, 4U);
}

}  // namespace
}  // namespace tmcl::plan
