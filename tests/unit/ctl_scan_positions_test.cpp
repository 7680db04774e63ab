// scan-positions: on an axis that moves in virtual time.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "sim/module/module.hpp"
#include "support/temp_path.hpp"
#include "unit/ctl_bench.hpp"

namespace tmclctl::test {
namespace {

using std::chrono::milliseconds;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

class CtlScanPositions : public testing::Test, public CtlBench {
 protected:
  explicit CtlScanPositions(const std::string& toml = plain_axis) : CtlBench(toml) {
    std::filesystem::remove(file);
  }
  ~CtlScanPositions() override { std::filesystem::remove(file); }

  ExitCode scan(const std::vector<std::string>& more = {}) {
    std::vector<std::string> words{"scan-positions", "x",    "--from",  "0",
                                   "--to",           "1000", "--steps", "3"};
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  }
  std::vector<std::string> moves() const {
    auto moves = calls_of("axis.move_to");
    for (auto& move : moves) {
      move.erase(0, move.find("position"));
      move.erase(move.find(",\"deadline"));
    }
    return moves;
  }
  bool has_called(const std::string& method) const {
    return std::ranges::any_of(calls, [&](const auto& call) { return call.starts_with(method); });
  }
  std::string contents() const {
    std::ifstream in(file);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  /// Without comments and columns, and without their times.
  std::vector<std::string> rows() const {
    std::vector<std::string> rows;
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);)
      if (!line.starts_with('#') && !line.starts_with("utc"))
        rows.push_back(line.substr(line.find(',') + 1));
    return rows;
  }

  std::string file = tmcl::test::temp_path("scan.csv");
};

TEST_F(CtlScanPositions, VisitsThemAllAndWritesWhatWasReached) {
  EXPECT_EQ(scan({"--csv", file, "--dwell", "200ms"}), ExitCode::done) << err;
  EXPECT_THAT(moves(),
              ElementsAre(R"(position":"0")", R"(position":"500")", R"(position":"1000")"));
  EXPECT_THAT(rows(), ElementsAre("1,0,none,0,0,,0,0,0", "1,1,up,500,500,,500,500,0",
                                  "1,2,up,1000,1000,,1000,1000,0"));
  EXPECT_THAT(contents(), AllOf(HasSubstr("# tmclctl "), HasSubstr("# x: TMCM-1110 1.13"),
                                HasSubstr("# scan of x from 0 to 1000 in 3 positions, 1 times;"),
                                HasSubstr("\nutc,pass,index,approach,command_microsteps,")));
  EXPECT_THAT(out, HasSubstr("the configuration names no encoder"));
  EXPECT_TRUE(has_called("lease.acquire"));
  EXPECT_TRUE(has_called("lease.release"));
}

struct CtlScanPositionsInMm : CtlScanPositions {
  explicit CtlScanPositionsInMm(const std::string& more = {})
      : CtlScanPositions(axis_in_mm + more) {}
};
struct CtlScanPositionsWithinLimits : CtlScanPositionsInMm {
  CtlScanPositionsWithinLimits() : CtlScanPositionsInMm("soft_limits = [0, 5]\n") {}
};

TEST_F(CtlScanPositions, GoesBackAsOftenAsItIsTold) {
  EXPECT_EQ(scan({"--repeat", "2", "--both-ways"}), ExitCode::done) << err;
  EXPECT_EQ(moves().size(), 9U);
  const auto document =
      json({"scan-positions", "x", "--from", "0", "--to", "1000", "--steps", "3", "--both-ways"});
  EXPECT_EQ(document.at("visits"), 5);
  EXPECT_EQ(document.at("positions").as_array().size(), 3U);
  EXPECT_EQ(document.at("positions").at(1).at("count"), 2);
  EXPECT_EQ(document.at("backlash").to_number<double>(), 0);
  EXPECT_EQ(document.at("encoder"), false);
}

TEST_F(CtlScanPositions, AnEncoderSaysWhatWasReached) {
  set("encoder_position", 490);
  EXPECT_EQ(scan({"--encoder", "--csv", file}), ExitCode::done) << err;
  EXPECT_THAT(rows(), testing::Contains("1,1,up,500,500,490,500,490,-10"));
  EXPECT_THAT(out, Not(HasSubstr("names no encoder")));
}

TEST_F(CtlScanPositionsInMm, HasTheUnitThatWasTyped) {
  EXPECT_EQ(
      run({"scan-positions", "x", "--from", "0", "--to", "0.5mm", "--steps", "6", "--csv", file}),
      ExitCode::done)
      << err;
  EXPECT_THAT(contents(), HasSubstr("target_mm,reached_mm,deviation_mm\n"));
  EXPECT_EQ(get("target_position"), 5'120);
  EXPECT_EQ(run({"scan-positions", "x", "--from", "0mm", "--to", "1cm", "--steps", "6"}),
            ExitCode::usage);
}

TEST_F(CtlScanPositions, GoesOnBehindTheLastRow) {
  EXPECT_EQ(scan({"--csv", file, "--at", "test $TMCL_INDEX != 1"}), ExitCode::not_reached);
  EXPECT_THAT(err, AllOf(HasSubstr("behind 1 of 3 positions"), HasSubstr("ended with exit code 1"),
                         HasSubstr("--resume goes on")));
  EXPECT_EQ(rows().size(), 1U) << "what was not measured is visited again";
  EXPECT_TRUE(has_called("axis.stop "));
  // As a computer leaves it that loses its power.
  std::ofstream(file, std::ios::app) << "1970-01-01T01:0";
  calls.clear();
  EXPECT_EQ(scan({"--csv", file}), ExitCode::usage) << "it is not written over";
  EXPECT_THAT(moves(), ElementsAre());
  EXPECT_EQ(scan({"--csv", file, "--resume"}), ExitCode::done) << err;
  EXPECT_THAT(moves(), ElementsAre(R"(position":"500")", R"(position":"1000")"));
  EXPECT_EQ(rows().size(), 3U);
  EXPECT_THAT(contents(), HasSubstr("\n# resumed 1970"));
  calls.clear();
  EXPECT_EQ(scan({"--csv", file, "--resume"}), ExitCode::done) << "there is nothing left to do";
  EXPECT_THAT(moves(), ElementsAre());
  EXPECT_FALSE(has_called("lease.acquire"));
  EXPECT_EQ(scan({"--csv", file, "--resume", "--both-ways"}), ExitCode::usage);
}

TEST_F(CtlScanPositions, TheCommandIsToldWhereTheAxisIs) {
  const auto told = tmcl::test::temp_path("told");
  EXPECT_EQ(scan({"--at",
                  "echo $TMCL_AXIS $TMCL_INDEX $TMCL_PASS $TMCL_APPROACH $TMCL_TARGET "
                  "$TMCL_POSITION $TMCL_UNIT > " +
                      told}),
            ExitCode::done)
      << err;
  std::ifstream in(told);
  std::string line;
  std::getline(in, line);
  EXPECT_EQ(line, "x 2 1 up 1000 1000 microsteps");
  std::filesystem::remove(told);
}

TEST_F(CtlScanPositions, AStopOfAnotherProgramEndsItWhereTheAxisStands) {
  other_after(milliseconds(80), "axis.stop", {{"axis", "x"}});
  EXPECT_EQ(scan({"--csv", file, "--dwell", "0.1s"}), ExitCode::not_reached);
  EXPECT_THAT(err, HasSubstr("cause: client"));
  EXPECT_THAT(moves(), ElementsAre(R"(position":"0")")) << "it stood there";
}

TEST_F(CtlScanPositions, AStopOfAnotherProgramEndsItOnTheWay) {
  other_after(milliseconds(300), "axis.stop", {{"axis", "x"}});
  EXPECT_EQ(run({"scan-positions", "x", "--from", "50000", "--to", "100000", "--steps", "3"}),
            ExitCode::not_reached);
  EXPECT_THAT(err, HasSubstr("cause: client"));
}

TEST_F(CtlScanPositions, CtrlCEndsItAndStopsTheAxis) {
  host.press_ctrl_c_after(milliseconds(100));
  EXPECT_EQ(scan({"--csv", file, "--dwell", "0.1s"}), ExitCode::interrupted);
  EXPECT_THAT(
      err, AllOf(HasSubstr("behind 0 of 3 positions, and it was stopped"), HasSubstr("--resume")));
  EXPECT_TRUE(has_called("axis.stop "));
  EXPECT_TRUE(has_called("lease.release"));
}

TEST_F(CtlScanPositions, ALostLeaseEndsIt) {
  fail("lease.renew",
       Error{"lease_lost", ErrorKind::failed, tmcl::Outcome::refused, "the lease is over", {}});
  EXPECT_EQ(scan({"--dwell", "3"}), ExitCode::not_reached);
  EXPECT_THAT(err, HasSubstr("the lease is over"));
}

TEST_F(CtlScanPositionsWithinLimits, NothingMovesBeyondThem) {
  EXPECT_EQ(run({"scan-positions", "x", "--from", "0mm", "--to", "6mm", "--steps", "3"}),
            ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("6mm is beyond the soft limits of x"));
  EXPECT_THAT(moves(), ElementsAre());
}

TEST_F(CtlScanPositions, WordsThatDoNotGoTogetherAreRefused) {
  EXPECT_EQ(scan({"--resume"}), ExitCode::usage);
  EXPECT_EQ(scan({"--json", "--csv", "-"}), ExitCode::usage);
  EXPECT_EQ(scan({"--dwell", "2h"}), ExitCode::usage);
  EXPECT_EQ(run({"scan-positions", "x", "--from", "0", "--to", "9", "--steps", "1"}),
            ExitCode::usage);
}

}  // namespace
}  // namespace tmclctl::test
