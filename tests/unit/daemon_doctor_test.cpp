// What the method finds that looks for what keeps axes from moving.
#include <algorithm>

#include <gmock/gmock.h>

#include "tmcl/doctor.hpp"
#include "unit/journey_bench.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct Found {
  std::string check;
  std::string subject;
  std::string text;
  std::string cure;
};

std::vector<Found> wrong_in(JourneyBench& bench, json::object params = {}) {
  const auto result = bench.call("doctor.examine", std::move(params));
  if (!result) throw std::runtime_error(result.error().message);
  std::vector<Found> wrong;
  for (const auto& one : result->at("findings").as_array())
    if (one.at("wrong").as_bool())
      wrong.push_back(
          {std::string(one.at("check").as_string()), std::string(one.at("subject").as_string()),
           std::string(one.at("text").as_string()), std::string(one.at("cure").as_string())});
  return wrong;
}

/// "check of subject"
std::vector<std::string> names_in(JourneyBench& bench, json::object params = {}) {
  std::vector<std::string> names;
  for (const auto& one : wrong_in(bench, std::move(params)))
    names.push_back(one.check + " of " + one.subject);
  return names;
}

void set(JourneyBench& bench, const char* axis, const char* parameter, int value) {
  const auto done =
      bench.call("parameter.set", {{"axis", axis}, {"parameter", parameter}, {"value", value}});
  ASSERT_TRUE(done) << done.error().message;
}

TEST(Doctor, FindsNothingWhereNothingIsWrong) {
  JourneyBench bench;
  EXPECT_THAT(names_in(bench), IsEmpty());
  const auto all = bench.call("doctor.examine", {});
  EXPECT_GT(all->at("findings").as_array().size(), 50U);
}

TEST(Doctor, ChangesNothing) {
  JourneyBench bench;
  bench.requests.clear();
  ASSERT_TRUE(bench.call("doctor.examine", {}));
  for (const auto& request : bench.requests)
    EXPECT_EQ(tmcl::intent_of(request).effect, tmcl::Effect::reads) << describe(request);
}

TEST(Doctor, FindsWhatWasSetTo0) {
  JourneyBench bench;
  set(bench, "x", "max_current", 0);
  set(bench, "y", "max_velocity", 0);
  EXPECT_THAT(names_in(bench), ElementsAre("current of x", "velocity of y"));
  EXPECT_THAT(names_in(bench, {{"axis", "y"}}), ElementsAre("velocity of y"));
  EXPECT_THAT(names_in(bench, {{"axis", "far"}}), IsEmpty());
  EXPECT_THAT(wrong_in(bench).front().cure, HasSubstr("tmclctl set x max_current"));
}

TEST(Doctor, FindsAModuleThatHasNoSupply) {
  JourneyBench bench;
  ASSERT_THAT(names_in(bench), IsEmpty());
  bench.wire.bench().modules().front()->power_off();
  const auto names = names_in(bench);
  EXPECT_THAT(names, testing::Contains("module of line:1"));
  EXPECT_THAT(names, testing::Not(testing::Contains("replies of line"))) << "the line is well";
  EXPECT_THAT(names_in(bench, {{"axis", "far"}}), IsEmpty());
}

TEST(Doctor, SaysWhatALineBringsInsteadOfAnswers) {
  JourneyBench bench;
  ASSERT_THAT(names_in(bench), IsEmpty());
  for (const auto& module : bench.wire.bench().modules()) module->power_off();
  const auto nothing = wrong_in(bench, {{"axis", "x"}}).front();
  EXPECT_THAT(nothing.text, testing::EndsWith("does not answer: nothing came back"));
  EXPECT_THAT(nothing.cure, HasSubstr("A and B, or RX and TX swapped?"));
  // One that was silent just now is left alone for a while: nothing can be said of its answers.
  EXPECT_THAT(wrong_in(bench, {{"axis", "x"}}).front().text, testing::EndsWith("does not answer"));
}

TEST(Doctor, FindsMotorsWithoutSupply) {
  JourneyBench bench;
  bench.wire.bench().modules().front()->set_supply(52);
  const auto wrong = wrong_in(bench, {{"axis", "x"}});
  ASSERT_FALSE(wrong.empty());
  EXPECT_EQ(wrong.front().check, "supply");
  EXPECT_THAT(wrong.front().text, AllOf(HasSubstr("its supply is too low"), HasSubstr("5.2 V")));
}

TEST(Doctor, FindsALineThatLosesReplies) {
  JourneyBench bench;
  int asked = 0;
  bench.on_request = [&](const tmcl::Request&) { bench.wire.is_cut = ++asked % 40 == 0; };
  EXPECT_THAT(names_in(bench, {{"axis", "x"}}), testing::Contains("replies of line"));
  bench.on_request = {};
  bench.wire.is_cut = false;
  EXPECT_THAT(names_in(bench, {{"axis", "x"}}), IsEmpty());
}

TEST(Doctor, BlamesAPauseForTenMinutes) {
  JourneyBench bench;
  bench.time.run_for(1s);
  bench.time.freeze_for(3s);
  bench.time.run_for(9min);
  EXPECT_THAT(names_in(bench), testing::Contains(testing::StartsWith("stalls of")));
  bench.time.run_for(2min);
  EXPECT_THAT(names_in(bench), testing::Not(testing::Contains(testing::StartsWith("stalls of"))));
}

TEST(Doctor, SharesItsProbesAmongTheModulesOfABus) {
  constexpr auto most_probes = 100;
  const auto positions_asked = [](json::object params) {
    JourneyBench bench;
    bench.requests.clear();
    EXPECT_TRUE(bench.call("doctor.examine", std::move(params)));
    return std::ranges::count_if(bench.requests, [](const tmcl::Request& request) {
      return request.command == tmcl::Command::GAP && request.type == 1;
    });
  };
  const auto of_one = positions_asked({{"axis", "x"}});
  const auto of_two = positions_asked({});
  EXPECT_GE(of_one, most_probes);
  EXPECT_LT(of_two, of_one + most_probes / 2);
}

TEST(Doctor, FindsALatchAfterARestart) {
  JourneyBench bench;
  bench.wire.bench().modules().front()->power_cycle();
  bench.time.run_for(1s);
  bench.call("axis.move_to", {{"axis", "x"}, {"position_microsteps", 100}});
  const auto names = names_in(bench);
  EXPECT_THAT(names, testing::IsSupersetOf({"latch of x", "latch of y", "latch of z"}));
  EXPECT_THAT(names, testing::Not(testing::Contains("latch of far")));
}

TEST(Doctor, FindsAMissingReference) {
  JourneyBench bench("TMCM-3110", "reference = \"required\"\n");
  EXPECT_THAT(names_in(bench, {{"axis", "x"}}), ElementsAre("reference of x"));
}

TEST(Doctor, FindsAPlaceBeyondTheLimits) {
  JourneyBench bench("TMCM-3110", "soft_limits = [100, 1000]\n");
  const auto wrong = wrong_in(bench, {{"axis", "x"}});
  ASSERT_EQ(wrong.size(), 1U);
  EXPECT_EQ(wrong.front().check, "limits");
  EXPECT_THAT(wrong.front().text, HasSubstr("0 microsteps is beyond the soft limit of 100"));
}

TEST(Doctor, FindsAnotherResolutionThanConfigured) {
  JourneyBench bench("TMCM-3110", "unit = \"mm\"\nunits_per_revolution = 1\nmicrosteps = 64\n");
  EXPECT_THAT(wrong_in(bench, {{"axis", "x"}}).front().text,
              HasSubstr("it counts 256 of a full step, the configuration 64"));
}

TEST(Doctor, FindsWhyAnAxisWasStopped) {
  JourneyBench bench;
  ASSERT_TRUE(bench.call("axis.move_to", {{"axis", "x"}, {"position_microsteps", 100'000}}));
  bench.time.run_for(500ms);
  ASSERT_TRUE(bench.call("axis.stop", {{"axis", "x"}}));
  bench.time.run_for(2s);
  const auto wrong = wrong_in(bench, {{"axis", "x"}});
  ASSERT_EQ(wrong.size(), 1U);
  EXPECT_EQ(wrong.front().check, "stop");
  EXPECT_THAT(wrong.front().text, HasSubstr("client"));
}

/// Another host has sent it there: nothing but its switch tells.
TEST(Doctor, FindsTheSwitchThatStoppedAnAxisForAnother) {
  JourneyBench bench;
  auto& module = *bench.wire.bench().modules().front();
  bench.wire.inject({tmcl::ModuleAddress{1}, tmcl::Command::MVP, 0, 0, 100'000});
  bench.time.run_for(500ms);
  module.at_stage(
      0, [](tmcl::sim::Stage& stage) { stage.press(tmcl::sim::StageSwitch::right, true); });
  bench.time.run_for(2s);
  EXPECT_THAT(names_in(bench, {{"axis", "x"}}), ElementsAre("stop of x"));
}

TEST(Doctor, FindsAMotorThatTheModuleDoesNotHave) {
  JourneyBench bench("TMCM-1110");
  EXPECT_THAT(names_in(bench), ElementsAre("motor of y", "motor of z"));
}

TEST(Doctor, KnowsItsSubjects) {
  JourneyBench bench;
  EXPECT_EQ(bench.call("doctor.examine", {{"axis", "nix"}}).error().name, "unknown_axis");
  EXPECT_EQ(bench.call("doctor.examine", {{"bus", "nix"}}).error().name, "unknown_bus");
  EXPECT_EQ(bench.call("doctor.examine", {{"bus", "line"}, {"axis", "x"}}).error().name,
            "bad_argument");
}

/// At every request a module may fall silent: what was found until then is an answer all the same.
TEST(Doctor, EndsWhereverTheModuleFallsSilent) {
  for (int asked = 1; asked < 120; asked += 7) {
    JourneyBench bench;
    int left = asked;
    bench.on_request = [&](const tmcl::Request&) { bench.wire.is_cut = --left <= 0; };
    EXPECT_TRUE(bench.call("doctor.examine", {})) << asked;
  }
}

}  // namespace
}  // namespace tmcld::test
