// tmclctl tune, on simulated loads that bear so much and no more.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "sim/module/module.hpp"
#include "unit/ctl_bench.hpp"

namespace tmclctl::test {
namespace {

using testing::ContainsRegex;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using tmcl::sim::StageSettings;

constexpr std::int32_t of_full_steps = 256;

StageSettings with_encoder() {
  StageSettings stage;
  stage.encoder = tmcl::sim::EncoderSettings{10'000};
  return stage;
}

/// It hangs, and cannot be turned at 800 full steps a second.
StageSettings some_weight() {
  auto stage = with_encoder();
  stage.load = 50;
  stage.pull = 300;
  stage.inertia = 100'000;
  stage.corner_speed = 400;
  stage.torque_follows_current = true;
  return stage;
}

/// Axis "x" stands at its reference. A mm are 40 full steps.
struct TunedBench : CtlBench {
  TunedBench(const StageSettings& stage, int most_mm, int most_mm_per_s,
             const char* model = "TMCM-1276")
      : CtlBench(axis_in_mm + fmt::format("soft_limits = [{}, {}]\nmax_velocity = {}\n"
                                          "max_acceleration = 50\n",
                                          -most_mm, most_mm, most_mm_per_s),
                 model) {
    module().mount(0, stage);
    if (std::string_view(model) == "TMCM-142") {
      set("unit_mode", 1);
      set("stop_deceleration", 1500 * of_full_steps);
      for (const auto* name : {"reference_search_speed", "reference_switch_speed"})
        set(name, 100 * of_full_steps);
    }
    set("max_velocity", 200 * of_full_steps);
    set("max_acceleration", 1500 * of_full_steps);
    EXPECT_EQ(run({"set", "x", "actual_position", "0"}), ExitCode::done) << err;
    calls.clear();
  }
};

/// Its axis has narrow bounds, within which nothing is lost.
struct CtlTune : testing::Test, TunedBench {
  CtlTune() : TunedBench(with_encoder(), 3, 6) {}
  const std::vector<std::string> words{"tune",     "x",         "--max-current", "30",
                                       "--travel", "-2mm..2mm", "--yes"};
};

TEST(CtlTuneOfAWeight, SaysWhatWasFoundDrawsTheTrialsAndSaysWhatToTypeNext) {
  TunedBench one(some_weight(), 12, 100);
  one.set("standby_current", 80);
  one.set("max_velocity", 600 * of_full_steps);
  EXPECT_EQ(one.run({"tune", "x", "--max-current", "160", "--travel", "-10mm..10mm", "--yes"}),
            ExitCode::done)
      << one.err;
  EXPECT_THAT(one.calls, ElementsAre(R"(axis.tune {"axis":"x","max_current":160,)"
                                     R"("from":"-10mm","to":"10mm"})"));
  EXPECT_THAT(one.out, ContainsRegex("^ +LIMIT +PROPOSED\n"
                                     "velocity +20[0-9]{4}pps +1[67][0-9]{4}pps +beyond that it "
                                     "lost steps\n"
                                     "acceleration +512000pps/s +426667pps/s +no more was tried\n"
                                     "current +1[0-9]{2} +1[0-9]{2} +below that it lost steps\n"
                                     "hold current +64 +77 +below that it slid at rest\n"
                                     "threshold +[0-9]+ +the load value keeps off 0\n"));
  EXPECT_THAT(one.out, HasSubstr("\nvelocity     |o "));
  EXPECT_THAT(one.out, ContainsRegex("\nvelocity .*x\\| 51200 to 2[0-9]{5}\n"));
  EXPECT_THAT(one.out, ContainsRegex("\nhold         \\|x .* o\\| 56 to 80\n"));
  EXPECT_THAT(one.out,
              ContainsRegex("\n[0-9]{2} trials, [0-9]{2} of them held \\(o\\); backlash [0-9.]+ "
                            "microsteps\ntmclctl set x max_velocity 1[67][0-9]{4}\n"));
  EXPECT_THAT(one.out, ContainsRegex("\ntmclctl set x stallguard2_threshold [0-9]+\n$"));
  EXPECT_THAT(one.err, HasSubstr("search the reference again"));
}

TEST(CtlTuneOfALoadThatSwings, SaysWhichBowLetsItStand) {
  auto stage = with_encoder();
  stage.resonance = tmcl::ramp::Resonance{8, 0.03};
  TunedBench one(stage, 12, 10, "TMCM-142");
  EXPECT_EQ(one.run({"tune", "x", "--max-current", "5", "--travel", "-10mm..10mm", "--yes"}),
            ExitCode::done)
      << one.err;
  EXPECT_THAT(one.out,
              ContainsRegex("\nbow +[1-9] +the load swings at [78]\\.[0-9]+ Hz, at rest by "
                            "[0-9.]+ microsteps, before by [0-9.]+\n"));
}

TEST_F(CtlTune, HandsOnWhatIsSaid) {
  EXPECT_EQ(run({"tune", "x", "--max-current", "30", "--margin", "100", "--store", "--yes"}),
            ExitCode::done)
      << err;
  EXPECT_THAT(calls,
              ElementsAre(R"(axis.tune {"axis":"x","max_current":30,"margin":1E0,"store":true})"));
  EXPECT_THAT(out, EndsWith("this is set and stored\n"));
  EXPECT_THAT(out, Not(HasSubstr("tmclctl set")));
  EXPECT_EQ(get("max_velocity"), 120 * of_full_steps) << "half of its limit";
}

TEST_F(CtlTune, HandsOnTheSwitchThatTells) {
  StageSettings stage;
  stage.left_switch = -100 * of_full_steps;
  module().mount(0, stage);
  EXPECT_EQ(run({"tune", "x", "--max-current", "30", "--switch", "left", "--yes"}), ExitCode::done)
      << err;
  EXPECT_THAT(calls, ElementsAre(R"(axis.tune {"axis":"x","max_current":30,"by_switch":"left"})"));
}

TEST_F(CtlTune, MovesNothingThatWasNotAllowed) {
  EXPECT_EQ(run({"tune", "x", "--max-current", "200"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("--yes says that it may"));
  EXPECT_EQ(run({"tune", "x", "--yes"}), ExitCode::usage);
  EXPECT_EQ(run({"tune", "x", "--max-current", "0", "--yes"}), ExitCode::usage);
  EXPECT_EQ(run({"tune", "x", "--max-current", "9", "--travel", "3mm", "--yes"}), ExitCode::usage);
  EXPECT_THAT(calls, IsEmpty());
}

TEST_F(CtlTune, IsADocument) {
  const auto document = json(words);
  EXPECT_TRUE(document.at("threshold").is_int64());
  EXPECT_GT(document.at("trials").as_array().size(), 5U);
  EXPECT_EQ(document.at("velocity").at("limited_by"), "bounds");
}

}  // namespace
}  // namespace tmclctl::test
