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

TEST_F(CtlMint, NothingMovesForAProgramThatGoesBeyondASoftLimit) {
  check(exercise);
  const std::vector<std::string> words{"mint", "run", path, "--axis", "0=x"};
  target.counts.limits = tmcl::SoftLimits{{0}, {20}};
  EXPECT_EQ(run(words), ExitCode::refused) << out;
  EXPECT_THAT(err,
              HasSubstr("line 5 moves x too far: 23.4375 mm is beyond the soft limit of 20 mm"));
  target.counts.scale->unit.clear();
  EXPECT_EQ(run(words), ExitCode::refused) << out;
  EXPECT_THAT(err, HasSubstr("240000 microsteps is beyond the soft limit of 20 microsteps"));
  for (const auto& call : target.calls) EXPECT_THAT(call, testing::Not(HasSubstr("move_to")));
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
