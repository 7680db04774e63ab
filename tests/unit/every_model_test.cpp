// Axes of every model that is known are moved through the gateway.
#include <gtest/gtest.h>

#include "unit/journey_bench.hpp"

namespace tmcld::test {
namespace {

class EveryModel : public testing::TestWithParam<tmcl::Model> {};

TEST_P(EveryModel, MovesTurnsAndStops) {
  JourneyBench bench(GetParam().name);
  const auto call = [&](const char* method, json::object params) {
    params["axis"] = "x";
    const auto result = bench.call(method, std::move(params));
    EXPECT_TRUE(result) << method << ": " << result.error().message;
  };
  call("axis.move_to", {{"position_microsteps", 500}});
  call("axis.wait", {});
  EXPECT_EQ(bench.position("x"), 500);
  call("axis.move_by", {{"distance_microsteps", -700}});
  call("axis.wait", {});
  EXPECT_EQ(bench.position("x"), -200);
  call("axis.rotate", {{"velocity_internal", 100}});
  bench.time.run_for(std::chrono::seconds(2));
  call("axis.stop", {});
  bench.time.run_for(std::chrono::seconds(5));
  EXPECT_GT(bench.position("x"), -200);
  EXPECT_EQ(bench.get("x", 3), 0);
  call("axis.get_state", {});
  call("axis.get_units", {});
}

INSTANTIATE_TEST_SUITE_P(Models, EveryModel,
                         testing::ValuesIn(tmcl::models().begin(), tmcl::models().end()),
                         [](const auto& one) {
                           std::string name(one.param.name);
                           std::erase(name, '-');
                           return name;
                         });

}  // namespace
}  // namespace tmcld::test
