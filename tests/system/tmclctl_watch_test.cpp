// tmclctl watch and top, while tmcld and its modules come and go.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "system/tmclctl_bench.hpp"

namespace tmcl::test {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;

class TmclctlWatch : public testing::Test, public CtlBench {
 protected:
  TmclctlWatch() { start_daemon(); }
  Ran run(const Words& words) const { return ctl(through_daemon(), words); }
};

TEST_F(TmclctlWatch, AllAxesAreSeenWhateverBecomesOfTmcld) {
  OnTerminal watching(through_daemon(), {"watch", "--all"});
  ASSERT_TRUE(watching.wait_for("s  x  position 0"));
  ASSERT_TRUE(watching.wait_for("s  y  position 0"));
  ASSERT_TRUE(watching.wait_for("s  ghost: "));
  stop_daemon();
  ASSERT_TRUE(watching.wait_for("s  the connection to tmcld at "));
  start_daemon();
  ASSERT_TRUE(watching.wait_for("s  tmcld is there again"));
  EXPECT_EQ(run({"move", "y", "5000"}).status, 0);
  EXPECT_TRUE(watching.wait_for("s  y  position 5000"));
  watching.press_ctrl_c();
  EXPECT_EQ(watching.wait(), 0);
}

TEST_F(TmclctlWatch, TopShowsAllAxesUntilSomebodyPressesQ) {
  OnTerminal top(through_daemon(), {"top", "--interval", "50"});
  ASSERT_TRUE(top.wait_for("at target"));
  for (const auto* seen : {"AXIS", "FLAGS", "ghost", "3 axes"})
    EXPECT_TRUE(top.wait_for(seen)) << seen;
  stop_daemon();
  EXPECT_TRUE(top.wait_for("AWAY"));
  top.press('q');
  EXPECT_EQ(top.wait(), 0);
}

TEST_F(TmclctlWatch, TopEndsWithCtrlC) {
  OnTerminal top(through_daemon(), {"top"});
  ASSERT_TRUE(top.wait_for("at target"));
  top.press_ctrl_c();
  EXPECT_EQ(top.wait(), 0);
}

TEST_F(TmclctlWatch, TopWritesNothingToAFile) {
  const auto ran = run({"top"});
  EXPECT_EQ(ran.status, 2);
  EXPECT_EQ(ran.out, "");
  EXPECT_THAT(ran.err, HasSubstr("watch --all"));
}

TEST_F(TmclctlWatch, BusesSaysWhatBecameOfEach) {
  const auto ran = run({"buses", "--for", "0.1"});
  EXPECT_EQ(ran.status, 0);
  EXPECT_THAT(ran.out, ContainsRegex("BUS +LINK +STATE +LOAD"));
  EXPECT_THAT(ran.out, ContainsRegex("bench +tcp:.* +open +- "));
  EXPECT_EQ(ctl({"--direct", pty_link()}, {"buses", "--for", "0.1"}).status, 0);
}

}  // namespace
}  // namespace tmcl::test
