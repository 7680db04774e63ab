// Paths on simulated axes that are slowed down, sped up and held at random: where the motors are,
// and how their speeds change, each millisecond.
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

namespace tmcl::plan {
namespace {

using std::chrono::microseconds;
using Bench = test::StreamBench;
using Random = tmcl::test::Random<>;

struct Feeding {
  path_file::Path path{};
  StreamMode mode = StreamMode::velocity;
  std::uint16_t model = 6212;
  double velocity = 24;
  double acceleration = 500;
  Duration round_trip{};
  bool turned = true;  // the knob; otherwise all is as planned
  double jerk = std::numeric_limits<double>::infinity();
};

Feeding random_feeding(Random& random) {
  Feeding made;
  made.mode = random.one_in(2) ? StreamMode::velocity : StreamMode::segments;
  if (random.one_in(3)) made.model = 3110;
  if (random.one_in(4)) made.model = 142;
  if (made.model != 6212) made.velocity = 5, made.acceleration = 50;
  made.path = test::random_path(random, made.model == 142 ? 1 : 2);
  made.round_trip = microseconds(random.between(60, 1500));
  if (random.one_in(3)) made.jerk = static_cast<double>(random.positive(50'000));
  return made;
}

struct Seen {
  double farthest = 0;
  std::array<double, 2> largest_jump{};  // in a millisecond, beyond the acceleration
  std::array<double, 2> fastest{};
  std::array<double, 2> allowed_jump{};  // by the corners of the path
  int holds = 0;
  int turns = 0;
  double late_turn = 0;  // how far an axis goes while another one waits for a late update
  std::string fault{};
  bool at_end = true;
};

class Passing {
 public:
  Passing(Random& random, const Feeding& feeding)
      : random_(random), feeding_(feeding), bench_(feeding.model) {
    bench_.limit(feeding.velocity, feeding.acceleration);
    bench_.round_trip = feeding.round_trip;
    bench_.jerk = feeding.jerk;
    bench_.most_deviation = 3;
    bench_.every_ms = [this] { look(); };
  }

  Seen run() {
    const auto report = bench_.pass(feeding_.path, feeding_.mode);
    if (report.fault) seen_.fault = report.fault->message;
    seen_.late_turn = test::late_turn(report, feeding_.velocity, feeding_.round_trip);
    const auto& end = std::get<path_file::LineTo>(feeding_.path.elements.back()).target;
    for (const auto axis : axes()) {
      const auto is = bench_.get(axis, test::ap::actual_position);
      seen_.at_end = seen_.at_end && is == std::lround(end[axis] * test::microsteps_per_mm);
    }
    for (std::size_t leg = 1; leg < bench_.course().legs(); ++leg) look_at_corner(leg);
    return seen_;
  }

 private:
  std::span<const std::uint8_t> axes() const {
    return bench_.motors().first(feeding_.path.axes.size());
  }

  AxisValues direction_of(std::size_t leg) const {
    const auto& course = bench_.course();
    AxisValues way{};
    double length = 0;
    for (std::size_t axis = 0; axis < course.axes(); ++axis) {
      way[axis] =
          course.leg(leg).axis[axis].target - course.at(course.leg(leg).begin).position[axis];
      length = std::hypot(length, way[axis]);
    }
    for (auto& part : way) part /= length;
    return way;
  }
  double length_of(std::size_t leg) const {
    const auto [from, to] = std::pair(bench_.course().leg(leg).begin, bench_.course().leg(leg).end);
    const auto one = bench_.course().at(from).position, other = bench_.course().at(to).position;
    return std::hypot(other[0] - one[0], axes().size() > 1 ? other[1] - one[1] : 0);
  }
  // Whatever the feed of the path is.
  void look_at_corner(std::size_t leg) {
    const auto from = direction_of(leg - 1), to = direction_of(leg);
    if (bench_.course().leg(leg).start_speed == 0) return;
    const double room = std::min(length_of(leg - 1), length_of(leg));
    const double speed =
        std::min(corner_speed(from, to, room, bench_.limits()), feeding_.velocity * std::sqrt(2.0));
    for (const auto axis : axes())
      seen_.allowed_jump[axis] =
          std::max(seen_.allowed_jump[axis], speed * std::abs(to[axis] - from[axis]));
  }

  void look() {
    if (++ms_ > 400'000) throw std::runtime_error("it does not end");
    const double y = bench_.motors().size() > 1 ? bench_.mm(1) : 0;
    seen_.farthest = std::max(seen_.farthest, test::off(feeding_.path, bench_.mm(0), y));
    for (const auto axis : axes()) {
      const double speed = bench_.get(axis, test::ap::actual_velocity) * unit_;
      const double change = std::abs(speed - before_[axis]) - feeding_.acceleration * 1e-3;
      seen_.largest_jump[axis] = std::max(seen_.largest_jump[axis], change);
      seen_.fastest[axis] = std::max(seen_.fastest[axis], std::abs(speed));
      before_[axis] = speed;
    }
    if (feeding_.turned) turn();
  }

  void turn() {
    auto& stream = bench_.stream();
    if (stream.phase() != PathStream::Phase::running &&
        stream.phase() != PathStream::Phase::pausing)
      return;
    if (ms_ > 60'000) return stream.pause(false), stream.set_feed(1);
    if (!random_.one_in(120)) return;
    if (random_.one_in(3)) {
      seen_.holds += stream.feed().held ? 0 : 1;
      stream.pause(!stream.feed().held);
    } else {
      ++seen_.turns;
      stream.set_feed(static_cast<double>(random_.between(10, 200)) / 100);
    }
  }

  Random& random_;
  const Feeding& feeding_;
  Bench bench_;
  Seen seen_;
  const double unit_ =
      initial_units(*find_model(feeding_.model)).velocity.value / test::microsteps_per_mm;
  std::array<double, 3> before_{};
  int ms_ = 0;
};

std::string describe(const Feeding& feeding) {
  return std::string(name_of(feeding.mode)) + " on " + std::to_string(feeding.model) + ", " +
         std::to_string(feeding.round_trip.count() / 1000) + " us:" + test::describe(feeding.path) +
         (std::isfinite(feeding.jerk) ? ", jerk " + std::to_string(feeding.jerk) : "");
}

// As far off as paths get that go as planned: see stream_property_test.cpp.
double most_off_with_feed(const Feeding& feeding, const Seen& seen) {
  const double by_mode = feeding.mode == StreamMode::velocity ? 0.1 : 0.2;
  return std::max(by_mode, seen.late_turn);
}

// A change of speed takes half an update, by twice the acceleration; the rest is to be in time.
double spare_jump(const Feeding& feeding) {
  return 0.1 + 0.02 * feeding.velocity + feeding.acceleration * 1e-3;
}

void judge(const Feeding& feeding, const Seen& seen) {
  EXPECT_EQ(seen.fault, "");
  EXPECT_TRUE(seen.at_end);
  EXPECT_LT(seen.farthest, most_off_with_feed(feeding, seen));
  // Others make it in steps of their own.
  if (feeding.model != 6212) return;
  for (std::size_t axis = 0; axis < feeding.path.axes.size(); ++axis)
    EXPECT_LE(seen.largest_jump[axis], seen.allowed_jump[axis] + spare_jump(feeding)) << axis;
}

TEST(Feed, StaysOnThePathWhateverIsAskedFor) {
  Random random(tmcl::test::seed());
  int turns = 0, holds = 0;
  double greatest_part = 0;
  for (int round = 0; round < tmcl::test::rounds(150); ++round) {
    const auto feeding = random_feeding(random);
    SCOPED_TRACE("round " + std::to_string(round) + ": " + describe(feeding));
    const auto seen = Passing(random, feeding).run();
    judge(feeding, seen);
    greatest_part = std::max(greatest_part, seen.farthest / most_off_with_feed(feeding, seen));
    turns += seen.turns, holds += seen.holds;
    if (HasFailure()) return;
  }
  std::printf("off the path by %.3f of what is allowed, at most\n", greatest_part);
  EXPECT_GT(turns, 0);
  EXPECT_GT(holds, 0);
}

// What is asked for before the axes set out is how long it takes.
TEST(Feed, OfAPartTakesTheTimeThatItSays) {
  for (const auto mode : {StreamMode::velocity, StreamMode::segments}) {
    for (const double factor : {0.25, 0.5, 1.0}) {
      SCOPED_TRACE(std::string(name_of(mode)) + " " + std::to_string(factor));
      Bench bench;
      bench.limit(20, 400);
      bench.at_wait = [&] { bench.stream().set_feed(factor); };
      bench.instead = [&](const DriveCommand&) -> std::optional<tmcl::Result<std::int32_t>> {
        bench.stream().set_feed(factor);
        return std::nullopt;
      };
      path_file::Path path{{"X", "Y"}, {}, {}};
      path.elements = {path_file::LineTo{{5, 0}, 10.0, {}, 1}, path_file::Dwell{0.5, 2},
                       path_file::LineTo{{5, 5}, 10.0, {}, 3},
                       path_file::LineTo{{0, 0}, 10.0, {}, 4}};
      const auto report = bench.pass(path, mode);
      ASSERT_FALSE(report.fault) << report.fault->message;
      const double wanted = (bench.course().duration() - 0.5) / factor + 0.5;
      EXPECT_NEAR(report.passed_s, wanted, 0.03);
      EXPECT_EQ(bench.mm(0), 0);
      EXPECT_EQ(bench.mm(1), 0);
    }
  }
}

// A circle has room for more; the axes stay on it as they do when it is passed as planned.
TEST(Feed, OfACircleIsDoubledWhereTheAxesHaveRoom) {
  for (const auto mode : {StreamMode::velocity, StreamMode::segments}) {
    SCOPED_TRACE(std::string(name_of(mode)));
    Bench bench;
    bench.limit(24, 500);
    double farthest = 0, fastest = 0;
    int ms = 0;
    bench.every_ms = [&] {
      const double off = std::hypot(bench.mm(0) - test::circle_radius, bench.mm(1));
      farthest = std::max(farthest, std::abs(off - test::circle_radius));
      fastest = std::max(fastest, bench.stream().feed().now);
      if (++ms == 500) bench.stream().set_feed(2);
    };
    const auto report = bench.pass(test::circle(10, 0.1), mode);
    ASSERT_FALSE(report.fault) << report.fault->message;
    EXPECT_NEAR(fastest, 2, 0.001);
    EXPECT_LT(farthest, 0.02);
    const double planned = bench.course().duration();
    EXPECT_LT(report.passed_s, 0.6 + (planned - 0.6) / 2 + 0.2);
  }
}

}  // namespace
}  // namespace tmcl::plan
