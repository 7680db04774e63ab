// tmclctl straight on a bus.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "system/tmclctl_bench.hpp"

namespace tmcl::test {
namespace {

using testing::HasSubstr;
using testing::Not;

class TmclctlDirect : public testing::Test, public CtlBench {
 protected:
  Ran run(const Words& words) const { return ctl(direct(), words); }
};

TEST_F(TmclctlDirect, ReadsWritesAndMovesOverTcp) {
  EXPECT_EQ(run({"get", "1/0", "actual_position"}).out, "0\n");
  EXPECT_EQ(run({"set", "1/0", "max_velocity", "2000"}).status, 0);
  EXPECT_EQ(run({"get", "1/0", "4"}).out, "2000\n");
  const auto moved = run({"move", "1/0", "20000", "--wait"});
  EXPECT_EQ(moved.status, 0) << moved.err;
  EXPECT_EQ(moved.out, "1/0 stands at 20000\n");
  EXPECT_EQ(moved.err, "");
  EXPECT_EQ(run({"move", "1/0", "-1000", "--by", "--wait"}).out, "1/0 stands at 19000\n");
}

TEST_F(TmclctlDirect, ReadsAndMovesOnASerialLine) {
  const Words how{"--direct", pty_link()};
  EXPECT_EQ(ctl(how, {"move", "3/2", "-500", "--wait"}).out, "3/2 stands at -500\n");
  EXPECT_EQ(ctl(how, {"get", "3/2", "position"}).out, "-500\n");
}

TEST_F(TmclctlDirect, CountsInTurnsAndPulses) {
  const auto ramp =
      run({"ramp", "3/1", "--velocity", "100000pps", "--acceleration", "1000000pps/s"});
  EXPECT_EQ(ramp.status, 0) << ramp.err;
  EXPECT_THAT(ramp.out, HasSubstr("gives 99"));
  EXPECT_EQ(run({"get", "3/1", "pulse_divisor"}).out, "2\n");
  EXPECT_EQ(run({"set", "3/1", "microstep_resolution", "4"}).status, 0);
  EXPECT_EQ(run({"move", "3/1", "-1.5rev", "--wait", "--full-steps", "400"}).out,
            "3/1 stands at -9600\n");
  EXPECT_EQ(run({"rotate", "3/1", "1rps", "--unattended"}).status, 0);
  const auto refused =
      run({"ramp", "3/1", "--velocity", "50000pps", "--acceleration", "1000000pps/s"});
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.err, HasSubstr("moves"));
  EXPECT_EQ(run({"move", "3/1", "1mm"}).status, 2);
}

TEST_F(TmclctlDirect, TurnsLeftAndStops) {
  EXPECT_EQ(run({"rotate", "1/0", "-500", "--unattended"}).status, 0);
  EXPECT_EQ(json(direct(), {"state", "1/0"}).at("moving"), true);
  EXPECT_EQ(run({"stop", "1/0"}).status, 0);
  ::usleep(300'000);
  const auto state = json(direct(), {"state", "1/0"});
  EXPECT_EQ(state.at("moving"), false);
  EXPECT_LT(state.at("position_microsteps").as_int64(), 0);
}

TEST_F(TmclctlDirect, Scans) {
  const auto text = run({"scan", "--addresses", "1-5"});
  EXPECT_EQ(text.status, 0);
  EXPECT_THAT(text.out, HasSubstr("TMCM-1110"));
  EXPECT_EQ(text.err, "");
  const auto modules = json(direct(), {"scan", "--addresses", "1-5"}).at("modules").as_array();
  ASSERT_EQ(modules.size(), 2U);
  EXPECT_EQ(modules.at(0).at("address"), 1);
  EXPECT_EQ(modules.at(1).at("model"), "TMCM-3110");
  EXPECT_EQ(modules.at(1).at("axes"), 3);
}

TEST_F(TmclctlDirect, AModuleMayTakeAsLongAsIsSaid) {
  const auto patiently = [&](const Words& words) {
    return ctl({"--direct", tcp_link(), "--reply-timeout", "2000"}, words);
  };
  EXPECT_EQ(patiently({"global", "set", "3", "telegram_pause_time", "150"}).status, 0);
  EXPECT_EQ(run({"scan", "--addresses", "3"}).status, 3);
  EXPECT_THAT(patiently({"scan", "--addresses", "3"}).out, HasSubstr("TMCM-3110"));
  EXPECT_EQ(run({"get", "3/0", "4"}).status, 3);
  EXPECT_EQ(patiently({"get", "3/0", "4"}).out, "1000\n");
}

TEST_F(TmclctlDirect, ExitCodes) {
  EXPECT_EQ(run({"get", "1/0", "4"}).status, 0);
  EXPECT_EQ(run({"set", "1/0", "4", "99999"}).status, 2) << "out of range";
  EXPECT_EQ(run({"get", "1/0", "max_velocty"}).status, 2);
  EXPECT_EQ(run({"get", "x", "4"}).status, 2);
  EXPECT_EQ(run({"frobnicate"}).status, 2);
  EXPECT_EQ(run({"get", "9/0", "4"}).status, 3) << "nobody answers";
  EXPECT_EQ(ctl({"--direct", "serial:/nowhere"}, {"get", "1/0", "4"}).status, 3);
  EXPECT_EQ(ctl({"--direct", "carrier-pigeon:1"}, {"get", "1/0", "4"}).status, 2);
  EXPECT_EQ(run({"move", "1/0", "1000000", "--wait", "--timeout", "0.2"}).status, 5);
}

TEST_F(TmclctlDirect, WhatTheTableRefusesIsNotSent) {
  EXPECT_EQ(json(direct(), {"set", "1/0", "max_velocity", "99999"}).at("error").at("name"),
            "out_of_range");
  EXPECT_EQ(run({"set", "1/0", "max_velocity", "99999"}).status, 2);
  EXPECT_EQ(run({"set", "1/0", "actual_velocity", "1"}).status, 2) << "can only be read";
  EXPECT_EQ(run({"home", "1/0", "--mode", "137"}).status, 2);
  EXPECT_EQ(run({"home", "1/0", "--mode", "20"}).status, 1) << "the module refuses";
  EXPECT_EQ(run({"home", "1/0", "--mode", "20", "--no-wait"}).status, 1);
  EXPECT_EQ(run({"get", "1/0", "reference_search_mode"}).out, "1\n") << "as it was before";
  EXPECT_THAT(run({"store", "1/0", "target_position"}).err, HasSubstr("cannot be kept"));
}

TEST_F(TmclctlDirect, NobodyThereIsNoSuccess) {
  EXPECT_EQ(run({"scan", "--addresses", "9"}).status, 3);
  EXPECT_EQ(run({"get", "9/0", "4"}).status, 3);
  EXPECT_EQ(run({"info", "9"}).status, 3);
}

TEST_F(TmclctlDirect, ATypoGetsASuggestion) {
  EXPECT_THAT(run({"get", "1/0", "max_velocty"}).err, HasSubstr("'max_velocity'"));
  const auto error = json(direct(), {"get", "1/0", "max_velocty"}).at("error");
  EXPECT_EQ(error.at("name"), "unknown_parameter");
  EXPECT_EQ(error.at("exit_code"), 2);
}

TEST_F(TmclctlDirect, RawShowsTheBytes) {
  const auto raw = run({"raw", "1", "GAP", "max_velocity", "0", "0"});
  EXPECT_THAT(raw.out, HasSubstr("-> 01 06 04 00 00 00 00 00 0B"));
  EXPECT_THAT(raw.out, HasSubstr("<- 02 01 64 06 00 00 "));
  EXPECT_THAT(run({"raw", "1", "GET_FIRMWARE_VERSION", "0", "0", "0"}).out, HasSubstr("<- 1110V"));
}

TEST_F(TmclctlDirect, PlotsAMoveIntoFiles) {
  const auto plot =
      run({"plot", "1/0", "--to", "10000", "--svg", file("p.svg"), "--csv", file("p.csv")});
  EXPECT_EQ(plot.status, 0) << plot.err;
  EXPECT_THAT(plot.out, HasSubstr("1/0 went from 0 to 10000 microsteps"));
  EXPECT_THAT(plot.out, Not(HasSubstr("\x1b")));
  EXPECT_EQ(plot.err, "");
  EXPECT_THAT(contents(file("p.csv")), testing::ContainsRegex(",10000,0,20[0-9T:.-]+Z\n$"));
  const auto parsed = run_program(
      {"/bin/sh", "-c",
       "python3 -c 'import sys, xml.dom.minidom as m; m.parse(sys.argv[1])' " + file("p.svg")});
  EXPECT_EQ(parsed.status, 0) << parsed.output;
}

TEST_F(TmclctlDirect, WatchIsJsonLines) {
  ctl(direct(), {"move", "1/0", "20000"});
  auto how = direct();
  how.emplace_back("--json");
  const auto watched = ctl(how, {"watch", "1/0", "--interval", "20", "--for", "0.6"});
  EXPECT_EQ(watched.status, 0);
  std::istringstream lines(watched.out);
  int count = 0;
  std::int64_t before = -1;
  for (std::string line; std::getline(lines, line); ++count) {
    const auto position = boost::json::parse(line).at("position_microsteps").as_int64();
    EXPECT_GE(position, before);
    before = position;
  }
  EXPECT_GE(count, 5);
}

TEST_F(TmclctlDirect, CtrlCWhileWaiting) {
  OnTerminal program(direct(), {"move", "1/0", "1000000", "--wait"});
  ASSERT_TRUE(program.wait_for("of 1000000"));
  program.press_ctrl_c();
  EXPECT_EQ(program.wait(), 130);
  EXPECT_THAT(program.output(), HasSubstr("goes on moving to 1000000"));
  EXPECT_THAT(program.output(), HasSubstr("tmclctl --direct " + tcp_link() + " stop 1/0"));
  EXPECT_EQ(json(direct(), {"state", "1/0"}).at("moving"), true);
}

TEST_F(TmclctlDirect, CtrlCEndsAWatch) {
  OnTerminal program(direct(), {"watch", "1/0"});
  ASSERT_TRUE(program.wait_for("position"));
  program.press_ctrl_c();
  EXPECT_EQ(program.wait(), 0);
}

TEST_F(TmclctlDirect, ColoursAndBrailleOnATerminal) {
  OnTerminal program(direct(), {"plot", "1/0", "--to", "5000"});
  EXPECT_EQ(program.wait(), 0);
  EXPECT_THAT(program.output(), HasSubstr("\x1b[36m"));
  EXPECT_THAT(program.output(), HasSubstr("⣀"));
}

TEST_F(TmclctlDirect, TellsWhenTheBusGoesAway) {
  OnTerminal program(direct(), {"move", "1/0", "1000000", "--wait"});
  ASSERT_TRUE(program.wait_for("of 1000000"));
  simulator().signal(SIGKILL);
  EXPECT_EQ(program.wait(), 4);
  EXPECT_THAT(program.output(), HasSubstr("lost sight of 1/0"));
}

}  // namespace
}  // namespace tmcl::test
