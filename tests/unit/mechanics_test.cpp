// Gears, screws, encoders and soft limits: what a motor drives.
#include <gtest/gtest.h>

#include "tmcl/mechanics.hpp"
#include "tmcl/parameter.hpp"

namespace tmcl {
namespace {

UserScale screw(double pitch, double gear, bool reverse = false) {
  return {"mm", pitch, reverse, {200, 8}, gear};
}

TEST(Mechanics, AGearComesBeforeTheOutput) {
  const auto scale = screw(10, 3);
  EXPECT_EQ(to_microsteps(UserPosition{10}, scale).value().value, 3 * 51'200);
  EXPECT_EQ(to_user(Microsteps{3 * 51'200}, scale).value, 10);
  EXPECT_EQ(to_pps(UserVelocity{-10}, scale).value, -3 * 51'200);
  EXPECT_EQ(to_user(PulsesPerSecond2{3 * 51'200}, scale).value, 10);
  EXPECT_EQ(to_microsteps(UserPosition{1}, revolutions(scale)).value().value, 51'200)
      << "revolutions are the motor's";
  EXPECT_DOUBLE_EQ(scale.units_per_motor_revolution(), 10.0 / 3);
  EXPECT_EQ(to_microsteps(UserPosition{-5}, screw(10, 0.5, true)).value().value, 12'800)
      << "a gear may be a step-up one";
}

TEST(Mechanics, CountsOfTheExamplesOfAn00115) {
  const UserScale table{"deg", 360, false, {200, 8}};
  EXPECT_DOUBLE_EQ(counts_per_unit({1000}, table), 4000.0 / 360) << "11.111 a degree";
  EXPECT_EQ(counts_per_unit({1000}, screw(10, 3)), 1200) << "of a mm, to the bit";
  const auto linear = encoder_scale(1000, screw(10, 3));
  EXPECT_EQ(to_user(Microsteps{1500}, linear).value, 1.5) << "a micrometre a count";
  EXPECT_EQ(counts_per_unit({1000, false}, screw(10, 3)), 300);
}

TEST(Mechanics, AnEncoderCountsTheSameAxis) {
  const auto scale = screw(10, 3, true);
  const auto counts = encoder_scale(counts_per_unit({1000}, scale), scale);
  EXPECT_EQ(counts.unit, "mm");
  EXPECT_EQ(to_user(Microsteps{-12'000}, counts).value, 10);
  EXPECT_EQ(to_microsteps(UserPosition{10}, counts).value().value, -12'000);
}

TEST(Mechanics, KnowsWhatEncodersRead) {
  const auto rows = axis_parameters(*find_model(3110));
  EXPECT_TRUE(is_encoder_position(*find_parameter(rows, 209)));
  EXPECT_FALSE(is_encoder_position(*find_parameter(rows, axis_parameter::actual_position)));
  EXPECT_TRUE(is_encoder_position(*find_parameter(axis_parameters(*find_model(142)), 41)));
  EXPECT_TRUE(is_encoder_position(*find_parameter(axis_parameters(*find_model(6212)), 199)));
}

// Absolute positions are rounded one by one, never their sum.
TEST(Mechanics, AThousandTenthsAreAHundred) {
  const auto scale = screw(7.3, 3.71);
  UserPosition wish{};
  Microsteps at{};
  for (int i = 0; i < 1000; ++i) {
    wish.value += 0.1;
    at = to_microsteps(wish, scale).value();
  }
  EXPECT_EQ(at, to_microsteps(UserPosition{100}, scale).value());
  const auto rounded_each_time = 1000 * to_microsteps(UserPosition{0.1}, scale).value().value;
  EXPECT_NE(at.value, rounded_each_time) << "the scale is one where it matters";
}

TEST(SoftLimits, CanBeReachedButNotPassed) {
  const auto scale = screw(7.3, 3.71);
  const SoftLimits limits{{-2.5}, {100}};
  for (const double inside : {-2.5, 0.0, 99.9999, 100.0})
    EXPECT_FALSE(beyond(limits, to_microsteps(UserPosition{inside}, scale).value(), scale))
        << inside;
  const auto range = microsteps_within(limits, scale);
  EXPECT_FALSE(beyond(limits, Microsteps{range.least}, scale));
  EXPECT_TRUE(beyond(limits, Microsteps{range.least - 1}, scale));
  EXPECT_FALSE(beyond(limits, Microsteps{range.greatest}, scale));
  EXPECT_TRUE(beyond(limits, Microsteps{range.greatest + 1}, scale));
}

TEST(SoftLimits, NameTheLimitInTheUnit) {
  const auto text = [](const SoftLimits& limits, double position, const UserScale& scale) {
    return describe(beyond(limits, to_microsteps(UserPosition{position}, scale).value(), scale)
                        .value_or(BeyondLimit{}));
  };
  for (const bool reverse : {false, true}) {
    const auto scale = screw(10, 1, reverse);
    EXPECT_EQ(text({{-2.5}, {100}}, 120, scale), "120 mm is beyond the soft limit of 100 mm");
    EXPECT_EQ(text({{-2.5}, {100}}, -3, scale), "-3 mm is beyond the soft limit of -2.5 mm");
  }
}

TEST(SoftLimits, AreClippedToWhatModulesHold) {
  for (const bool reverse : {false, true}) {
    const auto range = microsteps_within({{-1e12}, {1e12}}, screw(10, 1, reverse));
    EXPECT_EQ(range, ValueRange{});
  }
}

}  // namespace
}  // namespace tmcl
