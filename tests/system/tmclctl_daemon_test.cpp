// tmclctl through a running tmcld.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/build_paths.hpp"
#include "system/tmclctl_bench.hpp"

namespace tmcl::test {
namespace {

using testing::HasSubstr;

class TmclctlDaemon : public testing::Test, public CtlBench {
 protected:
  TmclctlDaemon() { start_daemon(); }
  Ran run(const Words& words) const { return ctl(through_daemon(), words); }
};

TEST(TmclctlNoDaemon, NamesTheSocketAndWhatToTry) {
  CtlBench bench;
  const auto ran = bench.ctl(bench.through_daemon(), {"axes"});
  EXPECT_EQ(ran.status, 3);
  EXPECT_EQ(ran.out, "");
  EXPECT_THAT(ran.err, HasSubstr(bench.file("tmcld.sock")));
  EXPECT_THAT(ran.err, HasSubstr("Is tmcld running?"));
  EXPECT_THAT(ran.err, HasSubstr("--direct"));
  EXPECT_EQ(bench.json(bench.through_daemon(), {"axes"}).at("error").at("name"),
            "daemon_unreachable");
}

TEST_F(TmclctlDaemon, ListsWhatThereIs) {
  EXPECT_THAT(run({"axes"}).out, HasSubstr("ghost"));
  EXPECT_EQ(json(through_daemon(), {"axes"}).at("axes").as_array().size(), 3U);
  EXPECT_EQ(json(through_daemon(), {"modules"}).at("modules").as_array().size(), 3U);
  const auto found =
      json(through_daemon(), {"scan", "--addresses", "1-5"}).at("modules").as_array();
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found.at(0).at("bus"), "bench");
  EXPECT_THAT(run({"__complete", "axes"}).out, HasSubstr("y\n"));
}

TEST_F(TmclctlDaemon, ReadsWritesAndMoves) {
  EXPECT_EQ(run({"set", "x", "max_velocity", "2000"}).status, 0);
  EXPECT_EQ(run({"get", "x", "4"}).out, "2000\n");
  const auto moved = run({"move", "x", "20000", "--wait"});
  EXPECT_EQ(moved.out, "x stands at 20000\n") << moved.err;
  EXPECT_EQ(run({"move", "x", "-1000", "--by", "--wait"}).out, "x stands at 19000\n");
  EXPECT_EQ(run({"rotate", "y", "-300", "--unattended"}).status, 0);
  EXPECT_EQ(json(through_daemon(), {"state", "y"}).at("moving"), true);
  EXPECT_EQ(run({"stop", "y"}).status, 0);
}

TEST_F(TmclctlDaemon, ExitCodes) {
  EXPECT_EQ(run({"set", "x", "max_velocity", "99999"}).status, 2) << "out of range";
  EXPECT_EQ(run({"set", "x", "actual_velocity", "1"}).status, 2) << "can only be read";
  EXPECT_EQ(run({"home", "x", "--mode", "137"}).status, 2) << "out of range";
  EXPECT_EQ(run({"home", "x", "--mode", "20"}).status, 1) << "the module refuses";
  EXPECT_EQ(run({"get", "x", "reference_search_mode"}).out, "1\n");
  EXPECT_EQ(run({"get", "x", "77"}).status, 1) << "the module refuses";
  EXPECT_EQ(run({"get", "xx", "4"}).status, 2);
  EXPECT_THAT(run({"get", "x", "max_velocty"}).err, HasSubstr("'max_velocity'"));
  EXPECT_EQ(run({"get", "x", "max_velocty"}).status, 2);
  EXPECT_EQ(run({"raw", "--bus", "benhc", "1", "GAP", "4", "0", "0"}).status, 2);
  const int silent = run({"move", "ghost", "100"}).status;
  EXPECT_TRUE(silent == 3 || silent == 4) << silent;
}

TEST_F(TmclctlDaemon, StopAllStopsAndTellsWhatDidNot) {
  run({"rotate", "x", "300", "--unattended"});
  run({"rotate", "y", "300", "--unattended"});
  const auto stopped = json(through_daemon(), {"stop", "--all"});
  EXPECT_EQ(stopped.at("stopped").as_array().size(), 4U) << "every motor of both modules";
  ASSERT_EQ(stopped.at("failed").as_array().size(), 1U);
  EXPECT_EQ(stopped.at("failed").at(0).at("axis"), "ghost");
  EXPECT_NE(run({"stop", "--all"}).status, 0);
}

TEST_F(TmclctlDaemon, AStopFromAnotherProgramEndsTheWaiting) {
  OnTerminal waiting(through_daemon(), {"move", "x", "1000000", "--wait"});
  ASSERT_TRUE(waiting.wait_for("of 1000000"));
  EXPECT_EQ(run({"stop", "x"}).status, 0);
  EXPECT_EQ(waiting.wait(), 5);
  EXPECT_THAT(waiting.output(), HasSubstr("short of its target: at "));
  EXPECT_THAT(waiting.output(), HasSubstr("cause: client"));
}

TEST_F(TmclctlDaemon, WatchSeesWhatOthersDo) {
  OnTerminal watching(through_daemon(), {"watch", "x"});
  ASSERT_TRUE(watching.wait_for("position 0"));
  run({"move", "x", "5000"});
  EXPECT_TRUE(watching.wait_for("position 5000"));
  watching.press_ctrl_c();
  EXPECT_EQ(watching.wait(), 0);
}

TEST_F(TmclctlDaemon, PlotsAndSendsRawCommands) {
  const auto recorded = json(through_daemon(), {"plot", "x", "--by", "5000"});
  EXPECT_EQ(recorded.at("position_microsteps").as_array().back(), 5000);
  const auto raw = json(through_daemon(), {"raw", "1", "GAP", "1", "0", "0"});
  EXPECT_EQ(raw.at("reply").at("value"), 5000);
  EXPECT_EQ(raw.at("bus"), "bench");
}

TEST(TmclctlUnits, AnAxisThatSaysWhatItDrivesSpeaksItsUnit) {
  CtlBench bench;
  bench.start_daemon("unit = \"mm\"\nscrew_pitch = 10\ngear_ratio = 3.7\nsoft_limits = [-5, 20]\n");
  const auto run = [&](const Words& words) { return bench.ctl(bench.through_daemon(), words); };
  const auto document = [&](const Words& words) {
    return bench.json(bench.through_daemon(), words);
  };
  // A millimetre is 18944 microsteps, a tenth 1894.4.
  EXPECT_EQ(run({"move", "y", "2mm", "--wait"}).out, "y stands at 2 mm\n");
  EXPECT_EQ(run({"move", "y", "2mm", "--wait", "--internal"}).out, "y stands at 37888\n");
  for (int i = 0; i < 10; ++i) EXPECT_EQ(run({"move", "y", "0.1mm", "--by", "--wait"}).status, 0);
  const auto state = document({"state", "y"});
  EXPECT_EQ(state.at("position_microsteps"), 3 * 18'944);
  EXPECT_DOUBLE_EQ(state.at("position").to_number<double>(), 3);
  EXPECT_EQ(run({"get", "y", "actual_position", "--in-units"}).out, "3mm\n");
  EXPECT_THAT(run({"get", "y", "max_velocity", "--in-units"}).out, HasSubstr("mm/s\n"));
  EXPECT_THAT(run({"watch", "y", "--for", "0.05"}).out,
              HasSubstr("position 3 mm  velocity 0 mm/s"));
  EXPECT_THAT(run({"state", "y", "--internal"}).out, HasSubstr("position  56832 microsteps\n"));
  EXPECT_THAT(run({"params", "y", "--values"}).out, HasSubstr("  3 mm  "));
  EXPECT_EQ(document({"get", "y", "actual_position"}).at("value_in_unit").to_number<double>(), 3);
  EXPECT_EQ(run({"coordinate", "set", "y", "3", "2.5mm"}).status, 0);
  EXPECT_EQ(run({"coordinate", "get", "y", "3"}).out, "2.5mm\n");
  EXPECT_EQ(run({"coordinate", "get", "y", "3", "--internal"}).out, "47360\n");

  const auto refused = run({"move", "y", "21mm"});
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.err, HasSubstr("21 mm is beyond the soft limit of 20 mm"));
  EXPECT_THAT(run({"move", "y", "-9mm", "--by"}).err, HasSubstr("-6 mm is beyond"));
  EXPECT_EQ(run({"rotate", "y", "100", "--internal"}).status, 1);
  const auto bare = run({"move", "y", "12"});
  EXPECT_EQ(bare.status, 2);
  EXPECT_THAT(bare.err, HasSubstr("12mm or 12microsteps"));
  EXPECT_EQ(document({"state", "y"}).at("target_microsteps"), 3 * 18'944) << "nothing was sent";

  const auto recorded = document({"plot", "y", "--by", "1mm"});
  EXPECT_EQ(recorded.at("unit"), "mm");
  EXPECT_DOUBLE_EQ(recorded.at("position").as_array().back().to_number<double>(), 4);
  EXPECT_EQ(recorded.at("position_microsteps").as_array().back(), 4 * 18'944);
  EXPECT_THAT(run({"plot", "y", "--by", "1mm", "--compare"}).out,
              testing::ContainsRegex("at most [0-9.]+ mm off its plan|went as planned"));
}

TEST_F(TmclctlDaemon, BashCompletesVerbsAxesAndParameters) {
  const auto complete = [this](const std::string& words, int cursor) {
    const std::string script = "PATH='" TMCL_BIN_DIR "':$PATH; source '" TMCL_SOURCE_DIR
                               "/config/completions/tmclctl.bash'; compopt() { :; }; COMP_WORDS=(" +
                               words + "); COMP_CWORD=" + std::to_string(cursor) +
                               "; _tmclctl; echo \"${COMPREPLY[*]}\"";
    return run_program({"/bin/bash", "-c", script}).output;
  };
  const auto how = "tmclctl --socket " + file("tmcld.sock");
  EXPECT_EQ(complete("tmclctl mo", 1), "modules models move\n");
  EXPECT_EQ(complete(how + " move g", 4), "ghost\n");
  EXPECT_EQ(complete(how + " get x max_v", 5),
            "max_velocity max_velocity_encoder_deviation max_velocity_minimum_time\n");
  EXPECT_EQ(complete("tmclctl plot x --sv", 3), "--svg\n");
  EXPECT_EQ(complete(how + " wait x g", 5), "ghost\n");
  EXPECT_EQ(complete(how + " path pause x g", 6), "ghost\n");
  EXPECT_EQ(complete(how + " line g", 4), "ghost=\n");
  EXPECT_EQ(complete("tmclctl help mo", 2), "modules models move\n");
  EXPECT_EQ(complete("tmclctl --json help program ve", 4), "verify\n");
}

/// What a shell's own completion file offers for a line; the shell must be there.
std::string completed_by(const std::string& shell, const std::string& script) {
  const std::string path = "'" TMCL_BIN_DIR "'";
  const auto set_path =
      shell == "fish" ? "set PATH " + path + " $PATH\n" : "PATH=" + path + ":$PATH\n";
  return run_program({"/usr/bin/" + shell, "-c", set_path + script}).output;
}

TEST_F(TmclctlDaemon, ZshCompletesVerbsAxesAndFiles) {
  const auto complete = [](const std::string& words) {
    return completed_by(
        "zsh",
        "compadd() { while [[ $1 != -- ]]; do shift; done; shift; print -l -- $@ }\n"
        "_files() { print files }\nwords=(" +
            words +
            "); CURRENT=$#words\n"
            "source '" TMCL_SOURCE_DIR "/config/completions/_tmclctl'");
  };
  const auto how = "tmclctl --socket " + file("tmcld.sock");
  EXPECT_THAT(complete("tmclctl mo"), HasSubstr("modules\n"));
  EXPECT_THAT(complete(how + " move ''"), HasSubstr("ghost\n"));
  EXPECT_THAT(complete(how + " line ''"), HasSubstr("ghost=\n"));
  EXPECT_EQ(complete("tmclctl path check ''"), "files\n");
}

TEST_F(TmclctlDaemon, FishCompletesVerbsAxesAndFiles) {
  const auto complete = [](const std::string& line) {
    return completed_by("fish", "source '" TMCL_SOURCE_DIR
                                "/config/completions/tmclctl.fish'\n"
                                "complete -C '" +
                                    line + "'");
  };
  const auto how = "tmclctl --socket " + file("tmcld.sock");
  EXPECT_EQ(complete("tmclctl mov"), "move\n");
  EXPECT_THAT(complete(how + " move "), HasSubstr("ghost\n"));
  EXPECT_THAT(complete(how + " settings load " TMCL_SOURCE_DIR "/READ"), HasSubstr("README.md"));
}

TEST_F(TmclctlDaemon, TheEnvironmentNamesTheSocket) {
  const auto line = "TMCLD_SOCKET=" + file("tmcld.sock") + " '" TMCL_BIN_DIR "/tmclctl' get x 4";
  EXPECT_EQ(run_program({"/bin/sh", "-c", line}).status, 0);
}

TEST_F(TmclctlDaemon, ADaemonThatDiesIsNoticed) {
  OnTerminal waiting(through_daemon(), {"move", "x", "1000000", "--wait"});
  ASSERT_TRUE(waiting.wait_for("of 1000000"));
  stop_daemon();
  EXPECT_EQ(waiting.wait(), 4);
  EXPECT_THAT(waiting.output(), HasSubstr("lost sight of x"));
}

TEST_F(TmclctlDaemon, MotorsOfAModuleStartTogetherAndTellWhenTheyArrive) {
  for (const auto& how : {through_daemon(), direct()}) {
    const bool through_tmcld = how == through_daemon();
    const auto number = through_tmcld ? "1" : "2";
    for (const auto* motor : {"0", "1"}) {
      ASSERT_EQ(ctl(direct(), {"coordinate", "set", std::string("3/") + motor, number,
                               through_tmcld ? "3000" : "0"})
                    .status,
                0);
    }
    OnTerminal arrivals(how, {"arrivals", "3", "0", "1", "--next", "--for", "15"});
    ::usleep(300'000);
    ASSERT_EQ(ctl(how, {"coordinate", "start", "3", number, "0", "1", "--arrive-together"}).status,
              0);
    EXPECT_EQ(arrivals.wait(), 0);
    EXPECT_THAT(arrivals.output(), HasSubstr("motor 0"));
    EXPECT_THAT(arrivals.output(), HasSubstr("motor 1"));
  }
}

}  // namespace
}  // namespace tmcl::test
