// A ramp is chosen, and a twin that is set so shows what it is worth.
#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tmcl/jerk.hpp"
#include "tmcl/plan/ramp_choice.hpp"

namespace tmcl::plan {
namespace {

using std::chrono::duration;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

double seconds_to(std::int32_t target, const Model& model, std::span<const Setting> settings) {
  auto twin = *AxisTwin::of(model);
  EXPECT_TRUE(twin.set(settings));
  twin.place({0});
  twin.move_to({target});
  return duration<double>(twin.time_to_arrival().value()).count();
}

RampChoice choose(const char* name, const RampRequest& wish) {
  const auto& model = *find_model(name);
  return choose_ramp(model, wish, initial_units(model)).value();
}

TEST(RampChoice, OfATmc429HasAMinimumVelocityThatDoesNotCreep) {
  const auto& model = *find_model("TMCM-1110");
  auto choice = choose("TMCM-1110", {{10'000}, {20'000}, {20'000}});
  EXPECT_THAT(choice.remarks, IsEmpty());
  EXPECT_EQ(choice.settings.back().parameter, 130);
  const double ideal = 50'000 / 10'000.0 + 10'000.0 / 20'000;
  EXPECT_NEAR(seconds_to(50'000, model, choice.settings), ideal, 0.010);
  const double quick = seconds_to(1, model, choice.settings);
  choice.settings.back().value = 1;
  const double creeping = seconds_to(1, model, choice.settings);
  EXPECT_LT(quick, 0.02);
  EXPECT_GT(creeping, 0.13);
}

TEST(RampChoice, SaysWhatAModuleDoesInstead) {
  const auto& model = *find_model("TMCM-1110");
  const auto choice = choose("TMCM-1110", {{10'000}, {20'000}, {40'000}, 1e6});
  EXPECT_THAT(choice.remarks,
              ElementsAre(HasSubstr("the deceleration is"), HasSubstr("begins and ends at once")));
  EXPECT_TRUE(
      choose_ramp(model, {{1e7}, {1e6}, {1e6}}, initial_units(model)).error().is_velocity());
  EXPECT_FALSE(
      choose_ramp(model, {{10}, {1e9}, {1e9}}, initial_units(model)).error().is_velocity());
}

// The application note's factor of 15/16 is made up for.
TEST(RampChoice, OfATmc457DeceleratesAsAskedAlsoWithABow) {
  const auto& model = *find_model("TMCM-142");
  for (const double jerk : {1e7, 1e300}) {
    const auto choice = choose("TMCM-142", {{100'000}, {300'000}, {200'000}, jerk});
    EXPECT_NEAR(choice.deceleration.value, 200'000, 60);
    EXPECT_LE(choice.jerk, jerk);
    auto twin = *AxisTwin::of(model);
    ASSERT_TRUE(twin.set(choice.settings));
    EXPECT_THAT(twin.warnings(), IsEmpty());
    const double ideal = 1'000'000 / 100'000.0 + 0.5 * (100'000 / 300'000.0 + 100'000 / 200'000.0);
    const double rounding = 0.5 * (300'000 + 200'000) / choice.jerk;
    EXPECT_NEAR(seconds_to(1'000'000, model, choice.settings), ideal + rounding, 0.005);
  }
}

TEST(RampChoice, OfATmc457KeepsABowThatIsNotAskedFor) {
  RampRequest wish{{100'000}, {300'000}, {200'000}, std::nullopt, 11};
  const auto kept = choose("TMCM-142", wish);
  EXPECT_EQ(std::ranges::count(kept.settings, 18, &Setting::parameter), 0);
  EXPECT_EQ(kept.jerk, to_pps3(11).value);
  EXPECT_THAT(kept.remarks, IsEmpty());
  EXPECT_NEAR(kept.deceleration.value, 200'000, 60) << "15/16 of what is set";
  wish.bow = 17;
  EXPECT_THAT(choose("TMCM-142", wish).remarks, ElementsAre(HasSubstr("its bow of 17")));
  wish.jerk = highest_jerk;
  const auto highest = choose("TMCM-142", wish);
  EXPECT_THAT(highest.remarks, IsEmpty());
  EXPECT_FALSE(may_oscillate(highest.settings.back().value, {200'000}));
  EXPECT_TRUE(may_oscillate(highest.settings.back().value + 1, {200'000}));
}

TEST(RampChoice, WithoutAJerkATmc457MakesTrapezoids) {
  const auto choice = choose("TMCM-142", {{100'000}, {300'000}, {200'000}});
  EXPECT_EQ(choice.settings.back(), (Setting{18, 0}));
  EXPECT_THAT(choice.remarks, IsEmpty());
}

TEST(RampChoice, OfASixPointModuleHasADecelerationOfItsOwn) {
  const auto& model = *find_model("TMCM-1276");
  const auto choice = choose("TMCM-1276", {{50'000}, {100'000}, {200'000}});
  EXPECT_THAT(choice.remarks, IsEmpty());
  const double ideal = 100'000 / 50'000.0 + 0.5 * (0.5 + 0.25);
  EXPECT_NEAR(seconds_to(100'000, model, choice.settings), ideal, 0.005);
}

TEST(RampChoice, WorksForModulesWhoseGeneratorIsNotKnown) {
  const auto choice = choose("TMCM-1021", {{50'000}, {100'000}, {100'000}});
  EXPECT_THAT(choice.settings, ElementsAre(Setting{4, 50'000}, Setting{5, 100'000}));
  EXPECT_FALSE(AxisTwin::of(*find_model("TMCM-1021")));
}

TEST(AxisTwin, GoesOnFromASpeed) {
  for (const auto* name : {"TMCM-1110", "TMCM-142", "TMCM-1276"}) {
    SCOPED_TRACE(name);
    auto twin = *AxisTwin::of(*find_model(name));
    twin.place({1000}, {500});
    EXPECT_EQ(twin.motion().position, Microsteps{1000});
    EXPECT_NEAR(twin.motion().velocity.value, twin.to_pps(InternalVelocity{500}).value, 1);
    twin.move_to({0});
    EXPECT_TRUE(twin.time_to_arrival());
    twin.advance(*twin.time_to_arrival());
    EXPECT_EQ(twin.motion().position, Microsteps{0});
  }
}

TEST(RampChoice, IsWrittenSoThatNoSpeedInBetweenIsFasterThanBothTheOldAndTheNewOne) {
  const std::vector<Setting> settings{{154, 5}, {153, 7}, {4, 1500}, {5, 100}, {130, 3}};
  EXPECT_EQ(in_safe_order(settings, 3), settings) << "it gets slower: the dividers first";
  EXPECT_THAT(in_safe_order(settings, 8),
              ElementsAre(Setting{4, 1500}, Setting{5, 100}, Setting{130, 3}, Setting{154, 5},
                          Setting{153, 7}));
  const std::vector<Setting> without_dividers{{4, 1500}, {5, 100}};
  EXPECT_EQ(in_safe_order(without_dividers, 8), without_dividers);
}

TEST(AxisTwin, TakesWhatTheModuleTakes) {
  auto twin = *AxisTwin::of(*find_model("TMCM-1110"));
  EXPECT_TRUE(twin.set({5, 2047}));
  EXPECT_FALSE(twin.set({5, 2048}));
  EXPECT_FALSE(twin.set({250, 0}));
  EXPECT_FALSE(twin.rotate({2048}));
  EXPECT_TRUE(twin.set({5, 0}));
  twin.move_to({1000});
  EXPECT_FALSE(twin.time_to_arrival()) << "with no acceleration it never arrives";
}

}  // namespace
}  // namespace tmcl::plan
