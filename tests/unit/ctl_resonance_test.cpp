// tmclctl resonance, on a gateway that the test plays.
#include <gmock/gmock.h>

#include "unit/ctl_fixture.hpp"

namespace tmclctl::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct CtlResonance : testing::Test, Ctl {
  CtlResonance() {
    target.result = {{"axis", "x"},
                     {"verdict", "rings"},
                     {"resonance_hz", 12.0341},
                     {"damping", 0.05123},
                     {"swing", 35.25},
                     {"confidence", 0.987},
                     {"lowest_hz", 1},
                     {"highest_hz", 130.25},
                     {"readings", 326},
                     {"readings_s", 1.001},
                     {"recorded", false},
                     {"distance_microsteps", -12'800},
                     {"velocity_pps", 100'000},
                     {"acceleration_pps2", 999'984.375},
                     {"warnings", boost::json::array{}}};
  }
};

TEST_F(CtlResonance, SaysHowTheLoadSwingsAndWhatToTypeNext) {
  EXPECT_EQ(run({"resonance", "x"}), ExitCode::done) << err;
  EXPECT_EQ(out,
            "the load of x swings at 12.03 Hz, with a damping of 0.05123: 35.25 counts to either "
            "side at first, 99 % of what the encoder did\n"
            "seen is what swings at 1 to 130.2 Hz: 326 readings in 1.001 s\n"
            "tmclctl ramp x --compare --velocity 100000pps --acceleration 999984pps/s --distance "
            "12800microsteps --resonance 12.03Hz --damping 0.05123\n");
  EXPECT_THAT(target.calls, ElementsAre(R"(axis.resonance {"axis":"x"})"));
}

TEST_F(CtlResonance, HandsOnWhatIsSaid) {
  EXPECT_EQ(run({"resonance", "x", "--distance", "-2mm", "--for", "0.5"}), ExitCode::done) << err;
  EXPECT_THAT(out, HasSubstr(" --distance 12800microsteps "));
  EXPECT_EQ(run({"resonance", "x", "--distance", "500", "--internal"}), ExitCode::done) << err;
  EXPECT_THAT(target.calls,
              ElementsAre(R"(axis.resonance {"axis":"x","distance":"-2mm","listen_ms":500})",
                          R"(axis.resonance {"axis":"x","distance_microsteps":500})"));
}

TEST_F(CtlResonance, SaysWhatItDoesNotKnow) {
  target.result["verdict"] = "unclear";
  for (const auto* name : {"resonance_hz", "damping", "swing"}) target.result[name] = nullptr;
  target.result["warnings"] = boost::json::array{"no swing explains it"};
  EXPECT_EQ(run({"resonance", "x"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr("how the load of x swings is not clear\nseen is what swings at 1 to"));
  EXPECT_THAT(err, HasSubstr("no swing explains it"));
  target.result["verdict"] = "still";
  EXPECT_EQ(run({"resonance", "x"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr("the load of x stood as soon as its motor\n"));
}

TEST_F(CtlResonance, IsADocument) {
  const auto document = json({"resonance", "x"});
  EXPECT_EQ(document.at("axis"), "x");
  EXPECT_EQ(document.at("resonance_hz"), 12.0341);
  EXPECT_THAT(std::string(document.at("compare").as_string()),
              HasSubstr("--resonance 12.03Hz --damping 0.05123"));
}

TEST_F(CtlResonance, ListensForATime) {
  EXPECT_EQ(run({"resonance", "x", "--for", "11"}), ExitCode::usage);
  EXPECT_EQ(run({"resonance", "x", "--for", "0"}), ExitCode::usage);
  EXPECT_THAT(target.calls, IsEmpty());
}

}  // namespace
}  // namespace tmclctl::test
