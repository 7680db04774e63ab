// A movement beside its plan.
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "axis/prediction_text.hpp"
#include "plot/comparison.hpp"
#include "plot/svg_plot.hpp"
#include "support/temp_path.hpp"
#include "unit/ctl_bench.hpp"
#include "verbs/verbs.hpp"

namespace tmclctl::plot {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;
using tmcl::plan::AxisTwin;

AxisTwin moving_twin() {
  auto twin = *AxisTwin::of(*tmcl::find_model("TMCM-1110"));
  twin.place({1000});
  twin.move_to({60'000});
  return twin;
}

// What somebody sees who looks every 10 ms and began 50 ms before the command.
Recording seen(AxisTwin twin, double start) {
  Recording recording{"x", {}};
  for (int i = 0; i < 300; ++i) {
    const double time = 0.01 * i;
    const double since = time - start;
    if (since > 0) {
      const auto past = std::chrono::duration<double>(since);
      twin.advance(std::chrono::duration_cast<tmcl::Duration>(past) - twin.elapsed());
    }
    recording.samples.push_back({time, twin.motion().position.value, 0});
  }
  return recording;
}

TEST(CtlComparison, FindsWhenTheModuleTookTheCommand) {
  const auto recording = seen(moving_twin(), 0.0537);
  const auto comparison = compare(recording, moving_twin(), {0.04, 0.07});
  EXPECT_NEAR(comparison.start, 0.0537, 0.0002);
  // Within the 0.15 ms between two starts that are tried, at 61 microsteps a millisecond.
  EXPECT_LT(comparison.largest, 10);
}

TEST(CtlComparison, SaysThatTheAxisWentAsPlanned) {
  const auto recording = seen(moving_twin(), 0.05);
  Comparison comparison;
  comparison.largest = 0.4;
  EXPECT_EQ(summary(comparison, recording), "the axis went as planned, to the microstep");
}

TEST(CtlComparison, SaysWhereTheAxisWasOffThePlan) {
  auto recording = seen(moving_twin(), 0.05);
  recording.samples[60].position -= 700;
  const auto comparison = compare(recording, moving_twin(), {0.05, 0.05});
  EXPECT_NEAR(comparison.largest, 700, 10);
  EXPECT_DOUBLE_EQ(comparison.largest_at, recording.samples[60].time);
  const auto picture = picture_of(recording, comparison);
  EXPECT_THAT(picture.title, testing::ContainsRegex("was at most (69|70|71). microsteps off its"));
  EXPECT_THAT(picture.title, HasSubstr("at 0.60 s"));
  EXPECT_EQ(picture.curves.size(), 3U);
  const auto svg = to_svg(picture);
  EXPECT_THAT(svg, HasSubstr("class=\"curve planned\""));
  EXPECT_THAT(svg, HasSubstr("class=\"curve difference\""));
}

/// As tmclctl foresees a move by what the gateway tells.
std::optional<tmcl::Duration> arrival_of(test::CtlBench& ctl) {
  std::ostringstream text;
  Output output{text, text, {}, {}};
  Context context{ctl.gateway, output, ctl.host};
  auto twin = twin_of("x", context).value();
  twin.move_to({1'001});
  return twin.time_to_arrival();
}

TEST(CtlComparison, IsWithWhatWasMeasuredOfTheModule) {
  const auto file = tmcl::test::temp_path("measured.toml");
  const auto arrival = [&](const std::string& trait) {
    std::ofstream(file) << "[module]\nmodel = \"TMCM-1110\"\n" + trait + '\n';
    test::CtlBench ctl(test::plain_axis + "[[module]]\nbus = \"bench\"\naddress = 1\nas = \"" +
                       file + "\"\n");
    return arrival_of(ctl);
  };
  const auto usual = arrival("");
  EXPECT_NE(arrival("last_step = \"r1\""), usual);
  EXPECT_EQ(arrival("last_step = \"r3\""), usual);
  std::filesystem::remove(file);
}

// Words that only a newer gateway knows are as usual.
TEST(CtlComparison, LeavesOutWhatOnlyANewerGatewayKnows) {
  test::CtlBench ctl;
  const auto arrival = [&](const char* trait, const char* variant) {
    ctl.amend("axis.get_ramp", [=](boost::json::object& ramp) {
      ramp["traits"] = boost::json::array{{{"trait", trait}, {"variant", variant}}};
    });
    return arrival_of(ctl);
  };
  const auto usual = arrival_of(ctl);
  EXPECT_EQ(arrival("last_step", "r9"), usual);
  EXPECT_EQ(arrival("next_step", "r1"), usual);
  EXPECT_NE(arrival("last_step", "r1"), usual);
}

TEST(CtlComparison, IsOfMovesOfModulesThatAreKnown) {
  test::CtlBench ctl;
  EXPECT_EQ(ctl.run({"plot", "x", "--compare"}), ExitCode::usage);
  EXPECT_THAT(ctl.err, HasSubstr("--to or --by"));
  // What no TMCM-1110 can hold, and a model of which this program has not heard.
  ctl.amend("axis.get_ramp", [](boost::json::object& ramp) {
    ramp["settings"] = {{{"parameter", "max_velocity"}, {"number", 4}, {"value", -7}}};
  });
  EXPECT_EQ(ctl.run({"plot", "x", "--to", "100", "--compare"}), ExitCode::usage);
  EXPECT_THAT(ctl.err, HasSubstr("cannot be foreseen"));
  EXPECT_EQ(ctl.out, "");
  ctl.amend("axis.get_ramp", [](boost::json::object& ramp) { ramp["model"] = "TMCM-9999"; });
  EXPECT_EQ(ctl.run({"plot", "x", "--to", "100", "--compare"}), ExitCode::usage);
  EXPECT_THAT(ctl.err, HasSubstr("does not know the ramps of a TMCM-9999"));
  EXPECT_THAT(ctl.orders(), testing::IsEmpty());
}

}  // namespace
}  // namespace tmclctl::plot
