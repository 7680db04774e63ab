// The families of modules: their models, their parameters, their units.
#include <gtest/gtest.h>

#include "names.hpp"
#include "tmcl/model.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/ramp/sixpoint.hpp"
#include "tmcl/ramp/tmc457.hpp"

namespace tmcl {
namespace {

TEST(Families, HaveModelsThatGoByNameAndNumber) {
  for (const auto* name : {"TMCM-142", "tmcm142", "142"}) {
    ASSERT_NE(find_model(name), nullptr) << name;
    EXPECT_EQ(find_model(name)->number, 142);
  }
  for (const auto* name : {"PD-146", "pd146", "146"}) {
    ASSERT_NE(find_model(name), nullptr) << name;
    EXPECT_EQ(find_model(name)->family, Family::tmc457);
  }
  EXPECT_EQ(find_model("TMCM-146"), nullptr);
  EXPECT_EQ(find_model("6212")->family, Family::sixpoint);
  EXPECT_EQ(find_model("6212")->axes, 6);
  for (const auto& model : models()) EXPECT_EQ(find_model(model.number), &model);
}

TEST(Families, NameEachParameterOnce) {
  for (const auto family : families) {
    const auto table = axis_parameters(family);
    for (const auto& row : table) {
      EXPECT_EQ(find_parameter(table, row.number), &row);
      EXPECT_EQ(find_parameter(table, row.name), &row) << row.name;
      for (const auto alias : row.aliases) {
        if (alias.empty()) continue;
        EXPECT_EQ(find_parameter(table, alias), &row) << alias;
      }
    }
  }
}

TEST(Families, AgreeOnWhatTheLibraryUses) {
  const auto& first = axis_parameters(Family::tmc429);
  for (const auto family : families) {
    for (std::uint8_t number = 0; number <= 8; ++number) {
      EXPECT_EQ(find_parameter(axis_parameters(family), number)->name,
                find_parameter(first, number)->name);
    }
  }
}

TEST(Families, NameTheirRegistersAsTheDataSheetsDo) {
  const auto number = [](Family family, std::string_view name) {
    const auto* row = find_parameter(axis_parameters(family), name);
    return row == nullptr ? -1 : int{row->number};
  };
  EXPECT_EQ(number(Family::tmc429, "a_max"), 5);
  EXPECT_EQ(number(Family::tmc457, "a_max"), 16);
  EXPECT_EQ(number(Family::tmc457, "d_max"), 17);
  EXPECT_EQ(number(Family::tmc457, "d_stop"), 15);
  EXPECT_EQ(number(Family::tmc457, "bow_max"), 18);
  EXPECT_EQ(number(Family::sixpoint, "amax"), 5);
  EXPECT_EQ(number(Family::sixpoint, "a1"), 15);
  EXPECT_EQ(number(Family::sixpoint, "v1"), 16);
  EXPECT_EQ(number(Family::sixpoint, "dmax"), 17);
  EXPECT_EQ(number(Family::sixpoint, "d1"), 18);
  EXPECT_EQ(number(Family::sixpoint, "vstart"), 19);
  EXPECT_EQ(number(Family::sixpoint, "vstop"), 20);
  EXPECT_EQ(number(Family::sixpoint, "tzerowait"), 21);
}

TEST(Families, HaveTheRangesOfTheirChips) {
  const auto maximum = [](Family family, std::uint8_t number) {
    return find_parameter(axis_parameters(family), number)->maximum;
  };
  const auto tmc457 = ramp::Tmc457::registers();
  using R457 = ramp::Tmc457::Register;
  EXPECT_EQ(maximum(Family::tmc457, 4), tmc457[static_cast<std::size_t>(R457::v_max)].maximum);
  EXPECT_EQ(maximum(Family::tmc457, 16), tmc457[static_cast<std::size_t>(R457::a_max)].maximum);
  EXPECT_EQ(maximum(Family::tmc457, 18), tmc457[static_cast<std::size_t>(R457::bow_max)].maximum);
  // In microsteps per second.
  EXPECT_EQ(maximum(Family::sixpoint, 4), 7'999'511);
  EXPECT_EQ(maximum(Family::sixpoint, 16), 999'999);
  EXPECT_EQ(maximum(Family::sixpoint, 19), 249'999);
  EXPECT_EQ(maximum(Family::sixpoint, 5), 7'629'278);
}

TEST(Families, CountVelocitiesInUnitsOfTheirOwn) {
  EXPECT_EQ(velocity_unit_parameter(Family::tmc429), 154);
  EXPECT_NEAR(velocity_unit(Family::tmc429, 2)->value, 61.035, 0.001);
  EXPECT_EQ(velocity_unit(Family::tmc429, 14), std::nullopt);
  EXPECT_EQ(velocity_unit_parameter(Family::tmc457), 255);
  EXPECT_DOUBLE_EQ(velocity_unit(Family::tmc457, 0)->value, ramp::tmc457_to_pps(1, 16e6).value);
  EXPECT_EQ(velocity_unit_parameter(Family::sixpoint), 255);
  EXPECT_DOUBLE_EQ(velocity_unit(Family::sixpoint, 0)->value, 16e6 / (1 << 24));
  for (const auto family : {Family::tmc457, Family::sixpoint}) {
    EXPECT_EQ(velocity_unit(family, 1)->value, 1);
    EXPECT_EQ(velocity_unit(family, 2), std::nullopt);
    EXPECT_EQ(velocity_unit(family, -1), std::nullopt);
  }
}

TEST(Families, HaveInCommonWhatNoTwoOfThemDisagreeOn) {
  const auto common = tmclctl::common_parameters();
  for (const auto family : families) {
    const auto table = axis_parameters(family);
    for (const auto& row : common) {
      const auto* same_number = find_parameter(table, row.number);
      EXPECT_TRUE(same_number == nullptr || same_number->name == row.name) << row.name;
      for (const auto name : {row.name, row.aliases[0], row.aliases[1]}) {
        const auto* same_name = find_parameter(table, name);
        EXPECT_TRUE(same_name == nullptr || same_name->number == row.number) << name;
      }
    }
  }
  EXPECT_EQ(find_parameter(common, "max_velocity")->number, 4);
  EXPECT_EQ(find_parameter(common, "pulse_divisor")->number, 154);
  EXPECT_EQ(find_parameter(common, "bow_max"), nullptr);  // 18 is D1 elsewhere
  EXPECT_EQ(find_parameter(common, "ramp_mode"), nullptr);
  EXPECT_EQ(find_parameter(common, "a_max"), nullptr);
}

}  // namespace
}  // namespace tmcl
