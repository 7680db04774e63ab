// line.move on simulated modules: how its axes are started, and that they get their settings back.
#include <gmock/gmock.h>

#include "unit/simulated_modules.hpp"

namespace tmcld::test {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

/// x on a TMCM-1110, y and z on a TMCM-3110.
class LineStarts : public testing::Test {
 protected:
  static std::string axis_on(const std::string& bus, const std::string& name, int module,
                             int motor) {
    return "[[axis]]\nname = \"" + name + "\"\nbus = \"" + bus +
           "\"\naddress = " + std::to_string(module) + "\nmotor = " + std::to_string(motor) + '\n';
  }
  static std::string bus(const std::string& name) {
    return "[[bus]]\nname = \"" + name + "\"\nlink = \"serial:/dev/" + name + "\"\n";
  }
  LineStarts() : LineStarts("bench", "bench") {}
  /// On one bus each.
  LineStarts(const std::string& of_x, const std::string& of_others)
      : daemon(bus(of_x) + (of_x == of_others ? "" : bus(of_others)) + axis_on(of_x, "x", 1, 0) +
                   axis_on(of_others, "y", 2, 0) + axis_on(of_others, "z", 2, 1),
               reactor) {
    modules.add(daemon.wire(of_x), "TMCM-1110", 1);
    modules.add(daemon.wire(of_others), "TMCM-3110", 2);
    daemon.start();
    client = std::make_unique<RpcClient>(daemon.socket());
  }

  json::object move(const json::array& axes, const json::array& positions) {
    return client->result("line.move", {{"axes", axes}, {"positions_microsteps", positions}});
  }
  std::int64_t setting(const std::string& axis, const std::string& parameter) {
    return client->result("parameter.get", {{"axis", axis}, {"parameter", parameter}})
        .at("value")
        .as_int64();
  }
  std::int64_t wait_for(const std::string& axis) {
    return client->result("axis.wait", {{"axis", axis}, {"timeout_ms", 20'000}})
        .at("position_microsteps")
        .as_int64();
  }
  void expect_skew_is_foreseen(const json::array& axes, const json::array& there,
                               std::chrono::duration<double> exchange) {
    const auto line = move(axes, there);
    const auto skew = line.at("skew_s").to_number<double>();
    EXPECT_GE(skew, exchange.count());
    EXPECT_NEAR(line.at("predicted_skew_s").to_number<double>(), skew, 0.01 * skew);
  }
  // The settings are set back when all of them stand.
  bool has_its_settings_again(const std::string& axis) {
    for (int i = 0; i < 200; ++i) {
      if (setting(axis, "max_velocity") == 1000 && setting(axis, "max_acceleration") == 500)
        return true;
      daemon.run_for(milliseconds(20));
    }
    return false;
  }

  std::shared_ptr<VirtualReactor> reactor = std::make_shared<VirtualReactor>();
  SimulatedModules modules{reactor->clock};
  TestDaemon daemon;
  std::unique_ptr<RpcClient> client;
};

TEST_F(LineStarts, MotorsOfOneModuleStartWithOneCommand) {
  const auto line = move({"y", "z"}, {60'000, -15'000});
  EXPECT_TRUE(line.at("one_command").as_bool());
  EXPECT_LT(line.at("spread_s").to_number<double>(), 0.01);
  EXPECT_LT(line.at("deviation").to_number<double>(), 0.012);
  EXPECT_LT(setting("z", "max_velocity"), 400) << "a quarter of the way, a quarter of the speed";
  EXPECT_EQ(wait_for("y"), 60'000);
  EXPECT_EQ(wait_for("z"), -15'000);
  EXPECT_TRUE(has_its_settings_again("y"));
  EXPECT_TRUE(has_its_settings_again("z"));
}

TEST_F(LineStarts, MotorsOfSeveralModulesStartInTurn) {
  const auto line = move({"x", "y"}, {30'000, 60'000});
  EXPECT_FALSE(line.at("one_command").as_bool());
  EXPECT_GT(line.at("skew_s").to_number<double>(), 0);
  // At once, along the way back: the settings come back before the next line begins.
  EXPECT_EQ(wait_for("x"), 30'000);
  EXPECT_EQ(wait_for("y"), 60'000);
  move({"x", "y"}, {0, 0});
  EXPECT_EQ(wait_for("x"), 0);
  EXPECT_EQ(wait_for("y"), 0);
  EXPECT_TRUE(has_its_settings_again("x"));
}

TEST_F(LineStarts, AreForeseenAsFarApartAsTheyAre) {
  daemon.wire().delay = milliseconds(6);
  expect_skew_is_foreseen({"x", "y"}, {2000, 4000}, milliseconds(6));
}

TEST_F(LineStarts, AnAxisThatIsTooSlowForItsDividersGetsOthersAndThenItsOwn) {
  const auto pulse = setting("z", "pulse_divisor");
  const auto ramp = setting("z", "ramp_divisor");
  const auto line = move({"y", "z"}, {60'000, 15});
  EXPECT_LT(line.at("spread_s").to_number<double>(), 0.002);
  EXPECT_GT(setting("z", "pulse_divisor"), pulse);
  EXPECT_EQ(wait_for("y"), 60'000);
  EXPECT_EQ(wait_for("z"), 15);
  EXPECT_TRUE(has_its_settings_again("z"));
  EXPECT_EQ(setting("z", "pulse_divisor"), pulse);
  EXPECT_EQ(setting("z", "ramp_divisor"), ramp);
}

TEST_F(LineStarts, AStopOfOneStopsAll) {
  client->result("subscribe", {{"axes", json::array{"x"}}, {"interval_ms", 60'000}});
  move({"x", "y"}, {4'000'000, 2'000'000});
  daemon.run_for(milliseconds(300));
  client->result("axis.stop", {{"axis", "x"}});
  const auto error = client->error("axis.wait", {{"axis", "y"}, {"timeout_ms", 20'000}});
  EXPECT_EQ(error.at("data").at("name"), "move_interrupted");
  while (client->notification("notify_event").at("kind") != "line_broken") {
  }
  EXPECT_TRUE(has_its_settings_again("x"));
  EXPECT_TRUE(has_its_settings_again("y"));
}

TEST_F(LineStarts, AnAxisIsOnOneLineAtATime) {
  move({"y", "z"}, {4'000'000, 2'000'000});
  RpcClient other(daemon.socket());
  const auto error = other.error(
      "line.move", {{"axes", json::array{"x", "z"}}, {"positions_microsteps", json::array{1, 2}}});
  EXPECT_THAT(std::string(error.at("message").as_string()),
              HasSubstr("is on its way along a line"));
  client->result("axis.stop", {{"axis", "y"}});
  EXPECT_TRUE(has_its_settings_again("z"));
}

class LineStartsOnTwoBuses : public LineStarts {
 protected:
  LineStartsOnTwoBuses() : LineStarts("one", "other") {}
};

TEST_F(LineStartsOnTwoBuses, AreForeseenAsFarApartAsTheyAre) {
  daemon.wire("one").delay = milliseconds(3);
  daemon.wire("other").delay = milliseconds(9);
  // x starts after half of its exchange, the last of the others after one and a half: 12 ms apart.
  expect_skew_is_foreseen({"x", "y", "z"}, {2000, 4000, -2000}, milliseconds(12));
}

}  // namespace
}  // namespace tmcld::test
