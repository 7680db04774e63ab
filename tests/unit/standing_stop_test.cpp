// A stop for an axis that did not stop: it is not given up, and nobody moves the axis before.
#include "gateway/standing_stop.hpp"

#include <gmock/gmock.h>

#include "unit/virtual_gateway.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using tmcl::Command;

class StandingStop : public testing::Test {
 protected:
  StandingStop() {
    bench.gateway().on_event([this](const GatewayEvent& event) {
      if (event.kind == GatewayEvent::Kind::axis_stopped) stopped.push_back(event.text);
    });
  }
  void begin() {
    bench.wire.seen.clear();
    stop_until_it_stands(bench.gateway().find_axis("x"));
  }
  /// A movement of the axis as its module does not know of it.
  std::string refusal() {
    const auto moved = bench.call("axis.rotate", {{"axis", "x"}, {"velocity_internal", 100}});
    return moved ? "none" : moved.error().name;
  }

  VirtualGateway bench;
  std::vector<std::string> stopped;
};

TEST_F(StandingStop, GoesOutAgainUntilAModuleThatWasSilentAnswers) {
  bench.wire.loses = [](const auto&) { return true; };
  begin();
  bench.time.run_for(10min);
  EXPECT_TRUE(stopped.empty());
  const auto sent = bench.wire.count(Command::MST);
  // Two each 4.1 seconds at least: each attempt also waits for what would end the ASCII mode of its
  // module.
  EXPECT_GE(sent, 2 * 600 / 4.1);
  EXPECT_LE(sent, 3000U) << "others need the line, too";
  bench.wire.loses = {};
  bench.wire.seen.clear();
  bench.time.run_for(1500ms);
  EXPECT_GE(bench.wire.count(Command::MST), 1U);
  bench.time.run_for(10s);
  EXPECT_THAT(stopped, ElementsAre("axis 'x' stands now"));
  EXPECT_EQ(refusal(), "none");
}

TEST_F(StandingStop, IsNotDoneBeforeTheModuleSaysThatTheAxisStands) {
  bool brakes = true;
  bench.wire.modules.at(1).before = [&](FakeModule& module, const tmcl::Request& request) {
    if (request.command == Command::GAP && brakes) module.parameter(0, 3) = 17;
    if (request.command == Command::GAP && !brakes) module.parameter(0, 3) = 0;
  };
  begin();
  bench.time.run_for(1min);
  EXPECT_TRUE(stopped.empty());
  EXPECT_EQ(refusal(), "axis_claimed");
  EXPECT_EQ(bench.wire.count(Command::ROR), 0U);
  brakes = false;
  bench.time.run_for(100ms);
  EXPECT_EQ(stopped.size(), 1U);
  EXPECT_EQ(refusal(), "none");
}

TEST_F(StandingStop, OutlivesALostLink) {
  bench.wire.unplug();
  begin();
  EXPECT_TRUE(stopped.empty());
  bench.time.run_for(3s);
  EXPECT_EQ(stopped.size(), 1U);
}

TEST_F(StandingStop, LetsEverybodyElseStopTheAxis) {
  bool brakes = true;
  bench.wire.modules.at(1).before = [&](FakeModule& module, const tmcl::Request& request) {
    if (request.command == Command::GAP && brakes) module.parameter(0, 3) = 17;
  };
  begin();
  EXPECT_TRUE(bench.call("axis.stop", {{"axis", "x"}}));
  bench.time.run_for(1s);
  EXPECT_TRUE(stopped.empty());
  brakes = false;
  bench.time.run_for(1s);
  EXPECT_EQ(stopped.size(), 1U);
}

}  // namespace
}  // namespace tmcld::test
