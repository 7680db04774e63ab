// Paths that a gateway passes with each kind of ramp generator, in virtual time.
#include <gmock/gmock.h>

#include <map>
#include <tuple>

#include "tmcl/parameter.hpp"
#include "unit/journey_bench.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using tmcl::Command;

/// Of one model, and of a TMCM-1110 beside it.
class PathOnEveryFamily : public testing::TestWithParam<std::tuple<const char*, const char*>> {
 protected:
  static const char* model() { return std::get<0>(GetParam()); }
  static json::object path(const char* mode = std::get<1>(GetParam())) {
    return {{"axes", json::array{"x", "far"}},
            {"text", "G1 X4 Y2 F240\nG1 X-3 Y1\nG1 X2 Y0\n"},
            {"mode", mode}};
  }
  using Settings = std::map<std::string_view, std::int64_t>;

  /// All that a module may keep in its EEPROM, but for what a movement is.
  Settings settings(const char* axis, const char* model) {
    Settings all;
    for (const auto& row : axis_parameters(*tmcl::find_model(model)))
      if (row.stored && row.name != "ramp_mode") all[row.name] = bench.get(axis, row.number);
    return all;
  }
  double mm(const char* axis) { return static_cast<double>(bench.position(axis)) / (51'200 / 5.0); }
  bool stands() { return bench.get("x", 3) == 0 && bench.get("far", 3) == 0; }
  void expect_rest_and_own_settings() {
    EXPECT_TRUE(stands());
    EXPECT_EQ(settings("x", model()), own_x);
    EXPECT_EQ(settings("far", "TMCM-1110"), own_far);
  }

  JourneyBench bench{model(), "unit = \"mm\"\nunits_per_revolution = 5\n"};
  const Settings own_x = settings("x", model());
  const Settings own_far = settings("far", "TMCM-1110");
};

TEST_P(PathOnEveryFamily, IsPassedToItsExactEnd) {
  const auto ended = bench.call("path.run", path());
  ASSERT_TRUE(ended) << ended.error().message;
  EXPECT_EQ(mm("x"), 2);
  EXPECT_EQ(mm("far"), 0);
  for (const auto& axis : ended->at("tracking_error").as_array())
    EXPECT_LT(axis.at("rms").to_number<double>(), 0.05);
  expect_rest_and_own_settings();
}

TEST_P(PathOnEveryFamily, EndsWhereOneAxisIsStopped) {
  const auto running = bench.begin("path.run", path());
  bench.time.run_for(1s);
  ASSERT_TRUE(bench.call("axis.stop", {{"axis", "far"}}));
  const auto ended = bench.end_of(running);
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().name, "stopped_by_other");
  expect_rest_and_own_settings();
}

TEST_P(PathOnEveryFamily, EndsWhereACommandIsRefused) {
  const auto running = bench.begin("path.run", path());
  bench.time.run_for(1s);
  bool refused = false;
  bench.wire.refuses = [&](const tmcl::Request& request) {
    const bool leads_on = request.command == Command::SAP || request.command == Command::ROR ||
                          request.command == Command::ROL;
    const bool is_first = leads_on && request.address == tmcl::ModuleAddress{1} && !refused;
    refused = refused || is_first;
    return is_first;
  };
  const auto ended = bench.end_of(running);
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().name, "command_failed");
  expect_rest_and_own_settings();
}

TEST_P(PathOnEveryFamily, StandsWhileItPauses) {
  const auto running = bench.begin("path.run", path());
  bench.time.run_for(1s);
  ASSERT_TRUE(bench.call("path.pause", {{"axes", json::array{"x"}}}));
  bench.time.run_for(3s);
  const auto stood = mm("x");
  bench.time.run_for(3s);
  // What is turned by segments is told a microstep a second to and fro.
  EXPECT_NEAR(mm("x"), stood, 2 / (51'200 / 5.0));
  ASSERT_TRUE(bench.call("path.resume", {{"axes", json::array{"x"}}}));
  EXPECT_TRUE(bench.end_of(running));
  EXPECT_EQ(mm("x"), 2);
  expect_rest_and_own_settings();
}

// That of the TMCM-1110 at least has none.
TEST_P(PathOnEveryFamily, ByPositionsTakesStartAndStopVelocities) {
  const auto refused = bench.call("path.run", path("position"));
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("has no start and stop velocities"));
  EXPECT_TRUE(bench.sent(Command::MVP).empty());
  expect_rest_and_own_settings();
}

INSTANTIATE_TEST_SUITE_P(Families, PathOnEveryFamily,
                         testing::Combine(testing::Values("TMCM-3110", "TMCM-142", "TMCM-6212",
                                                          "TMCM-3351", "TMCM-1021"),
                                          testing::Values("velocity", "segments")),
                         [](const auto& one) {
                           return std::string(std::get<0>(one.param)).substr(5) + '_' +
                                  std::get<1>(one.param);
                         });

}  // namespace
}  // namespace tmcld::test
