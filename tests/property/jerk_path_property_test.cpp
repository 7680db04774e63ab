// A path with a jerk: on it, within its limits at each place, and with no more jerk than that.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "support/random.hpp"
#include "support/random_path.hpp"
#include "support/rounds.hpp"
#include "support/seed.hpp"
#include "support/stream_bench.hpp"
#include "tmcl/plan/course.hpp"

namespace tmcl::plan {
namespace {

constexpr double no_feed = std::numeric_limits<double>::infinity();
// Rounding of what is computed, in parts of the limits.
constexpr double slack = 1e-6;

struct SmoothScene {
  path_file::Path path;
  PathLimits limits;
};

double decades(tmcl::test::Random<>& random, std::int64_t least, std::int64_t most) {
  return std::pow(10, static_cast<double>(random.between(100 * least, 100 * most)) / 100);
}

/// Or chords of a circle.
path_file::Path arc_path(tmcl::test::Random<>& random) {
  path_file::Path path{{"X", "Y"}, {}, {}};
  path.axes.resize(2);
  const double radius = decades(random, -1, 1);
  const auto chords = random.between(3, 200);
  for (std::int64_t i = 1; i <= chords; ++i) {
    const double angle =
        2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(chords);
    path_file::LineTo to{{radius - radius * std::cos(angle), radius * std::sin(angle)},
                         {},
                         {},
                         static_cast<std::size_t>(i)};
    path.elements.push_back(to);
  }
  return path;
}

SmoothScene random_smooth_scene(tmcl::test::Random<>& random) {
  SmoothScene scene;
  const auto axes = static_cast<std::size_t>(random.between(1, 2));
  scene.path = axes == 2 && random.one_in(4) ? arc_path(random) : test::random_path(random, axes);
  scene.path.length_axes = axes;
  scene.limits.axes = axes;
  for (auto& axis : scene.limits.axis) {
    axis = {decades(random, 0, 2), decades(random, 1, 3)};
    if (random.one_in(3)) axis.corner_jump = decades(random, -2, 1);
  }
  scene.limits.corner_tolerance = random.one_in(4) ? 0 : decades(random, -4, -1);
  scene.limits.jerk = decades(random, 1, 6);
  return scene;
}

std::string describe_limits(const PathLimits& limits) {
  std::string text = ", jerk " + std::to_string(limits.jerk) + ", corners " +
                     std::to_string(limits.corner_tolerance);
  for (std::size_t axis = 0; axis < limits.axes; ++axis)
    text += ", " + std::to_string(limits.axis[axis].velocity) + " and " +
            std::to_string(limits.axis[axis].acceleration) + " by " +
            std::to_string(limits.axis[axis].corner_jump);
  return text;
}

double size_of(const AxisValues& values, std::size_t axes) {
  double size = 0;
  for (std::size_t axis = 0; axis < axes; ++axis) size = std::hypot(size, values[axis]);
  return size;
}

AxisValues direction_of(const Course& course, std::size_t leg) {
  const auto from = course.at(course.leg(leg).begin).position;
  AxisValues direction{};
  for (std::size_t axis = 0; axis < course.axes(); ++axis)
    direction[axis] = course.leg(leg).axis[axis].target - from[axis];
  return direction;
}

/// Of the line of the file, along the path.
double feed_at(const path_file::Path& path, std::size_t line) {
  for (const auto& element : path.elements) {
    const auto* to = std::get_if<path_file::LineTo>(&element);
    if (to != nullptr && to->line == line) return to->feed.value_or(no_feed);
  }
  return no_feed;
}

void expect_within_limits(const SmoothScene& scene, const Course& course, double time) {
  const auto& limits = scene.limits;
  const auto motion = course.motion_at(time);
  for (std::size_t axis = 0; axis < course.axes(); ++axis) {
    EXPECT_LE(std::abs(motion.velocity[axis]), limits.axis[axis].velocity * (1 + slack));
    EXPECT_LE(std::abs(motion.acceleration[axis]), limits.axis[axis].acceleration * (1 + slack));
  }
  EXPECT_LE(size_of(motion.jerk, course.axes()), limits.jerk * (1 + slack));
  const double speed = size_of(motion.velocity, course.axes());
  EXPECT_LE(speed, feed_at(scene.path, course.line_at(time).value_or(0)) * (1 + slack));
}

/// By differences of positions and speeds, whatever it says of its acceleration; in corners, too:
/// the speed along the path is steady there.
void expect_little_jerk(const SmoothScene& scene, const Course& course, double time, double step) {
  const auto speed_at = [&](double when) {
    return size_of(course.at(when).velocity, course.axes());
  };
  const double before = speed_at(time - step), here = speed_at(time), after = speed_at(time + step);
  const double rounding = 1e-11 * std::max(1.0, here);
  EXPECT_LE(std::abs(before - 2 * here + after),
            scene.limits.jerk * step * step * (1 + slack) + rounding)
      << "at " << time;
  const auto from = course.at(time).position, to = course.at(time + step).position;
  AxisValues way{};
  for (std::size_t axis = 0; axis < course.axes(); ++axis) way[axis] = to[axis] - from[axis];
  const double passed = (here + after) / 2 * step;
  const double grain = scene.limits.jerk * step * step * step + 1e-9;
  EXPECT_LE(size_of(way, course.axes()), passed + grain);
  if (course.leg_at(time) == course.leg_at(time + step)) {
    EXPECT_GE(size_of(way, course.axes()), passed - grain);
  }
}

void expect_corners_kept(const SmoothScene& scene, const Course& course) {
  for (std::size_t leg = 1; leg < course.legs(); ++leg) {
    auto from = direction_of(course, leg - 1), to = direction_of(course, leg);
    const double before = size_of(from, course.axes()), after = size_of(to, course.axes());
    for (std::size_t axis = 0; axis < course.axes(); ++axis)
      from[axis] /= before, to[axis] /= after;
    const double most = corner_speed(from, to, std::min(before, after), scene.limits);
    const double speed = course.leg(leg).start_speed;
    // The lengths of these legs are those between rounded places.
    EXPECT_LE(speed, most * (1 + slack) + 1e-6) << "at leg " << leg;
    for (std::size_t axis = 0; axis < course.axes(); ++axis) {
      EXPECT_LE(std::abs(to[axis] - from[axis]) * speed,
                scene.limits.axis[axis].corner_jump * (1 + slack) + 1e-6);
    }
  }
}

void expect_same_way(const Course& plain, const Course& smooth) {
  const auto axes = plain.axes();
  ASSERT_EQ(smooth.legs(), plain.legs());
  for (std::size_t axis = 0; axis < axes; ++axis) {
    EXPECT_EQ(smooth.at(0).position[axis], plain.at(0).position[axis]);
    EXPECT_NEAR(smooth.at(smooth.duration()).position[axis],
                plain.at(plain.duration()).position[axis], 1e-9);
    for (std::size_t leg = 0; leg < plain.legs(); ++leg) {
      EXPECT_NEAR(smooth.at(smooth.leg(leg).end).position[axis], plain.leg(leg).axis[axis].target,
                  1e-9);
    }
  }
  EXPECT_GE(smooth.duration(), plain.duration() * (1 - slack));
  EXPECT_EQ(size_of(smooth.at(0).velocity, axes), 0);
  EXPECT_NEAR(smooth.resting_after(0), plain.resting_after(0), 1e-9);
}

TEST(JerkPathProperty, IsPassedWithinItsLimitsAtEachPlace) {
  tmcl::test::Random<> random(tmcl::test::seed());
  for (int round = 0; round < tmcl::test::rounds(200); ++round) {
    const auto scene = random_smooth_scene(random);
    SCOPED_TRACE(test::describe(scene.path) + describe_limits(scene.limits));
    auto unlimited = scene.limits;
    unlimited.jerk = no_feed;
    const auto plain = Course::of(scene.path, unlimited).value();
    const auto smooth = Course::of(scene.path, scene.limits).value();
    expect_same_way(plain, smooth);
    expect_corners_kept(scene, smooth);
    constexpr int looks = 3000;
    const double step = smooth.duration() / looks;
    for (int look = 1; look < looks; ++look) {
      expect_within_limits(scene, smooth, look * step);
      expect_little_jerk(scene, smooth, look * step, step);
      expect_little_jerk(scene, smooth, look * step, step / 50);
      const auto place = smooth.at(look * step).position;
      EXPECT_LT(test::off(scene.path, place[0], smooth.axes() > 1 ? place[1] : 0), 1e-9);
      if (HasFailure()) return;
    }
    if (HasFailure()) return;
  }
}

}  // namespace
}  // namespace tmcl::plan
