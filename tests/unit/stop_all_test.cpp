// A stop of everything: in which order, and at what cost.
#include <gmock/gmock.h>

#include "unit/virtual_gateway.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using tmcl::Command;

const std::string six_axes = [] {
  auto text = std::string(bench_bus);
  for (int module = 1; module <= 2; ++module) {
    for (int motor = 0; motor < 3; ++motor) {
      text += "[[axis]]\nname = \"m" + std::to_string(module) + std::to_string(motor) +
              "\"\nbus = \"bench\"\naddress = " + std::to_string(module) +
              "\nmotor = " + std::to_string(motor) + "\n";
    }
  }
  return text;
}();

TEST(StopOfAll, TakesOneExchangeAMotorThoseThatMoveFirstAndModulesInTurn) {
  VirtualGateway bench(six_axes);
  bench.wire.modules.emplace(std::uint8_t{2}, FakeModule(2));
  bench.time.run_for(3s);
  for (const char* axis : {"m22", "m12", "m21"})
    ASSERT_TRUE(bench.call("axis.rotate", {{"axis", axis}, {"velocity_internal", 100}}));
  bench.wire.seen.clear();
  ASSERT_TRUE(bench.call("system.stop_all", {}));
  std::vector<std::pair<int, int>> stops;
  for (const auto& request : bench.wire.seen) {
    EXPECT_EQ(request.command, Command::MST);
    stops.emplace_back(number(request.address), request.motor);
  }
  using Stop = std::pair<int, int>;
  EXPECT_THAT(stops,
              ElementsAre(Stop{1, 2}, Stop{2, 1}, Stop{2, 2}, Stop{1, 0}, Stop{2, 0}, Stop{1, 1}));
}

}  // namespace
}  // namespace tmcld::test
