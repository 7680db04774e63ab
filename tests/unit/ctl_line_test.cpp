// line: what is asked of the daemon, and how its answer is told.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ctl_fixture.hpp"

namespace tmclctl {
namespace {

using testing::HasSubstr;

class CtlLine : public testing::Test, public test::Ctl {
 protected:
  CtlLine() {
    target.result = boost::json::parse(R"({
      "axes": [{"axis": "x", "target_microsteps": 102400, "target": 10, "unit": "mm",
                "predicted_s": 1.5},
               {"axis": "y", "target_microsteps": -500, "target": null, "unit": null,
                "predicted_s": 1.5}],
      "predicted_s": 1.5, "spread_s": 0, "deviation": 0.001, "one_command": true,
      "predicted_skew_s": 0, "skew_s": 0})")
                        .as_object();
  }
  std::string asked() const { return target.calls.empty() ? "" : target.calls.back(); }
};

TEST_F(CtlLine, TellsPositionsInTheUnitsOfTheAxes) {
  EXPECT_EQ(run({"line", "x=10mm", "y=-500"}), ExitCode::done) << err;
  EXPECT_EQ(asked(), R"(line.move {"axes":["x","y"],"positions":["10mm","-500"]})");
  EXPECT_THAT(out, HasSubstr("x moves to 10 mm\n"));
  EXPECT_THAT(out, HasSubstr("y moves to -500\n"));
  run({"line", "x=10mm", "y=-500", "--internal"});
  EXPECT_THAT(asked(), HasSubstr(R"("positions":["10mm","-500microsteps"])"));
  EXPECT_THAT(out, HasSubstr("x moves to 102400\ny moves to -500\n"));
  const auto document = json({"line", "x=10mm", "y=-500"});
  EXPECT_EQ(document.at("axes").at(0).at("target_microsteps"), 102'400);
  EXPECT_EQ(document.at("axes").at(0).at("target").to_number<double>(), 10);
}

TEST_F(CtlLine, SaysWhatIsForeseen) {
  run({"line", "x=10mm", "y=-500"});
  EXPECT_THAT(out,
              HasSubstr("Foreseen: 1.50 s; all arrive at the same time and move at most 0.10 % "
                        "of the longest way off the straight line. They were started by one "
                        "command.\n"));
  target.result["deviation"] = 0;
  target.result["spread_s"] = 0.0021;
  target.result["one_command"] = false;
  target.result["skew_s"] = 0.0003;
  run({"line", "x=10mm", "y=-500"});
  EXPECT_THAT(out, HasSubstr("Foreseen: 1.50 s; all arrive within 2.10 ms of each other and move "
                             "along the straight line. They were started within 0.30 ms of each "
                             "other.\n"));
}

TEST_F(CtlLine, LimitsMayHaveUnits) {
  EXPECT_EQ(run({"line", "x=1", "y=2", "--velocity", "2.5mm/s", "--acceleration", "1000pps/s",
                 "--time", "4"}),
            ExitCode::done)
      << err;
  EXPECT_THAT(asked(),
              HasSubstr(R"("velocity":"2.5mm/s","acceleration":"1000pps/s","time_s":4E0)"));
  EXPECT_EQ(run({"line", "x=1", "--time", "0"}), ExitCode::usage);
}

}  // namespace
}  // namespace tmclctl
