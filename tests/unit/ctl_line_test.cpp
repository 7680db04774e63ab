// line: what is asked of the daemon, and how its answer is told.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "unit/ctl_bench.hpp"

namespace tmclctl {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;

const std::string two_axes = test::axis_in_mm + test::axis_section("y", 1, 1);

class CtlLine : public testing::Test, public test::CtlBench {
 protected:
  CtlLine() : CtlBench(two_axes, "TMCM-6212") {}
  /// Waits until both stand.
  void finish() { pass(std::chrono::seconds(10)); }
};

TEST_F(CtlLine, TellsPositionsInTheUnitsOfTheAxes) {
  EXPECT_EQ(run({"line", "x=10mm", "y=-500"}), ExitCode::done) << err;
  EXPECT_EQ(get("target_position", 0), 102'400);
  EXPECT_EQ(get("target_position", 1), -500);
  EXPECT_THAT(out, HasSubstr("x moves to 10 mm\n"));
  EXPECT_THAT(out, HasSubstr("y moves to -500\n"));
  finish();
  run({"line", "x=10mm", "y=-500", "--internal"});
  EXPECT_THAT(calls.back(), HasSubstr(R"("positions":["10mm","-500microsteps"])"));
  EXPECT_THAT(out, HasSubstr("x moves to 102400\ny moves to -500\n"));
  finish();
  const auto document = json({"line", "x=10mm", "y=-500"});
  EXPECT_EQ(document.at("axes").at(0).at("target_microsteps"), 102'400);
  EXPECT_EQ(document.at("axes").at(0).at("target").to_number<double>(), 10);
}

TEST_F(CtlLine, SaysWhatIsForeseen) {
  run({"line", "x=10mm", "y=-500"});
  EXPECT_THAT(out, ContainsRegex("Foreseen: 3.03 s; all arrive within 0.06 ms of each other and "
                                 "move at most 0.01 % of the longest way off the straight line. "
                                 "They were started by one command.\n"));
}

// They cannot be started by one command.
TEST(CtlLineOfTwoModules, SaysWhatIsForeseen) {
  test::CtlBench ctl(test::plain_axis + test::axis_section("y", 2));
  ctl.add("TMCM-1110", 2);
  EXPECT_EQ(ctl.run({"line", "x=20000", "y=20000"}), ExitCode::done) << ctl.err;
  EXPECT_THAT(ctl.out, ContainsRegex("Foreseen: [0-9.]+ s; all arrive within [0-9.]+ ms of each "
                                     "other and move .* line. They were started within [0-9.]+ ms "
                                     "of each other.\n"));
}

TEST(CtlLineInMm, LimitsMayHaveUnits) {
  test::CtlBench ctl(
      test::axis_in_mm + test::axis_section("y", 1, 1, "unit = \"mm\"\nunits_per_revolution = 5\n"),
      "TMCM-6212");
  EXPECT_EQ(ctl.run({"line", "x=1mm", "y=2mm", "--velocity", "2.5mm/s", "--acceleration",
                     "10000pps/s", "--time", "4"}),
            ExitCode::done)
      << ctl.err;
  EXPECT_THAT(ctl.calls.back(),
              HasSubstr(R"("velocity":"2.5mm/s","acceleration":"10000pps/s","time_s":4E0)"));
  EXPECT_THAT(ctl.out, HasSubstr("Foreseen: 4.0"));
  EXPECT_EQ(ctl.run({"line", "x=1", "--time", "0"}), ExitCode::usage);
}

}  // namespace
}  // namespace tmclctl
