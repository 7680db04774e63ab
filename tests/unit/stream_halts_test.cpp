// Where a course stands until something has been done: M words that switch something, and M0, which
// waits; on simulated modules, in virtual time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "motion/drive/course_clock.hpp"
#include "support/stream_bench.hpp"

namespace tmcl::plan {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
namespace ap = axis_parameter;
using Bench = test::StreamBench;
using Kind = DriveCommand::Kind;
using FaultKind = DriveFault::Kind;
using path_file::Dwell;
using path_file::LineTo;
using Answer = std::optional<tmcl::Result<std::int32_t>>;

/// Off whole microsteps, and with two words where it turns.
path_file::Path switched_path() {
  path_file::Path path{{"X", "Y"}, {}, {}};
  path.elements = {Dwell{0, 1, 3},
                   LineTo{{5.00003, 2.50002}, 20.0, {}, 2},
                   Dwell{0, 3, 8},
                   Dwell{0.05, 4},
                   Dwell{0, 5, 7},
                   Dwell{0, 5, 4},
                   LineTo{{1, 4}, 20.0, {}, 6},
                   Dwell{0, 7, 5},
                   Dwell{0, 7, 9}};
  return path;
}

path_file::Path waiting_path() {
  path_file::Path path{{"X", "Y"}, {}, {}};
  path.elements = {LineTo{{5.00003, 2.5}, 20.0, {}, 1}, Dwell{0, 2, 0}, Dwell{0, 3, 3},
                   LineTo{{1, 4}, 20.0, {}, 4}, Dwell{0, 5, 5}};
  return path;
}

TEST(CourseHalts, AreWhereTheCourseRests) {
  PathLimits limits;
  limits.axes = 2;
  limits.axis.fill({20, 400});
  const auto course = Course::of(switched_path(), limits);
  ASSERT_TRUE(course);
  std::vector<int> words;
  for (const auto& halt : course->halts()) {
    words.push_back(halt.word);
    EXPECT_EQ(course->at(halt.time).velocity, AxisValues{}) << halt.line;
  }
  EXPECT_THAT(words, ElementsAre(3, 8, 7, 4, 5, 9));
  EXPECT_EQ(course->halts().front().time, 0);
  EXPECT_NEAR(course->halts()[2].time, course->halts()[1].time + 0.05, 1e-9);
  EXPECT_EQ(course->halts().back().time, course->duration());
  EXPECT_EQ(course->halts().back().line, 7U);
}

// A shaped course is late: what comes before has come to rest by then.
TEST(CourseHalts, AreWhereAShapedCourseRests) {
  PathLimits limits;
  limits.axes = 2;
  limits.axis.fill({20, 400});
  const Shaping shaping{Shaper::zvd, {12, 0.05}};
  const auto course =
      Course::of(switched_path(), limits, std::numeric_limits<double>::infinity(), shaping);
  ASSERT_TRUE(course);
  EXPECT_EQ(course->halts().size(), 6U);
  for (const auto& halt : course->halts())
    EXPECT_NEAR(std::hypot(course->at(halt.time).velocity[0], course->at(halt.time).velocity[1]), 0,
                1e-6)
        << halt.line;
  EXPECT_LE(course->halts().back().time, course->duration());
}

TEST(CourseHalts, TimeStandsAtEachUntilItIsLeft) {
  PathLimits limits;
  limits.axes = 2;
  limits.axis.fill({20, 400});
  const auto course = Course::of(switched_path(), limits);
  ASSERT_TRUE(course);
  for (const double factor : {0.3, 1.0, 2.0}) {
    SCOPED_TRACE(factor);
    CourseClock clock(*course);
    clock.set_ramp(0.1);
    clock.set_factor(factor);
    TimePoint now{};
    clock.start(now, false);
    for (const auto& halt : course->halts()) {
      now += std::chrono::seconds(20);
      clock.advance(now);
      ASSERT_TRUE(clock.halt());
      EXPECT_EQ(clock.halt()->word, halt.word);
      EXPECT_NEAR(clock.passed(), halt.time, 2e-9);
      EXPECT_FALSE(clock.is_steady());
      EXPECT_FALSE(clock.is_over());
      now += std::chrono::hours(1);
      clock.leave_halt(now);
    }
    clock.advance(now + milliseconds(1));
    EXPECT_TRUE(clock.is_over());
    EXPECT_FALSE(clock.halt());
  }
}

class HaltsInEachMode : public testing::TestWithParam<StreamMode> {
 protected:
  HaltsInEachMode() {
    bench.limit(24, 500);
    own_acceleration = bench.get(0, ap::max_acceleration);
    own_velocity = bench.get(0, ap::max_velocity);
    bench.round_trip = milliseconds(1);
    bench.instead = [this](const DriveCommand& command) -> Answer {
      if (command.kind != Kind::carry_out) return std::nullopt;
      EXPECT_EQ(command.axis, 2U);
      return carry_out(command.value);
    };
  }
  Answer carry_out(std::int32_t word) {
    carried_out.push_back(word);
    EXPECT_FALSE(bench.moving()) << "at M" << word;
    places.push_back(bench.mm(0));
    if (word == refused) return test::no_reply();
    bench.let_pass(takes);
    return 0;
  }
  /// A path that never ends is stopped.
  StreamReport pass(const path_file::Path& path) {
    const auto limit = bench.now() + std::chrono::minutes(1);
    bench.at_wait = [this, limit] {
      if (bench.now() > limit) bench.stream().stop({FaultKind::no_end, {}, "it never ends"});
    };
    return bench.pass(path, GetParam());
  }
  /// Once it waits, after so long.
  void once_it_waits(Duration after, std::function<void()> then) {
    bench.every_ms = [this, after, then = std::move(then)] {
      if (!bench.stream().waits_at()) return;
      if (waits_since == TimePoint{}) waits_since = bench.now();
      if (bench.now() >= waits_since + after) then();
    };
  }
  void expect_own_settings() {
    EXPECT_FALSE(bench.moving());
    for (std::uint8_t axis = 0; axis < 2; ++axis) {
      EXPECT_EQ(bench.get(axis, ap::max_acceleration), own_acceleration);
      EXPECT_EQ(bench.get(axis, ap::max_velocity), own_velocity);
    }
  }

  Bench bench;
  std::vector<std::int32_t> carried_out;
  std::vector<double> places;
  std::int32_t own_acceleration = 0;
  std::int32_t own_velocity = 0;
  std::int32_t refused = -1;
  Duration takes{};
  TimePoint waits_since{};
};

TEST_P(HaltsInEachMode, WordsAreCarriedOutInTheirOrderWhereTheAxesStand) {
  const auto report = pass(switched_path());
  ASSERT_FALSE(report.fault) << report.fault->message;
  EXPECT_THAT(carried_out, ElementsAre(3, 8, 7, 4, 5, 9));
  const std::vector<double> planned{0, 5, 5, 5, 1, 1};
  for (std::size_t i = 0; i < planned.size(); ++i)
    EXPECT_NEAR(places.at(i), planned[i], 0.005) << i;
  EXPECT_EQ(bench.mm(0), 1);
  EXPECT_EQ(bench.mm(1), 4);
  EXPECT_LT(report.largest_off, 0.05);
  expect_own_settings();
}

// It is not late then.
TEST_P(HaltsInEachMode, AWordMayTakeLong) {
  takes = milliseconds(700);
  const auto report = pass(switched_path());
  ASSERT_FALSE(report.fault) << report.fault->message;
  EXPECT_THAT(carried_out, ElementsAre(3, 8, 7, 4, 5, 9));
  EXPECT_LT(report.largest_off, 0.05);
  EXPECT_LT(report.largest_lag_s, 0.06) << "which the dwell takes";
  EXPECT_GT(report.passed_s, 6 * 0.7);
}

TEST_P(HaltsInEachMode, AWordThatIsRefusedEndsThePathAndWhatIsOnIsSwitchedOff) {
  refused = 7;
  const auto report = pass(switched_path());
  ASSERT_TRUE(report.fault);
  EXPECT_EQ(report.fault->kind, FaultKind::refused);
  EXPECT_FALSE(report.fault->axis);
  EXPECT_EQ(report.fault->message, "line 5: M7 was not carried out: no reply");
  // It may have been carried out.
  EXPECT_THAT(carried_out, ElementsAre(3, 8, 7, 5, 9));
  EXPECT_TRUE(report.unswitched.empty());
  EXPECT_NEAR(bench.mm(0), 5, 0.005);
  expect_own_settings();
}

TEST_P(HaltsInEachMode, WhatIsStoppedOnTheWayIsSwitchedOffAtOnce) {
  bool was_moving = false;
  bench.instead = [&](const DriveCommand& command) -> Answer {
    if (command.kind != Kind::carry_out) return std::nullopt;
    carried_out.push_back(command.value);
    if (command.value == 5) was_moving = bench.moving();
    if (command.value == 5) return test::no_reply();
    return 0;
  };
  bench.every_ms = [&] {
    if (bench.mm(0) > 2) bench.stream().stop();
  };
  const auto report = pass(switched_path());
  ASSERT_TRUE(report.fault);
  EXPECT_EQ(report.fault->kind, FaultKind::asked);
  EXPECT_THAT(carried_out, ElementsAre(3, 5)) << "and not again: it may have been switched";
  EXPECT_TRUE(was_moving) << "while the axes brake";
  ASSERT_EQ(report.unswitched.size(), 1U);
  EXPECT_EQ(report.unswitched.front().word, 5);
  EXPECT_EQ(report.unswitched.front().why.message, "no reply");
  expect_own_settings();
}

TEST_P(HaltsInEachMode, M0WaitsUntilItIsLetGoOn) {
  once_it_waits(std::chrono::seconds(5), [&] {
    EXPECT_EQ(bench.stream().waits_at()->line, 2U);
    EXPECT_EQ(bench.stream().phase(), PathStream::Phase::waiting);
    EXPECT_TRUE(bench.stream().feed().held);
    EXPECT_EQ(bench.stream().feed().now, 0);
    EXPECT_FALSE(bench.moving());
    EXPECT_NEAR(bench.mm(0), 5, 0.005);
    EXPECT_THAT(carried_out, IsEmpty());
    bench.stream().pause(false);
  });
  const auto report = pass(waiting_path());
  ASSERT_FALSE(report.fault) << report.fault->message;
  EXPECT_NE(waits_since, TimePoint{});
  EXPECT_GT(report.passed_s, 5);
  EXPECT_LT(report.passed_s, 6.5);
  EXPECT_THAT(carried_out, ElementsAre(3, 5));
  EXPECT_EQ(bench.mm(0), 1);
  EXPECT_LT(report.largest_lag_s, 0.05);
  expect_own_settings();
}

// What was said before it waits is not for the wait.
TEST_P(HaltsInEachMode, APauseIsNoWaitAndAWaitMayBeHeld) {
  bool paused = false;
  bench.every_ms = [&] {
    auto& stream = bench.stream();
    if (!paused && bench.mm(0) > 2) {
      paused = true;
      stream.pause(true);
      stream.pause(false);
    }
    if (!stream.waits_at()) return;
    if (waits_since == TimePoint{}) stream.pause(true), waits_since = bench.now();
    EXPECT_TRUE(stream.feed().held);
    if (bench.now() > waits_since + milliseconds(300)) stream.pause(false);
  };
  const auto report = pass(waiting_path());
  ASSERT_FALSE(report.fault) << report.fault->message;
  EXPECT_NE(waits_since, TimePoint{});
  EXPECT_EQ(bench.mm(0), 1);
}

TEST_P(HaltsInEachMode, AStopWinsOverAWait) {
  once_it_waits(milliseconds(200), [&] { bench.stream().stop(); });
  const auto report = pass(waiting_path());
  ASSERT_TRUE(report.fault);
  EXPECT_EQ(report.fault->kind, FaultKind::asked);
  EXPECT_THAT(carried_out, IsEmpty());
  EXPECT_NEAR(bench.mm(0), 5, 0.005);
  expect_own_settings();
}

TEST_P(HaltsInEachMode, AStopThatComesWithAWordEndsThePath) {
  bench.instead = [&](const DriveCommand& command) -> Answer {
    if (command.kind != Kind::carry_out) return std::nullopt;
    carried_out.push_back(command.value);
    if (command.value == 8) bench.stream().stop();
    return 0;
  };
  const auto report = pass(switched_path());
  ASSERT_TRUE(report.fault);
  EXPECT_EQ(report.fault->kind, FaultKind::asked);
  EXPECT_THAT(carried_out, ElementsAre(3, 8, 5, 9));
}

TEST_P(HaltsInEachMode, ARehearsalGoesOnByItself) {
  const auto rehearsal = bench.rehearse(waiting_path(), GetParam());
  ASSERT_FALSE(rehearsal.fault) << rehearsal.fault->message;
  EXPECT_LT(rehearsal.farthest, 0.05);
  EXPECT_NEAR(rehearsal.passed_s, bench.course().duration(), 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Modes, HaltsInEachMode,
                         testing::Values(StreamMode::velocity, StreamMode::segments,
                                         StreamMode::position),
                         [](const auto& mode) { return std::string(name_of(mode.param)); });

class HaltsOfEachFamily : public testing::TestWithParam<std::tuple<std::uint16_t, StreamMode>> {};

// Of the TMCM-142 there is one axis.
TEST_P(HaltsOfEachFamily, WordsAreCarriedOutWhereTheAxesStand) {
  const auto [model, mode] = GetParam();
  auto path = switched_path();
  path.axes.resize(find_model(model)->axes == 1 ? 1 : 2);
  Bench bench(model, path.axes.size());
  bench.limit(5, 50);
  std::vector<std::int32_t> carried_out;
  bench.instead = [&](const DriveCommand& command) -> Answer {
    if (command.kind != Kind::carry_out) return std::nullopt;
    EXPECT_FALSE(bench.moving());
    carried_out.push_back(command.value);
    return 0;
  };
  const auto report = bench.pass(path, mode);
  ASSERT_FALSE(report.fault) << report.fault->message;
  EXPECT_THAT(carried_out, ElementsAre(3, 8, 7, 4, 5, 9));
  EXPECT_LT(report.largest_off, 0.05);
}

INSTANTIATE_TEST_SUITE_P(Families, HaltsOfEachFamily,
                         testing::Combine(testing::Values<std::uint16_t>(3110, 142),
                                          testing::Values(StreamMode::velocity,
                                                          StreamMode::segments)),
                         [](const auto& one) {
                           return "Tmcm" + std::to_string(std::get<0>(one.param)) +
                                  std::string(name_of(std::get<1>(one.param)));
                         });

}  // namespace
}  // namespace tmcl::plan
