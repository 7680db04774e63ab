// A load that swings behind a motor: against the equation itself, and what is known of it.
#include "tmcl/ramp/resonant_load.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/random.hpp"
#include "support/seed.hpp"

namespace tmcl::ramp {
namespace {

constexpr double turn = 2 * std::numbers::pi;

/// r'' = -a - 2 d w r' - w^2 r in steps so small that the method does not matter.
struct InSmallSteps {
  Resonance resonance;
  double offset = 0;
  double speed = 0;

  double change(double r, double v, double a) const {
    const double w = turn * resonance.frequency_hz;
    return -a - 2 * resonance.damping * w * v - w * w * r;
  }
  void advance(double seconds, double a) {
    const int steps = 2000;
    const double h = seconds / steps;
    for (int i = 0; i < steps; ++i) {
      // The midpoint rule.
      const double v = speed + h / 2 * change(offset, speed, a);
      const double r = offset + h / 2 * speed;
      offset += h * v;
      speed += h * change(r, v, a);
    }
  }
};

TEST(ResonantLoad, ObeysItsEquationWhateverTheMotorDoes) {
  tmcl::test::Random<> random(tmcl::test::seed());
  for (int round = 0; round < 50; ++round) {
    const Resonance resonance{static_cast<double>(random.between(1, 500)) / 10,
                              static_cast<double>(random.between(0, 90)) / 100};
    ResonantLoad load(resonance);
    InSmallSteps expected{resonance};
    for (int i = 0; i < 8; ++i) {
      const auto seconds =
          static_cast<double>(random.between(1, 1000)) / 1000 / resonance.frequency_hz;
      const auto acceleration = static_cast<double>(random.between(-1000, 1000));
      load.advance(seconds, acceleration);
      expected.advance(seconds, acceleration);
      const double scale = 1000 / std::pow(turn * resonance.frequency_hz, 2);
      ASSERT_NEAR(load.offset(), expected.offset, 1e-4 * scale);
      ASSERT_NEAR(load.speed(), expected.speed, 1e-4 * scale * turn * resonance.frequency_hz);
    }
  }
}

TEST(ResonantLoad, StandsAfterAPushThatLastsOneSwing) {
  ResonantLoad load({12, 0});
  load.advance(1. / 12, 500);
  EXPECT_NEAR(load.swing(), 0, 1e-9);
  EXPECT_EQ(load.time_to_settle(1e-6), 0);
  // Half a swing is the worst: twice as far as it hangs back under the acceleration.
  load.advance(0.5 / 12, 500);
  EXPECT_NEAR(load.swing(), 2 * 500 / std::pow(turn * 12, 2), 1e-9);
  EXPECT_FALSE(load.time_to_settle(1e-6)) << "nothing damps it";
}

TEST(ResonantLoad, SwingsByTheSpeedThatIsTakenAtOnce) {
  ResonantLoad load({12, 0});
  load.jump(300);
  EXPECT_EQ(load.offset(), 0);
  EXPECT_NEAR(load.swing(), 300 / (turn * 12), 1e-9);
  load.advance(0.25 / 12, 0);
  EXPECT_NEAR(load.offset(), -300 / (turn * 12), 1e-9) << "it comes later";
}

TEST(ResonantLoad, IsSettledWhenItSaysSo) {
  for (const double damping : {0.01, 0.05, 0.5}) {
    ResonantLoad load({8, damping});
    load.advance(0.03, 2000);
    const double tolerance = load.swing() / 50;
    const auto wait = load.time_to_settle(tolerance);
    ASSERT_TRUE(wait);
    auto early = load;
    early.advance(*wait * 0.95, 0);
    EXPECT_GT(early.swing(), tolerance);
    load.advance(*wait * 1.0001, 0);
    EXPECT_LE(load.swing(), tolerance);
    for (int i = 0; i < 100; ++i) {
      load.advance(0.01, 0);
      EXPECT_LE(std::abs(load.offset()), tolerance);
    }
  }
}

}  // namespace
}  // namespace tmcl::ramp
