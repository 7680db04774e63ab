// Movements that the gateway computes, of no axis.
#include <gmock/gmock.h>

#include "tmcl/api/profile.hpp"
#include "tmcl/plan/profile.hpp"
#include "unit/journey_bench.hpp"

namespace tmcld::test {
namespace {

using testing::HasSubstr;

struct DaemonProfile : testing::Test {
  std::string refusal(json::object params) {
    const auto result = bench.call("profile.solve", std::move(params));
    if (result) return "none";
    return result.error().name + ": " + result.error().message;
  }
  JourneyBench bench;
};

// The exercise of AN00115-001, and its second example.
TEST_F(DaemonProfile, IsSolvedFromAsMuchAsDeterminesIt) {
  const auto exercise = bench.call(
      "profile.solve",
      {{"distance", 200}, {"total_time", 1}, {"speed", 250}, {"assumption", "symmetric"}});
  ASSERT_TRUE(exercise) << exercise.error().message;
  const auto solved = api::from_json<api::profile::Solved>(*exercise);
  EXPECT_NEAR(solved.acceleration, 1250, 1e-9);
  EXPECT_NEAR(solved.slew_time, 0.6, 1e-9);
  const auto thirds = bench.call("profile.solve",
                                 {{"distance", 20}, {"total_time", 0.6}, {"assumption", "thirds"}});
  ASSERT_TRUE(thirds);
  EXPECT_NEAR(thirds->at("speed").to_number<double>(), 50, 1e-9);
  EXPECT_TRUE(bench.requests.empty()) << "it asks no module";
}

TEST_F(DaemonProfile, HasAFieldForEachQuantity) {
  const auto result = bench.call("profile.solve", {{"initial_speed", 2},
                                                   {"speed", 8},
                                                   {"acceleration", 3},
                                                   {"deceleration", 4},
                                                   {"distance", 40}});
  ASSERT_TRUE(result) << result.error().message;
  tmcl::plan::Given given;
  using tmcl::plan::Quantity;
  given[Quantity::initial_speed] = 2;
  given[Quantity::speed] = 8;
  given[Quantity::acceleration] = 3;
  given[Quantity::deceleration] = 4;
  given[Quantity::distance] = 40;
  const auto expected = tmcl::plan::solve(given).value();
  for (const auto quantity : tmcl::plan::quantities)
    EXPECT_EQ(result->at(name_of(quantity)).to_number<double>(), expected[quantity])
        << name_of(quantity);
  for (const auto quantity : tmcl::plan::side_quantities)
    EXPECT_EQ(result->at(name_of(quantity)).to_number<double>(), expected[quantity])
        << name_of(quantity);
}

TEST_F(DaemonProfile, IsSimulatedAsATwinMakesIt) {
  const auto result =
      bench.call("profile.simulate", {{"model", "TMCM-6212"},
                                      {"parameters", {"max_velocity", "5", "17", "velocity_v1"}},
                                      {"values", {50'000, 100'000, 100'000, 0}},
                                      {"distance_microsteps", 100'000},
                                      {"points", 251}});
  ASSERT_TRUE(result) << result.error().message;
  const auto told = api::from_json<api::profile::Simulated>(*result);
  EXPECT_NEAR(told.move_s.value(), 2.5, 0.01) << "half a second up, and down";
  EXPECT_NEAR(told.top_speed_pps, 50'000, 5);
  EXPECT_FALSE(told.swing_microsteps);
  const auto& curve = told.curve.value();
  ASSERT_EQ(curve.times_s.size(), 251U);
  EXPECT_EQ(curve.positions_microsteps.front(), 0);
  EXPECT_NEAR(curve.positions_microsteps.back(), 100'000, 2);
  EXPECT_NEAR(curve.times_s.back(), *told.move_s, 1e-6);
  EXPECT_NEAR(curve.velocities_pps[125], 50'000, 5);
  EXPECT_NEAR(curve.accelerations_pps2[10], 100'000, 120) << "in whole numbers of the register";
  EXPECT_TRUE(bench.requests.empty()) << "it asks no module";
}

TEST_F(DaemonProfile, IsSimulatedWithALoad) {
  const json::object move{{"model", "TMCM-142"},
                          {"parameters", {"4", "16", "17", "max_bow"}},
                          {"values", {5'000'000, 24'624, 24'624, 0}},
                          {"distance_microsteps", 50'000},
                          {"resonance_hz", 12},
                          {"tolerance_microsteps", 20}};
  const auto steep = bench.call("profile.simulate", move);
  ASSERT_TRUE(steep) << steep.error().message;
  auto smooth_move = move;
  smooth_move["values"] = {5'000'000, 24'624, 24'624, 6};
  const auto smooth = bench.call("profile.simulate", smooth_move);
  ASSERT_TRUE(smooth) << smooth.error().message;
  EXPECT_LT(smooth->at("swing_microsteps").to_number<double>(),
            steep->at("swing_microsteps").to_number<double>());
  EXPECT_GT(steep->at("settled_s").to_number<double>(), steep->at("move_s").to_number<double>());
}

// A case of its data sheet's formulas, with a cycle of half a millisecond.
TEST_F(DaemonProfile, OfTheMc1451aIsSimulatedByItsRegisters) {
  const json::object move{
      {"model", "MC1451A"},
      {"parameters", {"velocity", "acceleration", "jerk", "cycle_us"}},
      {"values", {180'224, 66, 42'950, 500}},
      {"distance_microsteps", 100'000},
      {"points", 101},
  };
  const auto result = bench.call("profile.simulate", move);
  ASSERT_TRUE(result) << result.error().message;
  const auto told = api::from_json<api::profile::Simulated>(*result);
  EXPECT_EQ(told.model, "MC1451A");
  EXPECT_NEAR(told.move_s.value(), 39'195.010 * 0.0005, 0.0005);
  EXPECT_NEAR(told.top_speed_pps, 2.75 / 0.0005, 0.1);
  EXPECT_NEAR(told.longest_phase_s, 2629.959 * 0.0005, 0.0005) << "phase II";
  EXPECT_THAT(told.warnings, testing::IsEmpty());
  const auto& curve = told.curve.value();
  ASSERT_EQ(curve.positions_microsteps.size(), 101U);
  EXPECT_EQ(curve.positions_microsteps.front(), 0);
  EXPECT_EQ(curve.positions_microsteps[50], 50'000);
  EXPECT_EQ(curve.positions_microsteps.back(), 100'000);
  EXPECT_NEAR(curve.times_s.back(), *told.move_s, 1e-9);
}

TEST_F(DaemonProfile, OfTheMc1451aIsRefusedWithTheRegister) {
  const auto refusal_of = [&](json::object params) {
    params.insert({{"model", "MC1451A"}, {"distance_microsteps", 1000}});
    const auto result = bench.call("profile.simulate", std::move(params));
    return result ? "none" : result.error().name + ": " + result.error().message;
  };
  EXPECT_EQ(refusal_of({}), "none") << "it stands, with a warning";
  EXPECT_THAT(refusal_of({{"parameters", {"acceleration"}}, {"values", {32'768}}}),
              HasSubstr("out_of_range: an MC1451A does not take 32768 for parameter acceleration"));
  EXPECT_THAT(refusal_of({{"parameters", {"cycle_us"}}, {"values", {0}}}),
              HasSubstr("out_of_range: "));
  for (const auto* name : {"position", "velocty", "4"}) {
    EXPECT_THAT(refusal_of({{"parameters", {name}}, {"values", {1}}}),
                HasSubstr("unknown_parameter: an MC1451A has no parameter"));
  }
  EXPECT_THAT(refusal_of({{"parameters", {"jerk"}}}), HasSubstr("one of 'values' for each"));
  EXPECT_THAT(refusal_of({{"resonance_hz", 12}}), HasSubstr("bad_argument: no load"));
}

TEST_F(DaemonProfile, WhatIsNotFollowedIsToldWhy) {
  const auto refusal = [&](json::object params) {
    params.insert({{"distance_microsteps", 1000}});
    const auto result = bench.call("profile.simulate", std::move(params));
    return result ? "none" : result.error().name + ": " + result.error().message;
  };
  EXPECT_THAT(refusal({{"model", "TMCM-9"}}), HasSubstr("unknown_model: "));
  EXPECT_THAT(refusal({{"model", "TMCM-1021"}}), HasSubstr("not_foreseeable: "));
  EXPECT_THAT(refusal({{"model", "TMCM-142"}, {"parameters", {"max_bw"}}, {"values", {1}}}),
              HasSubstr("unknown_parameter: a TMCM-142 has no parameter 'max_bw'"));
  EXPECT_THAT(refusal({{"model", "TMCM-142"}, {"parameters", {"max_bow"}}}),
              HasSubstr("one of 'values' for each"));
  EXPECT_THAT(refusal({{"model", "TMCM-142"}, {"parameters", {"max_bow"}}, {"values", {99}}}),
              HasSubstr("out_of_range: a TMCM-142 does not take 99 for parameter 18"));
  EXPECT_THAT(refusal({{"model", "TMCM-142"}, {"resonance_hz", 0}}),
              HasSubstr("'resonance_hz' is 0.01 to 100000, not 0"));
  EXPECT_THAT(refusal({{"model", "TMCM-142"}, {"until_s", 0}}), HasSubstr("'until_s' is"));
}

TEST_F(DaemonProfile, WhatDeterminesNoneIsRefused) {
  EXPECT_THAT(refusal({{"distance", 20}}), HasSubstr("insufficient: "));
  EXPECT_THAT(refusal({{"distance", 20}, {"assumption", "halves"}}),
              HasSubstr("bad_argument: 'halves' is no assumption"));
  EXPECT_THAT(refusal({{"distance", -20}, {"speed", 1}, {"acceleration", 1}, {"deceleration", 1}}),
              HasSubstr("bad_value: "));
  EXPECT_THAT(refusal({{"distance", 1}, {"speed", 8}, {"acceleration", 16}, {"deceleration", 16}}),
              HasSubstr("impossible: "));
  EXPECT_THAT(refusal({{"speed", 8},
                       {"acceleration", 16},
                       {"acceleration_time", 1},
                       {"deceleration", 16},
                       {"distance", 12}}),
              HasSubstr("contradiction: "));
}

}  // namespace
}  // namespace tmcld::test
