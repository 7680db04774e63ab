// Input shaping: what it leaves of the swing of a load, and what it makes of a course.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/random.hpp"
#include "support/random_path.hpp"
#include "support/rounds.hpp"
#include "support/seed.hpp"
#include "tmcl/plan/course.hpp"

namespace tmcl::plan {
namespace {

constexpr std::array all_shapers{Shaper::zv, Shaper::zvd, Shaper::ei};
constexpr double no_feed = std::numeric_limits<double>::infinity();

PathLimits limits_for(std::size_t axes) {
  PathLimits limits;
  limits.axes = axes;
  limits.axis.fill({20, 400});
  limits.corner_tolerance = 0.025;
  return limits;
}

path_file::Path one_line(double way) {
  path_file::Path path{{"X"}, {}, {}};
  path.elements.push_back(path_file::LineTo{{way}, {}, {}, 1});
  path.length_axes = 1;
  return path;
}

Course course_of(const path_file::Path& path, const std::optional<Shaping>& shaping) {
  return Course::of(path, limits_for(path.axes.size()), no_feed, shaping).value();
}

/// Of a load behind the first axis, when the course is over.
double swing_after(const Course& course, ramp::Resonance resonance) {
  constexpr double step = 1e-4;
  ramp::ResonantLoad load(resonance);
  double speed = 0;
  for (double time = 0; time < course.duration() + step; time += step) {
    const double next = course.at(time + step).velocity[0];
    load.advance(step, (next - speed) / step);
    speed = next;
  }
  return load.swing();
}

TEST(Shaping, HasPartsThatMakeOneAndANameThatIsReadBack) {
  for (const auto shaper : all_shapers) {
    EXPECT_EQ(shaper_named(name_of(shaper)), shaper);
    for (const double damping : {0.0, 0.05, 0.5}) {
      const auto impulses = impulses_of({shaper, {12, damping}});
      double sum = 0, last = -1;
      for (const auto& [delay, part] : impulses) {
        EXPECT_GT(delay, last);
        EXPECT_GT(part, 0);
        sum += part;
        last = delay;
      }
      EXPECT_EQ(impulses.front().delay, 0);
      EXPECT_NEAR(sum, 1, 1e-12);
      const double half_a_swing = 0.5 / (12 * std::sqrt(1 - damping * damping));
      EXPECT_NEAR(last, half_a_swing * (shaper == Shaper::zv ? 1 : 2), 1e-12);
    }
  }
  EXPECT_FALSE(shaper_named("zvdd"));
}

/// What a shaper leaves, as part of what is left without it.
double left(Shaper shaper, ramp::Resonance expected, ramp::Resonance real) {
  // Of a length at which the plain one leaves much.
  const auto path = one_line(2.6);
  return swing_after(course_of(path, Shaping{shaper, expected}), real) /
         swing_after(course_of(path, std::nullopt), real);
}

TEST(Shaping, LeavesNoSwingAtTheResonance) {
  for (const double damping : {0.0, 0.05, 0.2}) {
    const ramp::Resonance load{12, damping};
    EXPECT_LT(left(Shaper::zv, load, load), 0.001) << damping;
    EXPECT_LT(left(Shaper::zvd, load, load), 0.001) << damping;
    EXPECT_LT(left(Shaper::ei, load, load), 0.055) << damping;
  }
}

TEST(Shaping, LeavesLittleNearTheResonance) {
  const ramp::Resonance expected{12, 0};
  for (const double off : {0.9, 1.1}) {
    const ramp::Resonance real{12 * off, 0};
    EXPECT_LT(left(Shaper::zv, expected, real), 0.2);
    EXPECT_LT(left(Shaper::zvd, expected, real), 0.03);
    EXPECT_LT(left(Shaper::ei, expected, real), 0.055);
    EXPECT_GT(left(Shaper::zv, expected, real), left(Shaper::zvd, expected, real));
  }
}

struct ShapedScene {
  path_file::Path path;
  Shaping shaping;
};

ShapedScene random_shaped_scene(tmcl::test::Random<>& random) {
  ShapedScene scene;
  scene.path = test::random_path(random, static_cast<std::size_t>(random.between(1, 2)));
  scene.shaping = {all_shapers.at(static_cast<std::size_t>(random.between(0, 2))),
                   {static_cast<double>(random.between(3, 60)),
                    static_cast<double>(random.between(0, 30)) / 100}};
  return scene;
}

void expect_same_ends(const Course& plain, const Course& shaped) {
  EXPECT_EQ(shaped.at(-1).position, plain.at(-1).position);
  const auto end = plain.at(plain.duration()).position;
  for (std::size_t axis = 0; axis < plain.axes(); ++axis)
    EXPECT_NEAR(shaped.at(shaped.duration()).position[axis], end[axis], 1e-9);
}

/// No farther, no faster, and between two turns never back.
void expect_ways_between_turns(const Course& plain, const Course& shaped, std::size_t axis) {
  constexpr double rounding = 2e-6;
  const auto turns = shaped.turns(axis);
  std::size_t stretch = 0;
  double before = shaped.at(0).position[axis], direction = 0;
  for (double time = 0; time < shaped.duration(); time += 0.002) {
    while (stretch + 1 < turns.size() && turns[stretch].time <= time) {
      ++stretch;
      direction = 0;
    }
    const auto state = shaped.at(time);
    EXPECT_LE(std::abs(state.velocity[axis]), shaped.top_speed(axis) + rounding);
    EXPECT_LE(std::abs(state.velocity[axis]), plain.top_speed(axis) + rounding);
    EXPECT_GE(state.position[axis], shaped.least()[axis] - rounding);
    EXPECT_LE(state.position[axis], shaped.greatest()[axis] + rounding);
    if (std::abs(state.velocity[axis]) > 1e-6) {
      EXPECT_GE(direction * state.velocity[axis], 0) << "at " << time;
      direction = state.velocity[axis];
    }
    before = state.position[axis];
  }
  EXPECT_EQ(turns.back().time, shaped.duration());
  for (const auto& turn : turns)
    EXPECT_NEAR(shaped.at(turn.time).position[axis], turn.position, 1e-9) << before;
}

TEST(ShapingProperty, KeepsEndsLimitsAndDirections) {
  tmcl::test::Random<> random(tmcl::test::seed());
  for (int round = 0; round < tmcl::test::rounds(200); ++round) {
    const auto scene = random_shaped_scene(random);
    SCOPED_TRACE(test::describe(scene.path) + ", " + std::string(name_of(scene.shaping.shaper)) +
                 " at " + std::to_string(scene.shaping.resonance.frequency_hz) + " Hz");
    const auto plain = course_of(scene.path, std::nullopt);
    const auto shaped = course_of(scene.path, scene.shaping);
    expect_same_ends(plain, shaped);
    for (std::size_t axis = 0; axis < plain.axes(); ++axis)
      expect_ways_between_turns(plain, shaped, axis);
    if (HasFailure()) return;
  }
}

TEST(Shaping, StandsAsLongAsThePathDwells) {
  auto path = one_line(10);
  path.elements.push_back(path_file::Dwell{0.3, 2});
  path.elements.push_back(path_file::LineTo{{0}, {}, {}, 3});
  const auto shaped = course_of(path, Shaping{Shaper::zvd, {4, 0.05}});
  double stood = 0;
  for (double time = 0; time < shaped.duration(); time += 0.001) {
    if (std::abs(shaped.at(time).position[0] - 10) < 1e-9) stood += 0.001;
  }
  EXPECT_NEAR(stood, 0.3, 0.003);
}

}  // namespace
}  // namespace tmcl::plan
