// What the twin of an axis knows goes with the answers of moves, lines and turning.
#include <gmock/gmock.h>

#include "unit/journey_bench.hpp"

namespace tmcld::test {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> warnings(const RpcResult& result) {
  EXPECT_TRUE(result) << result.error().message;
  std::vector<std::string> all;
  for (const auto& text : result->at("warnings").as_array()) all.emplace_back(text.as_string());
  return all;
}
json::object to(std::int64_t position) {
  return {{"axis", "x"}, {"position_microsteps", position}};
}
void set(JourneyBench& bench, int parameter, std::int32_t value) {
  const auto result =
      bench.call("parameter.set", {{"axis", "x"}, {"parameter", parameter}, {"value", value}});
  EXPECT_TRUE(result) << result.error().message;
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
  EXPECT_THAT(warnings(bench.call("axis.move_to", to(100'000))), Contains(HasSubstr("d1 0")));
}

TEST(Warnings, SayWhyAMoveIsNotForeseen) {
  JourneyBench bench("TMCM-1111");
  const auto moved = bench.call("axis.move_to", to(100));
  EXPECT_TRUE(moved->at("predicted_s").is_null());
  EXPECT_THAT(warnings(moved), Contains(HasSubstr("not foreseen")));
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

}  // namespace
}  // namespace tmcld::test
