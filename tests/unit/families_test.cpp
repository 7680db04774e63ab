// The families of modules: their models, their parameters, their units.
#include <gtest/gtest.h>

#include "names.hpp"
#include "tmcl/model.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/ramp/sixpoint.hpp"
#include "tmcl/ramp/tmc457.hpp"

namespace tmcl {
namespace {

std::span<const ParameterInfo> table_of(std::uint16_t model) {
  return axis_parameters(*find_model(model));
}

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
  for (const auto& model : models()) {
    EXPECT_EQ(find_model(model.number), &model);
    EXPECT_EQ(find_model(model.name), &model);
  }
}

TEST(Families, HaveNoTablesForModelsThatNobodyKnows) {
  const Model unknown{9999, "TMCM-9999", 1, Family::tmc429};
  EXPECT_TRUE(axis_parameters(unknown).empty());
  EXPECT_TRUE(global_parameters(unknown).empty());
}

TEST(Families, NameEachParameterOnce) {
  for (const auto& model : models()) {
    for (const auto table : {axis_parameters(model), global_parameters(model)}) {
      for (const auto& row : table) {
        EXPECT_EQ(find_parameter(table, row.number), &row);
        EXPECT_EQ(find_parameter(table, row.name), &row) << model.name << ' ' << row.name;
        for (const auto alias : row.aliases) {
          if (alias.empty()) continue;
          EXPECT_EQ(find_parameter(table, alias), &row) << model.name << ' ' << alias;
        }
      }
    }
  }
}

TEST(Families, AgreeOnWhatTheLibraryUses) {
  const auto first = table_of(1110);
  for (const auto& model : models()) {
    for (std::uint8_t number = 0; number <= 8; ++number) {
      EXPECT_EQ(find_parameter(axis_parameters(model), number)->name,
                find_parameter(first, number)->name);
    }
  }
}

TEST(Families, NameTheirRegistersAsTheDataSheetsDo) {
  const auto number = [](std::uint16_t model, std::string_view name) {
    const auto* row = find_parameter(table_of(model), name);
    return row == nullptr ? -1 : int{row->number};
  };
  EXPECT_EQ(number(1110, "a_max"), 5);
  EXPECT_EQ(number(142, "a_max"), 16);
  EXPECT_EQ(number(142, "d_max"), 17);
  EXPECT_EQ(number(142, "d_stop"), 15);
  EXPECT_EQ(number(142, "bow_max"), 18);
  EXPECT_EQ(number(6212, "amax"), 5);
  EXPECT_EQ(number(6212, "a1"), 15);
  EXPECT_EQ(number(6212, "v1"), 16);
  EXPECT_EQ(number(6212, "dmax"), 17);
  EXPECT_EQ(number(6212, "d1"), 18);
  EXPECT_EQ(number(6212, "vstart"), 19);
  EXPECT_EQ(number(6212, "vstop"), 20);
  EXPECT_EQ(number(6212, "tzerowait"), 21);
}

TEST(Families, HaveTheRangesOfTheirChips) {
  const auto maximum = [](std::uint16_t model, std::uint8_t number) {
    return find_parameter(table_of(model), number)->maximum;
  };
  const auto tmc457 = ramp::Tmc457::registers();
  using R457 = ramp::Tmc457::Register;
  EXPECT_EQ(maximum(142, 4), tmc457[static_cast<std::size_t>(R457::v_max)].maximum);
  EXPECT_EQ(maximum(142, 16), tmc457[static_cast<std::size_t>(R457::a_max)].maximum);
  EXPECT_EQ(maximum(142, 18), tmc457[static_cast<std::size_t>(R457::bow_max)].maximum);
  // In microsteps per second.
  EXPECT_EQ(maximum(6212, 4), 7'999'511);
  EXPECT_EQ(maximum(6212, 16), 999'999);
  EXPECT_EQ(maximum(6212, 19), 249'999);
  EXPECT_EQ(maximum(6212, 5), 7'629'278);
}

TEST(Families, HaveInCommonWhatNoTwoModelsDisagreeOn) {
  const auto common = tmclctl::common_parameters();
  for (const auto& model : models()) {
    const auto table = axis_parameters(model);
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
  EXPECT_EQ(find_parameter(common, "bow_max"), nullptr);  // 18 is D1 elsewhere
  EXPECT_EQ(find_parameter(common, "ramp_mode"), nullptr);
  EXPECT_EQ(find_parameter(common, "a_max"), nullptr);
}

}  // namespace
}  // namespace tmcl
