// Random paths in each mode, with commands that are late and feeds that are turned: how fast axes
// are told to be, and are, beside the limit that they were planned with.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>

#include "support/random.hpp"
#include "support/random_path.hpp"
#include "support/rounds.hpp"
#include "support/seed.hpp"
#include "support/stream_bench.hpp"
#include "tmcl/parameter_number.hpp"

namespace tmcl::plan {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using CommandKind = DriveCommand::Kind;
using FaultKind = DriveFault::Kind;
using Bench = test::StreamBench;
using Random = tmcl::test::Random<>;

constexpr std::array mode_of{StreamMode::velocity, StreamMode::segments, StreamMode::position};
constexpr std::uint8_t stop_velocity = number_of("stop_velocity");

struct Hurried {
  path_file::Path path{};
  StreamMode mode = StreamMode::velocity;
  std::uint16_t model = 6212;
  double velocity = 0;
  double acceleration = 0;
  Duration round_trip{};
  std::int64_t one_late_in = 0;  // commands; 0: none
  bool turned = false;           // the feed
};

Hurried random_hurried(Random& random, StreamMode mode) {
  Hurried made;
  made.mode = mode;
  if (mode != StreamMode::position) {
    constexpr std::array<std::uint16_t, 5> models{6212, 3110, 142, 1021, 1111};
    made.model = models.at(static_cast<std::size_t>(random.between(0, 4)));
  }
  const bool is_slow = made.model == 3110 || made.model == 142;  // as they are delivered
  made.velocity = static_cast<double>(random.between(200, is_slow ? 500 : 2400)) / 100;
  const int steepest = made.model == 1111 ? 409 : 500;  // a TMC4361 takes no more
  made.acceleration = is_slow ? 50 : static_cast<double>(random.between(50, steepest));
  made.path = test::random_path(random, find_model(made.model)->axes < 2 ? 1 : 2);
  made.round_trip = microseconds(random.between(60, 1500));
  if (random.one_in(2)) made.one_late_in = random.between(5, 200);
  made.turned = takes_feed(mode) && random.one_in(2);
  return made;
}

std::string describe(const Hurried& hurried) {
  return std::string(name_of(hurried.mode)) + " on " + std::to_string(hurried.model) + ", " +
         std::to_string(hurried.round_trip.count() / 1000) + " us, one late in " +
         std::to_string(hurried.one_late_in) + ", " + std::to_string(hurried.velocity) + " mm/s, " +
         std::to_string(hurried.acceleration) + " mm/s2:" + test::describe(hurried.path);
}

/// In parts of the limit.
struct Speeds {
  double told = 0;
  double seen = 0;
};

class Hurry {
 public:
  Hurry(Random& random, const Hurried& hurried)
      : random_(random), hurried_(hurried), bench_(hurried.model) {
    bench_.limit(hurried.velocity, hurried.acceleration);
    bench_.round_trip = hurried.round_trip;
    bench_.most_deviation = 8;
    bench_.every_ms = [this] { look(); };
    bench_.instead = [this](const DriveCommand& command) {
      note(command);
      if (hurried_.one_late_in > 0 && random_.one_in(hurried_.one_late_in))
        bench_.let_pass(microseconds(random_.between(0, 8000)));
      return std::optional<tmcl::Result<std::int32_t>>();
    };
  }

  Speeds run() {
    const auto report = bench_.pass(hurried_.path, hurried_.mode);
    if (report.fault) judge(*report.fault);
    return speeds_;
  }

 private:
  void judge(const DriveFault& fault) const {
    const bool is_late = fault.kind == FaultKind::starved || fault.kind == FaultKind::off_course;
    EXPECT_TRUE(fault.kind == FaultKind::slow_bus || (is_late && hurried_.one_late_in > 0))
        << fault.message;
  }
  bool is_passing() {
    const auto phase = bench_.stream().phase();
    return phase == PathStream::Phase::running || phase == PathStream::Phase::pausing;
  }
  double part_of_limit(double velocity) const {
    return std::abs(velocity) * unit_ / hurried_.velocity;
  }
  void note(const DriveCommand& command) {
    const bool is_speed =
        command.kind == CommandKind::rotate ||
        (command.kind == CommandKind::set &&
         (command.parameter == test::ap::max_velocity || command.parameter == stop_velocity));
    if (is_speed && is_passing())
      speeds_.told = std::max(speeds_.told, part_of_limit(command.value));
  }
  void look() {
    if (++ms_ > 400'000) throw std::runtime_error("it does not end");
    if (!is_passing()) return;
    for (std::uint8_t axis = 0; axis < hurried_.path.axes.size(); ++axis) {
      const double speed = bench_.get(axis, test::ap::actual_velocity);
      speeds_.seen = std::max(speeds_.seen, part_of_limit(speed));
    }
    if (hurried_.turned) turn();
  }
  void turn() {
    auto& stream = bench_.stream();
    if (ms_ > 60'000) return stream.pause(false), stream.set_feed(1);
    if (!random_.one_in(120)) return;
    if (random_.one_in(3)) return stream.pause(!stream.feed().held);
    stream.set_feed(static_cast<double>(random_.between(10, 200)) / 100);
  }

  Random& random_;
  const Hurried& hurried_;
  Bench bench_;
  Speeds speeds_;
  const double unit_ =
      initial_units(*find_model(hurried_.model)).velocity.value / test::microsteps_per_mm;
  int ms_ = 0;
};

class SpeedLimit : public ::testing::TestWithParam<StreamMode> {};

TEST_P(SpeedLimit, HoldsForWhatAnAxisIsToldAlsoWhenItIsBehind) {
  Random random(tmcl::test::seed());
  // What a motor is seen to do is rounded to its unit.
  constexpr double rounding = 1e-3;
  Speeds greatest;
  for (int round = 0; round < tmcl::test::rounds(200); ++round) {
    const auto hurried = random_hurried(random, GetParam());
    SCOPED_TRACE("round " + std::to_string(round) + ": " + describe(hurried));
    const auto [told, seen] = Hurry(random, hurried).run();
    greatest = {std::max(greatest.told, told), std::max(greatest.seen, seen)};
    EXPECT_LE(told, 1 + 1e-9);
    EXPECT_LE(seen, 1 + rounding);
    if (HasFailure()) break;
  }
  std::printf("told %.4f of the limit at most, seen %.4f\n", greatest.told, greatest.seen);
}

// It needs more than what was planned all the time: without spare velocity it would be late by half
// a millimetre in the end.
TEST(SpeedLimitOfLegs, LeavesWhatMakesUpForASlowClock) {
  for (const auto mode : {StreamMode::velocity, StreamMode::segments}) {
    SCOPED_TRACE(std::string(name_of(mode)));
    Bench bench;
    bench.limit(20, 400);
    bench.slow_clock = 0.01;
    path_file::Path path{{"X", "Y"}, {}, {}};
    path.elements = {path_file::LineTo{{60, 30}, {}, {}, 1}};
    const auto report = bench.pass(path, mode);
    ASSERT_FALSE(report.fault) << report.fault->message;
    for (const auto& axis : report.axes) EXPECT_LT(axis.largest, 0.06);
    std::printf("late by %.3f and %.3f mm\n", report.axes[0].largest, report.axes[1].largest);
  }
}

INSTANTIATE_TEST_SUITE_P(All, SpeedLimit, ::testing::ValuesIn(mode_of),
                         [](const auto& tested) { return std::string(name_of(tested.param)); });

}  // namespace
}  // namespace tmcl::plan
