// The reactor stands still while axes go along a line, a path or a Mint program. Whenever that is,
// and whatever the axes do meanwhile: all stand in the end, have their settings back, and who asked
// is told why.
#include <gmock/gmock.h>

#include <algorithm>

#include "unit/journey_bench.hpp"

namespace tmcld::test {
namespace {

using testing::HasSubstr;
using namespace std::chrono_literals;

struct Journey {
  std::string name;
  std::string method;
  json::object params;
  std::string model = "TMCM-3110";
  std::vector<int> settings = {4, 5, 130, 153, 154};
};
void PrintTo(const Journey& journey, std::ostream* out) { *out << journey.name; }

constexpr const char* in_mm = "unit = \"mm\"\nunits_per_revolution = 5\n";

json::object path(const char* mode) {
  return {{"axes", json::array{"x", "y"}},
          {"text", "G1 X8 Y4 F1200\nG1 X9 Y2\nG1 X1 Y2.5\n"},
          {"mode", mode}};
}

class JourneyGap : public testing::TestWithParam<Journey> {
 protected:
  static std::vector<std::int64_t> settings_of(JourneyBench& bench) {
    std::vector<std::int64_t> settings;
    for (const auto* axis : {"x", "y"})
      for (const int parameter : GetParam().settings)
        settings.push_back(bench.get(axis, parameter));
    return settings;
  }
  static bool stands(JourneyBench& bench) {
    return bench.get("x", 3) == 0 && bench.get("y", 3) == 0;
  }
  static tmcl::Duration duration_of(const Journey& journey) {
    JourneyBench bench(GetParam().model, in_mm);
    const auto begin = bench.time.now();
    const auto result = bench.call(journey.method, journey.params);
    EXPECT_TRUE(result) << result.error().message;
    return bench.time.now() - begin;
  }
};

TEST_P(JourneyGap, EndsItAndSaysSo) {
  const auto whole = duration_of(GetParam());
  constexpr int places = 40;
  int ended = 0;
  for (int place = 0; place < places; ++place) {
    JourneyBench bench(GetParam().model, in_mm);
    const auto before = settings_of(bench);
    const auto pending = bench.begin(GetParam().method, GetParam().params);
    bench.time.run_for(whole * place / places);
    SCOPED_TRACE(testing::Message()
                 << "after " << std::chrono::duration<double>(whole * place / places).count()
                 << " s");
    bench.time.freeze_for(2s);
    const auto result = bench.end_of(pending);
    EXPECT_TRUE(stands(bench));
    EXPECT_EQ(settings_of(bench), before);
    if (result) continue;
    ++ended;
    EXPECT_EQ(result.error().name, "stale_request") << result.error().message;
    EXPECT_THAT(result.error().message, HasSubstr("stood still for 2."));
  }
  EXPECT_GT(ended, places * 3 / 4);
}

// Its axes go on alone; only what was not started yet is not.
TEST(LineGap, ItGoesOnOrHasNotBegun) {
  int arrived = 0;
  constexpr int places = 60;
  for (int place = 0; place < places; ++place) {
    SCOPED_TRACE(testing::Message() << "after " << place << " ms");
    JourneyBench bench;
    const auto velocity = bench.get("x", 4);
    const auto pending = bench.begin(
        "line.move",
        {{"axes", json::array{"x", "y"}}, {"positions_microsteps", json::array{-400'000, 70'000}}});
    bench.time.run_for(1ms * place);
    bench.time.freeze_for(2s);
    const auto result = bench.end_of(pending);
    bench.time.run_for(20s);
    // It may stand still while an axis is being started.
    EXPECT_NEAR(static_cast<double>(bench.position("x")), result ? -400'000 : 0, result ? 0 : 10);
    EXPECT_NEAR(static_cast<double>(bench.position("y")), result ? 70'000 : 0, result ? 0 : 10);
    EXPECT_EQ(bench.get("x", 4), velocity);
    EXPECT_FALSE(bench.gateway->has_journeys());
    if (result) ++arrived;
  }
  EXPECT_GT(arrived, 0);
  EXPECT_LT(arrived, places);
}

INSTANTIATE_TEST_SUITE_P(
    Journeys, JourneyGap,
    testing::Values(
        Journey{"velocity", "path.run", path("velocity")},
        Journey{"position", "path.run", path("position"), "TMCM-6212", {4, 5, 15, 16, 17, 19, 20}},
        Journey{"mint",
                "mint.run",
                {{"axes", json::array{"x", "y"}},
                 {"text",
                  "SPEED = 900;\nACCEL = 9000;\nMOVEA = 5000, -2000\nGO\n"
                  "MOVEA = 100, 1000\nGO\n"}}}),
    [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace tmcld::test
