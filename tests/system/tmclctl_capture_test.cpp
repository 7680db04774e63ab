// tmclctl capture, through tmcld and without it, on a module that records by itself.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <sstream>

#include "system/tmclctl_bench.hpp"

namespace tmcl::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

std::vector<std::vector<std::string>> rows_of(const std::string& csv) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(csv);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream cells(line);
    auto& row = rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(cell);
  }
  return rows;
}

class TmclctlCapture : public testing::Test {
 protected:
  TmclctlCapture() { bench_.start_daemon_without_axes(); }

  Ran direct(const Words& words) const { return bench_.ctl(bench_.direct(), words); }
  Ran daemon(const Words& words) const { return bench_.ctl(bench_.through_daemon(), words); }
  /// In the background, through tmcld.
  std::unique_ptr<Program> begin(const Words& words) const {
    Words all{"tmclctl"};
    for (const auto& list : {bench_.through_daemon(), words})
      all.insert(all.end(), list.begin(), list.end());
    return std::make_unique<Program>(all);
  }
  std::string state() const { return daemon({"raw", "1", "RAM_DEBUG", "GET_STATE", "0", "0"}).out; }

  CtlBench bench_{{"TMCM-6212", "TMCM-1110@2"}};
};

TEST_F(TmclctlCapture, RecordsAtOnceThroughBothDoors) {
  for (const bool with_daemon : {false, true}) {
    const Words words{"capture", "1/0",    "--channel", "max_current", "--channel",
                      "4",       "--rate", "500Hz",     "--samples",   "300"};
    const auto ran = with_daemon ? daemon(words) : direct(words);
    ASSERT_EQ(ran.status, 0) << ran.err;
    const auto rows = rows_of(ran.out);
    ASSERT_EQ(rows.size(), 301U);
    EXPECT_THAT(rows[0], testing::ElementsAre("time_s", "max_current", "max_velocity"));
    EXPECT_EQ(rows[1][0], "0");
    EXPECT_EQ(rows[300][0], "0.598");
    EXPECT_EQ(rows[300][1], rows[1][1]);
    EXPECT_THAT(state(), HasSubstr("value 0")) << "the module is free";
  }
}

TEST_F(TmclctlCapture, WaitsForItsTriggerAndSaysSo) {
  const auto capture =
      begin({"capture", "1/0", "--channel", "actual_position", "--channel", "actual_velocity",
             "--samples", "200", "--trigger", "actual_velocity rising 5000", "--pretrigger", "20%",
             "--csv", bench_.file("go.csv"), "--svg", bench_.file("go.svg")});
  ASSERT_TRUE(capture->wait_for("waits for the trigger: actual_velocity rising 5000; it is 0 now"));
  ASSERT_EQ(daemon({"rotate", "1/0", "20000", "--unattended"}).status, 0);
  EXPECT_EQ(capture->wait(), 0) << capture->output();
  EXPECT_THAT(capture->output(),
              HasSubstr("200 samples of actual_position, actual_velocity at 1000 Hz"));
  const auto rows = rows_of(contents(bench_.file("go.csv")));
  ASSERT_EQ(rows.size(), 201U);
  EXPECT_EQ(rows[41][0], "0");
  EXPECT_LE(std::stoi(rows[40][2]), 5000);
  EXPECT_GT(std::stoi(rows[41][2]), 5000);
  EXPECT_THAT(contents(bench_.file("go.svg")), HasSubstr("actual_velocity rising 5000"));
}

TEST_F(TmclctlCapture, CtrlCFreesTheModule) {
  const auto capture = begin({"capture", "1/0", "--channel", "actual_position", "--trigger",
                              "actual_position rising 1000000"});
  ASSERT_TRUE(capture->wait_for("waits for the trigger"));
  EXPECT_THAT(state(), HasSubstr("value 1"));
  capture->signal(SIGINT);
  EXPECT_EQ(capture->wait(), 130);
  EXPECT_THAT(capture->output(), HasSubstr("the module of 1/0 is free"));
  EXPECT_THAT(state(), HasSubstr("value 0"));
}

TEST_F(TmclctlCapture, TakesUpWhatTheModuleHasRecorded) {
  const Words words{"capture", "1/0", "--channel", "actual_position", "--samples", "20"};
  const auto capture = begin({"capture", "1/0", "--channel", "actual_position", "--samples", "20",
                              "--trigger", "max_current rising 100"});
  ASSERT_TRUE(capture->wait_for("waits for the trigger"));
  capture->signal(SIGKILL);
  capture->wait();
  auto other = words;
  other.push_back("--resume");
  other[3] = "actual_velocity";
  EXPECT_THAT(direct(other).err, HasSubstr("records something else"));
  ASSERT_EQ(daemon({"set", "1/0", "max_current", "50"}).status, 0);
  ASSERT_EQ(daemon({"set", "1/0", "max_current", "150"}).status, 0);
  auto again = words;
  again.push_back("--resume");
  const auto ran = direct(again);
  ASSERT_EQ(ran.status, 0) << ran.err;
  EXPECT_EQ(rows_of(ran.out).size(), 21U);
  EXPECT_THAT(direct(again).err, HasSubstr("records nothing"));
}

TEST_F(TmclctlCapture, SaysWhatCannotBeRecorded) {
  const auto said = [this](const Words& more, int status) {
    Words words{"capture", "1/0", "--channel", "actual_position"};
    words.insert(words.end(), more.begin(), more.end());
    const auto ran = daemon(words);
    EXPECT_EQ(ran.status, status) << ran.err;
    return ran.err;
  };
  EXPECT_THAT(said({"--samples", "9000"}, 2), HasSubstr("holds 8192: 1 to 8192 samples"));
  EXPECT_THAT(said({"--rate", "300Hz"}, 2), HasSubstr("250 Hz and 333.333 Hz"));
  EXPECT_THAT(said({"--channel", "actual_velocty"}, 2), HasSubstr("actual_velocity"));
  EXPECT_THAT(said({"--trigger", "actual_velocity raising 5"}, 2),
              HasSubstr("Did you mean 'rising'?"));
  EXPECT_THAT(said({"--pretrigger", "20%"}, 2), HasSubstr("--pretrigger needs --trigger"));
  EXPECT_THAT(daemon({"capture", "1/0"}).err, HasSubstr("--channel"));
  const auto without = daemon({"capture", "2/0", "--channel", "actual_position"});
  EXPECT_EQ(without.status, 1);
  EXPECT_THAT(without.err, HasSubstr("module 2 has no data logger"));
}

}  // namespace
}  // namespace tmcl::test
