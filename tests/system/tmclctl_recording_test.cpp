// plot --also and watch --csv, on simulated modules.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "system/tmclctl_bench.hpp"

namespace tmcl::test {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;

class TmclctlRecording : public testing::Test, public CtlBench {
 protected:
  Ran run(const Words& words) { return ctl(through_daemon(), words); }
};

TEST_F(TmclctlRecording, PlotRecordsSeveralAxesWithFurtherParameters) {
  start_daemon("unit = \"mm\"\nunits_per_revolution = 5\n");
  const auto plot = run({"plot", "y", "x", "--by", "2mm", "--also", "load_value,actual_velocity",
                         "--csv", file("both.csv")});
  EXPECT_EQ(plot.status, 0) << plot.err;
  EXPECT_THAT(plot.out, HasSubstr("x load_value [internal]"));
  const auto csv = contents(file("both.csv"));
  EXPECT_THAT(csv,
              AllOf(HasSubstr("# tmclctl "), ContainsRegex(", tmcld [0-9]"),
                    ContainsRegex("# begins 20[0-9T:.-]+Z\n"),
                    ContainsRegex("# y: TMCM-3110 [0-9.]+, module 3 of bench, motor 1; unit mm "
                                  "of 10240 microsteps, velocity_internal of "),
                    ContainsRegex("# x: TMCM-1110 [0-9.]+, module 1 of bench, motor 0"),
                    HasSubstr("# load_value: stallGuard2")));
  EXPECT_THAT(csv,
              HasSubstr("\ntime_s,axis,position_microsteps,velocity_internal,position_in_unit,"
                        "velocity_in_unit,load_value,load_value_in_unit,load_value_age_ms,"
                        "actual_velocity,actual_velocity_in_unit,actual_velocity_age_ms,utc\n"));
  EXPECT_THAT(csv,
              ContainsRegex("\n[0-9.]+,y,20480,0,2,0,[0-9]+,,[0-9-]+,[0-9-]+,[0-9.-]+,[0-9-]+,20"));
  EXPECT_THAT(csv, ContainsRegex("\n[0-9.]+,x,0,0,,,[0-9]+,,[0-9-]+,0,,[0-9-]+,20"));
}

TEST_F(TmclctlRecording, ANameThatTheModuleDoesNotHaveIsToldBeforeAnythingMoves) {
  start_daemon();
  for (const auto& verb : {Words{"plot", "x", "--by", "1000"}, Words{"watch", "x", "--for", "1"}}) {
    auto words = verb;
    words.insert(words.end(), {"--also", "load_valeu"});
    const auto ran = run(words);
    EXPECT_EQ(ran.status, 2);
    EXPECT_THAT(ran.err, HasSubstr("load_value"));
  }
  EXPECT_EQ(run({"get", "x", "actual_position"}).out, "0\n");
}

TEST_F(TmclctlRecording, WatchWritesRowsAsTheyCome) {
  start_daemon();
  const auto watched = run({"watch", "x", "--also", "actual_velocity", "--csv", file("x.csv"),
                            "--interval", "20", "--for", "0.3"});
  EXPECT_EQ(watched.status, 0) << watched.err;
  EXPECT_THAT(watched.out, HasSubstr("actual_velocity 0"));
  EXPECT_THAT(contents(file("x.csv")),
              ContainsRegex("\ntime_s,position_microsteps,velocity_internal,actual_velocity,"
                            "actual_velocity_age_ms,utc\n0[.][0-9]+,0,0,0,"));
}

}  // namespace
}  // namespace tmcl::test
