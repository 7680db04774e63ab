// What a motor feels on a path: its speed changes by its acceleration, and where
// two lines meet by what their directions differ in. All that is known of the path here is its
// lines, and of the axes what the simulated motors do, each millisecond.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/random.hpp"
#include "support/rounds.hpp"
#include "support/seed.hpp"
#include "support/stream_bench.hpp"

namespace tmcl::plan {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using Bench = test::StreamBench;
using Random = tmcl::test::Random<>;
using Vector = std::array<double, 3>;
namespace ap = axis_parameter;

constexpr double velocity = 24;
constexpr double acceleration = 500;
constexpr double corner_tolerance = 0.025;  // of the bench
constexpr double tolerance = 0.05;          // of which that is the half

struct Lines {
  std::size_t axes = 2;
  double feed = 20;
  std::vector<Vector> points{{}};  // the first is the start
};

double length(const Vector& way) { return std::hypot(way[0], way[1], way[2]); }
Vector way_of(const Lines& lines, std::size_t line) {
  Vector way{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    way[axis] = lines.points[line + 1][axis] - lines.points[line][axis];
  return way;
}
Vector direction_of(const Lines& lines, std::size_t line) {
  auto way = way_of(lines, line);
  const double size = length(way);
  for (auto& part : way) part /= size;
  return way;
}

/// How fast a joint may be passed at most: by the feed, and by an arc that is off the corner by the
/// tolerance, takes no more than half of a line, and asks each axis for no more than it can do.
double greatest_joint_speed(const Lines& lines, std::size_t before) {
  const auto one = direction_of(lines, before), other = direction_of(lines, before + 1);
  Vector sum{};
  for (std::size_t axis = 0; axis < 3; ++axis) sum[axis] = one[axis] + other[axis];
  const double cosine = length(sum) / 2;
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  if (sine < 1e-9) return lines.feed;
  const double room = std::min(length(way_of(lines, before)), length(way_of(lines, before + 1)));
  const double radius =
      std::min(corner_tolerance * cosine * (1 + cosine) / (sine * sine), room / 2 * cosine / sine);
  return std::min(lines.feed, std::sqrt(radius * acceleration * std::sqrt(lines.axes)));
}

/// By how much the speed of each axis may change at once, at the joint that asks for most.
Vector greatest_jumps(const Lines& lines) {
  Vector most{};
  for (std::size_t line = 0; line + 2 < lines.points.size(); ++line) {
    const auto one = direction_of(lines, line), other = direction_of(lines, line + 1);
    const double speed = greatest_joint_speed(lines, line);
    for (std::size_t axis = 0; axis < 3; ++axis)
      most[axis] = std::max(most[axis], speed * std::abs(other[axis] - one[axis]));
  }
  return most;
}

double off(const Lines& lines, const Vector& at) {
  double nearest = 1e9;
  for (std::size_t line = 0; line + 1 < lines.points.size(); ++line) {
    const auto way = way_of(lines, line);
    const auto& from = lines.points[line];
    double along = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) along += (at[axis] - from[axis]) * way[axis];
    const double part = std::clamp(along / (length(way) * length(way)), 0.0, 1.0);
    nearest = std::min(nearest,
                       std::hypot(at[0] - from[0] - part * way[0], at[1] - from[1] - part * way[1],
                                  at[2] - from[2] - part * way[2]));
  }
  return nearest;
}

path_file::Path path_of(const Lines& lines) {
  path_file::Path path{{"X", "Y", "Z"}, {}, {}};
  path.axes.resize(lines.axes);
  for (std::size_t i = 1; i < lines.points.size(); ++i) {
    path_file::LineTo to{{}, lines.feed, {}, i};
    for (std::size_t axis = 0; axis < 3; ++axis) to.target[axis] = lines.points[i][axis];
    path.elements.push_back(to);
  }
  return path;
}

struct Felt {
  Vector largest_jump{};  ///< In a millisecond, beyond what the acceleration gives.
  double farthest = 0;
  bool refused = false;
  std::string fault{};
};

/// `least` and `most`: how long a command takes.
Felt pass(const Lines& lines, Random& random, Duration least, Duration most,
          StreamMode mode = StreamMode::position) {
  Bench bench(6212, lines.axes);
  bench.limit(velocity, acceleration);
  bench.most_deviation = 1000;
  Felt felt;
  Vector before{};
  int ms = 0;
  auto at = bench.now();
  bench.every_ms = [&] {
    if (++ms > 300'000) throw std::runtime_error("it does not end");
    const double passed = std::chrono::duration<double>(bench.now() - at).count();
    at = bench.now();
    Vector position{};
    for (const auto axis : bench.motors()) {
      const double speed = bench.get(axis, ap::actual_velocity) / test::microsteps_per_mm;
      const double change = std::abs(speed - before[axis]) - acceleration * passed;
      felt.largest_jump[axis] = std::max(felt.largest_jump[axis], change);
      before[axis] = speed;
      position[axis] = bench.mm(axis);
    }
    felt.farthest = std::max(felt.farthest, off(lines, position));
  };
  bench.instead = [&](const DriveCommand&) -> std::optional<tmcl::Result<std::int32_t>> {
    bench.round_trip = Duration(random.between(least.count(), most.count()));
    return std::nullopt;
  };
  const auto report = bench.pass(path_of(lines), mode);
  if (report.fault) felt.fault = report.fault->message;
  felt.refused = report.fault && report.fault->kind == DriveFault::Kind::slow_bus;
  return felt;
}

std::string describe(const Lines& lines) {
  std::string text;
  for (const auto& point : lines.points) {
    text += " (";
    for (std::size_t axis = 0; axis < lines.axes; ++axis)
      text += (axis > 0 ? ", " : "") + std::to_string(point[axis]);
    text += ")";
  }
  return text + " F" + std::to_string(lines.feed);
}

/// What an axis may gain or lose beyond that, to be back in time: mm/s.
double spare(const Lines& lines) { return 0.1 + 0.02 * lines.feed; }

void expect_no_steps_lost(const Lines& lines, const Felt& felt) {
  EXPECT_EQ(felt.fault, "") << describe(lines);
  const auto jumps = greatest_jumps(lines);
  for (std::size_t axis = 0; axis < lines.axes; ++axis)
    EXPECT_LE(felt.largest_jump[axis], jumps[axis] + spare(lines)) << axis << describe(lines);
}

TEST(StreamJoint, IsPassedWithoutAStopByAnAxisThatGoesOn) {
  Random random(tmcl::test::seed());
  for (const auto us : {50, 100, 450, 2100, 5000, 20'000}) {
    for (const double y : {5.0, 8.0, 6.25}) {
      const Lines lines{2, 20, {{}, {20, 5}, {25, y}, {32, y}}};
      SCOPED_TRACE(std::to_string(us) + " us");
      expect_no_steps_lost(lines, pass(lines, random, microseconds(us), microseconds(us)));
      expect_no_steps_lost(lines, pass(lines, random, microseconds(us), microseconds(us + us / 2)));
    }
  }
}

Lines random_lines(Random& random) {
  Lines lines;
  lines.axes = static_cast<std::size_t>(random.between(1, 3));
  lines.feed = static_cast<double>(random.between(2, 20));
  const auto count = random.between(2, 8);
  const bool gently = random.one_in(2);  // near one direction
  for (std::int64_t i = 0; i < count; ++i) {
    auto to = lines.points.back();
    for (std::size_t axis = 0; axis < lines.axes; ++axis) {
      const auto size = static_cast<double>(random.between(500, 12'000)) / 1e3;
      const bool rests = random.one_in(5);
      to[axis] += rests ? 0 : gently || random.one_in(2) ? size : -size;
    }
    if (to == lines.points.back()) to[0] += 5;
    lines.points.push_back(to);
  }
  return lines;
}

TEST(StreamJoint, OfAnyLinesChangesNoSpeedByMoreThanItAllows) {
  Random random(tmcl::test::seed());
  int passed = 0;
  for (int round = 0; round < tmcl::test::rounds(150); ++round) {
    const auto lines = random_lines(random);
    const auto us = 100 + random.any_size(19'900);
    const auto jitter = random.between(0, us);
    SCOPED_TRACE("round " + std::to_string(round) + ": " + std::to_string(us) + " to " +
                 std::to_string(us + jitter) + " us");
    const auto felt = pass(lines, random, microseconds(us), microseconds(us + jitter));
    if (felt.refused) continue;
    ++passed;
    expect_no_steps_lost(lines, felt);
    if (us + jitter < 300) {
      EXPECT_LT(felt.farthest, tolerance) << describe(lines);
    }
    if (HasFailure()) return;
  }
  EXPECT_GT(passed, 0);
}

// A stream of velocities gives a change of speed in half an update, by twice the acceleration.
TEST(StreamJoint, OfAnyLinesInOtherModesChangesNoSpeedByMoreThanItAllows) {
  Random random(tmcl::test::seed());
  for (int round = 0; round < tmcl::test::rounds(150); ++round) {
    const auto lines = random_lines(random);
    const auto us = 100 + random.any_size(4900);
    const auto jitter = random.between(0, us);
    const auto mode = random.one_in(2) ? StreamMode::velocity : StreamMode::segments;
    SCOPED_TRACE("round " + std::to_string(round) + ": " + std::string(name_of(mode)) + ", " +
                 std::to_string(us) + " to " + std::to_string(us + jitter) + " us");
    const auto felt = pass(lines, random, microseconds(us), microseconds(us + jitter), mode);
    EXPECT_EQ(felt.fault, "") << describe(lines);
    const auto jumps = greatest_jumps(lines);
    for (std::size_t axis = 0; axis < lines.axes; ++axis)
      EXPECT_LE(felt.largest_jump[axis], jumps[axis] + spare(lines) + acceleration * 1e-3)
          << axis << describe(lines);
    if (HasFailure()) return;
  }
}

// A line, an arc of radius 5 in chords, two lines, and the corner between them.
TEST(StreamJoint, ArcsStayWithinTheirTolerance) {
  Random random(tmcl::test::seed());
  for (const int chords : {18, 36, 60}) {
    Lines lines{2, 20, {{}, {20, 5}, {25, 5}}};
    for (int i = 1; i <= chords; ++i) {
      const double angle = std::numbers::pi / 2 * i / chords;
      lines.points.push_back({25 + 5 * std::sin(angle), 10 - 5 * std::cos(angle)});
    }
    lines.points.push_back({30, 20});
    lines.points.push_back({});
    for (const auto us : {50, 200, 450, 900}) {
      SCOPED_TRACE(std::to_string(chords) + " chords, " + std::to_string(us) + " us");
      const auto felt = pass(lines, random, microseconds(us), microseconds(us + us / 2));
      if (felt.refused) continue;
      expect_no_steps_lost(lines, felt);
      EXPECT_LT(felt.farthest, tolerance);
    }
  }
}

}  // namespace
}  // namespace tmcl::plan
