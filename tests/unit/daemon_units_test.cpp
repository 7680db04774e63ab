// What the daemon makes of the velocities that modules count in units of their own.
#include <gmock/gmock.h>

#include "unit/daemon_fixture.hpp"

namespace tmcld::test {
namespace {

using testing::HasSubstr;
using tmcl::Command;

class DaemonUnits : public testing::Test {
 protected:
  void serve(std::uint16_t model) {
    daemon.wire().model = model;
    daemon.start();
    client = std::make_unique<RpcClient>(daemon.socket());
  }
  void hold(std::uint8_t parameter, std::int32_t value) {
    daemon.on_reactor([&] { return daemon.wire().modules.at(1).parameter(0, parameter) = value; });
  }
  double velocity_pps() {
    return client->result("axis.get_state", {{"axis", "x"}}).at("velocity_pps").to_number<double>();
  }
  std::size_t reads_of(std::uint8_t parameter) {
    return daemon.on_reactor([&] {
      return static_cast<std::size_t>(std::ranges::count_if(daemon.wire().seen, [&](auto& request) {
        return request.command == Command::GAP && request.type == parameter;
      }));
    });
  }

  TestDaemon daemon;
  std::unique_ptr<RpcClient> client;
};

TEST_F(DaemonUnits, DividersScaleTheVelocitiesOfATmc429) {
  serve(6110);
  hold(3, -1000);
  hold(154, 2);
  EXPECT_NEAR(velocity_pps(), -61'035.2, 0.1);
  hold(154, 14);  // no module has that
  client->result("parameter.set", {{"axis", "x"}, {"parameter", "pulse_divisor"}, {"value", 3}});
  EXPECT_NEAR(velocity_pps(), -30'517.6, 0.1);
}

TEST_F(DaemonUnits, TheUnitModeScalesTheVelocitiesOfATmc457) {
  serve(142);
  hold(3, 1 << 26);
  hold(255, 0);
  EXPECT_DOUBLE_EQ(velocity_pps(), 1'000'000);
  client->result("parameter.set", {{"axis", "x"}, {"parameter", "unit_mode"}, {"value", 1}});
  hold(3, -4'321);
  EXPECT_DOUBLE_EQ(velocity_pps(), -4'321);
}

TEST_F(DaemonUnits, TheUnitModeScalesTheVelocitiesOfASixPointChip) {
  serve(6212);
  hold(3, -1 << 20);
  hold(255, 1);
  EXPECT_DOUBLE_EQ(velocity_pps(), -1 << 20);
  client->result("parameter.set", {{"axis", "x"}, {"parameter", 255}, {"value", 0}});
  EXPECT_DOUBLE_EQ(velocity_pps(), -1'000'000);
}

TEST_F(DaemonUnits, TheUnitIsAskedForOnceUntilItMayHaveChanged) {
  serve(6212);
  hold(255, 1);
  for (int i = 0; i < 5; ++i) velocity_pps();
  EXPECT_EQ(reads_of(255), 1U);
  client->result("parameter.set", {{"axis", "x"}, {"parameter", 4}, {"value", 1000}});
  velocity_pps();
  EXPECT_EQ(reads_of(255), 1U);
  client->result("parameter.set", {{"axis", "x"}, {"parameter", 255}, {"value", 1}});
  velocity_pps();
  EXPECT_EQ(reads_of(255), 2U);
}

TEST_F(DaemonUnits, AUnitThatNoModuleHasGivesNoVelocity) {
  serve(6212);
  hold(255, 2);
  EXPECT_TRUE(client->result("axis.get_state", {{"axis", "x"}}).at("velocity_pps").is_null());
}

// Which range applies depends on the unit mode, so the module is the judge.
TEST_F(DaemonUnits, LeaveTheRangeOfWhatTheyScaleToTheModule) {
  serve(142);
  EXPECT_EQ(client
                ->result("parameter.set",
                         {{"axis", "x"}, {"parameter", "acceleration"}, {"value", 900'000'000}})
                .at("number"),
            16);
  const auto error =
      client->error("parameter.set", {{"axis", "x"}, {"parameter", "max_bow"}, {"value", 19}});
  EXPECT_THAT(text(error.at("message")), HasSubstr("outside 0..18"));
}

}  // namespace
}  // namespace tmcld::test
