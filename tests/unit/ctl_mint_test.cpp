// mint check: a table, JSON, and where a program is wrong.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "support/temp_path.hpp"
#include "unit/ctl_bench.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;
using testing::HasSubstr;

/// Motors "x" and "y" of a TMCM-3110, without units.
const std::string axes_of_mint = test::plain_axis + test::axis_section("y", 1, 1);

class CtlMint : public testing::Test, public test::CtlBench {
 protected:
  CtlMint() : CtlBench(axes_of_mint, "TMCM-3110") {}
  ~CtlMint() override { std::filesystem::remove(path); }

  std::vector<std::string> check(const std::string& program) const {
    std::ofstream(path, std::ios::binary) << program;
    return {"mint", "check", path};
  }
  ExitCode run_program(const std::string& program, const std::vector<std::string>& more = {}) {
    check(program);
    std::vector<std::string> words{"mint", "run", path};
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
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

// A second for 2000 microsteps, and another one back.
const std::string there_and_back =
    "SPEED.3 = 2500\nACCEL.3 = 12500\nMOVER.3 = 2000\nGO\nMOVEA.3 = 0\nGO\nMOVER.3 = 1\n";

TEST_F(CtlMint, TheGatewayRunsAProgram) {
  EXPECT_EQ(run_program(there_and_back, {"--axis", "3=x", "--axis", "0=y"}), ExitCode::done) << err;
  EXPECT_THAT(calls_of("mint.run"),
              testing::ElementsAre(R"(mint.run {"axes":["x","y"],"numbers":[3,0],"bytes":76})"));
  EXPECT_THAT(out, testing::MatchesRegex("GO of line 4: [01]\\.[0-9]{3} s, planned 1\\.000 s\n"
                                         "GO of line 6: [01]\\.[0-9]{3} s, planned 1\\.000 s\n"));
  EXPECT_THAT(err, HasSubstr("tmclctl: warning: line 7: no GO starts the move"));
}

TEST_F(CtlMint, WhatIsRemarkedAtTheEndIsAWarning) {
  amend("mint.run", [](json::object& ran) {
    ran["remarks"] = json::array{"parameter 4 of x was 7 before: silent"};
  });
  EXPECT_EQ(run_program(there_and_back, {"--axis", "3=x"}), ExitCode::done);
  EXPECT_THAT(err, HasSubstr("tmclctl: warning: parameter 4 of x was 7 before: silent\n"));
}

TEST_F(CtlMint, Axis0IsTheFirstThereIs) {
  EXPECT_EQ(run_program("SPEED = 2500\nACCEL = 12500\nMOVER = 200\nGO\n"), ExitCode::done) << err;
  EXPECT_THAT(calls_of("mint.run"),
              testing::ElementsAre(R"(mint.run {"axes":["x","y"],"bytes":42})"));
  EXPECT_THAT(out, testing::StartsWith("axis 0 is x\nGO of line 4: "));
  EXPECT_EQ(get("actual_position"), 200);
}

TEST_F(CtlMint, WhatTheGatewaySaysOfAProgramHasItsFile) {
  EXPECT_EQ(run_program("SPEED = 1\nSPED = 1\n", {"--axis", "0=x"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr(path + ":2:1: 'SPED' is none of SCALE"));
  EXPECT_EQ(run_program("SPEED.1 = 900\nACCEL.1 = 9000\nMOVEA.1 = 100\nGO\n", {"--axis", "0=x"}),
            ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("--axis 1=NAME"));
  EXPECT_EQ(run({"mint", "run", path, "--axis", "9=x"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("Mint's axes are 0 to 7"));
}

TEST_F(CtlMint, CtrlCStopsAllAxes) {
  host.press_ctrl_c_after(std::chrono::milliseconds(700));
  EXPECT_EQ(run_program("SPEED = 500;\nACCEL = 12500;\nMOVER = 2000, 1000\nGO\n",
                        {"--axis", "0=x", "--axis", "1=y"}),
            ExitCode::interrupted);
  EXPECT_THAT(orders(),
              testing::ElementsAre(HasSubstr("path.stage"), HasSubstr("mint.run"),
                                   R"(axis.stop {"axis":"x"})", R"(axis.stop {"axis":"y"})"));
  EXPECT_THAT(err, HasSubstr("stopped at the GO of line 4"));
  for (std::uint8_t motor = 0; motor < 2; ++motor) {
    EXPECT_EQ(get("actual_velocity", motor), 0);
    EXPECT_GT(get("actual_position", motor), 100);
    EXPECT_LT(get("actual_position", motor), 500);
  }
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
