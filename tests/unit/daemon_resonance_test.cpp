// How a load swings, measured by a small move: on simulated loads whose resonance is known.
#include <gmock/gmock.h>

#include "sim/bench.hpp"
#include "sim/module/data_logger.hpp"
#include "tmcl/api/resonance.hpp"
#include "unit/journey_bench.hpp"

namespace tmcld::test {
namespace {

using testing::HasSubstr;
using tmcl::ramp::Resonance;
using tmcl::sim::EncoderSettings;
using tmcl::sim::StageSettings;
using Measured = api::axis::MeasuredResonance;

/// On each kind of ramp generator: a model, and a steep ramp in its own units.
struct Ramp {
  const char* model;
  std::vector<std::pair<int, int>> settings;
};
void PrintTo(const Ramp& ramp, std::ostream* out) { *out << ramp.model; }

const Ramp of_sixpoint{"TMCM-1276", {{4, 100'000}, {5, 1'000'000}, {16, 0}, {17, 1'000'000}}};

class LoadBench : public JourneyBench {
 public:
  explicit LoadBench(const Ramp& ramp, const StageSettings& stage, const std::string& of_axes = {})
      : JourneyBench(ramp.model, of_axes) {
    wire.bench().modules().front()->mount(0, stage);
    for (const auto& [parameter, value] : ramp.settings) {
      const auto set =
          call("parameter.set", {{"axis", "x"}, {"parameter", parameter}, {"value", value}});
      EXPECT_TRUE(set) << set.error().message;
    }
    requests.clear();
  }
  static StageSettings stage(std::optional<Resonance> resonance, std::int32_t counts = 4000) {
    StageSettings stage;
    stage.encoder = EncoderSettings{counts, false};
    stage.resonance = resonance;
    return stage;
  }
  Result<json::object> measure(json::object more = {}) {
    more["axis"] = "x";
    return call("axis.resonance", std::move(more));
  }
  Measured measured(json::object more = {}) {
    const auto result = measure(std::move(more));
    EXPECT_TRUE(result) << result.error().message;
    return result ? api::from_json<Measured>(*result) : Measured{};
  }
  /// "name: message (hint)"
  std::string refusal(json::object more = {}) {
    const auto result = measure(std::move(more));
    if (result) return json::serialize(*result);
    return result.error().name + ": " + result.error().message + " (" + result.error().hint + ')';
  }
};

struct ResonanceOf : testing::TestWithParam<Ramp> {};

// Within 2 % and 0.01, at 115200 baud.
TEST_P(ResonanceOf, IsFoundFromTheEncoder) {
  for (const Resonance& expected : {Resonance{4, 0.02}, Resonance{12, 0.05}, Resonance{35, 0.03}}) {
    SCOPED_TRACE(expected.frequency_hz);
    LoadBench bench(GetParam(), LoadBench::stage(expected, 51'200));
    const auto found = bench.measured();
    EXPECT_EQ(found.verdict, "rings");
    EXPECT_NEAR(found.resonance_hz.value_or(0), expected.frequency_hz,
                0.02 * expected.frequency_hz);
    EXPECT_NEAR(found.damping.value_or(0), expected.damping, 0.01);
    EXPECT_GT(found.confidence, 0.95);
    EXPECT_GT(found.highest_hz, 40);
    const auto family = tmcl::find_model(GetParam().model)->family;
    EXPECT_EQ(found.recorded, tmcl::sim::has_data_logger(family));
    EXPECT_EQ(bench.sent(tmcl::Command::MVP).size(), 1U) << "one move, absolute";
    EXPECT_EQ(bench.position("x"), found.distance_microsteps);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Each, ResonanceOf,
    testing::Values(Ramp{"TMCM-1110", {{154, 3}, {153, 5}, {4, 1500}, {5, 1500}}},
                    Ramp{"TMCM-142", {{4, 6'700'000}, {16, 17'000}, {17, 17'000}, {18, 0}}},
                    of_sixpoint,
                    Ramp{"TMCM-3351", {{4, 100'000}, {5, 1'000'000}, {17, 1'000'000}}}),
    [](const auto& info) {
      std::string name = info.param.model;
      std::erase(name, '-');
      return name;
    });

TEST(MeasuredResonance, IsThatOfAUsualEncoderToo) {
  LoadBench bench(of_sixpoint, LoadBench::stage(Resonance{9, 0.04}));
  const auto found = bench.measured({{"listen_ms", 1500}});
  EXPECT_EQ(found.verdict, "rings");
  EXPECT_NEAR(found.resonance_hz.value_or(0), 9, 0.18);
  EXPECT_NEAR(found.damping.value_or(0), 0.04, 0.01);
}

TEST(MeasuredResonance, TellsWhatMadeItAndWhatItSaw) {
  LoadBench bench(of_sixpoint, LoadBench::stage(Resonance{9, 0.04}),
                  "unit = \"mm\"\nunits_per_revolution = 5\n");
  const auto found = bench.measured({{"distance", "-1mm"}, {"listen_ms", 500}});
  EXPECT_EQ(found.distance_microsteps, -10'240);
  EXPECT_EQ(bench.position("x"), -10'240);
  EXPECT_NEAR(found.velocity_pps, 100'000, 1);
  EXPECT_NEAR(found.acceleration_pps2, 1'000'000, 200);
  EXPECT_NEAR(found.readings_s, 0.5, 0.02);
  EXPECT_NEAR(found.lowest_hz, 2, 0.1);
  EXPECT_NEAR(found.highest_hz, found.readings / found.readings_s / 2.5, 1);
}

TEST(MeasuredResonance, OfARigidLoadIsNone) {
  LoadBench bench(of_sixpoint, LoadBench::stage({}));
  const auto found = bench.measured();
  EXPECT_EQ(found.verdict, "still");
  EXPECT_FALSE(found.resonance_hz);
}

TEST(MeasuredResonance, LeavesWhatTheModuleRecords) {
  LoadBench bench(of_sixpoint, LoadBench::stage(Resonance{9, 0.04}));
  const auto begun =
      bench.call("capture.start",
                 {{"axis", "x"}, {"channels", json::array{"actual_position"}}, {"samples", 10}});
  ASSERT_TRUE(begun) << begun.error().message;
  bench.time.run_for(std::chrono::seconds(1));
  const auto found = bench.measured();
  EXPECT_EQ(found.verdict, "rings");
  EXPECT_FALSE(found.recorded);
  const auto capture = begun->at("capture");
  const auto state = bench.call("capture.state", {{"axis", "x"}, {"capture", capture}});
  ASSERT_TRUE(state) << state.error().message;
  EXPECT_EQ(state->at("state"), "complete");
}

// It would look like a slower one if the encoder were read at even times only, as a module does
// that records it.
TEST(MeasuredResonance, ThatIsTooFastIsNotTakenForAnother) {
  const Ramp of_tmc429{"TMCM-1110", {{154, 3}, {153, 3}, {4, 1500}, {5, 1500}}};
  const Ramp steep{"TMCM-1276", {{4, 200'000}, {5, 7'000'000}, {16, 0}, {17, 7'000'000}}};
  const std::vector<std::pair<Ramp, double>> cases{{of_tmc429, 160}, {steep, 230}, {steep, 330}};
  for (const auto& [ramp, frequency] : cases) {
    LoadBench bench(ramp, LoadBench::stage(Resonance{frequency, 0.002}, 51'200));
    const auto found = bench.measured();
    EXPECT_EQ(found.verdict, "unclear") << frequency << ' ' << found.resonance_hz.value_or(0);
    EXPECT_LT(found.highest_hz, frequency);
    EXPECT_THAT(found.warnings.back(), HasSubstr("a quicker bus shows faster swings"));
  }
}

TEST(MeasuredResonance, NeedsAnEncoder) {
  LoadBench none({"TMCM-6110", {}}, {});
  EXPECT_THAT(none.refusal(), HasSubstr("no_encoder: the module of axis x has no encoder"));
  EXPECT_TRUE(none.sent(tmcl::Command::MVP).empty());
  LoadBench unconnected(of_sixpoint, {});
  EXPECT_THAT(unconnected.refusal(),
              HasSubstr("no_encoder: the encoder of axis x has counted nothing"));
}

TEST(MeasuredResonance, IsMeasuredBySmallMovesOnly) {
  LoadBench bench(of_sixpoint, LoadBench::stage(Resonance{9, 0.04}));
  EXPECT_THAT(bench.refusal({{"distance_microsteps", 256'001}}),
              HasSubstr("out_of_range: a move to measure by is 1 to 256000 microsteps"));
  EXPECT_THAT(bench.refusal({{"distance_microsteps", 0}}), HasSubstr("out_of_range"));
  EXPECT_TRUE(bench.sent(tmcl::Command::MVP).empty());
}

TEST(MeasuredResonance, IsThatOfAMoveFromRest) {
  LoadBench bench(of_sixpoint, LoadBench::stage(Resonance{9, 0.04}));
  ASSERT_TRUE(bench.call("axis.rotate", {{"axis", "x"}, {"velocity_internal", 1000}}));
  bench.time.run_for(std::chrono::milliseconds(10));
  EXPECT_THAT(bench.refusal(), HasSubstr("moving: axis x moves"));
  EXPECT_TRUE(bench.sent(tmcl::Command::MVP).empty());
}

TEST(MeasuredResonance, IsWithinSoftLimits) {
  LoadBench bench(of_sixpoint, LoadBench::stage(Resonance{9, 0.04}),
                  "unit = \"mm\"\nunits_per_revolution = 5\nsoft_limits = [-0.5, 0.5]\n");
  EXPECT_THAT(bench.refusal({{"distance", "1mm"}}), HasSubstr("soft_limit"));
  EXPECT_TRUE(bench.sent(tmcl::Command::MVP).empty());
}

TEST(MeasuredResonance, IsNotThatOfAnotherMove) {
  LoadBench bench(of_sixpoint, LoadBench::stage(Resonance{9, 0.04}));
  const auto pending = bench.begin("axis.resonance", {{"axis", "x"}});
  bench.time.run_for(std::chrono::milliseconds(700));
  ASSERT_TRUE(bench.call("axis.move_by", {{"axis", "x"}, {"distance_microsteps", 500}}));
  const auto result = bench.end_of(pending);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().name, "moved");
}

TEST(MeasuredResonance, IsNotFoundWhenTheAxisIsStopped) {
  LoadBench bench({"TMCM-1276", {{4, 5'000}, {5, 1'000'000}}},
                  LoadBench::stage(Resonance{9, 0.04}));
  const auto pending = bench.begin("axis.resonance", {{"axis", "x"}});
  bench.time.run_for(std::chrono::milliseconds(300));
  ASSERT_TRUE(bench.call("axis.stop", {{"axis", "x"}}));
  const auto result = bench.end_of(pending);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().name, "superseded_by_stop");
}

}  // namespace
}  // namespace tmcld::test
