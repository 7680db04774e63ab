// Random paths on simulated axes, by a random bus, with random trouble on the way.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "support/random.hpp"
#include "support/random_path.hpp"
#include "support/rounds.hpp"
#include "support/seed.hpp"
#include "support/stream_bench.hpp"

namespace tmcl::plan {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using Kind = DriveCommand::Kind;
using FaultKind = DriveFault::Kind;
using Bench = test::StreamBench;
using Random = tmcl::test::Random<>;
namespace ap = axis_parameter;

// How far off the lines axes get if nothing is in their way, in mm; with a tolerance of 0.05, of
// which corners have the half. Half of the paths stay within 0.01. By positions, it is short legs
// behind sharp corners that cost so much, where the bus is too slow to load a leg twice.
constexpr double most_off_by_velocity = 0.1;
constexpr double most_off_by_segments = 0.2;
constexpr double most_off_by_position = 0.3;

double most_off(StreamMode mode, double late_turn) {
  switch (mode) {
    case StreamMode::velocity: return std::max(most_off_by_velocity, late_turn);
    case StreamMode::segments: return most_off_by_segments;
    case StreamMode::position: break;
  }
  return most_off_by_position;
}

/// What goes wrong, if anything does.
enum class Trouble {
  none,
  lateness,      // now and then a command takes some milliseconds more
  long_pause,    // once nothing happens for very long
  refusal,       // one command fails
  silence,       // all commands to one axis fail from some time on
  foreign_stop,  // somebody stops an axis
  stop,          // stop() is called
  pause,         // and pause(), and it goes on
};

struct Scene {
  StreamMode mode = StreamMode::velocity;
  std::uint16_t model = 6212;
  path_file::Path path{};
  double velocity = 20;
  double acceleration = 500;
  Duration round_trip{};
  Trouble trouble = Trouble::none;
  std::size_t at_command = 0;  // the trouble begins there
  std::size_t axis = 0;        // whose it is
};

Scene random_scene(Random& random) {
  Scene scene;
  scene.mode = static_cast<StreamMode>(random.between(0, 2));
  if (scene.mode != StreamMode::position && random.one_in(3)) scene.model = 3110;
  if (scene.mode != StreamMode::position && random.one_in(3)) scene.model = 142;
  scene.path = test::random_path(random, scene.model == 142 ? 1 : 2);
  scene.velocity = static_cast<double>(random.between(4, 20));
  scene.acceleration = static_cast<double>(random.between(50, 500));
  if (scene.model != 6212) {  // as it is delivered
    scene.velocity = 5;
    scene.acceleration = 50;
  }
  scene.round_trip = microseconds(random.between(60, 1500));
  scene.trouble = static_cast<Trouble>(random.between(0, 7));
  scene.at_command = static_cast<std::size_t>(random.any_size(3000));
  if (scene.path.axes.size() > 1) scene.axis = static_cast<std::size_t>(random.between(0, 1));
  return scene;
}

bool sets_off(const DriveCommand& command) {
  return (command.kind == Kind::rotate && command.value != 0) || command.kind == Kind::move_to;
}

class Play {
 public:
  Play(Random& random, const Scene& scene) : random_(random), scene_(scene), bench_(scene.model) {
    bench_.limit(scene.velocity, scene.acceleration);  // a TMC429 keeps its own
    bench_.round_trip = scene.round_trip;
    bench_.most_deviation = 3;
    before_ = settings();
    bench_.instead = [this](const DriveCommand& command) { return disturb(command); };
    bench_.every_ms = [this] {
      const double y = bench_.motors().size() > 1 ? bench_.mm(1) : 0;
      farthest_ = std::max(farthest_, test::off(scene_.path, bench_.mm(0), y));
      if (++ms_ > 200'000) throw std::runtime_error("it does not end");
      if (scene_.trouble == Trouble::pause && ms_ == paused_at_ + 300) bench_.stream().pause(false);
    };
  }

  void run() {
    const auto report = bench_.pass(scene_.path, scene_.mode);
    // Whoever stopped it may have done so as the last thing.
    for (int i = 0; i < 2000 && bench_.moving() && !silent_; ++i) bench_.let_pass(milliseconds(1));
    if (report.fault) {
      judge(report, *report.fault);
    } else {
      judge_success(report);
    }
    if (silent_) return;
    EXPECT_FALSE(bench_.moving());
    if (report.unrestored.empty()) {
      EXPECT_EQ(settings(), before_);
    }
    EXPECT_LE(set_off_after_foreign_stop_, 1U) << "the one that was on its way";
  }

 private:
  std::map<std::pair<int, int>, std::int32_t> settings() {
    std::map<std::pair<int, int>, std::int32_t> all;
    for (const auto axis : bench_.motors()) {
      for (const std::uint8_t parameter :
           std::initializer_list<std::uint8_t>{4, 5, 16, 17, 18, 19, 20, 21}) {
        const auto value = bench_.ask(Command::GAP, parameter, axis, 0);
        if (value) all[{axis, parameter}] = *value;
      }
    }
    return all;
  }

  std::optional<tmcl::Result<std::int32_t>> disturb(const DriveCommand& command) {
    const bool is_time = ++commands_ >= scene_.at_command && !happened_;
    if (foreign_stop_ && command.axis == scene_.axis && sets_off(command))
      ++set_off_after_foreign_stop_;
    switch (scene_.trouble) {
      case Trouble::none: break;
      case Trouble::lateness:
        if (random_.one_in(60)) bench_.let_pass(microseconds(random_.between(0, 4000)));
        break;
      case Trouble::long_pause:
        if (is_time) happened_ = true, bench_.let_pass(milliseconds(400));
        break;
      case Trouble::refusal:
        if (is_time && command.kind != Kind::stop) {
          happened_ = true;
          return test::no_reply();
        }
        break;
      case Trouble::silence:
        if (is_time) silent_ = true;
        if (silent_ && command.axis == scene_.axis) return test::no_reply();
        break;
      case Trouble::foreign_stop:
        // Between a look at its target velocity and the command that follows, it could not be told.
        if (is_time && command.kind == Kind::get && turns(scene_.axis)) {
          happened_ = foreign_stop_ = true;
          bench_.ask(Command::MST, 0, static_cast<std::uint8_t>(scene_.axis), 0);
        }
        break;
      case Trouble::stop:
        if (is_time) happened_ = true, bench_.stream().stop();
        break;
      case Trouble::pause:
        if (is_time) happened_ = true, paused_at_ = ms_, bench_.stream().pause(true);
        break;
    }
    return std::nullopt;
  }

  // What says how fast it is to be.
  std::uint8_t greatest_speed() const {
    return scene_.mode == StreamMode::position ? ap::target_velocity : ap::max_velocity;
  }
  bool turns(std::size_t axis) {
    const auto motor = static_cast<std::uint8_t>(axis);
    return bench_.stream().phase() == PathStream::Phase::running &&
           bench_.get(motor, ap::actual_velocity) != 0 && bench_.get(motor, greatest_speed()) != 0;
  }

  void judge(const StreamReport& report, const DriveFault& fault) {
    SCOPED_TRACE(fault.message);
    if (fault.kind != FaultKind::slow_bus) {
      EXPECT_NE(scene_.trouble, Trouble::none);
    }
    switch (fault.kind) {
      case FaultKind::asked: EXPECT_EQ(scene_.trouble, Trouble::stop); break;
      case FaultKind::refused:
        EXPECT_TRUE(scene_.trouble == Trouble::refusal || scene_.trouble == Trouble::silence);
        break;
      case FaultKind::foreign: EXPECT_TRUE(foreign_stop_); break;
      case FaultKind::no_end:
        // Who could not be given its speed back does not get to its end.
        EXPECT_TRUE(foreign_stop_ || silent_ || !report.unrestored.empty());
        break;
      case FaultKind::starved:
      case FaultKind::off_course:
        EXPECT_TRUE(scene_.trouble == Trouble::long_pause || scene_.trouble == Trouble::lateness ||
                    foreign_stop_);
        break;
      case FaultKind::not_at_start:
      case FaultKind::unsuited: ADD_FAILURE() << "it could have begun"; break;
      case FaultKind::slow_bus: break;
    }
    if (!is_before_motion(fault)) expect_all_were_stopped(report);
  }
  static bool is_before_motion(const DriveFault& fault) {
    return fault.kind == FaultKind::slow_bus || fault.kind == FaultKind::not_at_start;
  }

  // Each of them, unless nothing had begun to move.
  void expect_all_were_stopped(const StreamReport& report) {
    if (report.updates == 0) return;
    for (std::size_t axis = 0; axis < scene_.path.axes.size(); ++axis) {
      EXPECT_TRUE(std::ranges::any_of(bench_.commands, [&](const DriveCommand& command) {
        return command.kind == Kind::stop && command.axis == axis;
      })) << axis;
    }
    EXPECT_FALSE(std::any_of(end_of_motion(), bench_.commands.cend(), may_move));
  }
  static bool may_move(const DriveCommand& command) {
    return command.kind == Kind::rotate || command.kind == Kind::move_to ||
           (command.kind == Kind::set && command.parameter == ap::target_position);
  }
  // From there on nothing may move an axis. That is its first stop; but a stream of velocities that
  // was passed stops as well, and then moves to the exact end.
  std::vector<DriveCommand>::const_iterator end_of_motion() {
    const auto& commands = bench_.commands;
    const bool was_passed = bench_.stream().passed() >= bench_.course().duration();
    if (scene_.mode == StreamMode::position || !was_passed)
      return std::ranges::find(commands, Kind::stop, &DriveCommand::kind);
    return std::ranges::find(commands.rbegin(), commands.rend(), Kind::stop, &DriveCommand::kind)
        .base();
  }

  void judge_success(const StreamReport& report) {
    const auto& end = std::get<path_file::LineTo>(scene_.path.elements.back()).target;
    for (std::uint8_t axis = 0; axis < scene_.path.axes.size(); ++axis)
      EXPECT_EQ(bench_.get(axis, ap::actual_position),
                std::lround(end[axis] * microsteps_per_mm()));
    EXPECT_FALSE(foreign_stop_) << "not noticed";
    if (scene_.trouble == Trouble::none) {
      const double late_turn = test::late_turn(report, scene_.velocity, scene_.round_trip);
      EXPECT_LT(farthest_, most_off(scene_.mode, late_turn));
    }
    EXPECT_EQ(report.axes.size(), scene_.path.axes.size());
  }
  static double microsteps_per_mm() { return test::microsteps_per_mm; }

  Random& random_;
  const Scene& scene_;
  Bench bench_;
  std::map<std::pair<int, int>, std::int32_t> before_;
  std::size_t commands_ = 0;
  bool happened_ = false;
  bool silent_ = false;
  bool foreign_stop_ = false;
  std::size_t set_off_after_foreign_stop_ = 0;
  int ms_ = 0;
  int paused_at_ = -1000;
  double farthest_ = 0;
};

std::string describe(const Scene& scene) {
  std::string text(name_of(scene.mode));
  text += " on " + std::to_string(scene.model) + ", trouble " +
          std::to_string(static_cast<int>(scene.trouble)) + " at command " +
          std::to_string(scene.at_command) + " of axis " + std::to_string(scene.axis) + ", " +
          std::to_string(scene.round_trip.count() / 1000) + " us, " +
          std::to_string(scene.velocity) + " mm/s, " + std::to_string(scene.acceleration) +
          " mm/s2:";
  return text + test::describe(scene.path);
}

TEST(StreamProperty, WhateverHappensItEndsAsItShould) {
  Random random(tmcl::test::seed());
  for (int round = 0; round < tmcl::test::rounds(150); ++round) {
    const auto scene = random_scene(random);
    SCOPED_TRACE(describe(scene));
    Play(random, scene).run();
    if (HasFailure()) return;
  }
}

constexpr double radius = test::circle_radius;

// Each axis turns round twice, and may do so a little before the path does.
TEST(StreamProperty, ACircleByPositionsBearsCommandsThatAreNotPunctual) {
  Random random(tmcl::test::seed());
  const auto path = test::circle(20, 0.1);
  for (int round = 0; round < tmcl::test::rounds(100); ++round) {
    Bench bench;
    bench.limit(24, 500);
    const auto least_us = random.between(15, 150);
    const auto one_in = random.between(10, 1000);
    const auto late_us = random.between(500, 6000);
    SCOPED_TRACE(std::to_string(least_us) + " us, one command in " + std::to_string(one_in) +
                 " takes " + std::to_string(late_us) + " us more");
    bench.instead = [&](const DriveCommand&) -> std::optional<tmcl::Result<std::int32_t>> {
      const auto late = random.between(1, one_in) == 1 ? late_us : 0;
      bench.round_trip = std::chrono::microseconds(random.between(least_us, 2 * least_us) + late);
      return std::nullopt;
    };
    double farthest = 0;
    bench.every_ms = [&] {
      const double off = std::hypot(bench.mm(0) - radius, bench.mm(1)) - radius;
      farthest = std::max(farthest, std::abs(off));
    };
    const auto report = bench.pass(path, StreamMode::position);
    const auto told = report.fault ? report.fault->kind : FaultKind::asked;
    ASSERT_TRUE(!report.fault || told == FaultKind::slow_bus || told == FaultKind::starved)
        << report.fault->message;
    ASSERT_LT(farthest, 0.2);
    if (report.fault) continue;
    for (const auto& axis : report.axes) ASSERT_LT(axis.largest, 0.5);
  }
}

}  // namespace
}  // namespace tmcl::plan
