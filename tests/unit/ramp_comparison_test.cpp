// Ramps beside each other, and the load that swings behind them: against a search that looks at the
// motor at every instant and adds the load up in small steps.
#include "tmcl/plan/ramp_comparison.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "support/random.hpp"
#include "support/seed.hpp"
#include "tmcl/conversion.hpp"
#include "tmcl/jerk.hpp"
#include "tmcl/plan/ramp_wish.hpp"

namespace tmcl::plan {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

std::vector<Setting> settings_of(const Model& model, double velocity, double acceleration) {
  AxisUnits units{"x", &model, initial_units(model)};
  const RampWish wish{{velocity, "pps"}, {acceleration, "pps/s"}};
  return plan_ramp(wish, units, 0).value().choice.settings;
}

std::vector<Setting> with(std::vector<Setting> settings, const std::vector<Setting>& more) {
  settings.insert(settings.end(), more.begin(), more.end());
  return settings;
}

/// The twin of the axis, looked at every few microseconds; the load follows by the midpoint rule.
struct BruteForce {
  static constexpr Duration step = std::chrono::microseconds(50);

  BruteForce(const Model& model, const std::vector<Setting>& settings, Microsteps distance)
      : twin(AxisTwin::of(model).value()) {
    EXPECT_TRUE(twin.set(settings));
    twin.move_to(distance);
    arrival = twin.time_to_arrival();
  }

  /// When it was last farther off than the tolerance, and how far it swings behind the motor.
  void follow(const LoadWish& load) {
    const double h = std::chrono::duration<double>(step).count();
    const double w = 2 * std::numbers::pi * load.resonance.frequency_hz;
    const auto change = [&](double r, double v, double a) {
      return -a - 2 * load.resonance.damping * w * v - w * w * r;
    };
    double offset = 0;
    double speed = 0;
    double before = 0;
    const double end = std::chrono::duration<double>(*arrival).count();
    const double ring = 2 / load.resonance.frequency_hz;
    for (double time = 0; time < end + 40 * ring; time += h) {
      double velocity = 0;
      if (time < end + h) {
        twin.advance(step);
        velocity = twin.motion().velocity.value;
      }
      const double a = (velocity - before) / h;
      before = velocity;
      const double half_speed = speed + h / 2 * change(offset, speed, a);
      const double half_offset = offset + h / 2 * speed;
      offset += h * half_speed;
      speed += h * change(half_offset, half_speed, a);
      if (std::abs(offset) > load.tolerance) settled_s = time + h;
      if (time > end && time < end + ring) swing = std::max(swing, std::abs(offset));
    }
    settled_s = std::max(settled_s, end);
  }

  AxisTwin twin;
  std::optional<Duration> arrival;
  double swing = 0;
  double settled_s = 0;
};

struct Scene {
  const Model* model;
  double velocity;
  double acceleration;
  std::int32_t distance;
  LoadWish load;
};

std::vector<RampVerdict> verdicts_of(const Scene& scene) {
  const auto settings = settings_of(*scene.model, scene.velocity, scene.acceleration);
  std::vector<RampVerdict> verdicts;
  for (const auto& variant : ramp_variants(*scene.model, settings)) {
    const auto move = follow_move(*scene.model, with(settings, variant), {scene.distance});
    EXPECT_TRUE(move);
    verdicts.push_back(judge(*move, scene.load));
  }
  return verdicts;
}

/// As the search sees it, each verdict; and the time of the one that stands first.
double compare_with_search(const Scene& scene, const std::vector<RampVerdict>& verdicts) {
  const auto settings = settings_of(*scene.model, scene.velocity, scene.acceleration);
  const auto variants = ramp_variants(*scene.model, settings);
  const double swing_s = 1 / scene.load.resonance.frequency_hz;
  const double bent = scene.acceleration / std::pow(2 * std::numbers::pi / swing_s, 2);
  double first = 1e9;
  for (std::size_t i = 0; i < variants.size(); ++i) {
    SCOPED_TRACE(i);
    BruteForce search(*scene.model, with(settings, variants[i]), {scene.distance});
    EXPECT_EQ(verdicts[i].seconds.has_value(), search.arrival.has_value());
    if (!search.arrival || !verdicts[i].seconds) continue;
    EXPECT_NEAR(*verdicts[i].seconds, std::chrono::duration<double>(*search.arrival).count(), 1e-6);
    search.follow(scene.load);
    // Between its peaks it is nearer than it swings; in small steps all is late by half of one.
    EXPECT_NEAR(*verdicts[i].swing, search.swing,
                0.02 * bent + (1 - std::exp(-4 * scene.load.resonance.damping)) * search.swing);
    EXPECT_LE(search.settled_s, *verdicts[i].settled_s + 0.02 * swing_s);
    EXPECT_GE(search.settled_s, *verdicts[i].settled_s - 0.75 * swing_s);
    first = std::min(first, search.settled_s);
  }
  return first;
}

TEST(RampComparison, ProposesWhatASearchFinds) {
  tmcl::test::Random<> random(tmcl::test::seed());
  for (const auto* name : {"TMCM-142", "TMCM-6212", "TMCM-1110"}) {
    for (int round = 0; round < 3; ++round) {
      SCOPED_TRACE(testing::Message() << name << ", round " << round);
      Scene scene{find_model(name),
                  static_cast<double>(random.between(20'000, 100'000)),
                  static_cast<double>(random.between(100'000, 1'000'000)),
                  static_cast<std::int32_t>(random.between(5'000, 60'000)),
                  {{static_cast<double>(random.between(40, 300)) / 10,
                    static_cast<double>(random.between(2, 15)) / 100},
                   static_cast<double>(random.between(5, 100))}};
      const auto verdicts = verdicts_of(scene);
      const auto proposed = first_settled(verdicts);
      const double best = compare_with_search(scene, verdicts);
      ASSERT_TRUE(proposed);
      EXPECT_NEAR(*verdicts[*proposed].settled_s, best, 0.8 / scene.load.resonance.frequency_hz);
    }
  }
}

TEST(RampComparison, HasEachBowOfATmc457) {
  const auto* model = find_model("TMCM-142");
  const auto settings = settings_of(*model, 50'000, 500'000);
  const auto variants = ramp_variants(*model, settings);
  ASSERT_THAT(variants, SizeIs(greatest_bow + 1));
  double before = 0;
  for (std::int32_t bow = 0; bow <= greatest_bow; ++bow) {
    const auto move =
        follow_move(*model, with(settings, variants[static_cast<std::size_t>(bow)]), {40'000});
    ASSERT_TRUE(move) << bow;
    EXPECT_TRUE(move->seconds || may_oscillate(bow, {500'000})) << bow;
    EXPECT_FALSE(move->seconds && bow == greatest_bow) << "it swings around its target";
    if (bow == 0 || !move->seconds) continue;
    if (before != 0) {
      EXPECT_LT(*move->seconds, before) << "a higher bow is quicker";
    }
    before = *move->seconds;
    const double longest = bow < 6 ? 0 : 500'000 / to_pps3(bow).value;
    EXPECT_GE(move->longest_phase_s, longest * 0.99) << bow;
  }
}

TEST(RampComparison, OfASixPointGeneratorIsGentlerAtLowSpeed) {
  const auto* model = find_model("TMCM-6212");
  const auto settings = settings_of(*model, 50'000, 500'000);
  const auto variants = ramp_variants(*model, settings);
  ASSERT_THAT(variants, SizeIs(25));
  std::optional<double> trapezoid;
  for (const auto& variant : variants) {
    const auto move = follow_move(*model, with(settings, variant), {40'000});
    ASSERT_TRUE(move && move->seconds);
    if (trapezoid) {
      EXPECT_GT(*move->seconds, *trapezoid);
    } else {
      trapezoid = move->seconds;
    }
    double way = 0;
    double speed = 0;
    for (const auto& [seconds, acceleration, jerk] : move->stretches) {
      way +=
          speed * seconds + acceleration * seconds * seconds / 2 + jerk * std::pow(seconds, 3) / 6;
      speed += acceleration * seconds + jerk * seconds * seconds / 2;
    }
    EXPECT_NEAR(speed, 0, 1e-3);
    EXPECT_NEAR(way, 40'000, 5);
  }
}

TEST(RampComparison, FollowsTheBowsOfATmc4361) {
  const auto* model = find_model("TMCM-1111");
  const auto settings = settings_of(*model, 50'000, 500'000);
  for (const auto& variant : ramp_variants(*model, settings)) {
    const auto move = follow_move(*model, with(settings, variant), {40'000});
    ASSERT_TRUE(move && move->seconds);
    EXPECT_LE(move->top_speed, 50'000.5);
  }
}

TEST(RampComparison, FollowsNoRampThatAModuleDoesNotTake) {
  const auto* model = find_model("TMCM-1110");
  EXPECT_FALSE(follow_move(*model, settings_of(*model, 50'000, 500'000), {9'000'000})) << "24 bits";
  EXPECT_FALSE(follow_move(*model, std::vector<Setting>{{4, 5000}}, {1000}));
  for (const auto& other : models())
    if (other.family == Family::firmware) {
      EXPECT_FALSE(follow_move(other, {}, {1000})) << other.name;
    }
}

TEST(RampComparison, ProposesNothingWhereNoLoadComesToRest) {
  const auto* model = find_model("TMCM-142");
  const auto move = follow_move(*model, settings_of(*model, 50'000, 500'000), {40'000});
  const std::vector verdicts{judge(*move, LoadWish{{7.3, 0}, 0.001}), judge(*move, {})};
  EXPECT_GT(verdicts[0].swing.value(), 1);
  EXPECT_FALSE(verdicts[1].swing);
  EXPECT_FALSE(first_settled(verdicts));
}

}  // namespace
}  // namespace tmcl::plan
