// mint check: a table, JSON, and where a program is wrong.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "ctl_fixture.hpp"
#include "support/temp_path.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;
using testing::HasSubstr;

class CtlMint : public testing::Test, public test::Ctl {
 protected:
  ~CtlMint() override { std::filesystem::remove(path); }

  std::vector<std::string> check(const std::string& program) const {
    std::ofstream(path, std::ios::binary) << program;
    return {"mint", "check", path};
  }

  const std::string path = tmcl::test::temp_path("ctl_mint_test.mint");
};

const std::string exercise =
    "SCALE = 1200\nSPEED = 250\nACCEL = 1250\nDECEL = 1250\nMOVER = 200\nGO\n";

TEST_F(CtlMint, PrintsWhereEachGoMoves) {
  EXPECT_EQ(run(check(exercise + "MOVEA[0,1] = 0; : SPEED.1 = 1 : ACCEL.1 = 1 : GO")),
            ExitCode::done)
      << err;
  EXPECT_EQ(err, "");
  EXPECT_THAT(out, HasSubstr("GO      START  AXIS  FROM  TO   TIME"));
  EXPECT_THAT(out,
              HasSubstr("line 6  0 s    0     0     200  1 s   250    0.2 s        0.6 s  0.2 s"));
  EXPECT_THAT(out, HasSubstr("line 7  1 s    0     200   0    1 s"));
  EXPECT_THAT(out, HasSubstr("line 7  1 s    1     0     0    0 s"));
}

TEST_F(CtlMint, SaysItAsJson) {
  const auto document = json(check(exercise));
  const auto& group = document.at("groups").at(0);
  EXPECT_EQ(group.at("line"), 6);
  const auto& move = group.at("moves").at(0);
  EXPECT_EQ(move.at("end").to_number<double>(), 200);
  EXPECT_EQ(move.at("scale").to_number<double>(), 1200);
  EXPECT_NEAR(move.at("profile").at("slew_time").to_number<double>(), 0.6, 1e-12);
  EXPECT_NEAR(document.at("duration_s").to_number<double>(), 1, 1e-12);
}

TEST_F(CtlMint, ProblemsHaveTheirPlaces) {
  EXPECT_EQ(run(check("SPED = 1\nGO\n")), ExitCode::usage);
  EXPECT_EQ(out, "");
  EXPECT_THAT(err, HasSubstr(path + ":1:1: 'SPED' is none of SCALE"));
  EXPECT_THAT(err, HasSubstr("1 problem in " + path));
  EXPECT_EQ(run(check("GO\n")), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr(path + ":1:1: no axis has a move loaded"));
}

TEST_F(CtlMint, ProblemsAreJsonToo) {
  const auto document = json(check("SPED = 1\n"), ExitCode::usage);
  const auto& error = document.at("error");
  EXPECT_EQ(error.at("name"), "bad_program");
  EXPECT_EQ(error.at("problems").at(0).at("line"), 1);
}

TEST_F(CtlMint, TheGatewayRunsAProgram) {
  check(exercise);
  target.news = {{{"phase", "checked"}, {"remarks", json::array{"line 7: it is late"}}},
                 {{"phase", "running"}, {"line", 6}, {"passed_s", 0.5}, {"duration_s", 1}},
                 {{"phase", "stands"}, {"line", 6}, {"passed_s", 1.25}, {"duration_s", 1}}};
  target.result = {{"groups",
                    {{{"line", 6}, {"planned_s", 1}, {"took_s", 1.25}},
                     {{"line", 8}, {"planned_s", 2}, {"took_s", 2}}}},
                   {"remarks", {"parameter 4 of x was 7 before: silent"}}};
  EXPECT_EQ(run({"mint", "run", path, "--axis", "3=x", "--axis", "0=y"}), ExitCode::done) << err;
  EXPECT_EQ(target.calls.front(), R"(mint.run {"axes":["x","y"],"numbers":[3,0],"bytes":66})");
  EXPECT_EQ(target.run_text, exercise);
  EXPECT_EQ(out,
            "GO of line 6: 1.250 s, planned 1.000 s\nGO of line 8: 2.000 s, planned 2.000 s\n");
  EXPECT_THAT(err, HasSubstr("tmclctl: warning: line 7: it is late\n"));
  EXPECT_THAT(err, HasSubstr("tmclctl: warning: parameter 4 of x was 7 before: silent\n"));
}

TEST_F(CtlMint, Axis0IsTheFirstThereIs) {
  check(exercise);
  target.news = {json::object{{"phase", "checked"},
                              {"axes", json::array{json::object{{"number", 0}, {"axis", "x"}}}}}};
  EXPECT_EQ(run({"mint", "run", path}), ExitCode::done) << err;
  EXPECT_EQ(target.calls.front(), R"(mint.run {"axes":["x"],"bytes":66})");
  EXPECT_EQ(out, "axis 0 is x\n");
}

TEST_F(CtlMint, WhatTheGatewaySaysOfAProgramHasItsFile) {
  check(exercise);
  const std::vector<std::string> words{"mint", "run", path, "--axis", "0=x"};
  target.run_failure = usage_error("bad_program", "the program cannot be run: line 2: no");
  target.run_failure->subject["problems"] =
      json::array{json::object{{"line", 2}, {"column", 1}, {"message", "no"}}};
  EXPECT_EQ(run(words), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr(path + ":2:1: no\n"));
  target.run_failure = usage_error("missing_axis", "line 3 moves axis 1: which axis is that?");
  target.run_failure->subject["file_axis"] = "1";
  EXPECT_EQ(run(words), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("--axis 1=NAME"));
  EXPECT_EQ(run({"mint", "run", path, "--axis", "9=x"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("Mint's axes are 0 to 7"));
}

TEST_F(CtlMint, CtrlCStopsAllAxes) {
  check(exercise);
  target.news = {
      json::object{{"phase", "running"}, {"line", 6}, {"passed_s", 0.5}, {"duration_s", 1}}};
  target.run_failure = error_of(ExitCode::unknown, "stopped_by_other", "x was stopped");
  host.press_ctrl_c_after(std::chrono::milliseconds(500));
  EXPECT_EQ(run({"mint", "run", path, "--axis", "0=x", "--axis", "1=y"}), ExitCode::interrupted);
  EXPECT_THAT(target.calls, testing::ElementsAre(testing::_, "stop x", "stop y"));
  EXPECT_THAT(err, HasSubstr("stopped at the GO of line 6"));
}

TEST_F(CtlMint, AMoveThatNeverStartsIsAWarning) {
  EXPECT_EQ(run(check(exercise + "MOVER = 1")), ExitCode::done);
  EXPECT_EQ(err, "tmclctl: warning: " + path + ":7: no GO starts the move of axis 0\n");
}

TEST_F(CtlMint, FilesThatCannotBe) {
  EXPECT_EQ(run({"mint", "check", "/nowhere/x.mint"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("cannot read /nowhere/x.mint"));
  EXPECT_EQ(run(check(std::string((1 << 20) + 1, '\n'))), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("too long"));
}

}  // namespace
}  // namespace tmclctl
