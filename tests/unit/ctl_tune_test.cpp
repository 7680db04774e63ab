// tmclctl tune, on a gateway that the test plays.
#include <gmock/gmock.h>

#include "unit/ctl_fixture.hpp"

namespace tmclctl::test {
namespace {

using boost::json::array;
using boost::json::object;
using boost::json::value;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

object trial_of(const char* sought, double velocity, bool held) {
  return {{"sought", sought},
          {"velocity_pps", velocity},
          {"acceleration_pps2", 5e5},
          {"current", 200},
          {"held", held},
          {"deviation", 12.5},
          {"load_value", nullptr},
          {"threshold", nullptr},
          {"trouble", held ? "" : "lost"},
          {"swing", nullptr}};
}

struct CtlTune : testing::Test, Ctl {
  CtlTune() {
    target.result = {
        {"axis", "x"},
        {"velocity", {{"limit", 120'000}, {"proposed", 100'000}, {"limited_by", "motor"}}},
        {"acceleration", {{"limit", 6e5}, {"proposed", 5e5}, {"limited_by", "bounds"}}},
        {"current", {{"limit", 120}, {"proposed", 144}, {"limited_by", "motor"}}},
        {"threshold", 7},
        {"backlash", 33.5},
        {"counts_per_microstep", 0.5},
        {"lost_steps", true},
        {"stored", false},
        {"trials", array{trial_of("velocity", 50'000, true), trial_of("velocity", 100'000, true),
                         trial_of("velocity", 200'000, false)}},
        {"settings",
         array{
             object{{"parameter", 4}, {"name", "max_velocity"}, {"value", 9}, {"before", 5}},
             object{{"parameter", 5}, {"name", "max_acceleration"}, {"value", 8}, {"before", 8}}}},
        {"hold_current", {{"limit", 64}, {"proposed", 77}, {"limited_by", "motor"}}},
        {"bow",
         {{"value", 4},
          {"resonance_hz", 12.25},
          {"damping", 0.05},
          {"swing", 3.5},
          {"swing_before", 130}}},
        {"warnings", array{"search the reference again"}}};
  }
  const std::vector<std::string> words{"tune",     "x",         "--max-current", "200",
                                       "--travel", "-2mm..2mm", "--yes"};
};

TEST_F(CtlTune, SaysWhatWasFoundDrawsTheTrialsAndSaysWhatToTypeNext) {
  EXPECT_EQ(run(words), ExitCode::done) << err;
  EXPECT_THAT(target.calls, ElementsAre(R"(axis.tune {"axis":"x","max_current":200,)"
                                        R"("from":"-2mm","to":"2mm"})"));
  EXPECT_THAT(out, HasSubstr("120000pps"));
  EXPECT_THAT(out, HasSubstr("beyond that it lost steps"));
  EXPECT_THAT(out, HasSubstr("no more was tried"));
  EXPECT_THAT(out, HasSubstr("below that it slid at rest"));
  EXPECT_THAT(out,
              HasSubstr("the load swings at 12.25 Hz, at rest by 3.5 microsteps, before by 130"));
  EXPECT_THAT(out, HasSubstr("velocity     |o "));
  EXPECT_THAT(out, HasSubstr(" x| 50000 to 200000\n"));
  EXPECT_THAT(out, HasSubstr("3 trials, 2 of them held (o); backlash 33.5 microsteps\n"));
  EXPECT_THAT(out, testing::EndsWith("tmclctl set x max_velocity 9\n"));
  EXPECT_THAT(err, HasSubstr("search the reference again"));
}

TEST_F(CtlTune, HandsOnWhatIsSaid) {
  target.result["stored"] = true;
  EXPECT_EQ(run({"tune", "x", "--max-current", "90", "--margin", "100", "--store", "--yes"}),
            ExitCode::done)
      << err;
  EXPECT_THAT(target.calls,
              ElementsAre(R"(axis.tune {"axis":"x","max_current":90,"margin":1E0,"store":true})"));
  EXPECT_THAT(out, testing::EndsWith("this is set and stored\n"));
}

TEST_F(CtlTune, HandsOnTheSwitchThatTells) {
  EXPECT_EQ(run({"tune", "x", "--max-current", "90", "--switch", "left", "--yes"}), ExitCode::done)
      << err;
  EXPECT_THAT(target.calls,
              ElementsAre(R"(axis.tune {"axis":"x","max_current":90,"by_switch":"left"})"));
}

TEST_F(CtlTune, MovesNothingThatWasNotAllowed) {
  EXPECT_EQ(run({"tune", "x", "--max-current", "200"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr("--yes says that it may"));
  EXPECT_EQ(run({"tune", "x", "--yes"}), ExitCode::usage);
  EXPECT_EQ(run({"tune", "x", "--max-current", "0", "--yes"}), ExitCode::usage);
  EXPECT_EQ(run({"tune", "x", "--max-current", "9", "--travel", "3mm", "--yes"}), ExitCode::usage);
  EXPECT_THAT(target.calls, IsEmpty());
}

TEST_F(CtlTune, IsADocument) {
  const auto document = json(words);
  EXPECT_EQ(document.at("threshold"), 7);
  EXPECT_EQ(document.at("trials").as_array().size(), 3U);
}

}  // namespace
}  // namespace tmclctl::test
