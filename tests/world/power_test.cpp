// The supply of a module fails, and nobody tells the gateway: its link is as it was.
#include <gmock/gmock.h>

#include <algorithm>
#include <string>
#include <vector>

#include <boost/json/serialize.hpp>

#include "tmcl/program.hpp"
#include "world/cable.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

class Power : public Cable {
 protected:
  explicit Power(const std::string& config = cable_config, std::string_view model = "TMCM-6212")
      : Cable(config, model) {
    events.clear();
    wire.on_request = [this](const tmcl::Request& request) { requests.push_back(request); };
  }
  void fail_and_return() {
    module.power_cycle();
    wire.touch();
  }
  void start_again() {
    fail_and_return();
    time.run_for(500ms);
    requests.clear();
  }
  std::size_t count(tmcl::Command command) const {
    return static_cast<std::size_t>(std::ranges::count(requests, command, &tmcl::Request::command));
  }
  std::vector<tmcl::Command> commands() const {
    std::vector<tmcl::Command> commands;
    for (const auto& request : requests) commands.push_back(request.command);
    return commands;
  }
  static json::object of(const char* axis, json::object more = {}) {
    more["axis"] = axis;
    return more;
  }
  void expect_latched(const Result<boost::json::object>& result) {
    ASSERT_FALSE(result);
    EXPECT_EQ(name_of_error(result), "latched");
    EXPECT_EQ(result.error().kind, ErrorKind::not_now);
    EXPECT_EQ(result.error().outcome, tmcl::Outcome::not_sent);
    EXPECT_THAT(result.error().message, HasSubstr("module 1 has started again"));
  }

  std::vector<tmcl::Request> requests;
};

TEST_F(Power, IsSeenToHaveFailedByTheNextLook) {
  call("axis.move_to", of("x", {{"position", 5}}));
  time.run_for(5s);
  start_again();
  EXPECT_TRUE(events.empty());
  call("axis.get_state", of("y"));
  EXPECT_THAT(events, testing::ElementsAre("module_reset"));
  for (const char* axis : {"x", "y"})
    expect_latched(call("axis.move_to", of(axis, {{"position", 5}})));
  EXPECT_TRUE(call("axis.stop", of("x")));
  call("axis.get_state", of("y"));
  EXPECT_EQ(events.size(), 1U) << "it is told once";
}

/// The module only records it: no search has begun.
TEST_F(Power, LatchesAlsoWhenAProgramIsLoadedThatSearchesTheReference) {
  start_again();
  call("axis.get_state", of("x"));
  json::object load{{"bus", "bench"}, {"address", 1}};
  load["program"] = tmcl::program::to_hex(tmcl::program::Program{{tmcl::Command::RFS, 0, 0, 0},
                                                                 {tmcl::Command::RFS, 0, 0, 0},
                                                                 {tmcl::Command::STOP, 0, 0, 0}});
  ASSERT_TRUE(call("program.load", load));
  expect_latched(call("axis.move_to", of("x", {{"position", 5}})));
}

TEST_F(Power, IsSeenToHaveFailedBeforeAnythingThatMoves) {
  const std::vector<std::pair<std::string, json::object>> ways{
      {"axis.move_to", {{"position", 5}}},
      {"axis.move_to", {{"position", 5}, {"predict", false}}},
      {"axis.move_by", {{"distance", 5}}},
      {"axis.rotate", {{"velocity", 5}}},
      {"parameter.set", {{"parameter", 0}, {"value", 5000}}},
      {"axis.home", {{"timeout_ms", 1000}}},
      {"module.execute", {{"bus", "bench"}, {"address", 1}, {"command", "MVP"}, {"value", 5}}},
  };
  for (const auto& [method, params] : ways) {
    SCOPED_TRACE(method);
    auto all = params;
    if (!params.contains("bus")) all["axis"] = "x";
    start_again();
    const auto result = call(method, all);
    expect_latched(result);
    for (const auto& request : requests)
      EXPECT_FALSE(can_move(request)) << static_cast<int>(request.command);
    EXPECT_FALSE(moves());
    EXPECT_THAT(events, testing::ElementsAre("module_reset"));
    events.clear();
    EXPECT_TRUE(call("axis.recover", of("x")));
  }
}

TEST_F(Power, FailsInVainForWhoeverWaits) {
  call("axis.move_to", of("x", {{"position", 5}}));
  time.run_for(10s);
  call("axis.move_to", of("x", {{"position", 900}}));
  const auto waits = begin("axis.wait", of("x"));
  time.run_for(1s);
  ASSERT_FALSE(*waits);
  fail_and_return();
  const auto result = end(waits);
  ASSERT_FALSE(result) << json::serialize(*result);
  EXPECT_THAT(name_of_error(result), testing::AnyOf("latched", "module_silent", "reply_timeout"));
  time.run_for(500ms);
  const auto again = call("axis.wait", of("x"));
  ASSERT_FALSE(again) << "it is where it was sent, as its module has it: at 0";
  EXPECT_EQ(name_of_error(again), "latched");
}

TEST_F(Power, EndsAPathWhenItFails) {
  const auto path = begin_path();
  fail_and_return();
  const auto result = end(path);
  ASSERT_FALSE(result);
  time.run_for(3s);
  EXPECT_FALSE(moves());
  call("axis.get_state", of("x"));
  EXPECT_THAT(events, Contains("module_reset"));
  requests.clear();
  time.run_for(60s);
  EXPECT_THAT(commands(), Not(Contains(tmcl::Command::MVP)));
  EXPECT_FALSE(moves()) << "nothing resumes by itself";
}

TEST_F(Power, EndsALineWhenItFails) {
  call("line.move", {{"axes", json::array{"x", "y"}}, {"positions", json::array{100, 50}}});
  time.run_for(1s);
  ASSERT_TRUE(moves());
  start_again();
  time.run_for(3s);
  EXPECT_FALSE(moves());
  EXPECT_THAT(events, Contains("module_reset"));
  EXPECT_THAT(events, Contains("line_broken"));
  expect_latched(call("axis.move_to", of("y", {{"position", 5}})));
}

TEST_F(Power, LeavesAnAxisAloneUntilSomebodySaysThatItMayMove) {
  call("axis.home", of("x", {{"mode", 1}, {"timeout_ms", 1000}}));
  start_again();
  auto state = call("axis.get_state", of("x"));
  state = call("axis.get_state", of("x"));
  EXPECT_EQ(state->at("latched"), true);
  EXPECT_EQ(state->at("referenced"), false);
  EXPECT_EQ(state->at("stop_cause"), "supply");
  EXPECT_EQ(call("axis.get_state", of("y"))->at("latched"), true);
  EXPECT_TRUE(call("axis.recover", of("x")));
  EXPECT_EQ(call("axis.get_state", of("x"))->at("latched"), false);
  EXPECT_TRUE(call("axis.move_to", of("x", {{"position", 5}})));
  expect_latched(call("axis.move_to", of("y", {{"position", 5}})));
  call("axis.start_home", of("y", {{"mode", 1}}));
  EXPECT_EQ(call("axis.get_state", of("y"))->at("latched"), false);
}

TEST_F(Power, IsNotRecoveredFromByWhoeverDoesNotKnowOfIt) {
  wire.is_cut = true;
  EXPECT_FALSE(call("axis.get_state", of("x")));
  fail_and_return();
  time.run_for(1s);
  wire.is_cut = false;
  auto recovered = call("axis.recover", of("x"));
  while (name_of_error(recovered) == "module_silent") {
    time.run_for(10ms);
    recovered = call("axis.recover", of("x"));
  }
  expect_latched(recovered);
  EXPECT_TRUE(call("axis.recover", of("x"))) << "now it is known";
}

TEST_F(Power, CostsNoWrongMillimetre) {
  // The EEPROM has 256 microsteps, and 16 were set since.
  call("parameter.set", of("x", {{"parameter", "microstep_resolution"}, {"value", 4}}));
  call("axis.move_to", of("x", {{"position", 10}}));
  time.run_for(20s);
  EXPECT_NEAR(call("axis.get_state", of("x"))->at("position").to_number<double>(), 10, 0.01);
  EXPECT_NEAR(get(0, ap::actual_position), 10 * 3200 / 5, 1);
  start_again();
  expect_latched(call("axis.move_to", of("x", {{"position", 10}})));
}

TEST_F(Power, IsAskedForWithoutAFurtherExchangeWhereAPositionIsProven) {
  call("axis.get_state", of("x"));
  time.run_for(10s);
  requests.clear();
  call("axis.move_by", of("x", {{"distance_microsteps", 100}, {"predict", false}}));
  EXPECT_THAT(commands(), testing::ElementsAre(tmcl::Command::GAP, tmcl::Command::GGP,
                                               tmcl::Command::GAP, tmcl::Command::MVP));
  time.run_for(10s);
  requests.clear();
  call("axis.move_to", of("x", {{"position_microsteps", 100}, {"predict", false}}));
  EXPECT_THAT(commands(), testing::ElementsAre(tmcl::Command::GGP, tmcl::Command::MVP));
}

TEST_F(Power, DoesNotSeemToHaveFailedWhenTheTimerWrapsOrIsSet) {
  call("global.set", {{"bus", "bench"},
                      {"address", 1},
                      {"bank", 0},
                      {"parameter", 132},
                      {"value", 2'147'483'000}});
  for (int i = 0; i < 20; ++i) {
    EXPECT_TRUE(call("axis.get_state", of("x")));
    time.run_for(100ms);
  }
  EXPECT_TRUE(events.empty());
  EXPECT_TRUE(call("axis.move_to", of("x", {{"position", 5}})));
}

TEST_F(Power, FailsWhileTheModuleIsNotReachable) {
  wire.is_cut = true;
  EXPECT_FALSE(call("axis.get_state", of("x")));
  fail_and_return();
  time.run_for(1s);
  wire.is_cut = false;
  time.run_for(5s);
  EXPECT_THAT(events, testing::ElementsAre("module_silent", "module_reset", "module_answers"));
  expect_latched(call("axis.move_to", of("x", {{"position", 5}})));
}

TEST_F(Power, IsSeenToHaveFailedByAMoveThatWasOnItsWayWhenTheModuleFellSilent) {
  time.run_for(1s);
  call("axis.get_state", of("y"));
  wire.is_cut = true;
  const auto lost = begin("parameter.set", of("y", {{"parameter", 0}, {"value", 1000}}));
  time.run_for(50ms);
  const auto move = begin("axis.move_to", of("x", {{"position", 5}}));
  wire.is_cut = false;
  fail_and_return();
  EXPECT_FALSE(end(lost));
  expect_latched(end(move));
  EXPECT_FALSE(moves());
}

TEST_F(Power, IsSeenToHaveFailedByAMoveThatHasWaitedForItsTurn) {
  time.run_for(1s);
  call("axis.get_state", of("y"));
  wire.is_cut = true;
  const auto lost = begin("parameter.set", of("y", {{"parameter", 0}, {"value", 1000}}));
  time.run_for(1ms);
  const auto move = begin("axis.move_to", of("x", {{"position", 5}, {"predict", false}}));
  fail_and_return();
  time.run_for(90ms);
  wire.is_cut = false;
  EXPECT_FALSE(end(lost));
  expect_latched(end(move));
  EXPECT_FALSE(moves());
}

TEST_F(Power, DoesNotSeemToHaveFailedWhenOnlyTheCableWas) {
  wire.is_cut = true;
  EXPECT_FALSE(call("axis.get_state", of("x")));
  time.run_for(60s);
  wire.is_cut = false;
  time.run_for(5s);
  EXPECT_THAT(events, testing::ElementsAre("module_silent", "module_answers"));
  EXPECT_TRUE(call("axis.move_to", of("x", {{"position", 5}})));
}

class MarkedPower : public Power {
 protected:
  MarkedPower()
      : Power(std::string(cable_config) +
              "[[module]]\nbus = \"bench\"\naddress = 1\nsentinel = \"variable:255\"\n") {}
};

TEST_F(MarkedPower, IsSeenToHaveFailedByTheVariableThatItCleared) {
  EXPECT_NE(module.globals().user_variable(255), 0);
  EXPECT_TRUE(call("axis.move_to", of("x", {{"position", 5}})));
  EXPECT_EQ(count(tmcl::Command::SGP), 0U) << "it was written when the module was met";
  start_again();
  expect_latched(call("axis.move_to", of("x", {{"position", 5}})));
  EXPECT_EQ(count(tmcl::Command::SGP), 1U);
  EXPECT_NE(module.globals().user_variable(255), 0);
}

class PowerBySettings : public Power, public testing::WithParamInterface<const char*> {
 protected:
  PowerBySettings()
      : Power(std::string(cable_config) +
                  "[[module]]\nbus = \"bench\"\naddress = 1\nsentinel = \"settings\"\n",
              GetParam()) {}
  json::value watched_by() {
    return call("module.list", {})->at("modules").as_array().front().at("watched_by");
  }
};

TEST_P(PowerBySettings, IsSeenToHaveFailedByATargetThatIsZero) {
  EXPECT_EQ(watched_by(), "none") << "nobody has sent it anywhere";
  EXPECT_TRUE(call("axis.move_to", of("x", {{"position", 5}})));
  EXPECT_EQ(watched_by(), "settings");
  start_again();
  expect_latched(call("axis.move_to", of("x", {{"position", 6}})));
  EXPECT_THAT(events, testing::ElementsAre("module_reset"));
  EXPECT_EQ(count(tmcl::Command::MVP), 0U);
  EXPECT_EQ(watched_by(), "none");
  EXPECT_TRUE(call("axis.recover", of("x")));
  EXPECT_TRUE(call("axis.move_to", of("x", {{"position", 5}})));
  EXPECT_EQ(watched_by(), "settings");
}

TEST_P(PowerBySettings, IsNotThoughtToHaveFailedWhateverTheAxisDoes) {
  module.mount(0, tmcl::sim::StageSettings{.left_switch = -30'000});
  for (int round = 0; round < 2; ++round) {
    for (const auto& [method, params] : std::vector<std::pair<std::string, json::object>>{
             {"axis.move_to", {{"position", 5}}},
             {"axis.move_by", {{"distance", -5}}},
             {"axis.move_to", {{"position", 2}}},
             {"axis.move_to", {{"position", 0}}},
             {"axis.move_to", {{"position", -3}}},
             {"axis.rotate", {{"velocity", 1}}},
             {"axis.stop", {}},
             {"parameter.set", {{"parameter", "actual_position"}, {"value", 0}}},
             {"parameter.set", {{"parameter", "target_position"}, {"value", 900}}},
             {"axis.home", {}},
             {"axis.move_to", {{"position", 1}}}}) {
      const auto done = call(method, of("x", params));
      EXPECT_TRUE(done) << method << ": " << done.error().message;
      for (int look = 0; look < 30; ++look) {
        time.run_for(100ms);
        call("axis.get_state", of("y"));
      }
    }
  }
  EXPECT_THAT(events, Not(Contains("module_reset")));
}

TEST_P(PowerBySettings, TellsNothingWhereAProgramMaySendTheAxis) {
  EXPECT_TRUE(call("axis.move_to", of("x", {{"position", 5}})));
  call("module.execute", {{"bus", "bench"}, {"address", 1}, {"command", "RUN_APPLICATION"}});
  EXPECT_EQ(watched_by(), "none");
}

INSTANTIATE_TEST_SUITE_P(Of, PowerBySettings,
                         testing::Values("TMCM-6212", "TMCM-3110", "TMCM-6110"),
                         [](const auto& one) { return "Model" + std::string(one.param + 5); });

class UnwatchedPower : public Power {
 protected:
  UnwatchedPower()
      : Power(std::string(cable_config) +
              "[[module]]\nbus = \"bench\"\naddress = 1\nsentinel = \"none\"\n") {}
};

TEST_F(UnwatchedPower, IsNotAskedFor) {
  EXPECT_TRUE(call("axis.move_to", of("x", {{"position", 5}})));
  EXPECT_TRUE(call("axis.get_state", of("x")));
  EXPECT_EQ(count(tmcl::Command::GGP), 0U);
}

class PowerDuringASearch : public Power, public testing::WithParamInterface<int> {};

TEST_P(PowerDuringASearch, DoesNotMakeItOneThatWasNotSent) {
  const auto search = begin("axis.home", {{"axis", "x"}, {"timeout_ms", 5000}});
  time.run_for(std::chrono::milliseconds(GetParam()));
  const bool is_sent = count(tmcl::Command::RFS) > 0;
  fail_and_return();
  const auto ended = end(search);
  if (is_sent && !ended) {
    EXPECT_NE(ended.error().outcome, tmcl::Outcome::not_sent) << ended.error().message;
  }
}

INSTANTIATE_TEST_SUITE_P(AtEachTime, PowerDuringASearch, testing::Range(5, 400, 15));

}  // namespace
}  // namespace tmcld::test
