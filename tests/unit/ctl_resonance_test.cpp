// tmclctl resonance, on simulated loads whose resonance is known.
#include <regex>

#include <gmock/gmock.h>

#include "sim/module/module.hpp"
#include "unit/ctl_bench.hpp"

namespace tmclctl::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using tmcl::ramp::Resonance;

/// Axis "x" has an encoder on its load, and a steep ramp.
struct CtlResonance : testing::Test, CtlBench {
  CtlResonance() : CtlBench(axis_in_mm, "TMCM-1276") {
    drive(Resonance{12, 0.05});
    set_ramp(100'000, 1'000'000);
  }
  void set_ramp(std::int32_t velocity, std::int32_t acceleration) {
    set("velocity_v1", 0);
    set("max_velocity", velocity);
    for (const auto* name : {"max_acceleration", "max_deceleration"}) set(name, acceleration);
  }
  void drive(std::optional<Resonance> resonance) {
    tmcl::sim::StageSettings stage;
    stage.encoder = tmcl::sim::EncoderSettings{51'200};
    stage.resonance = resonance;
    module().mount(0, stage);
  }
};

TEST_F(CtlResonance, SaysHowTheLoadSwingsAndWhatToTypeNext) {
  EXPECT_EQ(run({"resonance", "x"}), ExitCode::done) << err;
  std::smatch found;
  ASSERT_TRUE(std::regex_match(
      out, found,
      std::regex("the load of x swings at (12\\.\\d\\d|11\\.9\\d|12) Hz, with a damping of "
                 "(0\\.0[45]\\d*): \\d+(\\.\\d+)? counts to either side at first, (9\\d|100) % of "
                 "what the encoder did\n"
                 "seen is what swings at 1(\\.\\d+)? to \\d+(\\.\\d)? Hz: \\d+ readings in "
                 "(1|1\\.\\d+|0\\.9\\d+) s\n"
                 "tmclctl ramp x --compare --velocity 100000pps --acceleration (\\d+)pps/s "
                 "--distance 12800microsteps --resonance \\1Hz --damping \\2\n")))
      << out;
  EXPECT_NEAR(std::stod(found[8]), 1'000'000, 200);
  EXPECT_THAT(calls, ElementsAre(R"(axis.resonance {"axis":"x"})"));
}

TEST_F(CtlResonance, HandsOnWhatIsSaid) {
  EXPECT_EQ(run({"resonance", "x", "--distance", "-2mm", "--for", "0.5"}), ExitCode::done) << err;
  EXPECT_THAT(out, HasSubstr(" --distance 20480microsteps "));
  EXPECT_EQ(get("actual_position"), -20'480);
  EXPECT_EQ(run({"resonance", "x", "--distance", "500", "--internal"}), ExitCode::done) << err;
  EXPECT_THAT(calls, ElementsAre(R"(axis.resonance {"axis":"x","distance":"-2mm","listen_ms":500})",
                                 R"(axis.resonance {"axis":"x","distance_microsteps":500})"));
}

TEST_F(CtlResonance, SaysWhatItDoesNotKnow) {
  // Faster than the bus lets the encoder be read.
  drive(Resonance{230, 0.002});
  set_ramp(200'000, 7'000'000);
  EXPECT_EQ(run({"resonance", "x"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr("how the load of x swings is not clear\nseen is what swings at 1"));
  EXPECT_THAT(err, HasSubstr("a quicker bus shows faster swings"));
  drive({});
  EXPECT_EQ(run({"resonance", "x"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr("the load of x stood as soon as its motor\n"));
}

TEST_F(CtlResonance, IsADocument) {
  const auto document = json({"resonance", "x"});
  EXPECT_EQ(document.at("axis"), "x");
  EXPECT_NEAR(document.at("resonance_hz").as_double(), 12, 0.24);
  EXPECT_NEAR(document.at("damping").as_double(), 0.05, 0.01);
  EXPECT_THAT(std::string(document.at("compare").as_string()),
              testing::ContainsRegex("--resonance 1[12]\\.?[0-9]*Hz --damping 0\\.0[45]"));
}

TEST_F(CtlResonance, ListensForATime) {
  EXPECT_EQ(run({"resonance", "x", "--for", "11"}), ExitCode::usage);
  EXPECT_EQ(run({"resonance", "x", "--for", "0"}), ExitCode::usage);
  EXPECT_THAT(calls, IsEmpty());
}

}  // namespace
}  // namespace tmclctl::test
