#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "ctl_fixture.hpp"
#include "support/temp_path.hpp"

namespace tmclctl {
namespace {

using testing::HasSubstr;

class CtlPath : public testing::Test, protected test::Ctl {
 protected:
  ~CtlPath() override { std::filesystem::remove(path); }

  std::string file(const std::string& text) const {
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }

  const std::string path = tmcl::test::temp_path("ctl_path_test");
};

TEST_F(CtlPath, CheckTellsWhatAPathIs) {
  const auto square = file("G1 X10 F1200\nG1 Y10\nG4 P1\nG1 X0 Y0\n");
  EXPECT_EQ(run({"path", "check", square, "--velocity", "20", "--acceleration", "500"}),
            ExitCode::done)
      << err;
  EXPECT_THAT(out, HasSubstr("34.1421 units"));
  EXPECT_THAT(out, HasSubstr("X     0     10  20"));
  EXPECT_THAT(out, HasSubstr("end of line 2"));
  const auto document = json({"path", "check", square});
  EXPECT_EQ(document.at("legs"), 3);
  EXPECT_EQ(document.at("axes").at(1).at("greatest").to_number<double>(), 10);
  EXPECT_EQ(document.at("slowest_corners").at(0).at("speed").to_number<double>(), 0);
}

TEST_F(CtlPath, ATableIsKnownByItsFirstLine) {
  const auto table = file("# where when\nt,x,y\n0,0,0\n1,5,5\n");
  EXPECT_EQ(json({"path", "check", table}).at("duration_s").to_number<double>(), 1);
  EXPECT_EQ(run({"path", "check", table, "--velocity", "2"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("line 4: too fast for axis x"));
}

TEST_F(CtlPath, ProblemsHaveTheirPlaces) {
  EXPECT_EQ(run({"path", "check", file("G1 X1 F600\nG99\n")}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr(path + ":2:1: "));
  EXPECT_EQ(run({"path", "check", file("M2\n")}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("moves nothing"));
}

TEST_F(CtlPath, RunChecksBeforeItMoves) {
  const auto line = file("G1 X10 F600\n");
  target.values = {{"4", 1000}, {"5", 500}};
  target.known_axis = "left";
  EXPECT_EQ(run({"path", "run", line}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("the file moves X: which axis is that?"));
  target.known_axis.clear();
  EXPECT_EQ(run({"path", "run", line, "--axis", "Q=x"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("has no axis Q"));
  EXPECT_EQ(run({"path", "run", line, "--axis", "x"}), ExitCode::usage);
  EXPECT_EQ(run({"path", "run", line, "--axis", "X=x", "--mode", "fast"}), ExitCode::usage);
  EXPECT_EQ(run({"path", "run", line, "--axis", "X=x", "--dry-run"}), ExitCode::done) << err;
  target.counts.limits = tmcl::SoftLimits{{0}, {5}};
  EXPECT_EQ(run({"path", "run", line, "--axis", "X=x", "--dry-run"}), ExitCode::refused);
  EXPECT_THAT(err, HasSubstr("the path goes to X 10: 10 mm is beyond the soft limit of 5 mm of x"));
  target.counts.limits.reset();
  target.counts.scale->unit = "deg";
  EXPECT_EQ(run({"path", "run", line, "--axis", "X=x", "--dry-run"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("axis X of G-code is in mm, and x in deg"));
  for (const auto& call : target.calls) {
    EXPECT_THAT(call, testing::Not(testing::AnyOf(HasSubstr("move"), HasSubstr("set"))));
  }
}

TEST_F(CtlPath, XIsTheAxisOfThisName) {
  const auto line = file("G1 X10 F600\n");
  target.values = {{"4", 1000}, {"5", 500}};
  target.known_axis = "x";
  EXPECT_EQ(run({"path", "run", line, "--dry-run"}), ExitCode::done) << err;
  EXPECT_EQ(target.calls.back(), "get x max_acceleration");
}

TEST_F(CtlPath, GCodeBeginsWhereTheAxesStand) {
  target.values = {{"4", 1000}, {"5", 500}};
  target.counts.scale->unit = "mm";
  run({"move", "x", "5000", "--wait"});
  const double stands = 5000. / target.counts.scale->steps.per_revolution() *
                        target.counts.scale->units_per_motor_revolution();
  const auto by = json({"path", "run", file("G91 G1 X10 F600\n"), "--axis", "X=x", "--dry-run"});
  EXPECT_NEAR(by.at("axes").at(0).at("least").to_number<double>(), stands, 1e-9);
  EXPECT_NEAR(by.at("axes").at(0).at("greatest").to_number<double>(), stands + 10, 1e-9);
  const auto table = json(
      {"path", "run", file("x,y\n0,0\n10,0\n"), "--axis", "x=x", "--axis", "y=y", "--dry-run"});
  EXPECT_EQ(table.at("axes").at(0).at("least").to_number<double>(), 0);
}

TEST_F(CtlPath, TheGatewayPassesAPathItself) {
  const auto line = file("G1 X10 F600\n");
  target.values = {{"4", 1000}, {"5", 500}};
  target.result = {{"tracking_error", {{{"axis", "x"}, {"largest", 0.25}}}},
                   {"remarks", {"it was late"}},
                   {"updates", 7}};
  EXPECT_EQ(run({"path", "run", line, "--axis", "X=x", "--feed", "3"}), ExitCode::done) << err;
  EXPECT_EQ(target.path_text, "G1 X10 F600\n");
  EXPECT_THAT(target.calls.back(),
              HasSubstr(R"(path.run {"axes":["x"],"file_axes":["X"],"format":"gcode",)"
                        R"("mode":"velocity","tolerance":5E-2,"period_ms":5,"feed":3E0})"));
  EXPECT_THAT(out, HasSubstr("0.2500"));
  EXPECT_THAT(out, HasSubstr("7 updates"));
  EXPECT_THAT(err, HasSubstr("it was late"));
  for (const auto& call : target.calls) EXPECT_THAT(call, testing::Not(HasSubstr("rotate")));
}

TEST_F(CtlPath, CtrlCLetsTheGatewayStop) {
  const auto line = file("G1 X10 F600\n");
  target.values = {{"4", 1000}, {"5", 500}};
  target.path_failure = Failure{ExitCode::unknown, "stopped", "stopped", "", tmcl::Outcome::done};
  target.path_failure->details["run"] = boost::json::object{};
  host.press_ctrl_c_after(std::chrono::seconds(1));
  EXPECT_EQ(run({"path", "run", line, "--axis", "X=x"}), ExitCode::interrupted);
  EXPECT_EQ(target.path_will, PathWill::stop);
  EXPECT_THAT(err, HasSubstr("stopped before the end of the path"));
}

TEST_F(CtlPath, WhatTheGatewaySaysHasItsExitCodes) {
  const auto line = file("G1 X10 F600\n");
  target.values = {{"4", 1000}, {"5", 500}};
  for (const auto& [outcome, exit] : {std::pair{tmcl::Outcome::done, ExitCode::not_reached},
                                      std::pair{tmcl::Outcome::not_sent, ExitCode::refused}}) {
    target.path_failure = Failure{ExitCode::unknown, "starved", "late", "", outcome};
    target.path_failure->details["run"] = boost::json::object{};
    EXPECT_EQ(run({"path", "run", line, "--axis", "X=x"}), exit);
  }
}

TEST_F(CtlPath, MintRunRefusesWhatItCannotDo) {
  const auto second = file("SPEED.1 = 100\nACCEL.1 = 1000\nMOVER.1 = 200\nGO\n");
  EXPECT_EQ(run({"mint", "run", second}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("line 3 moves axis 1: which axis is that?"));
  EXPECT_EQ(run({"mint", "run", second, "--axis", "9=x"}), ExitCode::usage);
  const auto fast = file("SCALE = 1000\nSPEED = 9000\nACCEL = 9000\nMOVEA = 8000\nGO\n");
  EXPECT_EQ(run({"mint", "run", fast, "--axis", "0=x"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("line 4"));
  for (const auto& call : target.calls) EXPECT_THAT(call, testing::Not(HasSubstr("move")));
}

TEST_F(CtlPath, MintRunMovesAndSetsTheRampBack) {
  const auto program = file("SPEED = 1000\nACCEL = 10000\nMOVER = 200\nGO\n");
  target.values = {{"4", 1000}};
  EXPECT_EQ(run({"mint", "run", program, "--axis", "0=x"}), ExitCode::done) << err;
  EXPECT_THAT(out, HasSubstr("GO of line 4"));
  EXPECT_THAT(target.calls, testing::Contains("move_to x 200"));
  EXPECT_THAT(target.calls, testing::Contains("set x 4 1000"));
}

TEST_F(CtlPath, MintsAxis0IsTheFirstThereIs) {
  const auto program = file("SPEED = 1000;\nACCEL = 10000;\nMOVER = 200\nGO\n");
  target.values = {{"4", 1000}};
  EXPECT_EQ(run({"mint", "run", program}), ExitCode::done) << err;
  EXPECT_THAT(out, HasSubstr("axis 0 is x\n"));
  EXPECT_THAT(target.calls, testing::Contains("move_to x 200"));
}

TEST_F(CtlPath, CtrlCStopsAMintProgram) {
  const auto program = file("SPEED = 1000\nACCEL = 10000\nMOVER = 20000\nGO\nMOVER = 1\nGO\n");
  host.press_ctrl_c_after(std::chrono::milliseconds(500));
  EXPECT_EQ(run({"mint", "run", program, "--axis", "0=x"}), ExitCode::interrupted);
  EXPECT_THAT(target.calls, testing::Contains("stop x"));
  EXPECT_THAT(target.calls, testing::Not(testing::Contains("move_to x 20001")));
}

}  // namespace
}  // namespace tmclctl
