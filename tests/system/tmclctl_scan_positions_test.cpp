// scan-positions, on simulated modules, one of them with an encoder.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "system/tmclctl_bench.hpp"

namespace tmcl::test {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;

constexpr auto with_encoder = R"(
[[module]]
model = "TMCM-3110"
address = 3
[[module.axis]]
motor = 1
encoder_counts_per_turn = 4000
)";

class TmclctlScanPositions : public testing::Test, public CtlBench {
 protected:
  TmclctlScanPositions() : CtlBench({"TMCM-1110"}, {}, with_encoder) {
    start_daemon("unit = \"mm\"\nunits_per_revolution = 5\nencoder_lines = 1000\n");
  }
  Ran scan(const std::string& axis, const Words& more) const {
    Words words{"scan-positions", axis, "--from", "0", "--to", "2000", "--steps", "3"};
    if (axis == "y") std::ranges::replace(words, "2000", "0.2mm");
    words.insert(words.end(), more.begin(), more.end());
    return ctl(through_daemon(), words);
  }
  std::string tmclctl(const std::string& verb) const {
    return TMCL_BIN_DIR "/tmclctl --socket " + file("tmcld.sock") + " " + verb;
  }
};

TEST_F(TmclctlScanPositions, TheEncoderSaysWhatWasReached) {
  const auto scanned = scan("y", {"--both-ways", "--repeat", "2", "--csv", file("scan.csv")});
  EXPECT_EQ(scanned.status, 0) << scanned.err;
  EXPECT_THAT(scanned.out, AllOf(HasSubstr("POSITION [mm]"), HasSubstr("repeatability ")));
  const auto csv = contents(file("scan.csv"));
  EXPECT_THAT(csv, AllOf(HasSubstr("; reached: as the encoder says\n"),
                         HasSubstr("target_mm,reached_mm,deviation_mm\n"),
                         ContainsRegex("Z,1,1,up,1024,1024,-?[0-9]+,0.1,-?[0-9.]+,")));
  EXPECT_EQ(std::ranges::count(csv, 'Z'), 10) << "nine visits, and when it began";
}

TEST_F(TmclctlScanPositions, AStopWhileTheAxisStandsEndsIt) {
  const auto scanned = scan("x", {"--at", tmclctl("stop x")});
  EXPECT_EQ(scanned.status, 5);
  EXPECT_THAT(scanned.err, AllOf(HasSubstr("behind 1 of 3"), HasSubstr("cause: client")));
  EXPECT_EQ(ctl(through_daemon(), {"get", "x", "actual_position"}).out, "0\n");
}

TEST_F(TmclctlScanPositions, OnlyTheCommandMovesTheAxisMeanwhile) {
  EXPECT_EQ(scan("x", {"--at", tmclctl("move x 10 --wait")}).status, 0);
  const auto scanned =
      scan("x", {"--at", "env -u TMCL_LEASE -u TMCL_EPOCH " + tmclctl("move x 20")});
  EXPECT_EQ(scanned.status, 5);
  EXPECT_THAT(scanned.err, HasSubstr("ended with exit code 1"));
  EXPECT_EQ(ctl(through_daemon(), {"lease", "list"}).out.find("x "), std::string::npos);
}

TEST_F(TmclctlScanPositions, GoesOnWhereItWasEnded) {
  const Words to_file{"--csv", file("scan.csv")};
  auto failing = to_file;
  failing.insert(failing.end(), {"--at", "test $TMCL_INDEX -lt 2"});
  EXPECT_EQ(scan("x", failing).status, 5);
  EXPECT_EQ(scan("x", to_file).status, 2) << "it is not written over";
  auto resumed = to_file;
  resumed.emplace_back("--resume");
  EXPECT_EQ(scan("x", resumed).status, 0);
  EXPECT_THAT(contents(file("scan.csv")), ContainsRegex("# resumed .*\n.*,1,2,none,2000,2000,"));
}

}  // namespace
}  // namespace tmcl::test
