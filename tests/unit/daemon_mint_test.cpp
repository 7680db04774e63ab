// mint.run on simulated modules, in virtual time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "unit/journey_bench.hpp"

namespace tmcld::test {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;
using tmcl::Command;

// On a TMCM-3110 these need other dividers than it begins with.
const std::string two_goes =
    "SPEED = 9000, 4000\nACCEL = 90000, 40000\nMOVEA = 5000, -2000\nGO\n"
    "SPEED = 700\nMOVEA = 4000\nGO\n";

json::object order(const std::string& text, json::array axes = {"x", "y"}) {
  return {{"axes", std::move(axes)}, {"text", text}};
}
std::string name_of(const Result<boost::json::object>& result) { return result.error().name; }

std::map<int, std::int64_t> settings_of(JourneyBench& bench, std::string_view axis) {
  std::map<int, std::int64_t> settings;
  for (const int parameter : {4, 5, 130, 153, 154})
    settings[parameter] = bench.get(axis, parameter);
  return settings;
}

TEST(DaemonMint, GroupAfterGroupIsRunAndTheRampsAreAsTheyWere) {
  JourneyBench bench;
  const auto x = settings_of(bench, "x");
  const auto y = settings_of(bench, "y");
  bench.requests.clear();
  const auto result = bench.call("mint.run", order(two_goes));
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(bench.position("x"), 4000);
  EXPECT_EQ(bench.position("y"), -2000);
  EXPECT_EQ(settings_of(bench, "x"), x);
  EXPECT_EQ(settings_of(bench, "y"), y);
  const auto& groups = result->at("groups").as_array();
  ASSERT_EQ(groups.size(), 2U);
  EXPECT_EQ(groups[0].at("line"), 4);
  EXPECT_EQ(groups[1].at("line"), 7);
  const double planned = groups[1].at("planned_s").to_number<double>();
  EXPECT_NEAR(groups[1].at("took_s").to_number<double>(), planned, 0.2 * planned);
  EXPECT_TRUE(result->at("remarks").as_array().empty());
  EXPECT_FALSE(bench.gateway->has_journeys());
}

TEST(DaemonMint, GroupsThatMoveNothingDoNotKeepTheReactor) {
  JourneyBench bench;
  std::string text;
  for (int group = 0; group < 20'000; ++group) text += "MOVEA=0:GO\n";
  const auto run = bench.begin("mint.run", order(text, {"x"}));
  bench.time.run_for(std::chrono::seconds(1));
  EXPECT_FALSE(run->has_value());
  bench.call("axis.stop", {{"axis", "x"}});
  EXPECT_FALSE(bench.end_of(run));
}

TEST(DaemonMint, WhatIsTooFastIsRefusedWithAWayOut) {
  JourneyBench bench;
  const auto refused = [&](const std::string& text) {
    const auto result = bench.call("mint.run", order(text, {"x"}));
    return result ? "it was run" : result.error().message + " | " + result.error().hint;
  };
  const auto fast = refused("SCALE = 10\nSPEED = 100000\nACCEL = 100000\nMOVEA = 200000\nGO\n");
  EXPECT_THAT(fast, HasSubstr("SPEED of x: 100000 is too fast"));
  EXPECT_THAT(fast, HasSubstr("the nearest possible value is 49975.58"));
  EXPECT_THAT(fast, HasSubstr("With 64 microsteps a full step (parameter 140 set to 6) it can be "
                              "had; SCALE is 2.5 then"));
  // What no resolution makes possible has no such hint.
  EXPECT_THAT(refused("SPEED = 1E9\nACCEL = 1E12\nMOVEA = 100\nGO\n"),
              Not(HasSubstr("parameter 140")));
}

TEST(DaemonMint, WhichRampIsTooSteepIsSaid) {
  JourneyBench bench("TMCM-6212",
                     "unit = \"mm\"\nscrew_pitch = 10\ngear_ratio = 3\nencoder_lines = 1000\n");
  const auto refused = [&](const std::string& ramps) {
    auto params = order("SCALE = 1200\nSPEED = 250\n" + ramps + "MOVEA = 200\nGO\n", {"x"});
    params["counts"] = "encoder";
    const auto result = bench.call("mint.run", params);
    return result ? "it was run" : result.error().message + " | " + result.error().hint;
  };
  // The note's own: 19200000 microsteps/s^2 with 256 microsteps. In counts of an encoder the
  // program stays as it is.
  const auto accel = refused("ACCEL = 1250\nDECEL = 400\n");
  EXPECT_THAT(accel,
              HasSubstr("ACCEL of x: 1250 is too large; the nearest possible value is 496.69"));
  EXPECT_THAT(accel,
              EndsWith("With 64 microsteps a full step (parameter 140 set to 6) it can be had"));
  EXPECT_THAT(refused("ACCEL = 400\nDECEL = 1250\n"), HasSubstr("DECEL of x: 1250 is too large"));
}

TEST(DaemonMint, WhoAsksIsToldHowFarItIs) {
  JourneyBench bench;
  ASSERT_TRUE(bench.call("mint.run", order(two_goes + "MOVER = 1\n", {"x", "y", "z"})));
  ASSERT_GT(bench.news.size(), 3U);
  const auto& checked = bench.news.front();
  EXPECT_EQ(checked.at("phase"), "checked");
  EXPECT_EQ(json::serialize(checked.at("axes")),
            R"([{"number":0,"axis":"x"},{"number":1,"axis":"y"}])");
  EXPECT_THAT(json::serialize(checked.at("remarks")), HasSubstr("line 8: no GO starts the move"));
  EXPECT_EQ(bench.news[1].at("phase"), "running");
  EXPECT_EQ(bench.news[1].at("line"), 4);
  EXPECT_EQ(bench.news[1].at("passed_s").to_number<double>(), 0);
  const auto stands = std::ranges::find_if(
      bench.news, [](const json::object& news) { return news.at("phase") == "stands"; });
  ASSERT_NE(stands, bench.news.end());
  EXPECT_EQ(stands->at("line"), 4);
}

TEST(DaemonMint, AxesOfOneModuleStartByOneCommand) {
  JourneyBench bench;
  ASSERT_TRUE(bench.call("mint.run", order("SPEED = 500;\nACCEL = 9000;\nMOVEA = 50, 60, 70\nGO\n",
                                           {"x", "far", "y"})));
  const auto moves = bench.sent(Command::MVP);
  ASSERT_EQ(moves.size(), 2U);
  EXPECT_EQ(moves[0].type, 2);  // COORD
  EXPECT_EQ(moves[1].type, 0);  // ABS
  EXPECT_EQ(moves[1].value, 60);
  EXPECT_EQ(bench.sent(Command::SCO).size(), 2U);
  EXPECT_EQ(bench.position("y"), 70);
}

TEST(DaemonMint, NothingIsSentForAProgramThatCannotBe) {
  JourneyBench bench("TMCM-3110",
                     "unit = \"mm\"\nunits_per_revolution = 1\nsoft_limits = [-1, 1]\n");
  ASSERT_TRUE(bench.call("axis.get_units", {{"axis", "x"}}));
  const std::string good = "SPEED = 900\nACCEL = 9000\n";
  const std::pair<json::object, std::string> cases[] = {
      {order("SPED = 1\n"), "bad_program"},
      {order("GO\n"), "bad_program"},
      {order(good), "bad_program"},
      {order(good + "MOVEA = 99999\nGO\n"), "beyond_soft_limit"},
      {order(good + "MOVEA = 1E12\nGO\n"), "out_of_range"},
      {order("SPEED = 1E9\nACCEL = 1E12\nMOVEA = 100\nGO\n"), "out_of_range"},
      {order("SPEED.2 = 9\nACCEL.2 = 9\nMOVEA.2 = 100\nGO\n"), "missing_axis"},
      {order(good + "MOVEA = 1\nGO\n", {"x", "x"}), "bad_argument"},
      {order(good + "MOVEA = 1\nGO\n", {"nobody"}), "unknown_axis"}};
  for (const auto& [params, name] : cases) {
    const auto result = bench.call("mint.run", params);
    ASSERT_FALSE(result) << name;
    EXPECT_EQ(name_of(result), name) << result.error().message;
    EXPECT_EQ(result.error().outcome, tmcl::Outcome::not_sent);
  }
  const auto missing = bench.call("mint.run", cases[6].first);
  EXPECT_EQ(missing.error().subject.at("file_axis"), "2");
  const auto limited = bench.call("mint.run", cases[3].first);
  EXPECT_THAT(limited.error().message, HasSubstr("line 3 moves x too far: "));
  const auto wrong = bench.call("mint.run", cases[0].first);
  EXPECT_EQ(wrong.error().subject.at("problems").at(0).at("line"), 1);
  EXPECT_TRUE(bench.sent(Command::MVP).empty());
  EXPECT_TRUE(bench.sent(Command::SAP).empty());
}

// The note's exercise: 1000 lines behind a gear of 3:1 and a pitch of 10 mm are 1200 counts a mm,
// and 200 mm take a second.
TEST(DaemonMint, TheExerciseRunsAsPrintedInCountsOfTheEncoder) {
  JourneyBench bench("TMCM-6212",
                     "unit = \"mm\"\nscrew_pitch = 10\ngear_ratio = 3\nencoder_lines = 1000\n");
  constexpr int microsteps_of_a_mm = 16 * 200 * 3 / 10;
  bench.call("parameter.set", {{"axis", "x"}, {"parameter", 140}, {"value", 4}});
  const std::string exercise =
      "SCALE = 1200\nSPEED = 250\nACCEL = 1250\nDECEL = 1250\nMOVEA = 200\nGO\n";
  auto params = order(exercise, {"x"});
  params["counts"] = "encoder";
  const auto result = bench.call("mint.run", params);
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(bench.position("x"), 200 * microsteps_of_a_mm);
  EXPECT_NEAR(result->at("groups").at(0).at("planned_s").to_number<double>(), 1, 1e-9);
  EXPECT_NEAR(result->at("groups").at(0).at("took_s").to_number<double>(), 1, 0.05);
  // From where it stands, in counts.
  params["text"] = "SCALE = 1200\nSPEED = 250\nACCEL = 1250\nMOVER = -50\nGO\n";
  ASSERT_TRUE(bench.call("mint.run", params));
  EXPECT_EQ(bench.position("x"), 150 * microsteps_of_a_mm);
}

TEST(DaemonMint, CountsOfAnEncoderNeedOneInTheConfiguration) {
  JourneyBench bench;
  auto params = order(two_goes);
  params["counts"] = "encoder";
  const auto unknown = bench.call("mint.run", params);
  ASSERT_FALSE(unknown);
  EXPECT_EQ(name_of(unknown), "unknown_units");
  params["counts"] = "turns";
  EXPECT_EQ(name_of(bench.call("mint.run", params)), "bad_argument");
  EXPECT_TRUE(bench.sent(Command::MVP).empty());
  params["counts"] = "microsteps";
  EXPECT_TRUE(bench.call("mint.run", params));
}

TEST(DaemonMint, ItsAxesMoveForNobodyElseAndAStopOfOneStopsAll) {
  JourneyBench bench;
  const auto x = settings_of(bench, "x");
  const auto pending = bench.begin("mint.run", order("SPEED = 500;\nACCEL = 9000;\n"
                                                     "MOVEA = 5000, 6000\nGO\nMOVEA = 0, 0\nGO\n"));
  bench.time.run_for(std::chrono::seconds(2));
  EXPECT_TRUE(bench.gateway->has_journeys());
  const auto refused = bench.call("axis.move_to", {{"axis", "x"}, {"position_microsteps", 1}});
  ASSERT_FALSE(refused);
  EXPECT_EQ(name_of(refused), "axis_claimed");
  EXPECT_THAT(refused.error().message, HasSubstr("is moved by a Mint program"));
  ASSERT_TRUE(bench.call("axis.stop", {{"axis", "y"}}));
  const auto ended = bench.end_of(pending);
  ASSERT_FALSE(ended);
  EXPECT_EQ(name_of(ended), "stopped_by_other");
  EXPECT_EQ(ended.error().subject.at("axis"), "y");
  EXPECT_EQ(ended.error().outcome, tmcl::Outcome::done);
  EXPECT_TRUE(ended.error().subject.at("run").at("groups").as_array().empty());
  EXPECT_EQ(bench.get("x", 3), 0);
  EXPECT_EQ(bench.get("y", 3), 0);
  EXPECT_LT(bench.position("x"), 5000);
  EXPECT_EQ(settings_of(bench, "x"), x);
  EXPECT_FALSE(bench.gateway->has_journeys());
}

TEST(DaemonMint, TheEndOfTheDaemonStopsAll) {
  JourneyBench bench;
  const auto pending = bench.begin("mint.run", order(two_goes));
  bench.time.run_for(std::chrono::milliseconds(300));
  bench.gateway->end_journeys();
  const auto ended = bench.end_of(pending);
  ASSERT_FALSE(ended);
  EXPECT_EQ(name_of(ended), "stopped");
  EXPECT_EQ(bench.get("x", 3), 0);
}

}  // namespace
}  // namespace tmcld::test
