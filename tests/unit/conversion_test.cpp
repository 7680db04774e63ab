// From a module's units to what people measure in, and back.
#include <cmath>
#include <limits>

#include <gmock/gmock.h>

#include "tmcl/conversion.hpp"

namespace tmcl {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr auto nan = std::numeric_limits<double>::quiet_NaN();

const Model& model_of(std::uint16_t number) { return *find_model(number); }

std::span<const ParameterInfo> table_of(std::uint16_t model) {
  return axis_parameters(model_of(model));
}

TEST(ModuleUnits, OfATmc429FollowItsDividers) {
  const auto units = module_units(Tmc429Dividers{2, 3});
  EXPECT_NEAR(to_pps(InternalVelocity{1000}, units).value, 61'035.2, 0.1);
  EXPECT_NEAR(to_pps2(InternalAcceleration{500}, units).value, 7.45e6, 1e4);
  for (std::uint8_t pulse = 0; pulse <= tmc429_max_divider; ++pulse) {
    for (std::uint8_t ramp = 0; ramp <= tmc429_max_divider; ++ramp) {
      const Tmc429Dividers dividers{pulse, ramp};
      const auto both = module_units(dividers);
      ASSERT_EQ(to_pps(InternalVelocity{-2047}, both), to_pps(InternalVelocity{-2047}, dividers));
      ASSERT_EQ(to_pps2(InternalAcceleration{7}, both), to_pps2(InternalAcceleration{7}, dividers));
      ASSERT_EQ(module_units(model_of(1110), std::array<std::int32_t, 2>{pulse, ramp}), both);
    }
  }
}

TEST(ModuleUnits, OfOtherChipsFollowTheUnitMode) {
  const auto with_mode = [](std::uint16_t model, std::int32_t mode) {
    return module_units(model_of(model), std::array{mode}).value();
  };
  EXPECT_EQ(with_mode(142, 1), ModuleUnits{});
  EXPECT_EQ(with_mode(6212, 1), ModuleUnits{});
  EXPECT_EQ(to_pps(InternalVelocity{1 << 26}, with_mode(142, 0)).value, 1e6);
  EXPECT_EQ(to_pps(InternalVelocity{1 << 20}, with_mode(6212, 0)).value, 1e6);
  EXPECT_NEAR(to_pps2(InternalAcceleration{1}, with_mode(142, 0)).value, 58.21, 0.01);
  EXPECT_NEAR(to_pps2(InternalAcceleration{1}, with_mode(6212, 0)).value, 116.4, 0.1);
  EXPECT_EQ(module_units(model_of(1111), {}), ModuleUnits{}) << "no such parameter: always pps";
}

TEST(ModuleUnits, AreUnknownForValuesThatNoModuleHas) {
  EXPECT_FALSE(module_units(model_of(1110), std::array{14, 0}));
  EXPECT_FALSE(module_units(model_of(1110), std::array{0, -1}));
  EXPECT_FALSE(module_units(model_of(1110), std::array{0}));
  EXPECT_FALSE(module_units(model_of(6212), std::array{2}));
  EXPECT_FALSE(module_units(model_of(142), std::array{1, 1}));
}

TEST(ModuleUnits, AreToldByTheParametersThatTheModelHas) {
  EXPECT_THAT(unit_parameters(model_of(1110)), ElementsAre(154, 153));
  EXPECT_THAT(unit_parameters(model_of(142)), ElementsAre(255));
  EXPECT_THAT(unit_parameters(model_of(6212)), ElementsAre(255));
  EXPECT_THAT(unit_parameters(model_of(1111)), IsEmpty());
  EXPECT_EQ(initial_units(model_of(1110)), module_units(Tmc429Dividers{2, 3}));
  EXPECT_EQ(initial_units(model_of(6212)), ModuleUnits{});
}

TEST(ModuleUnits, AreKnownForEveryModel) {
  for (const auto& model : models()) {
    const auto table = axis_parameters(model);
    for (const auto number : unit_parameters(model)) {
      EXPECT_NE(find_parameter(table, number), nullptr) << model.name << ' ' << int{number};
    }
    const auto start = initial_units(model);
    for (const auto& row : table) {
      const bool scaled = dimension_of(row) == Dimension::velocity && row.maximum > 0;
      if (!scaled) continue;
      const auto range = range_of(row, start, start);
      EXPECT_EQ(range, (ValueRange{row.minimum, row.maximum})) << model.name << ' ' << row.name;
    }
  }
}

TEST(Conversion, RoundsToTheNearestAndTiesAwayFromZero) {
  const ModuleUnits twos{{2}, {2}};
  EXPECT_EQ(to_internal(PulsesPerSecond{2.99}, twos).value().value, 1);
  EXPECT_EQ(to_internal(PulsesPerSecond{3}, twos).value().value, 2);
  EXPECT_EQ(to_internal(PulsesPerSecond{-3}, twos).value().value, -2);
  EXPECT_EQ(to_internal(PulsesPerSecond2{5}, twos).value().value, 3);
  const UserScale half{"mm", 400, false, {200, 0}};
  EXPECT_EQ(to_microsteps(UserPosition{1}, half).value().value, 1);
  EXPECT_EQ(to_microsteps(UserPosition{-1}, half).value().value, -1);
  EXPECT_EQ(to_microsteps(UserPosition{-0.99}, half).value().value, 0);
}

TEST(Conversion, RefusesWhatDoesNotFitAndNamesTheNearest) {
  const auto units = module_units(Tmc429Dividers{});
  const auto fast = to_internal(PulsesPerSecond{1e6}, units, {-2047, 2047});
  ASSERT_FALSE(fast);
  EXPECT_EQ(fast.error().nearest, 499'755.859375);
  EXPECT_EQ(describe(fast.error()),
            "1000000 microsteps/s is too fast; the nearest possible value is 499755.8 "
            "microsteps/s");
  EXPECT_EQ(describe(OutOfReach{-1000, -819.19990234375, "mm", "too far"}),
            "-1000 mm is too far; the nearest possible value is -819.1999 mm");
  EXPECT_EQ(describe(OutOfReach{1, 10240.00001, "mm", "too little"}),
            "1 mm is too little; the nearest possible value is 10240.01 mm");
  EXPECT_EQ(to_internal(PulsesPerSecond{-1e6}, units, {-2047, 2047}).error().nearest,
            -499'755.859375);
  EXPECT_EQ(to_internal(PulsesPerSecond{1}, units, {1, 2047}).error().fault, "too slow");
  EXPECT_EQ(to_internal(PulsesPerSecond2{1e12}, units, {0, 2047}).error().fault, "too large");
  EXPECT_EQ(to_internal(PulsesPerSecond2{-1e12}, units, {0, 2047}).error().fault, "too small");
  EXPECT_FALSE(to_internal(PulsesPerSecond{nan}, units));
  EXPECT_FALSE(to_internal(PulsesPerSecond{1e300}, units));
  // Half a unit beyond the range still rounds into it.
  EXPECT_EQ(to_internal(PulsesPerSecond{499'756}, units, {-2047, 2047}).value().value, 2047);
}

TEST(Conversion, RangesFollowTheUnitMode) {
  const auto table = table_of(6212);
  const auto* row = find_parameter(table, "max_velocity");
  const auto start = initial_units(model_of(6212));
  EXPECT_EQ(range_of(*row, start, start), (ValueRange{row->minimum, row->maximum}));
  const auto chip = module_units(model_of(6212), std::array{0}).value();
  EXPECT_NEAR(range_of(*row, start, chip).greatest, (1 << 23) - 512, 1);
  const auto* bow = find_parameter(table_of(142), "max_bow");
  EXPECT_EQ(range_of(*bow, chip, start), (ValueRange{0, 18})) << "not scaled";
  const auto* fast = find_parameter(table_of(142), "max_velocity");
  const auto tmc457 = initial_units(model_of(142));
  EXPECT_NEAR(range_of(*fast, tmc457, {}).greatest, 31'999'000, 1'000);
}

TEST(Conversion, KnowsWhatAParameterMeasures) {
  const auto dimension = [](int model, int number) {
    const auto table = table_of(static_cast<std::uint16_t>(model));
    return dimension_of(*find_parameter(table, static_cast<std::uint8_t>(number)));
  };
  for (const int model : {1110, 142, 6212}) {
    for (const int number : {0, 1}) {
      EXPECT_EQ(dimension(model, number), Dimension::position);
    }
    for (const int number : {2, 3, 4}) {
      EXPECT_EQ(dimension(model, number), Dimension::velocity);
    }
    EXPECT_EQ(dimension(model, 5), Dimension::acceleration);
    for (const int number : {6, 8, 12, 140}) {
      EXPECT_EQ(dimension(model, number), Dimension::other);
    }
  }
  EXPECT_EQ(dimension(1110, 130), Dimension::velocity);
  EXPECT_EQ(dimension(142, 130), Dimension::other) << "a flag in this family";
  EXPECT_EQ(dimension(1110, 135), Dimension::acceleration);
  EXPECT_EQ(dimension(142, 16), Dimension::acceleration);
  EXPECT_EQ(dimension(6212, 16), Dimension::velocity);
}

TEST(UserScale, CountsTurnsAndUnits) {
  const UserScale spindle{"mm", 5, false, {200, 8}};
  EXPECT_EQ(to_microsteps(UserPosition{10}, spindle).value().value, 102'400);
  EXPECT_EQ(to_user(Microsteps{-51'200}, spindle).value, -5);
  EXPECT_EQ(to_user(PulsesPerSecond{102'400}, spindle).value, 10);
  EXPECT_EQ(to_pps(UserVelocity{-10}, spindle).value, -102'400);
  EXPECT_EQ(to_user(PulsesPerSecond2{102'400}, spindle).value, 10);
  EXPECT_EQ(to_pps2(UserAcceleration{10}, spindle).value, 102'400);
  const auto turns = revolutions(spindle);
  EXPECT_EQ(turns.unit, "rev");
  EXPECT_EQ(to_microsteps(UserPosition{1.5}, turns).value().value, 76'800);
  EXPECT_EQ(to_pps(UserVelocity{2}, turns).value, 102'400);
  EXPECT_EQ(to_user(PulsesPerSecond{25'600}, revolutions({"mm", 5, false, {400, 6}})).value, 1);
}

TEST(UserScale, ReversesPositionsAndVelocitiesButNotAccelerations) {
  const UserScale reversed{"deg", 360, true, {200, 4}};
  EXPECT_EQ(to_microsteps(UserPosition{360}, reversed).value().value, -3'200);
  EXPECT_EQ(to_user(Microsteps{-3'200}, reversed).value, 360);
  EXPECT_EQ(to_pps(UserVelocity{90}, reversed).value, -800);
  EXPECT_EQ(to_user(PulsesPerSecond{800}, reversed).value, -90);
  EXPECT_EQ(to_pps2(UserAcceleration{90}, reversed).value, 800);
  EXPECT_EQ(to_user(PulsesPerSecond2{800}, reversed).value, 90);
  EXPECT_FALSE(std::signbit(to_user(Microsteps{0}, reversed).value));
  EXPECT_EQ(to_microsteps(UserPosition{1}, revolutions(reversed)).value().value, -3'200);
}

TEST(UserScale, RefusesPositionsThatTheModuleCannotHold) {
  const UserScale spindle{"mm", 5, false, {200, 8}};
  const auto far = to_microsteps(UserPosition{1000}, spindle, {-(1 << 23), (1 << 23) - 1});
  ASSERT_FALSE(far);
  EXPECT_THAT(describe(far.error()), HasSubstr("1000 mm is too far"));
  EXPECT_NEAR(far.error().nearest, 819.2, 0.001);
  EXPECT_LT(
      to_microsteps(UserPosition{-1000}, spindle, {-(1 << 23), (1 << 23) - 1}).error().nearest,
      -819);
  EXPECT_FALSE(to_microsteps(UserPosition{1e300}, spindle));
  EXPECT_FALSE(to_microsteps(UserPosition{nan}, spindle));
}

TEST(Tmc429Ramp, TakesTheFinestDividersThatHold) {
  // The note "Choosing" of the facts: 10,000 pps are 1310 with a pulse divider of 5.
  const auto slow = choose_tmc429_ramp({10'000}, {100'000}).value();
  EXPECT_EQ(slow.dividers.pulse, 5);
  EXPECT_EQ(slow.v_max.value, 1311);
  EXPECT_NEAR(slow.velocity().value, 10'000, 4);
  EXPECT_NEAR(slow.acceleration().value, 100'000, 50);
  const auto fast = choose_tmc429_ramp({50'000}, {200'000}).value();
  EXPECT_EQ(fast.dividers.pulse, 3);
  EXPECT_EQ(fast.v_max.value, 1638);
  EXPECT_NEAR(fast.acceleration().value, 200'000, 100);
}

TEST(Tmc429Ramp, GivesUpResolutionWhereTheAccelerationAsksForIt) {
  const auto ramp = choose_tmc429_ramp({1'000}, {1e6}).value();
  EXPECT_LE(ramp.dividers.pulse, 5) << "8 would be the finest for the velocity alone";
  EXPECT_NEAR(ramp.velocity().value, 1'000, 4);
  EXPECT_NEAR(ramp.acceleration().value, 1e6, 1e3);
}

TEST(Tmc429Ramp, RefusesWithTheNearestPossibleValue) {
  const auto refused = [](double velocity, double acceleration) {
    return choose_tmc429_ramp({velocity}, {acceleration}).error();
  };
  const auto fast = refused(600'000, 1e6);
  EXPECT_TRUE(fast.is_velocity());
  EXPECT_EQ(fast.nearest, 499'755.859375);
  EXPECT_EQ(fast.fault, "too fast for a TMC429");
  const auto slow = refused(0.001, 1);
  EXPECT_TRUE(slow.is_velocity());
  EXPECT_NEAR(slow.nearest, 0.0298, 0.0001);
  EXPECT_TRUE(refused(0, 1).is_velocity());
  EXPECT_TRUE(refused(-5, 1).is_velocity());
  EXPECT_TRUE(refused(nan, 1).is_velocity());
  const auto steep = refused(10, 1e9);
  EXPECT_FALSE(steep.is_velocity());
  EXPECT_THAT(std::string(steep.fault), HasSubstr("too large"));
  const auto flat = refused(400'000, 1);
  EXPECT_FALSE(flat.is_velocity());
  EXPECT_THAT(std::string(flat.fault), HasSubstr("too small"));
  // What it names can be had.
  EXPECT_TRUE(choose_tmc429_ramp({fast.nearest}, {1e6}));
  EXPECT_TRUE(choose_tmc429_ramp({slow.nearest}, {1}));
  EXPECT_TRUE(choose_tmc429_ramp({10}, {steep.nearest}));
  EXPECT_TRUE(choose_tmc429_ramp({400'000}, {flat.nearest}));
  EXPECT_FALSE(choose_tmc429_ramp({1000}, {nan}));
  EXPECT_FALSE(choose_tmc429_ramp({1000}, {0}));
}

TEST(Tmc429Ramp, KnowsTheValidAccelerations) {
  EXPECT_EQ(tmc429_acceleration_range({3, 3}), (ValueRange{1, 2047}));
  EXPECT_EQ(tmc429_acceleration_range({3, 2}), (ValueRange{1, 2047}));
  EXPECT_EQ(tmc429_acceleration_range({2, 3}), (ValueRange{1, 2047}));
  EXPECT_EQ(tmc429_acceleration_range({5, 3}), (ValueRange{1, 1023}));
  EXPECT_EQ(tmc429_acceleration_range({0, 10}), (ValueRange{512, 2047}));
  const auto none = tmc429_acceleration_range({13, 0});
  EXPECT_GT(none.least, none.greatest);
  const auto nor_here = tmc429_acceleration_range({0, 13});
  EXPECT_GT(nor_here.least, nor_here.greatest);
}

}  // namespace
}  // namespace tmcl
