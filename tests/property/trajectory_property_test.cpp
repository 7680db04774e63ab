// Time-optimal movements between random states: what holds for all of them, and that nothing is
// faster.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <string>

#include "support/rounds.hpp"
#include "support/seed.hpp"
#include "tmcl/plan/trajectory.hpp"

namespace tmcl::plan {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr int usual_rounds = 20'000;

class Numbers {
 public:
  explicit Numbers(std::uint64_t seed) : random_(seed) {}

  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  bool one_in(int n) { return std::uniform_int_distribution<int>(1, n)(random_) == 1; }
  // Of all sizes within three decades.
  double magnitude() { return std::pow(10, between(-1.5, 1.5)); }
  // -limit..limit, and often what is special about that.
  double within(double limit) {
    if (one_in(6)) return 0;
    if (one_in(10)) return one_in(2) ? limit : -limit;
    return between(-limit, limit);
  }

 private:
  std::mt19937_64 random_;
};

// What an acceleration may be, in whichever direction the movement goes.
struct Box {
  double velocity;
  double low;
  double high;
  double jerk;

  Limits limits(bool backwards) const {
    return backwards ? Limits{velocity, -low, high, jerk} : Limits{velocity, high, -low, jerk};
  }
};

Box any_box(Numbers& random, bool with_jerk) {
  const double high = random.magnitude();
  return {random.magnitude(), random.one_in(3) ? -high : -random.magnitude(), high,
          with_jerk ? random.magnitude() : infinity};
}

// What the velocity was or will be without acceleration, at the greatest jerk.
double eventual(double velocity, double acceleration, double jerk) {
  return velocity + acceleration * std::abs(acceleration) / 2 / jerk;
}

State state_within(Numbers& random, const Box& box) {
  for (;;) {
    State state;
    state.velocity = random.within(box.velocity);
    if (std::isinf(box.jerk)) return state;
    state.acceleration = std::clamp(random.within(std::max(-box.low, box.high)), box.low, box.high);
    const double limit = box.velocity;
    if (std::abs(eventual(state.velocity, state.acceleration, box.jerk)) <= limit) return state;
  }
}

bool goes_backwards(const State& start, const State& target) {
  const double distance = target.position - start.position;
  for (const double value : {distance, target.velocity, start.velocity, start.acceleration}) {
    if (value != 0) return value < 0;
  }
  return false;
}

struct Case {
  Box box;
  State start;
  State target;

  Limits limits() const { return box.limits(goes_backwards(start, target)); }
  tl::expected<Trajectory, Fault> plan() const { return plan_move(start, target, limits()); }
};

Case any_case(Numbers& random, bool with_jerk) {
  Case c{any_box(random, with_jerk), {}, {}};
  c.start = state_within(random, c.box);
  c.target = random.one_in(3) ? State{} : state_within(random, c.box);
  // That is a state to leave from; in a mirror of time it is one to arrive at.
  c.target.acceleration = -c.target.acceleration;
  c.target.acceleration = std::clamp(c.target.acceleration, c.box.low, c.box.high);
  c.start.position = random.within(random.magnitude());
  c.target.position = random.within(random.magnitude());
  return c;
}

std::string text(const State& state) {
  return "(" + std::to_string(state.position) + ", " + std::to_string(state.velocity) + ", " +
         std::to_string(state.acceleration) + ")";
}

std::string text(const Case& c) {
  const auto limits = c.limits();
  return text(c.start) + " to " + text(c.target) + " within " + std::to_string(limits.velocity) +
         ", " + std::to_string(limits.acceleration) + ", " + std::to_string(limits.deceleration) +
         ", " + std::to_string(limits.jerk);
}

// What positions and velocities are compared with.
struct Scale {
  double position;
  double velocity;
  double acceleration;
};

Scale scale_of(const Trajectory& plan, const Box& box) {
  Scale scale{std::abs(plan.start().position) + std::abs(plan.end().position),
              std::max(box.velocity, std::abs(plan.start().velocity)),
              std::max({box.high, -box.low, std::abs(plan.start().acceleration)})};
  for (std::size_t i = 0; i < plan.phases(); ++i) {
    scale.velocity = std::max(scale.velocity, std::abs(plan.phase(i).start.velocity));
  }
  scale.position += scale.velocity * plan.duration();
  return scale;
}

void expect_near(const State& found, const State& expected, const Scale& scale, double share) {
  EXPECT_NEAR(found.position, expected.position, share * scale.position);
  EXPECT_NEAR(found.velocity, expected.velocity, share * scale.velocity);
  EXPECT_NEAR(found.acceleration, expected.acceleration, share * scale.acceleration);
}

// Where one phase ends the next one begins; the last one ends at the target.
void expect_continuous(const Trajectory& plan, const Box& box) {
  constexpr double share = 1e-9;
  const auto scale = scale_of(plan, box);
  const bool jumps = std::isinf(box.jerk);
  State state{0, plan.start().velocity, plan.start().acceleration};
  double time = 0;
  for (std::size_t i = 0; i < plan.phases(); ++i) {
    const auto& phase = plan.phase(i);
    EXPECT_GT(phase.duration, 0);
    EXPECT_NEAR(phase.begin, time, 1e-12 * plan.duration());
    if (jumps) state.acceleration = phase.start.acceleration;
    expect_near(phase.start, state, scale, share);
    state = phase.after(phase.duration);
    time += phase.duration;
  }
  auto end = plan.end();
  end.position -= plan.start().position;
  if (jumps) end.acceleration = state.acceleration;
  if (plan.duration() > 0) expect_near(state, end, scale, share);
  EXPECT_NEAR(plan.duration(), time, 1e-12 * time);
}

// Simpson's rule is exact for the velocity within a phase.
void expect_integrals(const Trajectory& plan, const Box& box) {
  double way = 0, change = 0;
  for (std::size_t i = 0; i < plan.phases(); ++i) {
    const auto& phase = plan.phase(i);
    const double t = phase.duration;
    const auto begin = plan.at(phase.begin);
    const auto middle = plan.at(phase.begin + t / 2);
    const auto end = phase.after(t);
    way += t / 6 * (begin.velocity + 4 * middle.velocity + end.velocity);
    change += t * middle.acceleration;
  }
  const auto scale = scale_of(plan, box);
  EXPECT_NEAR(way, plan.end().position - plan.start().position, 1e-9 * scale.position);
  EXPECT_NEAR(change, plan.end().velocity - plan.start().velocity, 1e-9 * scale.velocity);
}

// The greatest velocity within a phase is at its ends or where the acceleration passes zero.
double greatest_speed(const Phase& phase) {
  double speed =
      std::max(std::abs(phase.start.velocity), std::abs(phase.after(phase.duration).velocity));
  const double turn = -phase.start.acceleration / phase.jerk;
  if (turn > 0 && turn < phase.duration) {
    speed = std::max(speed, std::abs(phase.after(turn).velocity));
  }
  return speed;
}

void expect_within(const Trajectory& plan, const Box& box) {
  constexpr double a_little = 1 + 1e-9;
  for (std::size_t i = 0; i < plan.phases(); ++i) {
    const auto& phase = plan.phase(i);
    EXPECT_LE(greatest_speed(phase), box.velocity * a_little);
    for (const double t : {0.0, phase.duration}) {
      const double a = phase.after(t).acceleration;
      EXPECT_LE(a, box.high * a_little);
      EXPECT_GE(a, box.low * a_little);
    }
    EXPECT_LE(std::abs(phase.jerk), box.jerk);
  }
}

TEST(TrajectoryProperty, LeadsToTheTargetWithinTheLimits) {
  Numbers random(tmcl::test::seed());
  for (int round = 0; round < tmcl::test::rounds(usual_rounds); ++round) {
    const auto c = any_case(random, !random.one_in(4));
    SCOPED_TRACE("round " + std::to_string(round) + ": " + text(c));
    const auto plan = c.plan();
    ASSERT_TRUE(plan.has_value()) << describe(plan.error());
    EXPECT_EQ(plan->at(plan->duration()), c.target);
    expect_continuous(*plan, c.box);
    expect_integrals(*plan, c.box);
    expect_within(*plan, c.box);
    if (testing::Test::HasFailure()) return;
  }
}

TEST(TrajectoryProperty, LeadsToTheTargetFromBeyondTheLimits) {
  Numbers random(tmcl::test::seed());
  for (int round = 0; round < tmcl::test::rounds(usual_rounds); ++round) {
    auto c = any_case(random, !random.one_in(4));
    c.start.velocity += random.within(3 * c.box.velocity);
    if (!std::isinf(c.box.jerk)) c.start.acceleration += random.within(c.box.high);
    SCOPED_TRACE("round " + std::to_string(round) + ": " + text(c));
    const auto plan = c.plan();
    if (!plan) {  // another sign of the start acceleration may be another direction
      EXPECT_EQ(plan.error(), Fault::target_acceleration);
      continue;
    }
    expect_continuous(*plan, c.box);
    expect_integrals(*plan, c.box);
    if (testing::Test::HasFailure()) return;
  }
}

// A speed above the limit never grows further; once inside, it stays there.
TEST(TrajectoryProperty, SpeedAboveTheLimitOnlyFalls) {
  Numbers random(tmcl::test::seed());
  for (int round = 0; round < tmcl::test::rounds(usual_rounds); ++round) {
    auto c = any_case(random, !random.one_in(4));
    c.start.acceleration = 0;
    c.start.velocity *= random.between(1, 3);
    SCOPED_TRACE("round " + std::to_string(round) + ": " + text(c));
    const auto plan = c.plan();
    ASSERT_TRUE(plan.has_value());
    double most = std::max(c.box.velocity, std::abs(c.start.velocity)) * (1 + 1e-9);
    for (std::size_t i = 0; i < plan->phases(); ++i) {
      const double speed = greatest_speed(plan->phase(i));
      EXPECT_LE(speed, most);
      most = std::max(c.box.velocity,
                      std::abs(plan->phase(i).after(plan->phase(i).duration).velocity)) *
             (1 + 1e-9);
    }
    if (testing::Test::HasFailure()) return;
  }
}

TEST(TrajectoryProperty, FromRestToRestIsSymmetricInTime) {
  Numbers random(tmcl::test::seed());
  for (int round = 0; round < tmcl::test::rounds(usual_rounds); ++round) {
    Case c{any_box(random, !random.one_in(4)), {}, {}};
    c.box.low = -c.box.high;
    c.target.position = random.within(random.magnitude());
    SCOPED_TRACE("round " + std::to_string(round) + ": " + text(c));
    const auto plan = c.plan();
    ASSERT_TRUE(plan.has_value());
    const double t = random.between(0, plan->duration());
    EXPECT_NEAR(plan->at(plan->duration() - t).position, c.target.position - plan->at(t).position,
                1e-9 * std::abs(c.target.position));
    if (testing::Test::HasFailure()) return;
  }
}

// How long it takes from rest to a speed, and how far it leads.
struct Ramp {
  double time;
  double distance;
};

Ramp ramp(double speed, double acceleration, double jerk) {
  const double limit = acceleration * acceleration / jerk;
  const double time =
      speed < limit ? 2 * std::sqrt(speed / jerk) : speed / acceleration + acceleration / jerk;
  return {time, speed * time / 2};
}

// Over the greatest speeds of all sizes: none is faster, and the fastest is about as fast.
TEST(TrajectoryProperty, FromRestToRestNoGreatestSpeedIsFaster) {
  constexpr int speeds = 2000;
  Numbers random(tmcl::test::seed());
  for (int round = 0; round < tmcl::test::rounds(usual_rounds) / 100; ++round) {
    Case c{any_box(random, !random.one_in(4)), {}, {}};
    c.target.position = random.magnitude();
    SCOPED_TRACE("round " + std::to_string(round) + ": " + text(c));
    const auto plan = c.plan();
    ASSERT_TRUE(plan.has_value());
    double best = infinity;
    for (int i = 0; i <= speeds; ++i) {
      const double speed = c.box.velocity * std::pow(10, -6.0 * i / speeds);
      const auto up = ramp(speed, c.box.high, c.box.jerk);
      const auto down = ramp(speed, -c.box.low, c.box.jerk);
      const double rest = c.target.position - up.distance - down.distance;
      if (rest >= 0) best = std::min(best, up.time + rest / speed + down.time);
    }
    EXPECT_LE(plan->duration(), best * (1 + 1e-9));
    EXPECT_GE(plan->duration(), best * (1 - 1e-2));
    if (testing::Test::HasFailure()) return;
  }
}

// A movement that keeps to the limits: to one acceleration after the other, each kept for a while.
struct Wanderer {
  State state;
  double time = 0;

  // False if that led beyond the greatest velocity.
  bool wander(Numbers& random, const Box& box, double size) {
    const double a = random.one_in(3)   ? 0
                     : random.one_in(2) ? random.between(box.low, box.high)
                     : random.one_in(2) ? box.low
                                        : box.high;
    auto moved = *this;
    const double change = a - state.acceleration;
    const double rate = random.one_in(3) ? random.between(0.1, 1) * box.jerk : box.jerk;
    const bool in_limits =
        (std::isinf(box.jerk) ||
         moved.phase(std::abs(change) / rate, std::copysign(rate, change), box)) &&
        (moved.state.acceleration = a, moved.phase(random.between(0, size), 0, box));
    if (in_limits) *this = moved;
    return in_limits;
  }

  bool phase(double t, double jerk, const Box& box) {
    const Phase phase{time, t, state, jerk};
    if (greatest_speed(phase) > box.velocity) return false;
    state = phase.after(t);
    time += t;
    return true;
  }
};

Wanderer wandered(Numbers& random, const Box& box, const State& start) {
  Wanderer wanderer{start};
  const double size = random.magnitude() * box.velocity / std::max(box.high, -box.low);
  for (int steps = 1 + static_cast<int>(random.between(0, 6)); steps > 0; --steps) {
    for (int tries = 0; tries < 20 && !wanderer.wander(random, box, size); ++tries) continue;
  }
  return wanderer;
}

// What the last bits of the target may do to the time: a change of velocity within a jerk takes the
// square root of it.
double blur(double time, const Box& box) {
  const double ramp = box.velocity / std::min(box.high, -box.low);
  return 1e-6 * (time + std::sqrt(box.velocity / box.jerk)) + 1e-12 * ramp;
}

TEST(TrajectoryProperty, NothingWithinTheLimitsIsFaster) {
  Numbers random(tmcl::test::seed());
  int compared = 0;
  for (int round = 0; round < tmcl::test::rounds(usual_rounds); ++round) {
    const auto box = any_box(random, !random.one_in(4));
    const auto start = state_within(random, box);
    const auto other = wandered(random, box, start);
    const Case c{box, start, other.state};
    SCOPED_TRACE("round " + std::to_string(round) + ": " + text(c));
    const auto plan = c.plan();
    if (!plan) {  // the start may have been on the way to the target already
      EXPECT_EQ(plan.error(), Fault::target_not_entered);
      continue;
    }
    ++compared;
    EXPECT_LE(plan->duration(), other.time + blur(other.time, box)) << text(other.state);
    if (testing::Test::HasFailure()) return;
  }
  EXPECT_GT(compared, tmcl::test::rounds(usual_rounds) / 2);
}

TEST(TrajectoryProperty, NothingWithinTheLimitsComesFasterToAVelocity) {
  Numbers random(tmcl::test::seed());
  for (int round = 0; round < tmcl::test::rounds(usual_rounds); ++round) {
    auto box = any_box(random, !random.one_in(4));
    box.low = -box.high;
    const auto start = state_within(random, box);
    auto other = wandered(random, box, start);
    if (!std::isinf(box.jerk)) {
      const double a = other.state.acceleration;
      if (!other.phase(std::abs(a) / box.jerk, std::copysign(box.jerk, -a), box)) continue;
    }
    SCOPED_TRACE("round " + std::to_string(round) + ": " + text(start) + " to " +
                 std::to_string(other.state.velocity));
    const auto plan = plan_velocity(start, other.state.velocity, box.limits(false));
    ASSERT_TRUE(plan.has_value());
    EXPECT_LE(plan->duration(), other.time + blur(other.time, box));
    expect_continuous(*plan, box);
    expect_integrals(*plan, box);
    expect_within(*plan, box);
    if (testing::Test::HasFailure()) return;
  }
}

// What is left of the fastest movement is the fastest one from there.
TEST(TrajectoryProperty, PlannedAgainOnTheWayItIsTheSame) {
  Numbers random(tmcl::test::seed());
  for (int round = 0; round < tmcl::test::rounds(usual_rounds); ++round) {
    auto c = any_case(random, !random.one_in(4));
    c.box.low = -c.box.high;
    c.start.acceleration = c.target.acceleration = c.target.velocity = 0;
    SCOPED_TRACE("round " + std::to_string(round) + ": " + text(c));
    const auto plan = c.plan();
    ASSERT_TRUE(plan.has_value());
    const double t = random.between(0, 0.9) * plan->duration();
    const auto rest = plan_move(plan->at(t), c.target, c.limits());
    ASSERT_TRUE(rest.has_value());
    EXPECT_NEAR(rest->duration() + t, plan->duration(), 1e-4 * plan->duration()) << t;
    if (testing::Test::HasFailure()) return;
  }
}

}  // namespace
}  // namespace tmcl::plan
