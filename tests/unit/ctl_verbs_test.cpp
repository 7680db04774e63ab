// The verbs, on the axis of a simulated module.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <fmt/format.h>

#include "axis/arrival_wait.hpp"
#include "sim/module/module.hpp"
#include "support/temp_path.hpp"
#include "tmcl/seconds.hpp"
#include "unit/ctl_bench.hpp"
#include "verbs/verbs.hpp"

namespace tmclctl::test {
namespace {

using std::chrono::milliseconds;
using testing::Contains;
using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::MatchesRegex;
using testing::Not;
using testing::StartsWith;

class CtlVerbs : public testing::Test, public CtlBench {
 protected:
  using CtlBench::CtlBench;
  void on_terminal() { screen = {true, true, true, 80}; }
  void fail_with(tmcl::Outcome outcome) {
    fail_all(Error{"some_error", ErrorKind::failed, outcome, "it failed", "try this"});
  }
};

/// Its ramps are S-curves, of which some settings make the motor oscillate.
struct CtlVerbsOfA142 : CtlVerbs {
  CtlVerbsOfA142() : CtlVerbs(plain_axis, "TMCM-142") {}
};
struct CtlVerbsOfTwoAxes : CtlVerbs {
  CtlVerbsOfTwoAxes() : CtlVerbs(plain_axis + axis_section("y", 1, 1), "TMCM-3110") {}
};
struct CtlVerbsOnTwoBuses : CtlVerbs {
  CtlVerbsOnTwoBuses() : CtlVerbs(plain_axis + "[[bus]]\nname = \"can\"\nlink = \"can:none\"\n") {}
};

constexpr auto* moved_to_10000 =
    R"(axis.move_to {"axis":"x","position":"10000","deadline_ms":5000})";

TEST_F(CtlVerbs, GetPrintsOneBareValue) {
  set("max_velocity", 1500);
  EXPECT_EQ(run({"get", "x", "max_velocity"}), ExitCode::done);
  EXPECT_EQ(out, "1500\n");
  EXPECT_EQ(err, "");
  const auto document = json({"get", "x", "4"});
  EXPECT_EQ(document.at("value"), 1500);
  EXPECT_EQ(document.at("parameter"), "max_velocity");
  EXPECT_EQ(document.at("number"), 4);
  EXPECT_EQ(document.at("axis"), "x");
  place(-1500);
  run({"get", "x", "actual_position"});
  EXPECT_EQ(out, "-1500\n");
}

TEST_F(CtlVerbs, SetIsSilent) {
  EXPECT_EQ(run({"set", "x", "max_velocity", "1000"}), ExitCode::done);
  EXPECT_EQ(out, "");
  EXPECT_EQ(err, "");
  EXPECT_EQ(get("max_velocity"), 1000);
  EXPECT_EQ(json({"set", "x", "4", "7"}).at("value"), 7);
  EXPECT_EQ(get("max_velocity"), 7);
}

TEST_F(CtlVerbsOfA142, SetTellsWhatTheSettingsMakeOfMoves) {
  EXPECT_EQ(run({"set", "x", "max_bow", "18"}), ExitCode::done);
  EXPECT_EQ(out, "");
  EXPECT_EQ(err,
            "tmclctl: warning: max_bow 18 is 131072 and so exceeds acceleration 24624: the motor "
            "oscillates\n");
  EXPECT_THAT(std::string(json({"set", "x", "max_bow", "18"}).at("warnings").at(0).as_string()),
              HasSubstr("the motor oscillates"));
}

TEST_F(CtlVerbs, MoveSaysWhereItGoes) {
  EXPECT_EQ(run({"move", "x", "-1000"}), ExitCode::done);
  EXPECT_THAT(out, StartsWith("x moves to -1000 in "));
  EXPECT_EQ(get("target_position"), -1000);
}

TEST_F(CtlVerbs, MoveSaysHowLongItWillTake) {
  const auto began = host.now();
  const auto predicted_s =
      json({"move", "x", "10000", "--wait"}).at("predicted_s").to_number<double>();
  EXPECT_NEAR(tmcl::seconds(host.now() - began), predicted_s, 0.1);
  EXPECT_EQ(run({"move", "x", "0"}), ExitCode::done);
  EXPECT_EQ(out, fmt::format("x moves to 0 in {:.2f} s\n", predicted_s));
  screen.terminal = true;
  screen.width = 100;
  run({"move", "x", "15000", "--wait"});
  EXPECT_THAT(err, HasSubstr(" s left"));
}

TEST_F(CtlVerbs, MoveWaitComesBackWhenItStands) {
  EXPECT_EQ(run({"move", "x", "10000", "--wait"}), ExitCode::done);
  EXPECT_EQ(out, "x stands at 10000\n");
  EXPECT_EQ(err, "") << "no terminal, no progress";
  const auto document = json({"move", "x", "-500", "--by", "--wait"});
  EXPECT_EQ(document.at("target_microsteps"), 9500);
  EXPECT_EQ(document.at("position_microsteps"), 9500);
  EXPECT_EQ(document.at("reached"), true);
}

TEST_F(CtlVerbs, MoveWaitDrawsItsProgressOnATerminal) {
  on_terminal();
  EXPECT_EQ(run({"move", "x", "10000", "--wait"}), ExitCode::done);
  EXPECT_EQ(out, "x stands at 10000\n");
  EXPECT_THAT(err, HasSubstr("of 10000"));
  EXPECT_TRUE(err.ends_with("\r\x1b[K")) << "and takes it away again";
}

TEST_F(CtlVerbs, CtrlCEndsTheWaitingAndNotTheMove) {
  host.press_ctrl_c_after(milliseconds(200));
  EXPECT_EQ(run({"move", "x", "10000", "--wait"}), ExitCode::interrupted);
  EXPECT_EQ(out, "");
  EXPECT_THAT(err, HasSubstr("goes on moving to 10000"));
  EXPECT_THAT(err, HasSubstr("tmclctl --direct can:can0 stop x"));
  EXPECT_THAT(orders(), ElementsAre(moved_to_10000));
  pass(std::chrono::seconds(5));
  EXPECT_EQ(get("actual_position"), 10'000);
}

TEST_F(CtlVerbs, CtrlCBeforeTheMoveWentOutKeepsItFromGoing) {
  host.press_ctrl_c_after(milliseconds(0));
  EXPECT_EQ(run({"move", "x", "10000", "--wait"}), ExitCode::interrupted);
  EXPECT_EQ(run({"plot", "x", "--to", "10000"}), ExitCode::interrupted);
  EXPECT_THAT(err, HasSubstr("before anything moved"));
  EXPECT_THAT(orders(), IsEmpty());
}

TEST_F(CtlVerbs, CtrlCIsAnErrorDocumentWithJson) {
  host.press_ctrl_c_after(milliseconds(200));
  const auto document = json({"move", "x", "10000", "--wait"}, ExitCode::interrupted);
  EXPECT_EQ(document.at("error").at("name"), "interrupted");
  EXPECT_EQ(document.at("error").at("target_microsteps"), 10000);
}

TEST_F(CtlVerbs, WaitingHasALimit) {
  EXPECT_EQ(run({"move", "x", "100000", "--wait", "--timeout", "0.5"}), ExitCode::not_reached);
  EXPECT_THAT(err, HasSubstr("goes on moving"));
}

TEST_F(CtlVerbs, AStopFromElsewhereEndsTheWaiting) {
  other_after(milliseconds(300), "axis.stop", {{"axis", "x"}});
  EXPECT_EQ(run({"move", "x", "100000", "--wait"}), ExitCode::not_reached);
  EXPECT_THAT(err, ContainsRegex("x (stands still|is being stopped) short of its target: at "
                                 "[0-9]+, on its way to 100000; cause: client"));
}

TEST_F(CtlVerbs, WhyAnAxisWasStoppedIsSaidWithWhatToDo) {
  const auto expect_stop = [&](const std::string& cause, const char* advice) {
    EXPECT_EQ(run({"move", "x", "1000000", "--by", "--wait"}), ExitCode::not_reached) << cause;
    EXPECT_THAT(err, HasSubstr("; cause: " + cause));
    EXPECT_THAT(err, HasSubstr(advice)) << cause;
    EXPECT_THAT(err, Not(HasSubstr("Someone may have")));
    EXPECT_THAT(err, Not(HasSubstr("Another program moves")));
    run({"stop", "x"});
    pass(std::chrono::seconds(2));
  };
  other_after(milliseconds(300), "axis.stop", {{"axis", "x"}});
  expect_stop("client", "nother program or user sent a stop");
  after(milliseconds(300), [&] { execute(tmcl::Command::ROR, 0, 0, 0); });
  expect_stop("velocity_mode", "another host on the bus");
  tmcl::sim::StageSettings stage;
  stage.right_switch = 30'000;
  module().mount(0, stage);
  place(0);
  expect_stop("right_limit", "Its right switch");
}

TEST(CtlStopAdvice, IsThereForEveryCause) {
  const std::pair<const char*, const char*> causes[] = {
      {"stall", "raise the threshold"},
      {"deviation", "search the reference again"},
      {"left_limit", "Its left switch"},
      {"right_limit", "Its right switch"},
      {"deadman", "set a longer time"},
      {"supply", "check the supply"},
      {"client", "nother program or user sent a stop"},
      {"lease_lost", "renew its lease"},
      {"daemon", "the log of tmcld says why"},
      {"velocity_mode", "another host on the bus"},
      {"unknown", "does not say why"}};
  for (const auto& [cause, advice] : causes)
    EXPECT_THAT(advice_on_stop("x", cause), HasSubstr(advice)) << cause;
}

TEST_F(CtlVerbs, StopAllStopsEverythingUnlessAnAxisIsCalledSo) {
  for (const char* word : {"all", "ALL"}) {
    calls.clear();
    EXPECT_EQ(run({"stop", word}), ExitCode::done);
    EXPECT_THAT(orders(), Contains("system.stop_all {}"));
    EXPECT_THAT(out, ContainsRegex("x stopped after [0-9.]+ ms"));
  }
}

TEST(CtlStop, StopsTheAxisThatIsCalledAll) {
  CtlBench ctl(bench_of_ctl +
               "[[axis]]\nname = \"all\"\nbus = \"bench\"\naddress = 1\nmotor = 0\n");
  EXPECT_EQ(ctl.run({"stop", "all"}), ExitCode::done);
  EXPECT_THAT(ctl.orders(), ElementsAre(R"(axis.stop {"axis":"all"})"));
}

TEST_F(CtlVerbs, AStopOfNoAxisSaysThatEverythingMoves) {
  EXPECT_EQ(run({"stop", "y"}), ExitCode::usage);
  EXPECT_THAT(
      err,
      HasSubstr("Everything still moves: 'tmclctl --direct can:can0 stop --all' stops every axis"));
  EXPECT_EQ(run({"stop", "x", "y"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("Everything still moves"));
  EXPECT_EQ(run({"stop", "x", "--now"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("Everything still moves"));
  EXPECT_EQ(run({"move", "x", "1", "2", "3"}), ExitCode::usage);
  EXPECT_THAT(err, testing::Not(HasSubstr("Everything still moves")));
}

TEST_F(CtlVerbs, WaitComesBackWhenAnAxisStandsWhereItWasSent) {
  run({"move", "x", "10000"});
  EXPECT_EQ(run({"wait", "x"}), ExitCode::done) << err;
  EXPECT_EQ(out, "x stands at 10000\n");
  EXPECT_EQ(json({"wait", "x"}).at("axes").at(0).at("position_microsteps"), 10000);
  EXPECT_EQ(run({"wait"}), ExitCode::usage);
}

TEST_F(CtlVerbsOfA142, WaitTellsWhatTheSettingsMakeOfMoves) {
  set("max_bow", 13);
  set("max_acceleration", 6872);
  run({"move", "x", "10000"});
  EXPECT_EQ(run({"wait", "x", "--timeout", "60"}), ExitCode::done);
  EXPECT_EQ(out, "x stands at 10000\n");
  EXPECT_EQ(err,
            "tmclctl: warning: max_bow 13 is 4096, no less than half of acceleration 6872: "
            "the motor may oscillate\n");
  EXPECT_EQ(json({"wait", "x"}).at("axes").at(0).at("warnings").as_array().size(), 1U);
}

TEST_F(CtlVerbs, WaitTellsOfAnAxisThatDoesNotArrive) {
  run({"move", "x", "100000"});
  EXPECT_EQ(run({"wait", "x", "--timeout", "0.5"}), ExitCode::not_reached);
  EXPECT_THAT(err, HasSubstr("goes on moving"));
}

TEST_F(CtlVerbs, WaitTellsOfAnAxisThatIsStopped) {
  run({"move", "x", "100000"});
  other_after(milliseconds(300), "axis.stop", {{"axis", "x"}});
  EXPECT_EQ(run({"wait", "x"}), ExitCode::not_reached);
  EXPECT_THAT(err, HasSubstr("short of its target"));
}

TEST_F(CtlVerbs, RotateTakesNegativeVelocities) {
  EXPECT_EQ(run({"rotate", "x", "-500", "--unattended"}), ExitCode::done);
  EXPECT_EQ(get("target_velocity"), -500);
  EXPECT_THAT(out, HasSubstr("stop x"));
}

TEST_F(CtlVerbs, RotateStopsTheAxisWhenASignalComes) {
  host.press_ctrl_c_after(std::chrono::seconds(3));
  EXPECT_EQ(run({"rotate", "x", "500"}), ExitCode::done) << err;
  EXPECT_THAT(orders(), ElementsAre(StartsWith("axis.rotate "), R"(axis.stop {"axis":"x"})"));
  EXPECT_THAT(out, HasSubstr("Ctrl-C stops it"));
  EXPECT_THAT(out, HasSubstr("x stops"));
  EXPECT_EQ(get("target_velocity"), 0);
}

TEST_F(CtlVerbs, RotateSaysThatTheAxisMayStillTurn) {
  host.press_ctrl_c_after(std::chrono::seconds(3));
  fail("axis.stop",
       Error{"link_lost", ErrorKind::failed, tmcl::Outcome::not_sent, "the bus is not open"});
  EXPECT_EQ(run({"rotate", "x", "500"}), ExitCode::unknown);
  EXPECT_THAT(err, HasSubstr("x may still turn"));
}

TEST_F(CtlVerbs, RotateEndsWhenSomebodyElseStopsTheAxis) {
  other_after(milliseconds(300), "axis.stop", {{"axis", "x"}});
  EXPECT_EQ(run({"rotate", "x", "500"}), ExitCode::not_reached);
  EXPECT_THAT(orders(), ElementsAre(StartsWith("axis.rotate ")));
}

TEST_F(CtlVerbs, ATurnOfNothingIsOverAtOnce) {
  EXPECT_EQ(run({"rotate", "x", "0"}), ExitCode::done);
  EXPECT_THAT(orders(), ElementsAre(StartsWith("axis.rotate ")));
}

TEST(CtlStop, AllTellsWhatDidNotStop) {
  CtlBench ctl(plain_axis + axis_section("y", 2));
  ctl.add("TMCM-1110", 2);
  EXPECT_EQ(ctl.run({"state", "y"}), ExitCode::done);
  ctl.module(2).power_off();
  const auto document = ctl.json({"stop", "--all"}, ExitCode::unknown);
  EXPECT_EQ(document.at("stopped").as_array().size(), 1U);
  EXPECT_EQ(document.at("failed").at(0).at("error").at("name"), "module_silent");
  EXPECT_EQ(ctl.run({"stop", "--all"}), ExitCode::unknown);
  EXPECT_THAT(ctl.out, ContainsRegex("x stopped after [0-9.]+ ms"));
  EXPECT_THAT(ctl.err, HasSubstr("y NOT stopped"));
}

TEST_F(CtlVerbsOnTwoBuses, ScanListsAndFlagsDuplicates) {
  add("TMCM-1110", 7);
  amend("bus.scan", [](boost::json::object& found) {
    auto& second = found.at("modules").at(1).as_object();
    second["model"] = nullptr;
    second["model_number"] = 999;
  });
  add("TMCM-1110", 9);
  add("TMCM-1110", 9);
  EXPECT_EQ(run({"scan"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr("TMCM-1110"));
  EXPECT_THAT(out, HasSubstr("unknown (999)"));
  EXPECT_THAT(out, HasSubstr("DUPLICATE"));
  EXPECT_EQ(err, "");
  const auto modules = json({"scan"}).at("modules").as_array();
  EXPECT_EQ(modules.at(0).at("address"), 1);
  EXPECT_EQ(modules.at(1).at("address"), 7);
  EXPECT_TRUE(modules.at(1).at("model").is_null());
  EXPECT_EQ(modules.back().at("duplicate_suspected"), true);
  on_terminal();
  run({"scan"});
  EXPECT_THAT(err, ContainsRegex("scanning bench: [0-9]+ of 255 addresses"));
}

TEST_F(CtlVerbsOnTwoBuses, ScanWarnsOfAModuleThatTakesRepliesForCommands) {
  add("TMCM-1110", 2);
  EXPECT_EQ(run({"scan"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr("DANGER: its address is the identifier of all replies"));
  const auto modules = json({"scan"}).at("modules").as_array();
  ASSERT_EQ(modules.size(), 4U);
  EXPECT_EQ(modules.at(2).at("address_is_reply_id"), false);
  EXPECT_EQ(modules.at(3).at("address_is_reply_id"), true) << "on CAN";
}

TEST_F(CtlVerbs, AnEmptyScanSaysWhatToCheck) {
  module().power_off();
  EXPECT_EQ(run({"scan"}), ExitCode::not_sent);
  EXPECT_EQ(out, "");
  EXPECT_THAT(err, HasSubstr("baud"));
  EXPECT_THAT(err, Not(HasSubstr("bytes")));
}

TEST_F(CtlVerbsOnTwoBuses, AnEmptyScanSaysWhatWasHeardInstead) {
  module().power_off();
  let_lines_echo();
  EXPECT_EQ(run({"scan"}), ExitCode::not_sent);
  EXPECT_EQ(
      err,
      "No module answered on bench: only what was sent came back: the line echoes.\n"
      "  Try: check the supply and the cable of the module; where no module is meant to be, RX "
      "and TX are joined, or the adapter hears itself, which does no harm.\n"
      "No module answered on can.\n"
      "  Check the supply, the cabling, the termination and the bit rate.\n");
  const auto document = json({"scan"}, ExitCode::not_sent);
  EXPECT_THAT(document.at("modules").as_array(), IsEmpty());
  EXPECT_EQ(document.at("silent").at(0).at("heard").at("kind"), "echo");
  EXPECT_TRUE(document.at("silent").at(1).at("heard").is_null());
}

TEST_F(CtlVerbs, OnATerminalModulesAreShownAsTheyAreFound) {
  add("TMCM-3110", 7);
  on_terminal();
  EXPECT_EQ(run({"scan"}), ExitCode::done);
  EXPECT_EQ(out,
            "BUS       ADDRESS  MODEL       FIRMWARE  AXES\n"
            "bench     1        TMCM-1110   1.13      1\n"
            "bench     7        TMCM-3110   1.14      3\n");
  EXPECT_EQ(json({"scan"}).at("modules").as_array().size(), 2U);
}

TEST_F(CtlVerbsOnTwoBuses, AScanThatMissesABusFails) {
  open();
  cut_wires("gone", "can");
  EXPECT_EQ(run({"scan"}), ExitCode::not_sent);
  EXPECT_THAT(err, HasSubstr("can was not scanned"));
  EXPECT_EQ(json({"scan"}, ExitCode::not_sent).at("failed").at(0).at("bus"), "can");
}

TEST_F(CtlVerbs, EveryErrorIsOneDocumentWithJson) {
  fail_with(tmcl::Outcome::refused);
  for (const auto& words : {std::vector<std::string>{"get", "x", "4"},
                            {"set", "x", "4", "1"},
                            {"move", "x", "1"},
                            {"rotate", "x", "1"},
                            {"stop", "x"},
                            {"state", "x"},
                            {"watch", "x"},
                            {"plot", "x"},
                            {"raw", "1", "GAP", "4", "0", "0"},
                            {"scan"},
                            {"axes"},
                            {"modules"}}) {
    const auto document = json(words, ExitCode::refused);
    EXPECT_EQ(document.at("error").at("name"), "some_error") << words[0];
    EXPECT_EQ(err, "") << words[0];
  }
  EXPECT_EQ(json({"mvoe"}, ExitCode::usage).at("error").at("name"), "unknown_verb");
}

TEST_F(CtlVerbs, OnlyWhatActsMayHaveBeenExecuted) {
  fail_with(tmcl::Outcome::unknown);
  EXPECT_EQ(run({"move", "x", "1"}), ExitCode::unknown);
  EXPECT_THAT(err, HasSubstr("may or may not have been executed"));
  for (const auto& reading : {std::vector<std::string>{"get", "x", "4"},
                              {"info", "1"},
                              {"state", "x"},
                              {"program", "status", "1"},
                              {"coordinate", "get", "x", "1"},
                              {"input", "1", "0"},
                              {"scan"}}) {
    EXPECT_EQ(run(reading), ExitCode::not_sent) << reading[0];
    EXPECT_THAT(err, Not(HasSubstr("executed")));
  }
  EXPECT_EQ(run({"output", "1", "0", "1"}), ExitCode::unknown);
  EXPECT_EQ(run({"reset", "1"}), ExitCode::unknown);
}

TEST_F(CtlVerbsOfTwoAxes, SayWhyTheyCannotBeReached) {
  open();
  cut_wires("cannot open serial:/dev/ttyACM9@9600: No such file or directory");
  pass(std::chrono::seconds(1));
  const std::string why = "cannot open serial:/dev/ttyACM9@9600: No such file or directory";
  EXPECT_EQ(run({"axes"}), ExitCode::done);
  EXPECT_EQ(err, "bus bench is not open: " + why + "\n") << "once";
  EXPECT_EQ(json({"axes"}).at("axes").at(1).at("why").as_string(), why.c_str());
  cut_wires("");
  pass(std::chrono::seconds(30));
  EXPECT_TRUE(json({"axes"}).at("axes").at(0).at("why").is_null());
}

TEST_F(CtlVerbs, ParamsSayWhatCanBeStored) {
  EXPECT_EQ(run({"params", "x"}), ExitCode::done);
  EXPECT_THAT(out, ContainsRegex("max_velocity +RWE +0..2047"));
  EXPECT_THAT(out, ContainsRegex("target_position +RW +-8388608..8388607"));
  EXPECT_THAT(out, ContainsRegex("actual_velocity +R +read only"));
  const auto rows = json({"params", "x"}).at("parameters").as_array();
  const auto row =
      std::ranges::find(rows, 4, [](const auto& one) { return one.at("number").as_int64(); });
  ASSERT_NE(row, rows.end());
  EXPECT_EQ(row->at("stored"), true);
  EXPECT_EQ(row->at("default"), 1000);
  EXPECT_EQ(row->at("aliases").at(0), "v_max");
}

TEST_F(CtlVerbs, WhatCannotBeStoredIsNotCalledUnknown) {
  for (const auto* name : {"target_position", "x_target", "xtarget", "Target-Position", "0"}) {
    EXPECT_EQ(run({"store", "x", name}), ExitCode::refused) << name;
    EXPECT_THAT(err, HasSubstr("target_position cannot be kept in the EEPROM")) << name;
    EXPECT_THAT(err, HasSubstr("params x' shows RWE"));
  }
  fail_with(tmcl::Outcome::refused);
  run({"store", "x", "max_velocity"});
  EXPECT_THAT(err, HasSubstr("it failed"));
}

TEST_F(CtlVerbs, StateShowsAll) {
  EXPECT_EQ(run({"state", "x"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr("position  0 microsteps"));
  const auto document = json({"state", "x"});
  for (const auto* key : {"axis", "position_microsteps", "velocity_internal", "velocity_pps",
                          "target_microsteps", "position_reached", "moving", "age_ms", "latched",
                          "referenced", "stop_cause", "lease", "unattended"}) {
    EXPECT_TRUE(document.contains(key)) << key;
  }
}

TEST_F(CtlVerbs, WatchPrintsChangesOnly) {
  EXPECT_EQ(run({"watch", "x", "--for", "1"}), ExitCode::done);
  EXPECT_EQ(std::ranges::count(out, '\n'), 1);
  run({"move", "x", "100000"});
  EXPECT_EQ(run({"watch", "x", "--interval", "10", "--for", "1", "--json"}), ExitCode::done);
  EXPECT_GE(std::ranges::count(out, '\n'), 10);
  std::istringstream lines(out);
  for (std::string line; std::getline(lines, line);)
    EXPECT_TRUE(boost::json::parse(line).is_object());
}

TEST_F(CtlVerbs, CtrlCIsHowAWatchEnds) {
  host.press_ctrl_c_after(milliseconds(500));
  EXPECT_EQ(run({"watch", "x"}), ExitCode::done);
  EXPECT_EQ(err, "");
}

TEST_F(CtlVerbs, RawShowsTheBytes) {
  set("max_velocity", 1000);
  EXPECT_EQ(run({"raw", "1", "gap", "max_velocity", "0", "0"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr("-> 01 06 04 00 00 00 00 00 0B"));
  EXPECT_THAT(out, HasSubstr("<- 02 01 64 06 00 00 03 E8 58"));
  const auto document = json({"raw", "1", "6", "4", "0", "0"});
  EXPECT_EQ(document.at("request").at("bytes"), "01 06 04 00 00 00 00 00 0B");
  EXPECT_EQ(document.at("reply").at("value"), 1000);
  EXPECT_EQ(document.at("reply").at("status_name"), "ok");
  EXPECT_EQ(run({"raw", "1", "GAPP", "4", "0", "0"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("'GAP'"));
  EXPECT_EQ(run({"raw", "1", "MVP", "ABSS", "0", "0"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("'ABS'"));
}

TEST_F(CtlVerbs, RawWarnsOfWhatTurns) {
  EXPECT_EQ(run({"raw", "1", "ROR", "0", "0", "100"}), ExitCode::done);
  EXPECT_THAT(err, StartsWith("tmclctl: warning: axis 'x' turns for this connection"));
  EXPECT_THAT(
      std::string(json({"raw", "1", "ROR", "0", "0", "100"}).at("warnings").at(0).as_string()),
      HasSubstr("turns for this connection"));
  EXPECT_TRUE(json({"raw", "1", "MST", "0", "0", "0"}).at("warnings").as_array().empty());
}

TEST_F(CtlVerbs, PlotRecordsAMoveToItsEnd) {
  EXPECT_EQ(run({"plot", "x", "--to", "50000"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr("x went from 0 to 50000 microsteps in 0.9"));
  EXPECT_THAT(out, Not(HasSubstr("\x1b")));
  const auto document = json({"plot", "x", "--by", "-50000"});
  const auto& positions = document.at("position_microsteps").as_array();
  EXPECT_EQ(positions.front(), 50'000);
  EXPECT_EQ(positions.back(), 0);
  EXPECT_GE(positions.size(), 80U);
  EXPECT_EQ(positions.size(), document.at("time_s").as_array().size());
  EXPECT_EQ(positions.size(), document.at("velocity_internal").as_array().size());
}

TEST_F(CtlVerbs, PlotWithoutAMoveEndsWhenTheAxisStands) {
  run({"move", "x", "5000"});
  EXPECT_EQ(run({"plot", "x", "--csv", "-"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr("\ntime_s,position_microsteps,velocity_internal,utc\n0.000000,"));
  EXPECT_THAT(out, HasSubstr(",5000,0,1970-01-01T01:00:0"));
  EXPECT_EQ(run({"plot", "x", "--for", "0.3", "--csv", "-"}), ExitCode::done);
  const auto rows = out.substr(out.find("\ntime_s") + 1);
  EXPECT_NEAR(static_cast<double>(std::ranges::count(rows, '\n')), 32, 3);
}

TEST(CtlPlotCsv, SaysAboveItWhatItIsOf) {
  CtlBench ctl(axis_in_mm);
  EXPECT_EQ(ctl.run({"plot", "x", "--for", "0.1", "--also", "load_value", "--csv", "-"}),
            ExitCode::done);
  EXPECT_TRUE(ctl.out.starts_with("# tmclctl "));
  EXPECT_THAT(ctl.out, HasSubstr("\n# begins 1970-01-01T01:00:00."));
  EXPECT_THAT(ctl.out,
              HasSubstr("\n# x: TMCM-1110 1.13, module 1 of bench, motor 0; unit mm of 10240 "
                        "microsteps, velocity_internal of "));
  EXPECT_THAT(ctl.out, HasSubstr("\n# load_value: stallGuard2: "));
}

TEST_F(CtlVerbs, FurtherParametersHaveTheirAgeInTheCsv) {
  const auto load = std::to_string(get("load_value"));
  EXPECT_EQ(run({"plot", "x", "--for", "0.1", "--also", "load_value", "--csv", "-"}),
            ExitCode::done);
  EXPECT_THAT(out, HasSubstr("\ntime_s,position_microsteps,velocity_internal,load_value,load_value_"
                             "age_ms,utc\n0.000000,0,0,,,1970"));
  EXPECT_THAT(out, ContainsRegex(",0,0," + load + ",[0-9]+,1970"));
  const auto document = json({"plot", "x", "--by", "1000", "--also", "load_value"});
  const auto& loads = document.at("also").at("load_value").as_array();
  EXPECT_TRUE(loads.front().is_null()) << "read with the first look";
  EXPECT_FALSE(loads.back().is_null()) << "kept for the last";
}

TEST_F(CtlVerbsOfTwoAxes, AreRecordedAndTheFirstIsMoved) {
  EXPECT_EQ(run({"plot", "x", "y", "--to", "1000", "--csv", "-"}), ExitCode::done);
  EXPECT_EQ(get("target_position", 0), 1000);
  EXPECT_EQ(get("target_position", 1), 0);
  EXPECT_THAT(out, HasSubstr("\ntime_s,axis,position_microsteps,velocity_internal,"
                             "position_in_unit,velocity_in_unit,utc\n"));
  EXPECT_THAT(out, HasSubstr(",x,1000,0,,,1970"));
  EXPECT_THAT(out, HasSubstr(",y,0,0,,,1970"));
  EXPECT_EQ(run({"plot", "x", "y", "--for", "0.2"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr("x position [microsteps]"));
  EXPECT_THAT(out, HasSubstr("y velocity [internal]"));
  const auto document = json({"plot", "x", "y", "--for", "0.2"});
  EXPECT_EQ(document.at("axis"), "x");
  EXPECT_EQ(document.at("beside").at(0).at("axis"), "y");
}

TEST_F(CtlVerbs, TheRecordingOfAMoveThatWasRefusedIsNotWritten) {
  EXPECT_EQ(run({"plot", "x", "--to", "nowhere", "--csv", "-"}), ExitCode::usage);
  EXPECT_EQ(out, "");
}

TEST_F(CtlVerbs, TheCsvOfSeveralAxesHasNoDerivatives) {
  EXPECT_EQ(run({"plot", "x", "y", "--show", "v,a", "--csv", "-"}), ExitCode::usage);
  EXPECT_EQ(run({"plot"}), ExitCode::usage);
}

TEST_F(CtlVerbs, CtrlCDrawsWhatThereIs) {
  host.press_ctrl_c_after(milliseconds(300));
  EXPECT_EQ(run({"plot", "x", "--to", "100000"}), ExitCode::interrupted);
  EXPECT_THAT(out, HasSubstr("velocity [internal]"));
  EXPECT_THAT(err, HasSubstr("goes on moving"));
}

TEST_F(CtlVerbs, NothingMovesIfTheFileCannotBeWritten) {
  EXPECT_EQ(run({"plot", "x", "--to", "10000", "--svg", "/nowhere/at/all.svg"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("/nowhere/at/all.svg"));
  EXPECT_THAT(orders(), IsEmpty());
}

TEST_F(CtlVerbs, WhatOnlyTmcldDoesIsRefusedWithoutIt) {
  for (const auto& verb : verb_table()) {
    if (verb.doors != Doors::tmcld_only) continue;
    std::istringstream name{std::string(verb.name)};
    std::vector<std::string> words{"--direct", "can:can0"};
    for (std::string word; name >> word;) words.push_back(word);
    if (verb.name.starts_with("lease ") && verb.name != "lease list") words.emplace_back("x");
    if (verb.name == "token add") words.insert(words.end(), {"--role", "operate"});
    if (verb.name == "token revoke") words.emplace_back("lab");
    if (verb.name == "path feed") words.insert(words.end(), {"x", "50%"});
    EXPECT_EQ(run(words), ExitCode::usage) << verb.name;
    EXPECT_THAT(err, HasSubstr("needs a running tmcld: " + std::string(verb.reason)));
  }
  EXPECT_EQ(run({"path", "pause"}), ExitCode::done);
  EXPECT_THAT(calls, ElementsAre("path.pause {}"));
}

TEST_F(CtlVerbs, NoDaemonNamesTheSocketAndWhatToTry) {
  std::ostringstream out_stream;
  std::ostringstream err_stream;
  Output output{out_stream, err_stream, {}, {}};
  EXPECT_EQ(tmclctl::run({"--socket", "/nowhere/tmcld.sock", "axes"}, output, host),
            ExitCode::not_sent);
  EXPECT_EQ(out_stream.str(), "");
  EXPECT_THAT(err_stream.str(), HasSubstr("/nowhere/tmcld.sock"));
  EXPECT_THAT(err_stream.str(), HasSubstr("--direct"));
}

TEST_F(CtlVerbs, DeadmanSetSaysThatItProvesNothing) {
  EXPECT_EQ(run({"deadman", "set", "x", "1000"}), ExitCode::done);
  EXPECT_THAT(calls, ElementsAre(R"(axis.set_deadman {"axis":"x","ms":1000})"));
  EXPECT_THAT(out, HasSubstr("'tmclctl deadman test x' sees whether it does"));
  EXPECT_EQ(run({"deadman", "set", "x", "99"}), ExitCode::usage);
}

TEST_F(CtlVerbs, DeadmanOffSetsItToNothing) {
  EXPECT_EQ(run({"deadman", "off", "x"}), ExitCode::done);
  EXPECT_THAT(calls, ElementsAre(R"(axis.set_deadman {"axis":"x","ms":0})"));
  EXPECT_EQ(out, "x: the deadman of its module is off\n");
}

TEST_F(CtlVerbs, DeadmanTestTellsWhatWasFound) {
  run({"deadman", "set", "x", "1000"});
  EXPECT_EQ(run({"deadman", "test", "x"}), ExitCode::done);
  EXPECT_THAT(out, MatchesRegex("x: its module stops it 1[0-9][0-9][0-9] ms after the last command "
                                "\\(set to 1000 ms\\); it has gone [0-9]+ microsteps\n"));
  run({"deadman", "off", "x"});
  EXPECT_EQ(run({"deadman", "test", "x"}), ExitCode::not_reached);
  EXPECT_THAT(out, MatchesRegex("x: no deadman: .*; it has gone 0 microsteps\n"));
}

TEST_F(CtlVerbs, VerifyMovesNothingThatNobodyAllowed) {
  EXPECT_EQ(run({"verify", "x", "--travel", "-2mm..2mm"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("--yes says that it may"));
  EXPECT_EQ(run({"verify", "x", "--travel", "2mm", "--yes"}), ExitCode::usage);
  EXPECT_THAT(calls, IsEmpty());
}

TEST(CtlVerify, TellsWhatTheTwinHasAndWhatTheModuleDoes) {
  CtlBench ctl(axis_in_mm);
  EXPECT_EQ(ctl.run({"verify", "x", "--travel", "-2mm..2mm", "--yes"}), ExitCode::done);
  EXPECT_THAT(ctl.calls, ElementsAre(R"(axis.verify {"axis":"x","from":"-2mm","to":"2mm"})"));
  EXPECT_THAT(ctl.out, ContainsRegex("TMCM-1110, firmware 1.13, answers within [0-9.]+ ms\n"));
  EXPECT_THAT(ctl.out, HasSubstr("not measured"));
  // Which stage of its chip is first does not show on a line of 115200 baud.
  EXPECT_THAT(ctl.out, ContainsRegex("\norder +ramp_first +ramp_first or pulse_first "));
  EXPECT_THAT(
      ctl.out,
      testing::EndsWith("\n9 of 12 traits measured; the module is as its twin; 1 not decided\n"));
  EXPECT_EQ(ctl.run({"verify", "x", "--travel", "-2mm..2mm", "--yes", "--report", "-"}),
            ExitCode::done);
  EXPECT_THAT(ctl.out, HasSubstr("[module]\n"));
}

TEST(CtlVerify, CountsWhatTheTwinHasOtherwise) {
  const auto file = tmcl::test::temp_path("of_another_module.toml");
  std::ofstream(file) << "[module]\nmodel = \"TMCM-1110\"\nlast_step = \"r1\"\n";
  CtlBench ctl(axis_in_mm + "[[module]]\nbus = \"bench\"\naddress = 1\nas = \"" + file + "\"\n");
  EXPECT_EQ(ctl.run({"verify", "x", "--travel", "-2mm..2mm", "--yes"}), ExitCode::done) << ctl.err;
  EXPECT_THAT(ctl.out, ContainsRegex("\nlast_step +r1 +r3 "));
  EXPECT_THAT(ctl.out,
              testing::EndsWith("\n9 of 12 traits measured; 1 not as foreseen; 1 not decided\n"));
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace tmclctl::test
