// Courses on simulated modules, in virtual time: every command takes a while, and every millisecond
// the simulated axes are looked at.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "support/stream_bench.hpp"
#include "tmcl/seconds.hpp"

namespace tmcl::plan {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using testing::HasSubstr;
namespace ap = axis_parameter;
using Bench = test::StreamBench;
using Kind = DriveCommand::Kind;
using FaultKind = DriveFault::Kind;

using test::circle;
constexpr double radius = test::circle_radius;
constexpr std::int32_t acceleration = 5'119'946;  // 500 mm/s2

path_file::Path square() {
  path_file::Path path{{"X", "Y"}, {}, {}};
  path.elements = {path_file::LineTo{{5, 0}, 20.0, {}, 1}, path_file::LineTo{{5, 5}, 20.0, {}, 2},
                   path_file::Dwell{0.1, 3}, path_file::LineTo{{0, 5}, {}, {}, 4},
                   path_file::LineTo{{0, 0}, 20.0, {}, 5}};
  return path;
}

void set_limits(Bench& bench) {
  for (std::uint8_t axis = 0; axis < 2; ++axis) {
    bench.ask(Command::SAP, ap::max_acceleration, axis, acceleration);
    bench.ask(Command::SAP, 17, axis, acceleration);
    bench.ask(Command::SAP, ap::max_velocity, axis, 240'000);
  }
}

class EachMode : public testing::TestWithParam<StreamMode> {
 protected:
  EachMode() { set_limits(bench); }

  void expect_as_before() {
    EXPECT_FALSE(bench.moving());
    for (std::uint8_t axis = 0; axis < 2; ++axis) {
      EXPECT_EQ(bench.get(axis, ap::max_acceleration), acceleration);
      EXPECT_EQ(bench.get(axis, ap::max_velocity), 240'000);
      EXPECT_EQ(bench.get(axis, 16), 25600);
      EXPECT_EQ(bench.get(axis, 17), acceleration);
      EXPECT_EQ(bench.get(axis, 20), 10);
    }
  }
  StreamReport pass() { return bench.pass(circle(20, 0.1), GetParam()); }
  bool half_way() { return bench.mm(0) > radius; }

  Bench bench;
};

TEST_P(EachMode, ACircleStaysWithinItsTolerance) {
  double farthest = 0;
  int looks = 0;
  bench.every_ms = [&] {
    farthest = std::max(farthest, std::abs(std::hypot(bench.mm(0) - radius, bench.mm(1)) - radius));
    ++looks;
  };
  const auto report = pass();
  ASSERT_FALSE(report.fault) << report.fault->message;
  RecordProperty("farthest_um", std::to_string(farthest * 1e3));
  RecordProperty("commands_per_s",
                 std::to_string(static_cast<double>(report.commands) / report.passed_s));
  EXPECT_GT(looks, 2000);
  EXPECT_LT(farthest, 0.005);
  EXPECT_EQ(bench.mm(0), 0);
  EXPECT_EQ(bench.mm(1), 0);
  EXPECT_NEAR(report.passed_s, 2 * std::numbers::pi * radius / 20, 0.1);
  EXPECT_LT(report.busy_s, report.passed_s * (1 - spare_part_of_bus));
  for (const auto& axis : report.axes) {
    EXPECT_GT(axis.readings, GetParam() == StreamMode::segments ? 150U : 300U);
    EXPECT_LT(axis.largest, 0.03);
    EXPECT_LT(axis.rms(), GetParam() == StreamMode::position ? 0.006 : 0.003);
  }
  expect_as_before();
}

TEST_P(EachMode, KeepsSomeOfThePlacesWhereTheAxesWereSeen) {
  EXPECT_TRUE(pass().seen.empty());
  bench.most_seen = 40;
  const auto report = pass();
  ASSERT_FALSE(report.fault) << report.fault->message;
  const auto& seen = report.seen;
  ASSERT_GE(seen.size(), bench.most_seen / 2);
  EXPECT_LE(seen.size(), bench.most_seen);
  EXPECT_LT(seen.front().at_s, 0.1 * report.passed_s);
  EXPECT_GT(seen.back().at_s, 0.9 * report.passed_s);
  EXPECT_TRUE(std::ranges::is_sorted(seen, {}, &SeenPlace::at_s));
  constexpr double chords = 0.005;
  for (const auto& [at_s, place, on_path] : seen) {
    const double off = std::hypot(place[0] - radius, place[1]) - radius;
    EXPECT_LT(std::abs(off), report.largest_off + chords) << at_s;
    EXPECT_NEAR(std::hypot(on_path[0] - radius, on_path[1]), radius, chords) << at_s;
    EXPECT_LE(std::hypot(on_path[0] - place[0], on_path[1] - place[1]), report.largest_off + 1e-6);
  }
}

/// The motor of y slips by 0.08 mm half-way, and its counter runs over meanwhile.
TEST_P(EachMode, WhatEncodersTellIsReportedBesideThePositions) {
  constexpr std::uint8_t encoder_position = 209;
  constexpr double slip = 0.08;
  bench.encoders[1] = {encoder_position, -1000};
  bench.most_seen = 100;
  bench.instead = [&](const DriveCommand& command) -> std::optional<tmcl::Result<std::int32_t>> {
    if (command.kind != Kind::get || command.parameter != encoder_position) return std::nullopt;
    EXPECT_EQ(command.axis, 1U) << "x has none";
    const double y = bench.mm(1) + (half_way() ? slip : 0);
    const auto counted = static_cast<std::int32_t>(std::lround(-1000 * y));
    return static_cast<std::int32_t>(0x80000001U + static_cast<std::uint32_t>(counted));
  };
  const auto report = bench.pass(circle(20, 0.1), GetParam());
  ASSERT_FALSE(report.fault) << report.fault->message;
  EXPECT_LT(report.largest_off, 0.01);
  ASSERT_TRUE(report.motors);
  const auto& motors = *report.motors;
  EXPECT_EQ(motors.axes[0].readings, 0U);
  EXPECT_GT(motors.axes[1].readings, 50U);
  EXPECT_NEAR(motors.axes[1].largest, slip, 0.02);
  EXPECT_NEAR(motors.largest_off, slip, 0.01);
  EXPECT_GT(motors.largest_off_at[0], radius - 0.1) << "not before it slipped";
  ASSERT_GT(motors.seen.size(), 20U);
  for (const auto& [at_s, place, on_path] : motors.seen) {
    EXPECT_NEAR(std::hypot(on_path[0] - radius, on_path[1]), radius, 0.005) << at_s;
    EXPECT_LE(std::hypot(on_path[0] - place[0], on_path[1] - place[1]), motors.largest_off + 1e-6);
  }
  expect_as_before();
}

TEST_P(EachMode, WithoutEncodersNothingIsToldOfMotors) { EXPECT_FALSE(pass().motors); }

// Being late alone is no distance from the path.
TEST_P(EachMode, TellsHowFarFromThePathTheAxesWereAndHowLateOnIt) {
  const auto whole = pass();
  ASSERT_FALSE(whole.fault) << whole.fault->message;
  EXPECT_LT(whole.largest_off, 0.01);
  EXPECT_LT(whole.largest_lag_s, 0.003);
  path_file::Path line{{"X", "Y"}, {}, {}};
  line.elements = {path_file::LineTo{{20, 10}, 20, {}, 1}, path_file::LineTo{{20, 20}, 20, {}, 2}};
  Bench late;
  set_limits(late);
  late.most_deviation = 5;
  double farthest = 0;
  bool slept = false;
  late.instead = [&](const DriveCommand& command) -> std::optional<tmcl::Result<std::int32_t>> {
    const bool sets_speed = command.kind == Kind::set && command.parameter == ap::max_velocity;
    if (late.mm(0) < 19.8 || slept || !sets_speed) return std::nullopt;
    slept = true;
    late.let_pass(milliseconds(40));
    return std::nullopt;
  };
  late.every_ms = [&] { farthest = std::max(farthest, test::off(line, late.mm(0), late.mm(1))); };
  const auto report = late.pass(line, GetParam());
  ASSERT_FALSE(report.fault) << report.fault->message;
  EXPECT_LT(report.largest_off, farthest + 0.01);
  EXPECT_GT(report.largest_off, farthest / 6);  // it is not looked at all the time
}

TEST_P(EachMode, AStopOfAnyAxisStopsAll) {
  for (std::uint8_t axis = 0; axis < 2; ++axis) {
    SCOPED_TRACE(axis);
    Bench fresh;
    set_limits(fresh);
    bool stopped = false;
    fresh.every_ms = [&] {
      if (stopped || fresh.mm(0) < 5) return;
      stopped = true;
      fresh.ask(Command::MST, 0, axis, 0);
    };
    const auto report = fresh.pass(circle(20, 0.1), GetParam());
    ASSERT_TRUE(report.fault);
    EXPECT_EQ(report.fault->kind, FaultKind::foreign);
    EXPECT_EQ(report.fault->axis, axis);
    EXPECT_THAT(report.fault->message, HasSubstr("was stopped by another client"));
    EXPECT_FALSE(fresh.moving());
    EXPECT_LT(fresh.mm(0), 6);
    EXPECT_EQ(fresh.get(axis, ap::max_acceleration), acceleration);
  }
}

TEST_P(EachMode, ARefusedCommandStopsAll) {
  bench.instead = [&](const DriveCommand& command) -> std::optional<tmcl::Result<std::int32_t>> {
    const bool moves = command.kind == Kind::rotate ||
                       (command.kind == Kind::set && command.parameter == ap::target_position);
    if (!moves || !half_way() || command.axis != 1) return std::nullopt;
    return test::no_reply();
  };
  const auto report = pass();
  ASSERT_TRUE(report.fault);
  EXPECT_EQ(report.fault->kind, FaultKind::refused);
  EXPECT_EQ(report.fault->axis, 1U);
  EXPECT_EQ(report.fault->error->message, "no reply");
  EXPECT_LT(bench.mm(0), radius + 1.5);
  expect_as_before();
}

TEST_P(EachMode, AnAxisThatCannotBeStoppedDoesNotKeepTheOtherOneTurning) {
  int stops = 0;
  bench.instead = [&](const DriveCommand& command) -> std::optional<tmcl::Result<std::int32_t>> {
    if (half_way()) bench.stream().stop();
    if (command.kind != Kind::stop || command.axis != 0) return std::nullopt;
    ++stops;
    return test::no_reply();
  };
  const auto report = pass();
  ASSERT_TRUE(report.fault);
  EXPECT_EQ(report.fault->kind, FaultKind::asked);
  EXPECT_EQ(stops, 3);
  EXPECT_EQ(bench.get(1, ap::actual_velocity), 0);
  ASSERT_EQ(report.unstopped.size(), 1U);
  EXPECT_EQ(report.unstopped.front().axis, 0U);
}

TEST_P(EachMode, AStarvedStreamStops) {
  bench.most_deviation = 10;
  bool slept = false;
  bench.instead = [&](const DriveCommand&) -> std::optional<tmcl::Result<std::int32_t>> {
    if (half_way() && !slept) {
      slept = true;
      bench.let_pass(milliseconds(200));
    }
    return std::nullopt;
  };
  const auto report = pass();
  ASSERT_TRUE(report.fault);
  EXPECT_EQ(report.fault->kind, FaultKind::starved) << report.fault->message;
  EXPECT_THAT(report.fault->message, HasSubstr("ms late"));
  expect_as_before();
}

// How far an axis is behind that went 30 % too slow for 15 ms, in mm, each 5 ms from then on. It
// says all the time that it does what it is told.
std::vector<double> behind_after_slowness() {
  constexpr double speed = 10;
  constexpr Duration slow_from = milliseconds(1500), slow_until = milliseconds(1515);
  Bench bench(6212, 1);
  std::int32_t told = 0;
  const auto is_slow = [&] {
    const auto passed = bench.now().time_since_epoch();
    return passed >= slow_from && passed < slow_until;
  };
  const auto go = [&] {
    return bench.ask(Command::SAP, ap::max_velocity, 0, is_slow() ? told * 7 / 10 : told);
  };
  bench.instead = [&](const DriveCommand& command) -> std::optional<tmcl::Result<std::int32_t>> {
    const bool sets = command.kind == Kind::set && command.parameter == ap::max_velocity;
    if (sets) told = command.value;
    if (sets) return go();
    const bool looks = command.kind == Kind::get && command.parameter == ap::target_velocity;
    return looks && told != 0 ? std::optional(tmcl::Result<std::int32_t>(told)) : std::nullopt;
  };
  bool was_slow = false;
  double late = 0;
  std::vector<double> behind;
  bench.every_ms = [&] {
    if (is_slow() != was_slow) {
      EXPECT_TRUE(go());
    }
    was_slow = is_slow();
    const double now_s = tmcl::seconds(bench.now().time_since_epoch());
    const double lag = speed * now_s - bench.mm(0);
    if (now_s < tmcl::seconds(slow_from)) late = lag;
    if (now_s > tmcl::seconds(slow_until) + 0.005 * static_cast<double>(behind.size()))
      behind.push_back(lag - late);
  };
  path_file::Path path{{"X"}, {}, {}};
  path.elements = {path_file::LineTo{{30, 0}, speed, {}, 1}};
  const auto report = bench.pass(path, StreamMode::velocity);
  EXPECT_FALSE(report.fault) << report.fault->message;
  return behind;
}

TEST(Stream, AnAxisThatWasTooSlowIsBackWithinSixUpdates) {
  const auto behind = behind_after_slowness();
  ASSERT_GT(behind.size(), 20U);
  EXPECT_GT(behind[0], 0.03);
  EXPECT_LT(behind[6], 0.005);
  EXPECT_GT(*std::min_element(behind.begin(), behind.begin() + 20), -0.002) << "goes beyond";
}

TEST_P(EachMode, ALittleLateIsMadeUpFor) {
  int slept = 0;
  bench.instead = [&](const DriveCommand&) -> std::optional<tmcl::Result<std::int32_t>> {
    if (half_way() && slept++ % 100 == 0) bench.let_pass(milliseconds(2));
    return std::nullopt;
  };
  const auto report = pass();
  ASSERT_FALSE(report.fault) << report.fault->message;
  EXPECT_GT(report.worst_delay, microseconds(100));
  EXPECT_EQ(bench.mm(0), 0);
  for (const auto& axis : report.axes) EXPECT_LT(axis.largest, 0.2);
}

TEST_P(EachMode, WhoeverIsAskedToStopStops) {
  bench.every_ms = [&] {
    if (half_way()) bench.stream().stop();
  };
  const auto report = pass();
  ASSERT_TRUE(report.fault);
  EXPECT_EQ(report.fault->kind, FaultKind::asked);
  EXPECT_LT(bench.mm(0), radius + 1.5);
  expect_as_before();
}

TEST_P(EachMode, AnAxisThatIsHeldIsNoticed) {
  bench.most_deviation = 0.5;
  std::int32_t held = 0;
  bench.instead = [&](const DriveCommand& command) -> std::optional<tmcl::Result<std::int32_t>> {
    const bool looks = command.kind == Kind::get && command.parameter == ap::actual_position;
    if (!looks || command.axis != 0 || bench.mm(0) < 5) return std::nullopt;
    if (held == 0) held = bench.get(0, ap::actual_position);
    return held;
  };
  const auto report = pass();
  ASSERT_TRUE(report.fault);
  EXPECT_EQ(report.fault->kind, FaultKind::off_course);
  EXPECT_THAT(report.fault->message, HasSubstr(" off the path, at 5"));
  expect_as_before();
}

TEST_P(EachMode, NothingMovesThatIsNotAtTheStart) {
  bench.ask(Command::MVP, 0, 1, 100);
  bench.let_pass(std::chrono::seconds(2));
  const auto report = pass();
  ASSERT_TRUE(report.fault);
  EXPECT_EQ(report.fault->kind, FaultKind::not_at_start);
  EXPECT_THAT(report.fault->message, HasSubstr("is at 100 and not at 0"));
  for (const auto& command : bench.commands) EXPECT_EQ(command.kind, Kind::get);
}

TEST_P(EachMode, WhatStaysBehindIsTold) {
  bool ended = false;
  bench.instead = [&](const DriveCommand& command) -> std::optional<tmcl::Result<std::int32_t>> {
    if (half_way() && !ended) {
      ended = true;
      bench.stream().stop();
    }
    const bool restores =
        ended && command.kind == Kind::set && command.parameter == ap::max_acceleration;
    if (!restores) return std::nullopt;
    return test::no_reply();
  };
  const auto report = pass();
  ASSERT_TRUE(report.fault);
  for (const auto& kept : report.unrestored)
    EXPECT_EQ(kept.before, (Setting{ap::max_acceleration, 5119946}));
}

// How far a point is from the way through (5, 0), (5, 5) and (0, 5), from and to (0, 0).
double off_square(double x, double y) {
  const auto beside = [](double along, double across) {
    return std::hypot(across, along - std::clamp(along, 0.0, 5.0));
  };
  return std::min({beside(x, y), beside(y, x - 5), beside(x, y - 5), beside(y, x)});
}

TEST_P(EachMode, CornersStayWithinTheirTolerance) {
  double farthest = 0;
  bench.every_ms = [&] { farthest = std::max(farthest, off_square(bench.mm(0), bench.mm(1))); };
  const auto report = bench.pass(square(), GetParam());
  ASSERT_FALSE(report.fault) << report.fault->message;
  RecordProperty("farthest_um", std::to_string(farthest * 1e3));
  EXPECT_LT(farthest, 0.05);
  expect_as_before();
}

TEST_P(EachMode, WhereThePathTurnsBackTheAxesDoToo) {
  path_file::Path path{{"X", "Y"}, {}, {}};
  path.elements = {path_file::LineTo{{5, 0}, 20.0, {}, 1}, path_file::LineTo{{1, 0}, 20.0, {}, 2}};
  double farthest = 0;
  bench.every_ms = [&] { farthest = std::max(farthest, bench.mm(0)); };
  const auto report = bench.pass(path, GetParam());
  ASSERT_FALSE(report.fault) << report.fault->message;
  EXPECT_NEAR(farthest, 5, GetParam() == StreamMode::position ? 0.001 : 0.02);
  EXPECT_EQ(bench.mm(0), 1);
}

// Turning the axis that hardly moves on the last leg, it must not go beyond.
TEST_P(EachMode, AShortLegIsNoReasonToGoBeyondAJoint) {
  bench.limit(10, 271);
  path_file::Path path{{"X", "Y"}, {}, {}};
  path.elements = {path_file::LineTo{{-0.005, 6.518}, 7.0, {}, 1},
                   path_file::LineTo{{-2.106, 5.469}, {}, {}, 2},
                   path_file::LineTo{{-2.108, 5.3}, {}, {}, 3}};
  bench.round_trip = microseconds(1101);
  double farthest = 0;
  bench.every_ms = [&] {
    farthest = std::max(farthest, test::off(path, bench.mm(0), bench.mm(1)));
  };
  const auto report = bench.pass(path, GetParam());
  ASSERT_FALSE(report.fault) << report.fault->message;
  EXPECT_LT(farthest, 0.2);
}

// X goes to its turn slowly and back fast, while Y goes on. Most updates that lead back come before
// the turn, the others less than half a period later, whether or not the generator brakes already.
TEST(Stream, AnAxisTurnsRoundByTheFirstUpdateThatLeadsBack) {
  for (int i = 0; i < 40; ++i) {
    Bench bench;
    path_file::Path path{{"X", "Y"}, {}, {}};
    const double y = 1.3 + 0.005 * i;
    SCOPED_TRACE(y);
    path.elements = {path_file::LineTo{{0.1, y}, {}, {}, 1},
                     path_file::LineTo{{-0.4, y + 1}, {}, {}, 2}};
    std::vector<double> told_at;
    bench.instead = [&](const DriveCommand& command) -> std::optional<tmcl::Result<std::int32_t>> {
      const bool tells_target = command.kind == Kind::set && command.axis == 0 &&
                                command.parameter == ap::target_position;
      if (tells_target) told_at.push_back(bench.stream().passed());
      return std::nullopt;
    };
    double farthest = 0;
    bench.every_ms = [&] {
      farthest = std::max(farthest, test::off(path, bench.mm(0), bench.mm(1)));
    };
    const auto report = bench.pass(path, StreamMode::velocity);
    ASSERT_FALSE(report.fault) << report.fault->message;
    ASSERT_EQ(told_at.size(), 1U);
    EXPECT_LT(told_at[0], bench.course().turns(0)[0].time + seconds(report.period) / 2);
    EXPECT_LT(farthest, 0.085);
  }
}

// Y is behind at the first corner, and has all the way to the second one to catch up. There it
// stands from one moment to the next, and goes on later: it cannot come back.
TEST(Stream, AnAxisCatchesUpNoFasterThanItCanStopInTheNextCorner) {
  for (int i = 0; i < 20; ++i) {
    Bench bench;
    bench.round_trip = microseconds(174);
    path_file::Path path{{"X", "Y"}, {}, {}};
    const double x = 5.2 + 0.01 * i;
    SCOPED_TRACE(x);
    path.elements = {path_file::LineTo{{x, 0}, {}, {}, 1},
                     path_file::LineTo{{x + 0.486, 0.446}, {}, {}, 2},
                     path_file::LineTo{{x + 1.486, 0.446}, {}, {}, 3},
                     path_file::LineTo{{x + 1.485, 0.658}, 4.0, {}, 4}};
    double farthest = 0;
    bench.every_ms = [&] {
      farthest = std::max(farthest, test::off(path, bench.mm(0), bench.mm(1)));
    };
    const auto report = bench.pass(path, StreamMode::velocity);
    ASSERT_FALSE(report.fault) << report.fault->message;
    EXPECT_LT(farthest, 0.085);
  }
}

// Slower than a ramp generator can be: that is none that stands.
TEST(Stream, AnAxisThatHardlyMovesMovesAllTheSame) {
  Bench bench;
  bench.limit(10, 52);
  path_file::Path path{{"X", "Y"}, {}, {}};
  path.elements = {path_file::LineTo{{0.001, -4.795}, {}, {}, 1},
                   path_file::LineTo{{-4.932, -4.182}, {}, {}, 2}};
  const auto report = bench.pass(path, StreamMode::position);
  ASSERT_FALSE(report.fault) << report.fault->message;
  for (const auto& command : bench.commands) {
    const bool accelerates =
        command.kind == Kind::set && (command.parameter == 5 || command.parameter == 17);
    if (accelerates) {
      EXPECT_GT(command.value, 117);
    }
  }
}

// The turns of the path need all the acceleration that its axes have.
TEST_P(EachMode, AxesThatAreSlowForThePathStayOnIt) {
  const auto file = path_file::read_gcode("G1 X10 F600\nG1 Y10\nG2 X0 Y0 I-5 J-5\n");
  ASSERT_TRUE(file);
  const auto path = path_file::flatten(*file, 0.0125);
  ASSERT_TRUE(path);
  for (const double limit : {2.0, 5.0, 20.0}) {
    SCOPED_TRACE(limit);
    Bench slow;
    slow.limit(5, limit);
    double farthest = 0;
    slow.every_ms = [&] {
      farthest = std::max(farthest, test::off(*path, slow.mm(0), slow.mm(1)));
    };
    const auto report = slow.pass(*path, GetParam());
    ASSERT_FALSE(report.fault) << report.fault->message;
    RecordProperty(fmt::format("farthest_um_{}", limit), std::to_string(farthest * 1e3));
    EXPECT_LT(farthest, 0.05);
    // Along the path; readings are taken in the middle of long legs, too.
    for (const auto& axis : report.axes) EXPECT_LT(axis.largest, 0.15);
  }
}

// By segments, only the next ones are looked at.
class ModeThatLooksAhead : public EachMode {};

// Whoever runs the stream has other things to do, too.
TEST_P(ModeThatLooksAhead, DoesNotLookAtALongPathAllAtOnce) {
  path_file::Path path{{"X", "Y"}, {}, {}};
  for (int i = 1; i <= 20'000; ++i)
    path.elements.push_back(path_file::LineTo{{i % 2 * 0.5, i * 0.02}, 20.0, {}, 1});
  int waits = 0;
  bench.at_wait = [&] {
    if (++waits == 15) bench.stream().stop();
  };
  const auto report = bench.pass(path, GetParam());
  ASSERT_TRUE(report.fault);
  EXPECT_EQ(report.fault->kind, FaultKind::asked) << report.fault->message;
  EXPECT_EQ(waits, 15);
  for (const auto& command : bench.commands) EXPECT_EQ(command.kind, Kind::get);
}

INSTANTIATE_TEST_SUITE_P(Streams, EachMode,
                         testing::Values(StreamMode::velocity, StreamMode::segments,
                                         StreamMode::position),
                         [](const auto& mode) { return std::string(name_of(mode.param)); });
INSTANTIATE_TEST_SUITE_P(Streams, ModeThatLooksAhead,
                         testing::Values(StreamMode::velocity, StreamMode::position),
                         [](const auto& mode) { return std::string(name_of(mode.param)); });

TEST(Stream, APauseStaysOnThePath) {
  Bench bench;
  set_limits(bench);
  double farthest = 0;
  int standing = 0;
  int ms = 0;
  bench.every_ms = [&] {
    farthest = std::max(farthest, std::abs(std::hypot(bench.mm(0) - radius, bench.mm(1)) - radius));
    ++ms;
    if (ms == 500) bench.stream().pause(true);
    if (ms > 500 && ms < 1500) standing += bench.moving() ? 0 : 1;
    if (ms == 1500) bench.stream().pause(false);
  };
  const auto report = bench.pass(circle(20, 0.1), StreamMode::velocity);
  ASSERT_FALSE(report.fault) << report.fault->message;
  EXPECT_GT(standing, 700);
  EXPECT_LT(farthest, 0.005);
  EXPECT_EQ(bench.mm(0), 0);
}

TEST(Stream, PositionModePausesWhereThePathStands) {
  Bench bench;
  set_limits(bench);
  bool at_corner = false;
  int ms = 0;
  bench.every_ms = [&] {
    ++ms;
    if (ms == 350) bench.stream().pause(true);
    if (ms == 1300) at_corner = bench.mm(0) == 5 && bench.mm(1) == 5 && !bench.moving();
    if (ms == 1500) bench.stream().pause(false);
  };
  const auto report = bench.pass(square(), StreamMode::position);
  ASSERT_FALSE(report.fault) << report.fault->message;
  EXPECT_TRUE(at_corner);
  EXPECT_EQ(bench.mm(0), 0);
  EXPECT_EQ(bench.mm(1), 0);
}

TEST(Stream, ABusThatIsTooSlowForPositionsIsToldBeforeAnythingMoves) {
  Bench bench;
  set_limits(bench);
  bench.round_trip = microseconds(1760);  // RS485 at 115200
  const auto report = bench.pass(circle(20, 0.1), StreamMode::position);
  ASSERT_TRUE(report.fault);
  EXPECT_EQ(report.fault->kind, FaultKind::slow_bus);
  EXPECT_THAT(report.fault->message, HasSubstr("commands of 1760 us"));
  for (const auto& command : bench.commands) EXPECT_EQ(command.kind, Kind::get);
}

TEST(Stream, VelocitiesHoldTheCircleOnASlowBusToo) {
  Bench bench;
  set_limits(bench);
  bench.round_trip = microseconds(1760);
  double farthest = 0;
  bench.every_ms = [&] {
    farthest = std::max(farthest, std::abs(std::hypot(bench.mm(0) - radius, bench.mm(1)) - radius));
  };
  const auto report = bench.pass(circle(20, 0.1), StreamMode::velocity);
  ASSERT_FALSE(report.fault) << report.fault->message;
  RecordProperty("farthest_um", std::to_string(farthest * 1e3));
  EXPECT_GT(report.period, milliseconds(11));
  EXPECT_LT(farthest, 0.02);
}

TEST(Stream, VelocitiesOfATmc429) {
  Bench bench(3110);
  double farthest = 0;
  bench.every_ms = [&] {
    farthest = std::max(farthest, std::abs(std::hypot(bench.mm(0) - radius, bench.mm(1)) - radius));
  };
  const auto report = bench.pass(circle(5, 0.1), StreamMode::velocity);
  ASSERT_FALSE(report.fault) << report.fault->message;
  RecordProperty("farthest_um", std::to_string(farthest * 1e3));
  EXPECT_LT(farthest, 0.05);
  EXPECT_EQ(bench.mm(0), 0);
  const auto by_positions = Bench(3110).pass(circle(5, 0.1), StreamMode::position);
  ASSERT_TRUE(by_positions.fault);
  EXPECT_EQ(by_positions.fault->kind, FaultKind::unsuited);
}

// ---- guided to targets ----

struct OwnSettings {
  std::uint16_t model;
  std::vector<Setting> settings;
};

// None of them is what a module has from the start.
const OwnSettings own_settings[] = {{3110, {{4, 1500}, {5, 900}, {130, 3}}},
                                    {142, {{4, 6'000'000}, {16, 20'000}, {17, 30'000}, {18, 0}}},
                                    {6212,
                                     {{4, 200'000},
                                      {5, 500'000},
                                      {16, 7000},
                                      {17, 400'000},
                                      {18, 9000},
                                      {19, 5},
                                      {20, 12},
                                      {21, 300}}},
                                    {1111,
                                     {{4, 200'000},
                                      {5, 500'000},
                                      {15, 50},
                                      {16, 300'000},
                                      {17, 400'000},
                                      {18, 5000},
                                      {19, 200'000},
                                      {20, 60}}},
                                    {1021, {{4, 200'000}, {5, 500'000}}}};
// The last of them are turned: nobody knows what they do if parameter 4 changes on their way.
constexpr std::size_t guided_families = 3;

class EveryFamily : public testing::TestWithParam<OwnSettings> {
 protected:
  EveryFamily() : bench(GetParam().model) {
    for (const auto [parameter, value] : GetParam().settings) {
      EXPECT_TRUE(bench.ask(Command::SAP, parameter, 0, value)) << int{parameter};
      own.push_back({parameter, bench.get(0, parameter)});
      EXPECT_NEAR(own.back().value, value, 200) << "but for rounding";
    }
    bench.every_ms = [this] {
      EXPECT_GE(bench.mm(0), -3 - beyond());
      EXPECT_LE(bench.mm(0), 4 + beyond());
    };
  }
  static path_file::Path there_and_back() {
    path_file::Path path{{"X"}, {}, {}};
    for (const double x : {4.0, -3.0, 2.0})
      path.elements.push_back(path_file::LineTo{{x}, 4.0, {}, 1});
    return path;
  }
  StreamReport pass() { return bench.pass(there_and_back(), StreamMode::velocity); }
  void expect_own_settings() {
    for (const auto [parameter, value] : own)
      EXPECT_EQ(bench.get(0, parameter), value) << int{parameter};
  }
  bool is_guided() const { return AxisTwin::of(*find_model(GetParam().model)).has_value(); }
  /// Where it turns, an axis that goes to no target may go on for as long as it takes to tell it.
  double beyond() const { return is_guided() ? 0 : bench.limits().corner_tolerance; }
  bool goes_back() { return bench.stream().passed() > 1.5; }

  Bench bench;
  std::vector<Setting> own;
};

class Guided : public EveryFamily {};
class Turned : public EveryFamily {};

TEST_P(Guided, ItNeverTurnsWithoutAnEnd) {
  const auto report = pass();
  ASSERT_FALSE(report.fault) << report.fault->message;
  std::vector<std::int32_t> targets;
  for (const auto& command : bench.commands) {
    EXPECT_NE(command.kind, Kind::rotate);
    const bool aims = command.kind == Kind::set && command.parameter == ap::target_position;
    if (aims || command.kind == Kind::move_to) targets.push_back(command.value);
  }
  EXPECT_THAT(targets, testing::ElementsAre(40960, -30720, 20480, 20480));
  EXPECT_EQ(bench.mm(0), 2);
  expect_own_settings();
}

// What nobody knows better is told velocities.
TEST_P(Turned, ItGoesBothWaysAndToTheExactEnd) {
  const auto report = pass();
  ASSERT_FALSE(report.fault) << report.fault->message;
  for (const int way : {-1, 1}) {
    EXPECT_TRUE(std::ranges::any_of(bench.commands, [&](const DriveCommand& command) {
      return command.kind == Kind::rotate && command.value * way > 0;
    })) << way;
  }
  EXPECT_EQ(bench.mm(0), 2);
  expect_own_settings();
}

TEST_P(Turned, ByPositionsItIsRefused) {
  const auto report = bench.pass(there_and_back(), StreamMode::position);
  ASSERT_TRUE(report.fault);
  EXPECT_EQ(report.fault->kind, FaultKind::unsuited);
  EXPECT_THAT(report.fault->message, HasSubstr("has no start and stop velocities"));
  EXPECT_FALSE(bench.moving());
  expect_own_settings();
}

TEST_P(EveryFamily, WhateverEndsItGivesTheSettingsBack) {
  bool stopped = false;
  bench.every_ms = [&] {
    if (goes_back() && !stopped) stopped = true, bench.ask(Command::MST, 0, 0, 0);
  };
  const auto report = pass();
  ASSERT_TRUE(report.fault);
  EXPECT_EQ(report.fault->kind, FaultKind::foreign);
  EXPECT_THAT(report.fault->message, HasSubstr("was stopped"));
  EXPECT_FALSE(bench.moving());
  expect_own_settings();
}

// Its own greatest speed would set it off.
TEST_P(EveryFamily, AnAxisThatMayStillMoveGetsNoSettingsBack) {
  bench.instead = [&](const DriveCommand& command) -> std::optional<tmcl::Result<std::int32_t>> {
    if (!goes_back()) return std::nullopt;
    bench.stream().stop();
    if (command.kind == Kind::stop) return test::no_reply();
    EXPECT_NE(command.kind, Kind::set);
    return std::nullopt;
  };
  const auto report = pass();
  EXPECT_EQ(report.unstopped.size(), 1U);
  EXPECT_GE(report.unrestored.size(), is_guided() ? 2U : 1U);
}

TEST_P(EveryFamily, APauseStandsAndGoesOn) {
  int standing = 0;
  int ms = 0;
  bench.every_ms = [&] {
    ++ms;
    if (ms == 1500) bench.stream().pause(true);
    if (ms > 2000 && ms < 4000) standing += bench.moving() ? 0 : 1;
    if (ms == 4000) bench.stream().pause(false);
  };
  const auto report = pass();
  ASSERT_FALSE(report.fault) << report.fault->message;
  EXPECT_EQ(standing, 1999);
  EXPECT_EQ(bench.mm(0), 2);
  for (const auto& axis : report.axes) EXPECT_LT(axis.largest, 0.1);
}

constexpr auto name_of_model = [](const auto& own) { return std::to_string(own.param.model); };
constexpr auto first_turned = std::begin(own_settings) + guided_families;
INSTANTIATE_TEST_SUITE_P(Families, EveryFamily, testing::ValuesIn(own_settings), name_of_model);
INSTANTIATE_TEST_SUITE_P(Families, Guided,
                         testing::ValuesIn(std::begin(own_settings), first_turned), name_of_model);
INSTANTIATE_TEST_SUITE_P(Families, Turned, testing::ValuesIn(first_turned, std::end(own_settings)),
                         name_of_model);

// Four soft bows: with them it would leave the path.
TEST(Stream, ATmc4361DrivesTrapezoidsOnThePath) {
  Bench bench(1111);
  constexpr std::uint8_t ramp_type = 14;
  for (const auto [parameter, value] :
       {Setting{4, 200'000}, Setting{5, 500'000}, Setting{17, 400'000}, Setting{22, 3'000'000},
        Setting{23, 4'000'000}, Setting{24, 5'000'000}, Setting{25, 6'000'000},
        Setting{ramp_type, 1}})
    EXPECT_TRUE(bench.ask(Command::SAP, parameter, 0, value));
  path_file::Path path{{"X"}, {}, {}};
  for (const double x : {4.0, -3.0, 2.0})
    path.elements.push_back(path_file::LineTo{{x}, 4.0, {}, 1});
  const auto report = bench.pass(path, StreamMode::velocity);
  ASSERT_FALSE(report.fault) << report.fault->message;
  EXPECT_LT(report.axes[0].largest, 0.1);
  EXPECT_EQ(bench.mm(0), 2);
  EXPECT_EQ(bench.get(0, ramp_type), 1);
}

// A TMC429 goes the wrong way to a target that is more than 2^23 microsteps away.
TEST(Stream, ALongStretchIsPassedTowardsTargetsOnTheWay) {
  Bench bench(3110);
  bench.round_trip = milliseconds(20);
  path_file::Path path{{"X"}, {}, {}};
  path.elements = {path_file::LineTo{{-800}, 5.0, {}, 1}, path_file::LineTo{{800}, 5.0, {}, 2}};
  const auto report = bench.pass(path, StreamMode::velocity);
  ASSERT_FALSE(report.fault) << report.fault->message;
  EXPECT_EQ(bench.mm(0), 800);
  EXPECT_LT(report.axes[0].largest, 0.2);
}

TEST(Stream, WritesOnlyWhatChanges) {
  Bench bench;
  set_limits(bench);
  ASSERT_FALSE(bench.pass(square(), StreamMode::position).fault);
  std::map<std::pair<std::size_t, std::uint8_t>, std::int32_t> last;
  for (const auto& command : bench.commands) {
    if (command.kind != Kind::set) continue;
    const auto [known, is_new] = last.try_emplace({command.axis, command.parameter});
    EXPECT_TRUE(is_new || known->second != command.value) << int{command.parameter};
    known->second = command.value;
  }
  EXPECT_GT(last.size(), 8U);
}

/// Figures 4 and 5 of AN-035: by velocities the host shapes ramps, by positions the module does.
TEST(Stream, ControlsByVelocitiesOrByPositions) {
  const auto writes = [](StreamMode mode, std::uint8_t parameter) {
    Bench bench;
    set_limits(bench);
    EXPECT_FALSE(bench.pass(square(), mode).fault);
    return std::ranges::count_if(bench.commands, [&](const DriveCommand& command) {
      return command.kind == Kind::set && command.parameter == parameter;
    });
  };
  constexpr std::ptrdiff_t legs = 4;
  EXPECT_GT(writes(StreamMode::velocity, ap::max_velocity), 20 * legs);
  EXPECT_LE(writes(StreamMode::position, ap::max_velocity), 3 * legs);
  EXPECT_GE(writes(StreamMode::position, ap::target_position), legs);
  EXPECT_LE(writes(StreamMode::position, ap::target_position), 3 * legs);
}

TEST_P(EachMode, ThereIsOneAccelerationMeanwhile) {
  bench.every_ms = [&] {
    if (!bench.moving() || bench.stream().phase() != PathStream::Phase::running) return;
    for (std::uint8_t axis = 0; axis < 2; ++axis) EXPECT_EQ(bench.get(axis, 16), 0);
  };
  ASSERT_FALSE(pass().fault);
  expect_as_before();
}

path_file::Path timetable() {
  path_file::Path path{{"X", "Y"}, {}, {}};
  path.elements = {path_file::LineTo{{2, 1}, {}, 0.5, 2}, path_file::LineTo{{6, 3}, {}, 0.5, 3},
                   path_file::LineTo{{8, 4}, {}, 0.5, 4}};
  return path;
}

TEST(Stream, ATableWithTimesIsAVelocityStream) {
  Bench bench;
  set_limits(bench);
  const auto report = bench.pass(timetable(), StreamMode::velocity);
  ASSERT_FALSE(report.fault) << report.fault->message;
  EXPECT_NEAR(report.passed_s, 1.5, 0.01);
  EXPECT_EQ(bench.mm(0), 8);
  Bench other;
  const auto refused = other.pass(timetable(), StreamMode::position);
  ASSERT_TRUE(refused.fault);
  EXPECT_EQ(refused.fault->kind, FaultKind::unsuited);
}

// ---- courses ----

PathLimits limits(double velocity, double acceleration_limit) {
  PathLimits made;
  made.axes = 2;
  made.axis[0] = made.axis[1] = {velocity, acceleration_limit};
  made.corner_tolerance = 0.05;
  return made;
}

TEST(Course, ATimetableMeetsItsRowsAndNeverLeavesTheirRange) {
  const auto course = Course::of(timetable(), limits(24, 500));
  ASSERT_TRUE(course) << course.error();
  EXPECT_DOUBLE_EQ(course->duration(), 1.5);
  EXPECT_DOUBLE_EQ(course->at(0.5).position[0], 2);
  EXPECT_DOUBLE_EQ(course->at(1).position[1], 3);
  double before = 0;
  for (double t = 0; t <= 1.6; t += 0.001) {
    const auto state = course->at(t);
    EXPECT_GE(state.position[0], before - 1e-12);
    EXPECT_LE(std::abs(state.velocity[0]), course->top_speed(0) + 1e-9);
    before = state.position[0];
  }
  EXPECT_EQ(course->at(0).velocity[0], 0);
  EXPECT_FALSE(course->has_legs());
}

TEST(Course, TellsWhereAnAxisTurnsRound) {
  const auto course = Course::of(square(), limits(24, 500));
  ASSERT_TRUE(course) << course.error();
  const auto turns = course->turns(0);
  ASSERT_EQ(turns.size(), 2U);
  EXPECT_EQ(turns[0].position, 5);
  EXPECT_DOUBLE_EQ(turns[0].time, course->leg(2).begin);  // it stood since the first corner
  EXPECT_EQ(turns[1].position, 0);
  EXPECT_DOUBLE_EQ(turns[1].time, course->duration());
  const auto one_way = Course::of(timetable(), limits(24, 500));
  ASSERT_TRUE(one_way);
  ASSERT_EQ(one_way->turns(1).size(), 1U);
  EXPECT_EQ(one_way->turns(1)[0].position, 4);
}

TEST(Course, ATimetableThatIsTooFastNamesItsLine) {
  const auto fast = Course::of(timetable(), limits(5, 500));
  ASSERT_FALSE(fast);
  EXPECT_THAT(fast.error(), HasSubstr("line 2: too fast for axis X"));
  const auto steep = Course::of(timetable(), limits(24, 20));
  ASSERT_FALSE(steep);
  EXPECT_THAT(steep.error(), HasSubstr("line 2: too steep for axis X"));
}

TEST(Course, DwellsStand) {
  const auto course = Course::of(square(), limits(24, 500));
  ASSERT_TRUE(course) << course.error();
  ASSERT_EQ(course->legs(), 4U);
  const auto gap_begin = course->leg(1).end;
  EXPECT_NEAR(course->leg(2).begin - gap_begin, 0.1, 1e-12);
  EXPECT_EQ(course->at(gap_begin + 0.05).position[1], 5);
  EXPECT_EQ(course->at(gap_begin + 0.05).velocity[1], 0);
  EXPECT_DOUBLE_EQ(course->length(), 20);
  EXPECT_EQ(course->greatest()[0], 5);
  EXPECT_EQ(course->least()[0], 0);
  const auto corners = course->slowest_corners(2);
  ASSERT_EQ(corners.size(), 2U);
  EXPECT_EQ(corners[0].line, 2U);
  EXPECT_EQ(corners[0].speed, 0);
}

TEST(Course, NoJointThatCostsNoSpeedIsACorner) {
  const auto reading = path_file::read_gcode("G21 F1200\nG1 X100\nG1 X200\nG1 Y100\n");
  ASSERT_TRUE(reading);
  const auto course = Course::of(*reading, limits(24, 500));
  ASSERT_TRUE(course) << course.error();
  ASSERT_EQ(course->legs(), 3U);
  const auto corners = course->slowest_corners(5);
  ASSERT_EQ(corners.size(), 1U);
  EXPECT_EQ(corners[0].line, 3U);
}

TEST(Course, NoFasterThanTheFeed) {
  const auto course = Course::of(square(), limits(24, 500), 10);
  ASSERT_TRUE(course);
  EXPECT_DOUBLE_EQ(course->top_speed(0), 10);
}

}  // namespace
}  // namespace tmcl::plan
