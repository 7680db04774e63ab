// A movement beside its plan.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "axis/prediction_text.hpp"
#include "ctl_fixture.hpp"
#include "plot/comparison.hpp"
#include "plot/svg_plot.hpp"

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

// As [[module]] as = FILE of the gateway has it; words that only a newer one knows are as usual.
TEST(CtlComparison, IsWithWhatWasMeasuredOfTheModule) {
  test::Ctl ctl;
  std::ostringstream text;
  Output output{text, text, {}, {}};
  Context context{ctl.gateway, output, ctl.host};
  const auto arrival = [&](boost::json::array traits) {
    ctl.target.result = {{"model", "TMCM-1110"}, {"traits", std::move(traits)}};
    auto twin = twin_of("x", context).value();
    twin.move_to({1'001});
    return twin.time_to_arrival();
  };
  const auto trait = [](const char* name, const char* variant) {
    return boost::json::array{boost::json::object{{"trait", name}, {"variant", variant}}};
  };
  const auto usual = arrival({});
  EXPECT_NE(arrival(trait("last_step", "r1")), usual);
  EXPECT_EQ(arrival(trait("last_step", "r3")), usual);
  EXPECT_EQ(arrival(trait("last_step", "r9")), usual);
  EXPECT_EQ(arrival(trait("next_step", "r1")), usual);
}

TEST(CtlComparison, IsOfMovesOfModulesThatAreKnown) {
  test::Ctl ctl;
  EXPECT_EQ(ctl.run({"plot", "x", "--compare"}), ExitCode::usage);
  EXPECT_THAT(ctl.err, HasSubstr("--to or --by"));
  // What no TMCM-1110 can hold, and a model of which this program has not heard.
  ctl.target.result = {
      {"model", "TMCM-1110"},
      {"settings", {{{"parameter", "max_velocity"}, {"number", 4}, {"value", -7}}}}};
  EXPECT_EQ(ctl.run({"plot", "x", "--to", "100", "--compare"}), ExitCode::usage);
  EXPECT_THAT(ctl.err, HasSubstr("cannot be foreseen"));
  EXPECT_EQ(ctl.out, "");
  ctl.target.result = {{"model", "TMCM-9999"}};
  EXPECT_EQ(ctl.run({"plot", "x", "--to", "100", "--compare"}), ExitCode::usage);
  EXPECT_THAT(ctl.err, HasSubstr("does not know the ramps of a TMCM-9999"));
}

}  // namespace
}  // namespace tmclctl::plot
