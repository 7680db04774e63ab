// What tmclctl says of an axis whose driver has failed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "system/tmclctl_bench.hpp"

namespace tmcl::test {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

constexpr auto with_a_short = R"(
[[module]]
model = "TMCM-1110"
[[module.axis]]
driver_faults = ["short_a"]
)";

class TmclctlFaults : public testing::Test, public CtlBench {
 protected:
  TmclctlFaults() : CtlBench({"TMCM-3110@3"}, {}, with_a_short) { start_daemon(); }
  Ran run(const Words& words) const { return ctl(through_daemon(), words); }
};

TEST_F(TmclctlFaults, AreSaidByEachVerbThatLooks) {
  const auto moved = run({"move", "x", "500", "--wait"});
  EXPECT_EQ(moved.status, 5);
  EXPECT_THAT(moved.err, HasSubstr("short to ground of coil A"));
  const auto errors = run({"errors", "x"});
  EXPECT_EQ(errors.status, 1);
  EXPECT_THAT(errors.out, HasSubstr("short_to_ground_a"));
  EXPECT_EQ(run({"errors", "y"}).status, 0);
  EXPECT_THAT(run({"state", "x"}).out, HasSubstr("WRONG     short_to_ground_a"));
  EXPECT_THAT(run({"axes"}).out,
              AllOf(HasSubstr("FAULTS"), ContainsRegex("x .*short_to_ground_a")));
  const auto watched = run({"watch", "--all", "--for", "0.5"});
  EXPECT_THAT(watched.out, AllOf(ContainsRegex("s  x  .*FAULT: short_to_ground_a"),
                                 Not(ContainsRegex("s  y  .*FAULT"))));
}

TEST_F(TmclctlFaults, AreShownByTop) {
  OnTerminal top(through_daemon(), {"top", "--interval", "50"});
  EXPECT_TRUE(top.wait_for("FAULT:"));
  top.press('q');
  EXPECT_EQ(top.wait(), 0);
}

}  // namespace
}  // namespace tmcl::test
