// A load that swings, found again in positions with noise, read at uneven times.
#include "tmcl/plan/ring_down.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "support/random.hpp"
#include "support/rounds.hpp"
#include "support/seed.hpp"

namespace tmcl::plan {
namespace {

class Scene : public tmcl::test::Random<std::int64_t> {
 public:
  explicit Scene(std::uint64_t seed) : Random(seed) {
    count = static_cast<std::size_t>(between(100, 500));
    interval_s = part(1, 20) / 1000;
    jitter = part(0, 0.4);
    const double span_s = interval_s * static_cast<double>(count);
    const double highest = 0.8 / (2.5 * interval_s);
    resonance.frequency_hz = 4 / span_s * std::pow(highest * span_s / 4, part(0, 1));
    resonance.damping = part(0.002, 0.15);
    swing = part(10, 10'000);
    noise = part(0, 0.05) * swing;
    phase = part(0, 2 * std::numbers::pi);
    rest = part(-1e6, 1e6);
  }

  double part(double least, double greatest) {
    constexpr std::int64_t fine = 1'000'000;
    return least + (greatest - least) * static_cast<double>(between(0, fine)) / fine;
  }
  /// To either side, at most `noise`.
  double some_noise() { return part(-noise, noise); }

  std::vector<PositionAt> positions() {
    const double w = 2 * std::numbers::pi * resonance.frequency_hz;
    const double really = w * std::sqrt(1 - resonance.damping * resonance.damping);
    const double begin = part(0, 1000);
    std::vector<PositionAt> all;
    for (std::size_t i = 0; i < count; ++i) {
      const double t = (static_cast<double>(i) + part(-jitter, jitter)) * interval_s;
      const double swings =
          swing * std::exp(-resonance.damping * w * t) * std::cos(really * t + phase);
      all.push_back({begin + t, rest + swings + some_noise()});
    }
    return all;
  }

  std::size_t count;
  double interval_s;
  double jitter;
  ramp::Resonance resonance;
  double swing;
  double noise;
  double phase;
  double rest;
};

TEST(RingDownProperty, FindsFrequencyAndDampingAgain) {
  const auto first = tmcl::test::seed();
  for (auto seed = first; seed < first + static_cast<std::uint64_t>(tmcl::test::rounds(200));
       ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Scene scene(seed);
    const auto found = ring_down(scene.positions());
    const auto& expected = scene.resonance;
    ASSERT_EQ(found.verdict, RingDown::Verdict::rings)
        << expected.frequency_hz << " Hz, " << found.confidence;
    ASSERT_NEAR(found.resonance.frequency_hz, expected.frequency_hz, 0.02 * expected.frequency_hz);
    ASSERT_NEAR(found.resonance.damping, expected.damping, 0.01 + 0.1 * expected.damping);
    ASSERT_GT(found.highest_hz, expected.frequency_hz);
    ASSERT_LT(found.lowest_hz, expected.frequency_hz);
    if (scene.noise == 0) {
      ASSERT_NEAR(found.swing, scene.swing, 0.01 * scene.swing);
    }
  }
}

TEST(RingDownProperty, NoiseDoesNotRing) {
  const auto first = tmcl::test::seed();
  for (auto seed = first; seed < first + static_cast<std::uint64_t>(tmcl::test::rounds(200));
       ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Scene scene(seed);
    scene.swing = 0;
    scene.noise = 100;
    ASSERT_EQ(ring_down(scene.positions()).verdict, RingDown::Verdict::unclear);
  }
}

// Read at even times it would look like a slower one; what is read at other times tells.
TEST(RingDownProperty, TwoReadingsDoNotAgreeOnWhatOnlyLooksSo) {
  const auto first = tmcl::test::seed();
  for (auto seed = first; seed < first + static_cast<std::uint64_t>(tmcl::test::rounds(50));
       ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Scene scene(seed);
    const bool looks_slower = scene.one_in(2);
    const double swings = looks_slower ? scene.part(1.05, 1.35) : scene.part(0.05, 0.3);
    scene.resonance.frequency_hz = swings / scene.interval_s;
    scene.resonance.damping = scene.part(0.001, 0.004) / swings;
    scene.noise = 0;
    scene.jitter = 0;
    const auto found = ring_down(scene.positions());
    ASSERT_EQ(found.verdict, RingDown::Verdict::rings);
    scene.jitter = 0.4;
    ASSERT_EQ(explains(found.resonance, scene.positions()), !looks_slower) << swings;
  }
}

// Faster than they are read: with uneven times it does not look like a slower one.
TEST(RingDownProperty, WhatIsTooFastIsNotTakenForSomethingSlower) {
  const auto first = tmcl::test::seed();
  for (auto seed = first; seed < first + static_cast<std::uint64_t>(tmcl::test::rounds(200));
       ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Scene scene(seed);
    scene.jitter = 0.4;
    const double swings = scene.part(1.1, 20);  // from one position to the next
    scene.resonance.frequency_hz = swings / scene.interval_s;
    scene.resonance.damping = scene.part(0.001, 0.01) / swings;
    const auto found = ring_down(scene.positions());
    ASSERT_NE(found.verdict, RingDown::Verdict::rings) << swings << ' ' << found.confidence;
  }
}

TEST(RingDown, OfWhatStandsIsStill) {
  std::vector<PositionAt> positions;
  for (int i = 0; i < 100; ++i) positions.push_back({i * 0.01, 50});
  EXPECT_EQ(ring_down(positions).verdict, RingDown::Verdict::still);
  for (int i = 50; i < 100; ++i) positions[static_cast<std::size_t>(i)].position += i % 2;
  EXPECT_EQ(ring_down(positions).verdict, RingDown::Verdict::still) << "between two counts";
}

TEST(RingDown, OfFewPositionsIsNotKnown) {
  EXPECT_EQ(ring_down({}).verdict, RingDown::Verdict::too_few);
  std::vector<PositionAt> positions(least_ring_down_positions - 1);
  EXPECT_EQ(ring_down(positions).verdict, RingDown::Verdict::too_few);
  positions.resize(100);
  EXPECT_EQ(ring_down(positions).verdict, RingDown::Verdict::too_few) << "all at one time";
}

TEST(RingDown, TellsWhatItCanSee) {
  std::vector<PositionAt> positions;
  for (int i = 0; i <= 200; ++i) positions.push_back({i * 0.005, std::cos(i * 0.3)});
  const auto found = ring_down(positions);
  EXPECT_NEAR(found.lowest_hz, 1, 1e-9);
  EXPECT_NEAR(found.highest_hz, 80, 1e-9);
  EXPECT_NEAR(found.resonance.frequency_hz, 0.3 / 0.005 / (2 * std::numbers::pi), 1e-3);
}

}  // namespace
}  // namespace tmcl::plan
