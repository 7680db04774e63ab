// The verbs, on an axis that moves in virtual time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "ctl_fixture.hpp"

namespace tmclctl::test {
namespace {

using std::chrono::milliseconds;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class CtlVerbs : public testing::Test, public Ctl {
 protected:
  void on_terminal() { screen = {true, true, true, 80}; }
  void fail_with(ExitCode exit, tmcl::Outcome outcome) {
    target.failure = error_of(exit, "some_error", "it failed", "try this", outcome);
  }
};

TEST_F(CtlVerbs, GetPrintsOneBareValue) {
  EXPECT_EQ(run({"get", "x", "max_velocity"}), ExitCode::done);
  EXPECT_EQ(out, "-1500\n");
  EXPECT_EQ(err, "");
  const auto document = json({"get", "x", "4"});
  EXPECT_EQ(document.at("value"), -1500);
  EXPECT_EQ(document.at("parameter"), "max_velocity");
  EXPECT_EQ(document.at("number"), 4);
  EXPECT_EQ(document.at("axis"), "x");
}

TEST_F(CtlVerbs, SetIsSilent) {
  EXPECT_EQ(run({"set", "x", "max_velocity", "1000"}), ExitCode::done);
  EXPECT_EQ(out, "");
  EXPECT_EQ(json({"set", "x", "4", "7"}).at("value"), 7);
}

TEST_F(CtlVerbs, SetTellsWhatTheSettingsMakeOfMoves) {
  target.warnings = {"the motor oscillates"};
  EXPECT_EQ(run({"set", "x", "max_velocity", "1000"}), ExitCode::done);
  EXPECT_EQ(out, "");
  EXPECT_EQ(err, "tmclctl: warning: the motor oscillates\n");
  EXPECT_EQ(json({"set", "x", "4", "7"}).at("warnings").at(0), "the motor oscillates");
}

TEST_F(CtlVerbs, MoveSaysWhereItGoes) {
  EXPECT_EQ(run({"move", "x", "-1000"}), ExitCode::done);
  EXPECT_EQ(out, "x moves to -1000\n");
  EXPECT_THAT(target.calls, ElementsAre("move_to x -1000"));
}

TEST_F(CtlVerbs, MoveSaysHowLongItWillTake) {
  target.predicted_s = 1.204;
  EXPECT_EQ(run({"move", "x", "10000"}), ExitCode::done);
  EXPECT_EQ(out, "x moves to 10000 in 1.20 s\n");
  EXPECT_EQ(json({"move", "x", "7"}).at("predicted_s"), 1.204);
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
  EXPECT_THAT(target.calls, ElementsAre("move_to x 10000"));
}

TEST_F(CtlVerbs, CtrlCBeforeTheMoveWentOutKeepsItFromGoing) {
  host.press_ctrl_c_after(milliseconds(0));
  EXPECT_EQ(run({"move", "x", "10000", "--wait"}), ExitCode::interrupted);
  EXPECT_EQ(run({"plot", "x", "--to", "10000"}), ExitCode::interrupted);
  EXPECT_THAT(err, HasSubstr("before anything moved"));
  EXPECT_THAT(target.calls, IsEmpty());
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
  target.stopped_by_other_after = milliseconds(300);
  EXPECT_EQ(run({"move", "x", "10000", "--wait"}), ExitCode::not_reached);
  EXPECT_THAT(err, HasSubstr("x stands still short of its target: at 3000, on its way to 10000"));
}

TEST_F(CtlVerbs, WhyAnAxisWasStoppedIsSaidWithWhatToDo) {
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
  for (const auto& [cause, advice] : causes) {
    target.stop_cause = cause;
    target.stopped_by_other_after = milliseconds(300);
    EXPECT_EQ(run({"move", "x", "100000", "--wait"}), ExitCode::not_reached);
    EXPECT_THAT(err, HasSubstr(std::string("; cause: ") + cause));
    EXPECT_THAT(err, HasSubstr(advice)) << cause;
    EXPECT_THAT(err, testing::Not(HasSubstr("Someone may have")));
    EXPECT_THAT(err, testing::Not(HasSubstr("Another program moves")));
  }
}

TEST_F(CtlVerbs, StopAllStopsEverythingUnlessAnAxisIsCalledSo) {
  target.stopped = {{"x", 1.5, {}}};
  EXPECT_EQ(run({"stop", "all"}), ExitCode::done);
  EXPECT_THAT(target.calls, ElementsAre("stop all"));
  target.calls.clear();
  target.stop_failure = usage_error("unknown_axis", "there is no axis 'all'", "See");
  for (const char* word : {"all", "ALL"}) {
    target.calls.clear();
    EXPECT_EQ(run({"stop", word}), ExitCode::done);
    EXPECT_THAT(target.calls, ElementsAre("stop_all"));
    EXPECT_THAT(out, HasSubstr("x stopped after 1.5 ms"));
  }
}

TEST_F(CtlVerbs, AStopOfNoAxisSaysThatEverythingMoves) {
  target.stop_failure = usage_error("unknown_axis", "there is no axis 'y'", "See 'tmclctl axes'");
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

TEST_F(CtlVerbs, WaitTellsWhatTheSettingsMakeOfMoves) {
  target.warnings = {"the motor may oscillate"};
  run({"move", "x", "10000"});
  EXPECT_EQ(run({"wait", "x"}), ExitCode::done);
  EXPECT_EQ(out, "x stands at 10000\n");
  EXPECT_EQ(err, "tmclctl: warning: the motor may oscillate\n");
  EXPECT_EQ(json({"wait", "x"}).at("axes").at(0).at("warnings").as_array().size(), 1U);
}

TEST_F(CtlVerbs, WaitTellsOfAnAxisThatDoesNotArrive) {
  run({"move", "x", "100000"});
  EXPECT_EQ(run({"wait", "x", "--timeout", "0.5"}), ExitCode::not_reached);
  EXPECT_THAT(err, HasSubstr("goes on moving"));
}

TEST_F(CtlVerbs, WaitTellsOfAnAxisThatIsStopped) {
  target.stopped_by_other_after = milliseconds(300);
  run({"move", "x", "100000"});
  EXPECT_EQ(run({"wait", "x"}), ExitCode::not_reached);
  EXPECT_THAT(err, HasSubstr("stands still"));
}

TEST_F(CtlVerbs, RotateTakesNegativeVelocities) {
  EXPECT_EQ(run({"rotate", "x", "-500", "--unattended"}), ExitCode::done);
  EXPECT_THAT(target.calls, ElementsAre("rotate x -500 unattended"));
  EXPECT_THAT(out, HasSubstr("stop x"));
}

TEST_F(CtlVerbs, RotateStopsTheAxisWhenASignalComes) {
  host.press_ctrl_c_after(std::chrono::seconds(3));
  EXPECT_EQ(run({"rotate", "x", "500"}), ExitCode::done);
  EXPECT_THAT(target.calls, ElementsAre("rotate x 500", "stop x"));
  EXPECT_THAT(out, HasSubstr("Ctrl-C stops it"));
  EXPECT_THAT(out, HasSubstr("x stops"));
}

TEST_F(CtlVerbs, RotateSaysThatTheAxisMayStillTurn) {
  host.press_ctrl_c_after(std::chrono::seconds(3));
  target.stop_failure = error_of(ExitCode::not_sent, "link_lost", "the bus is not open");
  EXPECT_EQ(run({"rotate", "x", "500"}), ExitCode::unknown);
  EXPECT_THAT(err, HasSubstr("x may still turn"));
}

TEST_F(CtlVerbs, RotateEndsWhenSomebodyElseStopsTheAxis) {
  target.stopped_by_other_after = milliseconds(300);
  EXPECT_EQ(run({"rotate", "x", "500"}), ExitCode::not_reached);
  EXPECT_THAT(target.calls, ElementsAre("rotate x 500"));
}

TEST_F(CtlVerbs, ATurnOfNothingIsOverAtOnce) {
  EXPECT_EQ(run({"rotate", "x", "0"}), ExitCode::done);
  EXPECT_THAT(target.calls, ElementsAre("rotate x 0"));
}

TEST_F(CtlVerbs, StopAllTellsWhatDidNotStop) {
  const auto silent = error_of(ExitCode::unknown, "reply_timeout", "no answer");
  target.stopped = {{"x", 1.5, {}}, {"y", {}, silent}};
  EXPECT_EQ(run({"stop", "--all"}), ExitCode::unknown);
  EXPECT_THAT(out, HasSubstr("x stopped after 1.5 ms"));
  EXPECT_THAT(err, HasSubstr("y NOT stopped"));
  const auto document = json({"stop", "--all"}, ExitCode::unknown);
  EXPECT_EQ(document.at("stopped").as_array().size(), 1U);
  EXPECT_EQ(document.at("failed").at(0).at("error").at("name"), "reply_timeout");
}

TEST_F(CtlVerbs, ScanListsAndFlagsDuplicates) {
  target.found.modules = {{"bench", 1, "TMCM-1110", 1110, "1.01", 1, false, ""},
                          {"bench", 7, "", 999, "1.00", 0, true, ""}};
  EXPECT_EQ(run({"scan"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr("TMCM-1110"));
  EXPECT_THAT(out, HasSubstr("unknown (999)"));
  EXPECT_THAT(out, HasSubstr("DUPLICATE"));
  EXPECT_EQ(err, "");
  const auto modules = json({"scan"}).at("modules").as_array();
  EXPECT_EQ(modules.at(0).at("address"), 1);
  EXPECT_EQ(modules.at(1).at("duplicate_suspected"), true);
  EXPECT_TRUE(modules.at(1).at("model").is_null());
  on_terminal();
  run({"scan"});
  EXPECT_THAT(err, HasSubstr("16 of 255"));
}

TEST_F(CtlVerbs, ScanWarnsOfAModuleThatTakesRepliesForCommands) {
  target.found.modules = {{"bench", 1, "TMCM-1110", 1110, "1.01", 1, false, ""},
                          {"bench", 2, "TMCM-1110", 1110, "1.01", 1, false, "", false, true}};
  EXPECT_EQ(run({"scan"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr("DANGER: its address is the identifier of all replies"));
  const auto modules = json({"scan"}).at("modules").as_array();
  EXPECT_EQ(modules.at(0).at("address_is_reply_id"), false);
  EXPECT_EQ(modules.at(1).at("address_is_reply_id"), true);
}

TEST_F(CtlVerbs, AnEmptyScanSaysWhatToCheck) {
  EXPECT_EQ(run({"scan"}), ExitCode::not_sent);
  EXPECT_EQ(out, "");
  EXPECT_THAT(err, HasSubstr("baud"));
  EXPECT_THAT(err, testing::Not(HasSubstr("bytes")));
  target.found.silent = {{"bench", api::bus::Heard{"echo", 36, {}, "the line echoes", "cut it"}},
                         {"can", {}}};
  EXPECT_EQ(run({"scan"}), ExitCode::not_sent);
  EXPECT_EQ(err,
            "No module answered on bench: the line echoes.\n"
            "  Try: cut it.\n"
            "No module answered on can.\n"
            "  Check the supply, the cabling, the termination and the bit rate.\n");
  const auto document = json({"scan"}, ExitCode::not_sent);
  EXPECT_THAT(document.at("modules").as_array(), IsEmpty());
  EXPECT_EQ(document.at("silent").at(0).at("heard").at("kind"), "echo");
  EXPECT_TRUE(document.at("silent").at(1).at("heard").is_null());
}

TEST_F(CtlVerbs, OnATerminalModulesAreShownAsTheyAreFound) {
  target.found.modules = {{"bench", 1, "TMCM-1110", 1110, "1.01", 1, false, ""},
                          {"bench", 7, "TMCM-3110", 3110, "1.14", 3, false, ""}};
  on_terminal();
  EXPECT_EQ(run({"scan"}), ExitCode::done);
  EXPECT_EQ(out,
            "BUS       ADDRESS  MODEL       FIRMWARE  AXES\n"
            "bench     1        TMCM-1110   1.01      1\n"
            "bench     7        TMCM-3110   1.14      3\n");
  EXPECT_EQ(json({"scan"}).at("modules").as_array().size(), 2U);
}

TEST_F(CtlVerbs, AScanThatMissesABusFails) {
  target.found.failed = {{"shelf", error_of(ExitCode::not_sent, "link_lost", "gone")}};
  EXPECT_EQ(run({"scan"}), ExitCode::not_sent);
  EXPECT_THAT(err, HasSubstr("shelf"));
  EXPECT_EQ(json({"scan"}, ExitCode::not_sent).at("failed").at(0).at("bus"), "shelf");
}

TEST_F(CtlVerbs, EveryErrorIsOneDocumentWithJson) {
  fail_with(ExitCode::refused, tmcl::Outcome::refused);
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
  fail_with(ExitCode::unknown, tmcl::Outcome::unknown);
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

TEST_F(CtlVerbs, AxesSayWhyTheyCannotBeReached) {
  target.closed_because = "cannot open serial:/dev/ttyACM9@9600: No such file or directory";
  EXPECT_EQ(run({"axes"}), ExitCode::done);
  EXPECT_EQ(err, "bus bench is not open: " + target.closed_because + "\n") << "once";
  EXPECT_EQ(json({"axes"}).at("axes").at(1).at("why").as_string(), target.closed_because.c_str());
  target.closed_because = "";
  EXPECT_TRUE(json({"axes"}).at("axes").at(0).at("why").is_null());
}

TEST_F(CtlVerbs, ParamsSayWhatCanBeStored) {
  EXPECT_EQ(run({"params", "x"}), ExitCode::done);
  EXPECT_THAT(out, testing::ContainsRegex("max_velocity +RWE +0..2047"));
  EXPECT_THAT(out, testing::ContainsRegex("target_position +RW +-9..9"));
  EXPECT_THAT(out, testing::ContainsRegex("actual_velocity +R +read only"));
  const auto row = json({"params", "x"}).at("parameters").at(0);
  EXPECT_EQ(row.at("stored"), true);
  EXPECT_EQ(row.at("default"), 1000);
  EXPECT_EQ(row.at("aliases").at(0), "v_max");
}

TEST_F(CtlVerbs, WhatCannotBeStoredIsNotCalledUnknown) {
  fail_with(ExitCode::refused, tmcl::Outcome::refused);
  for (const auto* name : {"target_position", "xtarget", "0"}) {
    EXPECT_EQ(run({"store", "x", name}), ExitCode::refused);
    EXPECT_THAT(err, HasSubstr("target_position cannot be kept in the EEPROM")) << name;
    EXPECT_THAT(err, HasSubstr("params x' shows RWE"));
  }
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
  target.move_to(1000);
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
  EXPECT_EQ(err, "tmclctl: warning: it turns\n");
  EXPECT_EQ(json({"raw", "1", "ROR", "0", "0", "100"}).at("warnings").at(0), "it turns");
  EXPECT_TRUE(json({"raw", "1", "MST", "0", "0", "0"}).at("warnings").as_array().empty());
}

TEST_F(CtlVerbs, PlotRecordsAMoveToItsEnd) {
  EXPECT_EQ(run({"plot", "x", "--to", "10000"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr("x went from 0 to 10000 microsteps in 1.0"));
  EXPECT_THAT(out, Not(HasSubstr("\x1b")));
  const auto document = json({"plot", "x", "--by", "-10000"});
  const auto& positions = document.at("position_microsteps").as_array();
  EXPECT_EQ(positions.front(), 10000);
  EXPECT_EQ(positions.back(), 0);
  EXPECT_GE(positions.size(), 90U);
  EXPECT_EQ(positions.size(), document.at("time_s").as_array().size());
  EXPECT_EQ(positions.size(), document.at("velocity_internal").as_array().size());
}

TEST_F(CtlVerbs, PlotWithoutAMoveEndsWhenTheAxisStands) {
  target.move_to(5000);
  EXPECT_EQ(run({"plot", "x", "--csv", "-"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr("\ntime_s,position_microsteps,velocity_internal,utc\n0.000000,"));
  EXPECT_THAT(out, HasSubstr(",5000,0,1970-01-01T01:00:0"));
  EXPECT_EQ(run({"plot", "x", "--for", "0.3", "--csv", "-"}), ExitCode::done);
  const auto rows = out.substr(out.find("\ntime_s") + 1);
  EXPECT_NEAR(static_cast<double>(std::ranges::count(rows, '\n')), 32, 2);
}

TEST_F(CtlVerbs, CommentsAboveTheCsvSayWhatItIsOf) {
  target.values["load_value"] = 17;
  target.counts.scale->unit = "mm";
  target.tells_position_in_mm = true;
  EXPECT_EQ(run({"plot", "x", "--for", "0.1", "--also", "load_value", "--csv", "-"}),
            ExitCode::done);
  EXPECT_TRUE(out.starts_with("# tmclctl "));
  EXPECT_THAT(out, HasSubstr("\n# begins 1970-01-01T01:00:00.000000Z\n"));
  EXPECT_THAT(out, HasSubstr("\n# x: TMCM-1110, module 1 of bench, motor 0; unit mm of 10240 "
                             "microsteps, velocity_internal of "));
  EXPECT_THAT(out, HasSubstr("\n# load_value\n"));
}

TEST_F(CtlVerbs, FurtherParametersHaveTheirAgeInTheCsv) {
  target.values["load_value"] = 17;
  EXPECT_EQ(run({"plot", "x", "--for", "0.1", "--also", "load_value", "--csv", "-"}),
            ExitCode::done);
  EXPECT_THAT(out, HasSubstr("\ntime_s,position_microsteps,velocity_internal,load_value,load_value_"
                             "age_ms,utc\n0.000000,0,0,,,1970"));
  EXPECT_THAT(out, HasSubstr(",0,0,17,5,1970"));
  const auto document = json({"plot", "x", "--by", "1000", "--also", "load_value"});
  EXPECT_TRUE(document.at("also").at("load_value").at(0).is_null()) << "read with the first look";
  EXPECT_EQ(document.at("also").at("load_value").as_array().back(), 17) << "kept for the last";
}

TEST_F(CtlVerbs, SeveralAxesAreRecordedAndTheFirstIsMoved) {
  EXPECT_EQ(run({"plot", "x", "y", "--to", "1000", "--csv", "-"}), ExitCode::done);
  EXPECT_THAT(target.calls, Contains("move_to x 1000"));
  EXPECT_THAT(target.calls, Not(Contains("move_to y 1000")));
  EXPECT_THAT(out, HasSubstr("\ntime_s,axis,position_microsteps,velocity_internal,"
                             "position_in_unit,velocity_in_unit,utc\n"));
  EXPECT_THAT(out, HasSubstr(",x,1000,0,,,1970"));
  EXPECT_THAT(out, HasSubstr(",y,1000,0,,,1970"));
  EXPECT_EQ(run({"plot", "x", "y", "--for", "0.2"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr("x position [microsteps]"));
  EXPECT_THAT(out, HasSubstr("y velocity [internal]"));
  const auto document = json({"plot", "x", "y", "--for", "0.2"});
  EXPECT_EQ(document.at("axis"), "x");
  EXPECT_EQ(document.at("beside").at(0).at("axis"), "y");
}

TEST_F(CtlVerbs, TheRecordingOfAMoveThatWasRefusedIsNotWritten) {
  target.known_axis = "x";
  EXPECT_EQ(run({"plot", "x", "--to", "nowhere", "--csv", "-"}), ExitCode::usage);
  EXPECT_EQ(out, "");
}

TEST_F(CtlVerbs, TheCsvOfSeveralAxesHasNoDerivatives) {
  EXPECT_EQ(run({"plot", "x", "y", "--show", "v,a", "--csv", "-"}), ExitCode::usage);
  EXPECT_EQ(run({"plot"}), ExitCode::usage);
}

TEST_F(CtlVerbs, CtrlCDrawsWhatThereIs) {
  host.press_ctrl_c_after(milliseconds(300));
  EXPECT_EQ(run({"plot", "x", "--to", "10000"}), ExitCode::interrupted);
  EXPECT_THAT(out, HasSubstr("velocity [internal]"));
  EXPECT_THAT(err, HasSubstr("goes on moving"));
}

TEST_F(CtlVerbs, NothingMovesIfTheFileCannotBeWritten) {
  EXPECT_EQ(run({"plot", "x", "--to", "10000", "--svg", "/nowhere/at/all.svg"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("/nowhere/at/all.svg"));
  EXPECT_THAT(target.calls, IsEmpty());
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
  EXPECT_THAT(target.calls, ElementsAre("path.pause {}"));
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
  target.result = {{"ms", 1000}};
  EXPECT_EQ(run({"deadman", "set", "x", "1000"}), ExitCode::done);
  EXPECT_THAT(target.calls, ElementsAre(R"(axis.set_deadman {"axis":"x","ms":1000})"));
  EXPECT_THAT(out, HasSubstr("'tmclctl deadman test x' sees whether it does"));
  EXPECT_EQ(run({"deadman", "set", "x", "99"}), ExitCode::usage);
}

TEST_F(CtlVerbs, DeadmanOffSetsItToNothing) {
  target.result = {{"ms", 0}};
  EXPECT_EQ(run({"deadman", "off", "x"}), ExitCode::done);
  EXPECT_THAT(target.calls, ElementsAre(R"(axis.set_deadman {"axis":"x","ms":0})"));
  EXPECT_EQ(out, "x: the deadman of its module is off\n");
}

TEST_F(CtlVerbs, DeadmanTestTellsWhatWasFound) {
  target.result = {{"deadman", {{"ms", 1000}, {"measured", 1003}}},
                   {"reason", nullptr},
                   {"way_microsteps", 6200}};
  EXPECT_EQ(run({"deadman", "test", "x"}), ExitCode::done);
  EXPECT_EQ(out,
            "x: its module stops it 1003 ms after the last command (set to 1000 ms); it has gone "
            "6200 microsteps\n");
  target.result = {{"deadman", "none"}, {"reason", "it is switched off"}, {"way_microsteps", 0}};
  EXPECT_EQ(run({"deadman", "test", "x"}), ExitCode::not_reached);
  EXPECT_THAT(out, HasSubstr("x: no deadman: it is switched off; it has gone 0 microsteps\n"));
}

TEST_F(CtlVerbs, VerifyMovesNothingThatNobodyAllowed) {
  EXPECT_EQ(run({"verify", "x", "--travel", "-2mm..2mm"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("--yes says that it may"));
  EXPECT_EQ(run({"verify", "x", "--travel", "2mm", "--yes"}), ExitCode::usage);
  EXPECT_THAT(target.calls, IsEmpty());
}

TEST_F(CtlVerbs, VerifyTellsWhatTheTwinHasAndWhatTheModuleDoes) {
  using boost::json::array;
  using boost::json::object;
  const auto trait = [](const char* name, bool measured, array fits, const char* text) {
    return object{{"trait", name},
                  {"foreseen", "r3"},
                  {"measured", measured},
                  {"fits", std::move(fits)},
                  {"text", text}};
  };
  target.result = {{"model", "TMCM-1110"},
                   {"firmware", "1.13"},
                   {"answer_us", 420},
                   {"traits",
                    {trait("last_step", true, {"r1"}, "as 8 moves say"),
                     trait("limit_stop", false, {}, "it needs a switch")}},
                   {"moves", array{}},
                   {"report", "[module]\n"}};
  EXPECT_EQ(run({"verify", "x", "--travel", "-2mm..2mm", "--yes"}), ExitCode::done);
  EXPECT_THAT(target.calls, ElementsAre(R"(axis.verify {"axis":"x","from":"-2mm","to":"2mm"})"));
  EXPECT_THAT(out, HasSubstr("TMCM-1110, firmware 1.13, answers within 0.42 ms\n"));
  EXPECT_THAT(out, HasSubstr("not measured"));
  EXPECT_THAT(out, HasSubstr("1 of 2 traits measured; 1 not as foreseen\n"));
  EXPECT_EQ(run({"verify", "x", "--yes", "--report", "-"}), ExitCode::done);
  EXPECT_THAT(out, testing::EndsWith("[module]\n"));
}

}  // namespace
}  // namespace tmclctl::test
