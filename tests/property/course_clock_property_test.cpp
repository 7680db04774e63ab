// The time of a course at any rate: what an axis would do is within its limits, whatever is asked
// for when.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "motion/drive/course_clock.hpp"
#include "support/random.hpp"
#include "support/random_path.hpp"
#include "support/rounds.hpp"
#include "support/seed.hpp"

namespace tmcl::plan {
namespace {

using Random = tmcl::test::Random<>;

constexpr auto step = std::chrono::microseconds(500);
constexpr double step_s = 0.0005;
constexpr double clock_ramp_s = 0.1;
// A rate is taken to change evenly for a millisecond.
constexpr double rounding = 1.03;

PathLimits random_limits(Random& random) {
  PathLimits limits;
  limits.axes = 2;
  for (auto& axis : limits.axis)
    axis = {static_cast<double>(random.between(5, 30)),
            static_cast<double>(random.between(100, 600))};
  limits.corner_tolerance = 0.025;
  return limits;
}

/// Asks for rates and pauses.
class Knob {
 public:
  explicit Knob(Random& random) : random_(&random) {}
  void turn(CourseClock& clock) {
    if (!random_->one_in(150)) return;
    if (random_->one_in(3)) {
      clock.pause(!clock.paused());
    } else {
      clock.set_factor(static_cast<double>(random_->between(10, 200)) / 100);
    }
  }

 private:
  Random* random_;
};

/// A joint between, or next to, two times of the course.
bool is_joint_between(const Course& course, double from, double to) {
  const auto before = course.leg_at(from - 1e-9), after = course.leg_at(to + 1e-9);
  return before != after;
}

TEST(CourseClock, KeepsEachAxisWithinItsLimits) {
  Random random(tmcl::test::seed());
  double fastest = 0;
  for (int round = 0; round < tmcl::test::rounds(150); ++round) {
    const auto path = test::random_path(random, 2);
    const auto limits = random_limits(random);
    SCOPED_TRACE("round " + std::to_string(round) + test::describe(path));
    const auto course = Course::of(path, limits);
    ASSERT_TRUE(course) << course.error();
    CourseClock clock(*course);
    double ramp_s = 0.01;
    for (std::size_t axis = 0; axis < 2; ++axis)
      ramp_s = std::max(ramp_s, 2 * course->top_speed(axis) / limits.axis[axis].acceleration);
    clock.set_ramp(ramp_s);
    TimePoint now{};
    clock.start(now, false);
    Knob knob(random);
    AxisValues before{};
    double at = 0;
    for (int look = 0; clock.passed() < course->duration(); ++look) {
      ASSERT_LT(look, 500'000) << "it does not end";
      if (look < 20'000) knob.turn(clock);
      if (look == 20'000) clock.pause(false), clock.set_factor(2);
      now += step;
      clock.advance(now);
      ASSERT_GE(clock.passed(), at) << "time goes backwards";
      fastest = std::max(fastest, clock.rate());
      const auto planned = course->at(clock.passed()).velocity;
      const bool joint = is_joint_between(*course, at, clock.passed());
      for (std::size_t axis = 0; axis < 2; ++axis) {
        const double speed = clock.rate() * planned[axis];
        const auto& limit = limits.axis[axis];
        ASSERT_LE(std::abs(speed), limit.velocity * rounding) << "at " << clock.passed() << " s";
        if (!joint) {
          ASSERT_LE(std::abs(speed - before[axis]) / step_s, limit.acceleration * rounding + 1)
              << "at " << clock.passed() << " s, rate " << clock.rate();
        }
        before[axis] = speed;
      }
      at = clock.passed();
    }
  }
  EXPECT_GT(fastest, 1.5);
}

// A corner is passed no faster than the plan of a greater feed would pass it.
TEST(CourseClock, PassesNoCornerFasterThanItAllows) {
  path_file::Path path{{"X", "Y"}, {}, {}};
  path.elements = {path_file::LineTo{{20, 0}, 2.0, {}, 1}, path_file::LineTo{{40, 4}, 2.0, {}, 2}};
  PathLimits limits;
  limits.axes = 2;
  limits.axis.fill({20, 100});
  limits.corner_tolerance = 0.00045;
  const auto course = Course::of(path, limits);
  ASSERT_TRUE(course);
  const double length = std::hypot(20, 4);
  const double most = corner_speed({1, 0}, {20 / length, 4 / length}, 20, limits);
  ASSERT_GT(most, 2.0);
  ASSERT_LT(most, 4.0);
  CourseClock clock(*course);
  clock.set_ramp(clock_ramp_s);
  clock.set_factor(2);
  TimePoint now{};
  clock.start(now, false);
  double at_corner = 0, on_the_way = 0;
  while (clock.passed() < course->duration()) {
    now += step;
    clock.advance(now);
    if (std::abs(clock.passed() - course->leg(1).begin) < 2 * step_s) at_corner = clock.rate();
    on_the_way = std::max(on_the_way, clock.rate());
  }
  EXPECT_EQ(on_the_way, 2);
  EXPECT_NEAR(at_corner * 2.0, most, 0.05);
}

TEST(CourseClock, TakesTheTimeThatTheRateSays) {
  path_file::Path path{{"X", "Y"}, {}, {}};
  path.elements = {path_file::LineTo{{20, 0}, 10.0, {}, 1}, path_file::Dwell{0.7, 2},
                   path_file::LineTo{{40, 4}, 10.0, {}, 3}, path_file::Dwell{0.3, 4}};
  PathLimits limits;
  limits.axes = 2;
  limits.axis.fill({20, 100});
  const auto course = Course::of(path, limits);
  ASSERT_TRUE(course);
  EXPECT_NEAR(course->resting_after(0), 1, 1e-12);
  EXPECT_NEAR(course->resting_after(course->duration() - 0.1), 0.1, 1e-9);
  for (const double factor : {0.1, 0.25, 0.5, 1.0}) {
    CourseClock clock(*course);
    clock.set_ramp(clock_ramp_s);
    clock.set_factor(factor);
    clock.start({}, false);
    const double moving = course->duration() - 1;
    const double wanted = moving / factor + 1;
    EXPECT_NEAR(clock.time_between(0, course->duration()), wanted, 1e-9);
    const auto nearly =
        std::chrono::duration_cast<Duration>(std::chrono::duration<double>(wanted - 1e-6));
    EXPECT_LT(clock.passed_in(nearly), course->duration()) << factor;
    EXPECT_NEAR(clock.passed_in(nearly), course->duration(), 2e-6) << factor;
  }
}

// What stands in a dwell does so for the rest of it.
TEST(CourseClock, StandsInAPauseAndGoesOnWhereItStood) {
  path_file::Path path{{"X"}, {}, {}};
  path.elements = {path_file::LineTo{{20}, 10.0, {}, 1}, path_file::Dwell{1, 2},
                   path_file::LineTo{{40}, 10.0, {}, 3}};
  PathLimits limits;
  limits.axes = 1;
  limits.axis.fill({20, 100});
  const auto course = Course::of(path, limits);
  ASSERT_TRUE(course);
  for (const double at : {0.5, course->leg(0).end + 0.4}) {
    CourseClock clock(*course);
    clock.set_ramp(clock_ramp_s);
    TimePoint now{};
    clock.start(now, false);
    now += std::chrono::duration_cast<Duration>(std::chrono::duration<double>(at));
    clock.advance(now);
    clock.pause(true);
    now += std::chrono::milliseconds(200);
    clock.advance(now);
    EXPECT_EQ(clock.rate(), 0);
    const double stands = clock.passed();
    EXPECT_LT(stands - at, clock_ramp_s);
    now += std::chrono::hours(1);
    clock.advance(now);
    EXPECT_EQ(clock.passed(), stands);
    clock.pause(false);
    now += std::chrono::seconds(10);
    clock.advance(now);
    EXPECT_GT(clock.passed(), course->duration());
  }
}

}  // namespace
}  // namespace tmcl::plan
