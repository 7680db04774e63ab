// What holds for every value, every divider and every wish.
#include <cmath>

#include <gtest/gtest.h>

#include "support/random.hpp"
#include "support/seed.hpp"
#include "tmcl/conversion.hpp"
#include "tmcl/ramp/tmc429.hpp"

namespace tmcl::test {
namespace {

constexpr int wishes = 20'000;

// The same by going through everything.
struct Plain {
  bool found = false;
  double velocity_error = 0;
  double acceleration_error = 0;
};

Plain plain_choice(double velocity, double acceleration) {
  Plain best;
  for (int pulse = 0; pulse <= 13; ++pulse) {
    for (int ramp = 0; ramp <= 13; ++ramp) {
      const double velocity_unit = 16e6 / std::exp2(pulse + 16);
      const double acceleration_unit = 256e12 / std::exp2(pulse + ramp + 29);
      const double v = std::round(velocity / velocity_unit);
      const double a = std::round(acceleration / acceleration_unit);
      const double exponent = ramp - pulse;
      if (v < 1 || v > 2047 || a < 1 || a > 2047) continue;
      if (a < std::exp2(exponent - 1) || a > std::exp2(exponent + 12) - 1) continue;
      const auto v_error = std::abs(v * velocity_unit - velocity);
      const auto a_error = std::abs(a * acceleration_unit - acceleration);
      const auto better =
          std::pair(v_error, a_error) < std::pair(best.velocity_error, best.acceleration_error);
      if (!best.found || better) best = {true, v_error, a_error};
    }
  }
  return best;
}

bool generator_finds_nothing_wrong_with(const Tmc429Ramp& ramp) {
  using Register = ramp::Tmc429::Register;
  ramp::Tmc429 chip;
  chip.write(Register::v_min, 1);
  chip.write(Register::pulse_div, ramp.dividers.pulse);
  chip.write(Register::ramp_div, ramp.dividers.ramp);
  chip.write(Register::v_max, ramp.v_max.value);
  return chip.write(Register::a_max, ramp.a_max.value) && chip.findings().empty();
}

double of_any_size(Random<>& random, double least, double greatest) {
  const auto share = static_cast<double>(random.between(0, 1'000'000)) / 1e6;
  return least * std::pow(greatest / least, share);
}

TEST(ConversionProperty, EveryWishIsMetAsWellAsItCanBe) {
  Random random(seed());
  int met = 0;
  for (int i = 0; i < wishes; ++i) {
    const auto velocity = of_any_size(random, 0.01, 1e6);
    const auto acceleration = of_any_size(random, 0.001, 1e10);
    const auto plain = plain_choice(velocity, acceleration);
    const auto ramp = choose_tmc429_ramp({velocity}, {acceleration});
    ASSERT_EQ(ramp.has_value(), plain.found) << velocity << ' ' << acceleration;
    if (!ramp) continue;
    ++met;
    const auto v_error = std::abs(ramp->velocity().value - velocity);
    const auto a_error = std::abs(ramp->acceleration().value - acceleration);
    ASSERT_EQ(v_error, plain.velocity_error) << velocity << ' ' << acceleration;
    ASSERT_EQ(a_error, plain.acceleration_error) << velocity << ' ' << acceleration;
    // Half a register unit.
    ASSERT_LE(v_error / velocity, 0.5 / (ramp->v_max.value - 0.5) * (1 + 1e-12));
    ASSERT_LE(a_error / acceleration, 0.5 / (ramp->a_max.value - 0.5) * (1 + 1e-12));
    ASSERT_TRUE(generator_finds_nothing_wrong_with(*ramp)) << velocity << ' ' << acceleration;
  }
  EXPECT_GT(met, wishes / 10);
  EXPECT_LT(met, wishes);
}

TEST(ConversionProperty, WhatARefusalNamesCanBeHadAndNothingNearer) {
  Random random(seed());
  for (int i = 0; i < wishes; ++i) {
    const auto velocity = of_any_size(random, 0.01, 1e6);
    const auto acceleration = of_any_size(random, 0.001, 1e10);
    const auto ramp = choose_tmc429_ramp({velocity}, {acceleration});
    if (ramp || ramp.error().is_velocity()) continue;
    const auto nearest = ramp.error().nearest;
    ASSERT_TRUE(choose_tmc429_ramp({velocity}, {nearest})) << velocity << ' ' << nearest;
    for (const auto share : {0.25, 0.5, 0.9}) {
      const auto between = nearest + (acceleration - nearest) * share;
      const auto chosen = choose_tmc429_ramp({velocity}, {between});
      if (!chosen) continue;
      ASSERT_NEAR(chosen->acceleration().value, nearest, nearest * 1e-9);
    }
  }
}

TEST(ConversionProperty, AnAchievableWishIsMetExactly) {
  Random random(seed());
  for (int i = 0; i < wishes; ++i) {
    const Tmc429Dividers dividers{static_cast<std::uint8_t>(random.between(0, 13)),
                                  static_cast<std::uint8_t>(random.between(0, 13))};
    const auto range = tmc429_acceleration_range(dividers);
    if (range.least > range.greatest) continue;
    const InternalVelocity v{static_cast<std::int32_t>(random.between(1, 2047))};
    const InternalAcceleration a{
        static_cast<std::int32_t>(random.between(range.least, range.greatest))};
    const auto ramp = choose_tmc429_ramp(to_pps(v, dividers), to_pps2(a, dividers));
    ASSERT_TRUE(ramp);
    ASSERT_EQ(ramp->velocity(), to_pps(v, dividers));
    ASSERT_EQ(ramp->acceleration(), to_pps2(a, dividers));
  }
}

TEST(ConversionProperty, EveryRegisterValueComesBack) {
  for (std::uint8_t pulse = 0; pulse <= 13; ++pulse) {
    for (std::uint8_t ramp = 0; ramp <= 13; ++ramp) {
      const auto units = module_units(Tmc429Dividers{pulse, ramp});
      for (std::int32_t value = -2047; value <= 2047; ++value) {
        const InternalVelocity v{value};
        const InternalAcceleration a{value};
        ASSERT_EQ(to_internal(to_pps(v, units), units).value(), v);
        ASSERT_EQ(to_internal(to_pps2(a, units), units).value(), a);
      }
    }
  }
  Random random(seed());
  for (const int number : {142, 6212}) {
    const auto& model = *find_model(static_cast<std::uint16_t>(number));
    for (std::int32_t mode = 0; mode <= 1; ++mode) {
      const auto units = module_units(model, std::array{mode}).value();
      for (int i = 0; i < wishes; ++i) {
        const auto value = static_cast<std::int32_t>(random.either_way(random.any_size(INT32_MAX)));
        const InternalVelocity v{value};
        const InternalAcceleration a{value};
        ASSERT_EQ(to_internal(to_pps(v, units), units).value(), v);
        ASSERT_EQ(to_internal(to_pps2(a, units), units).value(), a);
      }
    }
  }
}

TEST(ConversionProperty, EveryPositionComesBackThroughEveryScale) {
  Random random(seed());
  for (int i = 0; i < wishes; ++i) {
    const UserScale scale{"mm",
                          of_any_size(random, 1e-6, 1e6),
                          random.one_in(2),
                          {static_cast<std::int32_t>(random.positive(max_full_steps)),
                           static_cast<std::int32_t>(random.between(0, 8))}};
    const Microsteps at{static_cast<std::int32_t>(random.either_way(random.any_size(INT32_MAX)))};
    ASSERT_EQ(to_microsteps(to_user(at, scale), scale).value(), at);
    const PulsesPerSecond speed{of_any_size(random, 1e-3, 1e6)};
    ASSERT_NEAR(to_pps(to_user(speed, scale), scale).value, speed.value, speed.value * 1e-14);
  }
}

}  // namespace
}  // namespace tmcl::test
