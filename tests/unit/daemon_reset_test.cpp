// A module without an axis in the configuration that clients reset, once and again.
#include <gmock/gmock.h>

#include "unit/journey_bench.hpp"

namespace tmcld::test {
namespace {

// Nobody meets it anew by himself; what was known of its timer is long ago.
TEST(DaemonReset, AModuleThatWasResetCanBeResetFurther) {
  JourneyBench bench;
  bench.wire.bench().add(*tmcl::find_model("TMCM-1110"), tmcl::ModuleAddress{7});
  ASSERT_TRUE(bench.call("parameter.get", {{"axis", "line:7/0"}, {"parameter", 4}}));
  const json::object here{{"bus", "line"}, {"address", 7}};
  ASSERT_TRUE(bench.call("module.reset", here));
  bench.time.run_for(std::chrono::milliseconds(500));
  const auto done = bench.call("module.factory_reset", here);
  EXPECT_TRUE(done) << done.error().message;
}

}  // namespace
}  // namespace tmcld::test
