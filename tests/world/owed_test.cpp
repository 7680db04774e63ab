// What could not be done because the link was away or the module silent is done when it is back:
// stops that were asked for, and settings that a path has changed.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <boost/json/serialize.hpp>

#include "support/random.hpp"
#include "support/rounds.hpp"
#include "support/seed.hpp"
#include "world/cable.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

// ---- stops -------------------------------------------------------------------------------------

class OwedStop : public Cable {
 protected:
  OwedStop() {
    wire.on_request = [this](const tmcl::Request& request) { requests.push_back(request); };
  }
  /// It is not stopped because its link is lost.
  void turn() {
    ASSERT_TRUE(call("axis.rotate", {{"axis", "x"}, {"velocity", 5}, {"unattended", true}}));
    time.run_for(1s);
    ASSERT_TRUE(moves());
  }
  void lose_link() {
    wire.unplug();
    time.run_for(1ms);
  }
  void expect_owed(const Result<boost::json::object>& result) {
    ASSERT_FALSE(result);
    EXPECT_THAT(result.error().hint, HasSubstr("as soon as the module can be"));
  }
  void expect_stop_when_it_is_back() {
    ASSERT_TRUE(moves());
    requests.clear();
    time.run_for(2s);
    ASSERT_THAT(requests, Not(IsEmpty()));
    EXPECT_EQ(requests.front().command, tmcl::Command::MST) << "before anything else";
    EXPECT_FALSE(moves());
  }

  std::vector<tmcl::Request> requests;
};

TEST_F(OwedStop, OfOneAxisIsSentWhenTheLinkIsBack) {
  turn();
  lose_link();
  expect_owed(call("axis.stop", {{"axis", "x"}}));
  expect_stop_when_it_is_back();
  EXPECT_THAT(stopped, Contains(HasSubstr("has taken the stop")));
  EXPECT_TRUE(call("axis.move_to", {{"axis", "x"}, {"position", 1}}));
}

TEST_F(OwedStop, OfAllAxesIsSentWhenTheLinkIsBack) {
  turn();
  lose_link();
  const auto all = call("system.stop_all", {});
  ASSERT_TRUE(all);
  EXPECT_THAT(json::serialize(*all), HasSubstr("as soon as the module can be"));
  expect_stop_when_it_is_back();
}

TEST_F(OwedStop, OfARawCommandIsSentWhenTheLinkIsBack) {
  turn();
  lose_link();
  expect_owed(call("module.execute", {{"bus", "bench"}, {"address", 1}, {"command", "MST"}}));
  expect_stop_when_it_is_back();
}

TEST_F(OwedStop, ThatWasInFlightIsSentAgain) {
  turn();
  wire.is_cut = true;
  const auto stop = begin("axis.stop", {{"axis", "x"}});
  time.run_for(1ms);
  wire.unplug();
  time.run_for(1ms);
  wire.is_cut = false;
  expect_owed(end(stop));
  expect_stop_when_it_is_back();
}

TEST_F(OwedStop, EndsAReferenceSearchToo) {
  call("axis.start_home", {{"axis", "y"}, {"mode", 1}});
  time.run_for(1s);
  ASSERT_TRUE(moves());
  lose_link();
  expect_owed(call("axis.stop", {{"axis", "y"}}));
  time.run_for(3s);
  EXPECT_FALSE(moves());
  EXPECT_TRUE(call("axis.move_to", {{"axis", "y"}, {"position", 1}}));
}

TEST_F(OwedStop, ThatASilentModuleDidNotGetIsSentWhenItAnswers) {
  turn();
  wire.is_cut = true;
  expect_owed(call("axis.stop", {{"axis", "x"}}));
  time.run_for(10s);
  EXPECT_TRUE(moves());
  const auto others = requests.size();
  EXPECT_LT(others, 200U) << "a silent module keeps the line from others";
  wire.is_cut = false;
  time.run_for(4s);
  EXPECT_FALSE(moves());
}

TEST_F(OwedStop, ComesBeforeAMovementThatIsAskedForAsTheLinkComesBack) {
  turn();
  lose_link();
  call("axis.stop", {{"axis", "x"}});
  requests.clear();
  while (!call("axis.move_to", {{"axis", "x"}, {"position", 500}})) time.run_for(1ms);
  const auto is_stop = [](const auto& request) { return request.command == tmcl::Command::MST; };
  const auto is_move = [](const auto& request) { return request.command == tmcl::Command::MVP; };
  const auto stop = std::ranges::find_if(requests, is_stop);
  const auto move = std::ranges::find_if(requests, is_move);
  EXPECT_LT(stop, move);
  EXPECT_EQ(std::ranges::count_if(requests, is_stop), 1);
}

TEST_F(OwedStop, IsGivenToWhatTurnsForAClientOrSearchesWhenItsLinkIsLost) {
  call("axis.rotate", {{"axis", "x"}, {"velocity", 5}});
  call("axis.start_home", {{"axis", "y"}, {"mode", 1}});
  time.run_for(1s);
  lose_link();
  ASSERT_TRUE(moves());
  EXPECT_THAT(logged, Contains(HasSubstr("axes that may move: 'x', 'y'")));
  time.run_for(3s);
  EXPECT_FALSE(moves());
}

TEST_F(OwedStop, IsNotGivenToWhatTurnsUnattended) {
  turn();
  lose_link();
  time.run_for(3s);
  EXPECT_TRUE(moves());
  EXPECT_TRUE(call("axis.stop", {{"axis", "x"}}));
}

TEST_F(OwedStop, AtAnyMomentOfALossIsCarriedOut) {
  const auto seed = tmcl::test::seed();
  tmcl::test::Random<int> random(seed);
  for (int round = 0; round < tmcl::test::rounds(20) && !HasFailure(); ++round) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed) + ", round " + std::to_string(round));
    call("axis.rotate", {{"axis", "x"}, {"velocity", 5}, {"unattended", true}});
    const auto lose = std::chrono::microseconds(random.between(0, 20'000));
    const auto ask = std::chrono::microseconds(random.between(0, 400'000));
    if (random.one_in(2)) wire.is_cut = true;
    time.run_for(lose);
    wire.unplug();
    time.run_for(ask);
    call("axis.stop", {{"axis", "x"}});
    wire.is_cut = false;
    time.run_for(5s);
    EXPECT_FALSE(moves());
  }
}

// ---- settings ----------------------------------------------------------------------------------

class Unrestored : public Cable {
 protected:
  Unrestored() {
    std::filesystem::create_directory(folder_);
    end_gateway();
    start_gateway(folder_ + "/journal");
    events.clear();
  }
  ~Unrestored() override { std::filesystem::remove_all(folder_); }

  std::string journal() const {
    std::ostringstream out;
    out << std::ifstream(folder_ + "/journal").rdbuf();
    return out.str();
  }
  std::vector<std::int32_t> settings() {
    std::vector<std::int32_t> all;
    for (const std::uint8_t motor : {std::uint8_t{0}, std::uint8_t{1}})
      for (const auto parameter : {ap::max_velocity, ap::max_acceleration})
        all.push_back(get(motor, parameter));
    return all;
  }

  const std::string folder_ =
      std::filesystem::temp_directory_path() / ("tmcl-unrestored-" + std::to_string(::getpid()));
};

TEST_F(Unrestored, SettingsOfAPathAreSetBackWhenTheModuleAnswersAgain) {
  const auto before = settings();
  const auto path = begin_path();
  wire.is_cut = true;
  end(path);
  ASSERT_NE(settings(), before);
  time.run_for(3s);
  EXPECT_THAT(journal(), HasSubstr(R"({"parameter":4,"value":240000})"));
  wire.is_cut = false;
  ASSERT_TRUE(time.run_while_not([&] { return settings() == before; }, 10s));
  time.run_for(2s);
  EXPECT_THAT(stopped, Contains(HasSubstr("max_velocity is set back to ")));
  const auto state = call("axis.get_state", {{"axis", "x"}});
  ASSERT_TRUE(state);
  EXPECT_EQ(json::serialize(state->at("unrestored")), "[]");
  EXPECT_TRUE(call("axis.move_to", {{"axis", "x"}, {"position", 1}}));
}

TEST_F(Unrestored, IsShownUntilTheModuleTakesIt) {
  const auto path = begin_path();
  wire.is_cut = true;
  end(path);
  // The module answers again, but nothing that is set gets to it.
  wire.on_request = [this](const auto& one) { wire.is_cut = one.command == tmcl::Command::SAP; };
  wire.is_cut = false;
  bool is_shown = false;
  for (int i = 0; i < 100 && !is_shown; ++i) {
    time.run_for(100ms);
    const auto state = call("axis.get_state", {{"axis", "x"}});
    is_shown = state && json::serialize(state->at("unrestored"))
                                .find(R"("parameter":"max_velocity","number":4,"value":240000)") !=
                            std::string::npos;
  }
  EXPECT_TRUE(is_shown);
}

json::object raw_setting(int motor, std::int32_t value) {
  return {{"bus", "bench"}, {"address", 1},   {"command", "SAP"},
          {"type", 4},      {"motor", motor}, {"value", value}};
}

TEST_F(Unrestored, WhatAClientSetsMeanwhileStays) {
  const auto before = settings();
  for (const bool is_raw : {false, true}) {
    const auto path = begin_path();
    wire.is_cut = true;
    end(path);
    wire.on_request = [this, old = before.front()](const auto& one) {
      wire.is_cut = one.command == tmcl::Command::SAP && one.value == old;
    };
    wire.is_cut = false;
    const auto is_pending = [&] {
      time.run_for(100ms);
      const auto state = call("axis.get_state", {{"axis", "x"}});
      return state &&
             json::serialize(state->at("unrestored")).find(R"("number":4)") != std::string::npos;
    };
    for (int i = 0; i < 100 && !is_pending(); ++i) continue;
    ASSERT_TRUE(is_pending());
    const auto set =
        is_raw ? call("module.execute", raw_setting(0, 150'000))
               : call("parameter.set", {{"axis", "x"}, {"parameter", 4}, {"value", 150'000}});
    ASSERT_TRUE(set) << set.error().message;
    EXPECT_FALSE(is_pending()) << is_raw;
    EXPECT_THAT(journal(), Not(testing::ContainsRegex(R"("motor":0,[^]]*"parameter":4,)")));
    wire.on_request = {};
    wire.is_cut = false;
    time.run_for(20s);
    auto expected = before;
    expected.front() = 150'000;
    EXPECT_EQ(settings(), expected) << is_raw;
    call("parameter.set", {{"axis", "x"}, {"parameter", 4}, {"value", before.front()}});
    for (const char* axis : {"x", "y"})
      call("axis.move_to", {{"axis", axis}, {"position_microsteps", 0}});
    time.run_for(100s);
  }
}

TEST_F(Unrestored, WhatAClientSetsDuringALineStays) {
  const auto before = settings();
  for (const bool is_raw : {false, true}) {
    const auto line = call("line.move", {{"axes", json::array{"x", "y"}},
                                         {"positions", json::array{is_raw ? 0 : 90, 30}}});
    ASSERT_TRUE(line) << line.error().message;
    time.run_for(500ms);
    ASSERT_NE(settings(), before);
    const auto set =
        is_raw ? call("module.execute", raw_setting(1, 150'000))
               : call("parameter.set", {{"axis", "y"}, {"parameter", 4}, {"value", 150'000}});
    ASSERT_TRUE(set) << set.error().message;
    time.run_for(100s);
    auto expected = before;
    expected[2] = 150'000;
    EXPECT_EQ(settings(), expected) << is_raw;
    call("parameter.set", {{"axis", "y"}, {"parameter", 4}, {"value", before[2]}});
    call("axis.move_to", {{"axis", "y"}, {"position", 0}});
    time.run_for(100s);
  }
}

TEST_F(Unrestored, AfterAnySilenceSettingsAreAsTheyWere) {
  const auto seed = tmcl::test::seed();
  tmcl::test::Random<int> random(seed);
  const auto before = settings();
  for (int round = 0; round < tmcl::test::rounds(6) && !HasFailure(); ++round) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed) + ", round " + std::to_string(round));
    for (const char* axis : {"x", "y"})
      call("axis.move_to", {{"axis", axis}, {"position_microsteps", 0}});
    time.run_for(100s);
    const bool on_line = random.one_in(2);
    const auto path = on_line ? begin("line.move", {{"axes", json::array{"x", "y"}},
                                                    {"positions", json::array{900, 300}}})
                              : begin_path();
    time.run_for(std::chrono::microseconds(random.between(0, 1'000'000)));
    wire.is_cut = true;
    time.run_for(std::chrono::milliseconds(random.between(0, 4'000)));
    wire.is_cut = false;
    time.run_for(20s);
    if (moves()) call("system.stop_all", {});
    time.run_for(20s);
    EXPECT_TRUE(path->has_value());
    EXPECT_EQ(settings(), before);
  }
}

TEST_F(Unrestored, AModuleThatHasStartedAgainKeepsItsOwnSettings) {
  const auto path = begin_path();
  wire.is_cut = true;
  end(path);
  module.power_cycle();
  const auto own = settings();
  wire.is_cut = false;
  time.run_for(10s);
  EXPECT_EQ(settings(), own);
}

TEST_F(Unrestored, WhoSetsItMeanwhileIsNotOverruled) {
  const auto path = begin_path();
  wire.is_cut = true;
  end(path);
  wire.is_cut = false;
  Result<boost::json::object> set = tl::unexpected(Error{});
  while (!set) {
    set = call("parameter.set", {{"axis", "y"}, {"parameter", "max_velocity"}, {"value", 1234}});
    time.run_for(1ms);
  }
  time.run_for(5s);
  EXPECT_EQ(get(1, ap::max_velocity), 1234);
}

// ---- a journal that cannot be written ----------------------------------------------------------

TEST_F(Unrestored, AJournalThatCannotBeWrittenIsAWarningAndAnEvent) {
  std::filesystem::remove_all(folder_);
  const auto warns = [](const Result<boost::json::object>& result) {
    return result && json::serialize(*result).find("if tmcld is killed") != std::string::npos;
  };
  EXPECT_TRUE(warns(call("axis.rotate", {{"axis", "x"}, {"velocity", 5}})));
  EXPECT_TRUE(call("axis.stop", {{"axis", "x"}}));
  time.run_for(3s);
  EXPECT_EQ(std::ranges::count(events, "journal_failed"), 1);
  EXPECT_TRUE(warns(
      call("line.move", {{"axes", json::array{"x", "y"}}, {"positions", json::array{3, 2}}})));
  time.run_for(20s);
  EXPECT_TRUE(warns(call("path.run", {{"axes", json::array{"x", "y"}},
                                      {"text", "G1 X20 Y10 F1200\n"},
                                      {"deviation", 900},
                                      {"to_start", true}})));
  EXPECT_TRUE(warns(call("lease.acquire", {{"axes", json::array{"x"}}})));
  std::filesystem::create_directory(folder_);
  time.run_for(2s);
  EXPECT_FALSE(warns(call("axis.rotate", {{"axis", "x"}, {"velocity", 5}})));
}

}  // namespace
}  // namespace tmcld::test
