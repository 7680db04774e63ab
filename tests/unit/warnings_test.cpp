// What the twin of an axis knows goes with the answers of moves, lines and turning.
#include <gmock/gmock.h>

#include "unit/journey_bench.hpp"

namespace tmcld::test {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> warnings(const Result<boost::json::object>& result) {
  EXPECT_TRUE(result) << result.error().message;
  std::vector<std::string> all;
  for (const auto& text : result->at("warnings").as_array()) all.emplace_back(text.as_string());
  return all;
}
json::object to(std::int64_t position) {
  return {{"axis", "x"}, {"position_microsteps", position}};
}
Result<boost::json::object> set(JourneyBench& bench, int parameter, std::int32_t value) {
  auto result =
      bench.call("parameter.set", {{"axis", "x"}, {"parameter", parameter}, {"value", value}});
  EXPECT_TRUE(result) << result.error().message;
  return result;
}

class WarningsOf : public testing::TestWithParam<const char*> {};

TEST_P(WarningsOf, AnAxisAsItWasDeliveredAreNone) {
  JourneyBench bench(GetParam());
  EXPECT_THAT(warnings(bench.call("axis.move_to", to(2000))), IsEmpty());
  bench.time.run_for(std::chrono::minutes(1));
  EXPECT_THAT(warnings(bench.call("axis.move_by", {{"axis", "x"}, {"distance_microsteps", -500}})),
              IsEmpty());
  bench.time.run_for(std::chrono::minutes(1));
  EXPECT_THAT(warnings(bench.call("line.move", {{"axes", json::array{"x", "far"}},
                                                {"positions_microsteps", json::array{100, 50}}})),
              IsEmpty());
  bench.time.run_for(std::chrono::minutes(1));
  EXPECT_THAT(warnings(bench.call("axis.rotate", {{"axis", "x"}, {"velocity_internal", 100}})),
              IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(Families, WarningsOf,
                         testing::Values("TMCM-1110", "TMCM-3110", "TMCM-142", "TMCM-6212"));

TEST(Warnings, AreOfABowWithWhichTheMotorSwings) {
  JourneyBench bench("TMCM-142");
  set(bench, 18, 18);
  const auto moved = bench.call("axis.move_to", to(100));
  EXPECT_TRUE(moved->at("predicted_s").is_null());
  EXPECT_THAT(warnings(moved),
              testing::AllOf(Contains(HasSubstr("the motor oscillates")),
                             Contains(HasSubstr("does not come to rest on its target"))));
}

TEST(Warnings, AreOfASettingWithWhichItNeverArrives) {
  JourneyBench bench("TMCM-6212");
  set(bench, 18, 0);
  EXPECT_THAT(warnings(bench.call("axis.move_to", to(100'000))),
              Contains(HasSubstr("deceleration_d1 0")));
}

TEST(Warnings, SayWhyAMoveIsNotForeseen) {
  JourneyBench bench("TMCM-1111");
  const auto moved = bench.call("axis.move_to", to(100));
  EXPECT_TRUE(moved->at("predicted_s").is_null());
  EXPECT_THAT(warnings(moved), Contains(HasSubstr("no prediction")));
  auto params = to(50);
  params["predict"] = false;
  EXPECT_THAT(warnings(bench.call("axis.move_to", params)), IsEmpty()) << "nobody wanted to know";
}

TEST(Warnings, AreOfASpeedAboveTheGreatest) {
  JourneyBench bench("TMCM-1110");
  set(bench, 4, 500);
  const auto turned = bench.call("axis.rotate", {{"axis", "x"}, {"velocity_internal", -1500}});
  EXPECT_THAT(warnings(turned), Contains(HasSubstr("faster than max_velocity")));
  bench.call("axis.stop", {{"axis", "x"}});
}

TEST(Warnings, AreOfABowThatIsSet) {
  JourneyBench bench("TMCM-142");
  EXPECT_THAT(warnings(set(bench, 18, 11)), IsEmpty());
  EXPECT_THAT(warnings(set(bench, 18, 18)), Contains(HasSubstr("the motor oscillates")));
  EXPECT_THAT(warnings(set(bench, 4, 1000)), Contains(HasSubstr("the motor oscillates")))
      << "whatever of the ramp is set";
  EXPECT_THAT(warnings(set(bench, 18, 3)), IsEmpty());
}

TEST(Warnings, AreOfTwoAccelerationsThatAreSetAtOnce) {
  JourneyBench bench("TMCM-142");
  EXPECT_THAT(warnings(set(bench, 5, 100)),
              Contains(HasSubstr("exceeds acceleration 100: the motor oscillates")));
  EXPECT_THAT(warnings(set(bench, 5, 20000)), IsEmpty());
}

TEST(Warnings, AreOfADecelerationThatEndsInACreep) {
  JourneyBench bench("TMCM-6212");
  EXPECT_THAT(warnings(set(bench, 18, 0)), Contains(HasSubstr("deceleration_d1 0 pps/s cannot")));
}

/// As the user knows them: parameters by name, in the unit of the moment and as they were typed.
TEST(Warnings, SpeakOfParametersAsTheyWereSet) {
  JourneyBench bench("TMCM-6212");
  EXPECT_THAT(warnings(set(bench, 19, 50'000)),
              testing::ElementsAre("stop_velocity 10 pps is below start_velocity 50000 pps, so a "
                                   "short way may not allow to stop"));
  set(bench, 19, 0);
  EXPECT_THAT(
      warnings(set(bench, 20, 9)),
      testing::ElementsAre("stop_velocity 9 pps is below 10 pps, the least for positioning"));
  set(bench, 20, 10);
  set(bench, 16, 0);
  EXPECT_THAT(warnings(set(bench, 18, 1)),
              testing::ElementsAre("deceleration_d1 1 pps/s (0 in the chip) is not to be "
                                   "set for positioning, not even while velocity_v1 is 0"));
  set(bench, 18, 1400);
  EXPECT_THAT(warnings(set(bench, 4, 0)),
              testing::ElementsAre("max_velocity 0 pps: the motor does not move"));
}

TEST(Warnings, SpeakOfTheFirstParameterThatIsSetAsWell) {
  JourneyBench bench("TMCM-6212");
  EXPECT_THAT(warnings(set(bench, 18, 1)),
              Contains(HasSubstr("deceleration_d1 1 pps/s (0 in the chip) cannot brake "
                                 "below velocity_v1 25600 pps")));
}

TEST(Warnings, SpeakInTheUnitModeOfAModule) {
  JourneyBench bench("TMCM-142");
  set(bench, 17, 8589);
  EXPECT_THAT(warnings(set(bench, 18, 18)),
              Contains("max_bow 18 is 131072 and so exceeds max_deceleration 8589: the motor "
                       "oscillates"));
  set(bench, 255, 1);
  set(bench, 17, 500'000);
  EXPECT_THAT(warnings(set(bench, 18, 17)),
              Contains("max_bow 17 is 3814698 pps/s and so exceeds max_deceleration 500000 pps/s: "
                       "the motor oscillates"));
  set(bench, 18, 0);
  EXPECT_THAT(warnings(set(bench, 5, 1)),
              Contains("acceleration 1 pps/s (0 in the chip): the motor cannot speed up"));
}

TEST(Warnings, SpeakInTheUnitOfTheAxisAsWell) {
  JourneyBench bench("TMCM-6212", "unit = \"mm\"\nscrew_pitch = 5\n");
  const auto done =
      bench.call("parameter.set", {{"axis", "x"}, {"parameter", 19}, {"value_in_unit", "4mm/s"}});
  EXPECT_THAT(warnings(done),
              Contains(HasSubstr("is below start_velocity 40960 pps (4 mm/s), so a short way")));
}

TEST(Warnings, SpeakOfParametersOfATmc429) {
  JourneyBench bench("TMCM-1110");
  set(bench, 153, 13);
  set(bench, 154, 0);
  EXPECT_THAT(warnings(set(bench, 5, 1)),
              Contains("max_acceleration 1 is outside its valid range for pulse_divisor 0 and "
                       "ramp_divisor 13: the motor may oscillate around its target"));
  set(bench, 5, 2000);
  EXPECT_THAT(warnings(set(bench, 130, 2000)),
              Contains("minimum_velocity 2000 is above max_velocity 1000"));
}

TEST(Warnings, AreOfAnAccelerationOutsideItsDividers) {
  JourneyBench bench("TMCM-1110");
  set(bench, 153, 13);
  set(bench, 154, 0);
  EXPECT_THAT(warnings(set(bench, 5, 1)), Contains(HasSubstr("outside its valid range")));
}

TEST(Warnings, AreOfASettingInWhicheverUnitItIsCounted) {
  JourneyBench bench("TMCM-142");
  set(bench, 255, 1);
  EXPECT_THAT(warnings(set(bench, 5, 1'455'192)), IsEmpty());
  EXPECT_THAT(warnings(set(bench, 5, 5000)),
              Contains(HasSubstr("exceeds acceleration 5000 pps/s")));
}

TEST(Warnings, CostTheReadingsOfARampOnce) {
  JourneyBench bench("TMCM-6212");
  set(bench, 5, 1000);
  bench.requests.clear();
  set(bench, 17, 1000);
  set(bench, 4, 5000);
  set(bench, 6, 100);
  EXPECT_EQ(bench.sent(tmcl::Command::GAP).size(), 0U);
}

class WaitingFor : public testing::Test {
 protected:
  Result<boost::json::object> wait(std::int64_t timeout_ms) {
    return bench.call("axis.wait", {{"axis", "x"}, {"timeout_ms", timeout_ms}});
  }

  JourneyBench bench{"TMCM-142"};
};

TEST_F(WaitingFor, AnAxisThatStandsTellsOfItsSettings) {
  EXPECT_THAT(warnings(wait(1000)), IsEmpty());
  set(bench, 18, 18);
  EXPECT_THAT(warnings(wait(1000)), Contains(HasSubstr("the motor oscillates")));
}

TEST_F(WaitingFor, AnAxisThatSwingsSaysWhyInTheEnd) {
  set(bench, 18, 18);
  bench.call("axis.move_to", to(100));
  const auto waited = wait(5000);
  ASSERT_FALSE(waited);
  EXPECT_EQ(waited.error().name, "deadline_passed");
  EXPECT_THAT(waited.error().hint, HasSubstr("the motor oscillates"));
}

// So slowly that its speed is read as 0 where it turns round.
TEST_F(WaitingFor, AnAxisThatSwingsDoesNotEndWhereItTurnsRound) {
  constexpr int greatest_bow_value = 4;
  set(bench, 18, 3);
  set(bench, 5, greatest_bow_value / 2);
  for (const int distance : {1, 10, 100}) {
    bench.call("axis.move_to", to(distance));
    for (int i = 0; i < 20; ++i) {
      bench.time.run_for(std::chrono::milliseconds(173));
      EXPECT_FALSE(wait(300)) << "looked at the " << i << ". time on its way to " << distance;
    }
  }
}

TEST_F(WaitingFor, AnAxisInDoubtEndsWhereItComesToRest) {
  set(bench, 5, 256);
  set(bench, 18, 9);
  bench.call("axis.move_to", to(5000));
  const auto waited = wait(60'000);
  EXPECT_THAT(warnings(waited), Contains(HasSubstr("may oscillate")));
  EXPECT_EQ(waited->at("position_microsteps"), 5000);
}

TEST(Warnings, AreOfThePathThatIsPlanned) {
  JourneyBench bench("TMCM-6212");
  const json::object path{{"axes", json::array{"x"}}, {"text", "G1 X1 F60\n"}, {"per_turn", 1.0}};
  EXPECT_THAT(warnings(bench.call("path.plan", path)), IsEmpty());
  set(bench, 18, 0);
  EXPECT_THAT(warnings(bench.call("path.plan", path)),
              Contains(testing::StartsWith("x: deceleration_d1 0 pps/s cannot brake")));
}

}  // namespace
}  // namespace tmcld::test
