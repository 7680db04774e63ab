// What a stream makes of answers: of those that do not come, and of those that come late.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "support/stream_bench.hpp"

namespace tmcl::plan {
namespace {

using std::chrono::milliseconds;
namespace ap = axis_parameter;
using Bench = test::StreamBench;
using Kind = DriveCommand::Kind;
using FaultKind = DriveFault::Kind;

constexpr double own_acceleration = 500;  // mm/s2

path_file::Path one_line() {
  path_file::Path path{{"X", "Y"}, {}, {}};
  path.elements = {path_file::LineTo{{20, 10}, 20.0, {}, 1}};
  return path;
}

// A link that is lost between a command and its answer does not say what has become of it.
class StreamInEachMode : public testing::TestWithParam<StreamMode> {};

TEST_P(StreamInEachMode, UndoesAWriteThatHadNoAnswer) {
  Bench bench;
  bench.limit(24, own_acceleration);
  const auto own = bench.get(0, ap::max_acceleration);
  bool lost = false;
  bench.instead = [&](const DriveCommand& command) -> std::optional<tmcl::Result<std::int32_t>> {
    if (lost || command.kind != Kind::set || command.parameter != ap::max_acceleration)
      return std::nullopt;
    const auto axis = static_cast<std::uint8_t>(command.axis);
    auto answer = bench.ask(Command::SAP, command.parameter, axis, command.value);
    lost = bench.get(axis, command.parameter) != own;
    if (!lost) return answer;
    return test::no_reply();
  };
  const auto report = bench.pass(one_line(), GetParam());
  ASSERT_TRUE(lost);
  ASSERT_TRUE(report.fault);
  EXPECT_EQ(report.fault->kind, FaultKind::refused);
  EXPECT_TRUE(report.unrestored.empty());
  for (std::uint8_t axis = 0; axis < 2; ++axis)
    EXPECT_EQ(bench.get(axis, ap::max_acceleration), own);
}

INSTANTIATE_TEST_SUITE_P(Streams, StreamInEachMode,
                         testing::Values(StreamMode::velocity, StreamMode::segments,
                                         StreamMode::position),
                         [](const auto& mode) { return std::string(name_of(mode.param)); });

// Whoever reads a position reads it half-way between question and answer.
TEST(Stream, ALongRoundTripIsNoTrackingError) {
  Bench bench;
  bench.limit(24, own_acceleration);
  bench.round_trip = milliseconds(10);
  const auto course = Course::of(one_line(), bench.planned_limits());
  ASSERT_TRUE(course) << course.error();
  std::optional<TimePoint> begin;
  std::array<std::int32_t, 2> velocity{};
  // Axes that are where the course is, whatever they are told; each is asked half-way.
  bench.instead = [&](const DriveCommand& command) -> std::optional<tmcl::Result<std::int32_t>> {
    const bool runs = bench.stream().phase() != PathStream::Phase::before;
    if (runs && !begin && command.kind == Kind::get) begin = bench.now() - bench.round_trip / 2;
    if (command.kind == Kind::set && command.parameter == ap::max_velocity)
      velocity[command.axis] = command.value;
    if (command.kind != Kind::get) return 0;
    switch (command.parameter) {
      case ap::target_velocity: return velocity[command.axis];
      case ap::actual_velocity: return 0;
      case ap::actual_position:
      case ap::target_position: break;
      default: return std::nullopt;
    }
    double passed = begin ? std::chrono::duration<double>(bench.now() - *begin).count() : 0;
    if (command.parameter == ap::target_position) passed = course->duration();
    return static_cast<std::int32_t>(
        std::lround(course->at(std::min(passed, course->duration())).position[command.axis] *
                    test::microsteps_per_mm));
  };
  const auto report = bench.pass(one_line(), StreamMode::velocity);
  ASSERT_FALSE(report.fault) << report.fault->message;
  for (const auto& axis : report.axes) {
    EXPECT_GT(axis.readings, 5U);
    EXPECT_LT(axis.largest, 1 / test::microsteps_per_mm) << "what rounding costs";
  }
}

}  // namespace
}  // namespace tmcl::plan
