// What a start velocity would be good for in position mode: nothing while the axes move, and steps
// are lost where a leg comes so late that an axis stands.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "support/stream_bench.hpp"
#include "tmcl/parameter_number.hpp"

namespace tmcl::plan {
namespace {

using std::chrono::milliseconds;
using Bench = test::StreamBench;
using Kind = DriveCommand::Kind;
namespace ap = axis_parameter;

constexpr auto vstart = number_of(Family::sixpoint, "start_velocity");

struct Track {
  std::vector<double> x, y;
  double largest_start = 0;  ///< From rest to what speed, in a millisecond; in mm/s.
};

/// If `with_vstart`, VSTART is the speed at the joint where an axis goes on in the same sense.
/// `late`: how much later one leg in the middle is loaded.
Track pass(bool with_vstart, Duration late) {
  Bench bench;
  bench.limit(24, 500);
  bench.most_deviation = 5;
  Track track;
  double before = 0;
  std::array<std::int32_t, 2> speed{};
  bool has_slept = false;
  bench.every_ms = [&] {
    track.x.push_back(bench.mm(0));
    track.y.push_back(bench.mm(1));
    const double now = std::abs(bench.get(1, ap::actual_velocity)) / test::microsteps_per_mm;
    if (before == 0) track.largest_start = std::max(track.largest_start, now);
    before = now;
  };
  bench.instead = [&](const DriveCommand& command) -> std::optional<tmcl::Result<std::int32_t>> {
    if (command.kind != Kind::set || command.parameter != ap::target_position) return std::nullopt;
    const auto axis = static_cast<std::uint8_t>(command.axis);
    const auto actual = bench.get(axis, ap::actual_velocity);
    const auto way = command.value - bench.get(axis, ap::actual_position);
    if (actual != 0) speed[axis] = (actual > 0) == (way > 0) ? std::abs(actual) : 0;
    if (axis == 1 && bench.mm(1) > 5 && !has_slept) {
      has_slept = true;
      bench.let_pass(late);
    }
    if (with_vstart) bench.ask(Command::SAP, vstart, axis, speed[axis]);
    return std::nullopt;
  };
  const auto report = bench.pass(test::circle(20, 1), StreamMode::position);
  EXPECT_FALSE(report.fault) << report.fault->message;
  return track;
}

double off_circle(const Track& track) {
  double farthest = 0;
  for (std::size_t i = 0; i < track.x.size(); ++i) {
    const double off = std::hypot(track.x[i] - test::circle_radius, track.y[i]);
    farthest = std::max(farthest, std::abs(off - test::circle_radius));
  }
  return farthest;
}

TEST(VstartInPositionMode, HardlyMakesADifferenceToAxesThatMove) {
  const auto without = pass(false, milliseconds(0));
  const auto with = pass(true, milliseconds(0));
  EXPECT_NEAR(off_circle(with), off_circle(without), 0.01);
}

TEST(VstartInPositionMode, SetsOutAtOnceWithTheSpeedOfAJointThatCameTooLate) {
  constexpr auto late = milliseconds(70);
  EXPECT_LT(pass(false, late).largest_start, 2);
  EXPECT_GT(pass(true, late).largest_start, 10);
}

TEST(StreamPosition, HasNoStartVelocityUntilItEnds) {
  Bench bench;
  bench.limit(24, 500);
  for (std::uint8_t axis = 0; axis < 2; ++axis) bench.ask(Command::SAP, vstart, axis, 5000);
  int looks = 0;
  bench.every_ms = [&] {
    if (!bench.moving()) return;
    ++looks;
    for (std::uint8_t axis = 0; axis < 2; ++axis) EXPECT_EQ(bench.get(axis, vstart), 0);
  };
  ASSERT_FALSE(bench.pass(test::circle(20, 0.1), StreamMode::position).fault);
  EXPECT_GT(looks, 2000);
  for (std::uint8_t axis = 0; axis < 2; ++axis) EXPECT_EQ(bench.get(axis, vstart), 5000);
}

TEST(StreamPosition, TargetsOfALegGoOutInQuickSuccession) {
  Bench bench;
  bench.limit(24, 500);
  bench.most_deviation = 5;
  ASSERT_FALSE(bench.pass(test::circle(20, 1), StreamMode::position).fault);
  const auto is_target = [](const DriveCommand& command) {
    return command.kind == Kind::set && command.parameter == ap::target_position;
  };
  const auto first = std::ranges::find_if(bench.commands, is_target);
  ASSERT_GE(bench.commands.end() - first, 2);
  EXPECT_TRUE(is_target(first[1])) << int{first[1].parameter};
  EXPECT_NE(first[0].axis, first[1].axis);
  // What they need is there before.
  for (const std::size_t axis : {0U, 1U}) {
    for (const auto parameter : {ap::max_velocity, ap::max_acceleration}) {
      const auto sets = [&](const DriveCommand& command) {
        return command.kind == Kind::set && command.axis == axis && command.parameter == parameter;
      };
      EXPECT_TRUE(std::any_of(bench.commands.begin(), first, sets)) << int{parameter};
    }
  }
}

}  // namespace
}  // namespace tmcl::plan
