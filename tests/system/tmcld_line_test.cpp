// Several axes on a straight line, through the daemon, on simulated modules.
#include <gmock/gmock.h>

#include "tmcld_fixture.hpp"

namespace tmcl::test {
namespace {

namespace json = boost::json;
using testing::HasSubstr;

class TmcldLine : public TmcldTest {
 protected:
  void SetUp() override {
    start_simulator_on_pty();
    write_config(pty_link());
    start_daemon();
    client = std::make_unique<RpcClient>(socket());
  }

  json::object move(json::array axes, json::array positions) {
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
  void set_answer_pause(int module, int milliseconds, const std::string& bus = "bench") {
    constexpr int telegram_pause_time = 75;
    client->result("module.execute", {{"bus", bus},
                                      {"address", module},
                                      {"command", "SGP"},
                                      {"type", telegram_pause_time},
                                      {"motor", 0},
                                      {"value", milliseconds}});
  }
  // Whoever takes the processor away in the moment of the starts cannot be foreseen. A line always
  // takes the same exchanges, so the fastest ones are those to which that has not happened.
  void expect_skew_is_foreseen(const json::array& axes, const json::array& there,
                               std::chrono::duration<double> exchange) {
    struct Measured {
      std::chrono::duration<double> took;
      double skew, predicted;
    };
    constexpr int lines = 12;
    constexpr double tolerance = 0.2;
    json::array back(there.size(), 0);
    std::vector<Measured> all;
    for (int i = 0; i < lines; ++i) {
      const auto begin = std::chrono::steady_clock::now();
      const auto line = move(axes, i % 2 == 0 ? there : back);
      all.push_back({std::chrono::steady_clock::now() - begin,
                     line.at("skew_s").to_number<double>(),
                     line.at("predicted_skew_s").to_number<double>()});
      for (const auto& axis : axes) wait_for(std::string(axis.as_string()));
    }
    const auto fastest = std::ranges::min(all, {}, &Measured::took).took;
    for (const auto& line : all) {
      SCOPED_TRACE("took " + std::to_string(line.took.count()) + " s");
      EXPECT_GE(line.predicted, exchange.count());
      EXPECT_GE(line.skew, exchange.count());
      if (line.took > fastest + tolerance * exchange) continue;
      EXPECT_NEAR(line.predicted, line.skew, tolerance * line.skew);
    }
  }
  // The settings are set back when all of them stand.
  bool has_its_settings_again(const std::string& axis) {
    for (int i = 0; i < 200; ++i) {
      if (setting(axis, "max_velocity") == 1000 && setting(axis, "max_acceleration") == 500)
        return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return false;
  }

  std::unique_ptr<RpcClient> client;
};

TEST_F(TmcldLine, MotorsOfOneModuleStartWithOneCommand) {
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

TEST_F(TmcldLine, MotorsOfSeveralModulesStartInTurn) {
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

// Modules that wait so long with their answers make a wire that is as slow.
TEST_F(TmcldLine, ForeseesHowFarApartTheStartsAre) {
  for (const int module : {1, 2}) set_answer_pause(module, 6);
  expect_skew_is_foreseen({"x", "y"}, {2000, 4000}, std::chrono::milliseconds(6));
}

TEST_F(TmcldLine, AnAxisThatIsTooSlowForItsDividersGetsOthersAndThenItsOwn) {
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

TEST_F(TmcldLine, AStopOfOneStopsAll) {
  client->result("subscribe", {{"axes", json::array{"x"}}, {"interval_ms", 60'000}});
  move({"x", "y"}, {4'000'000, 2'000'000});
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  client->result("axis.stop", {{"axis", "x"}});
  const auto error = client->error("axis.wait", {{"axis", "y"}, {"timeout_ms", 20'000}});
  EXPECT_EQ(error.at("data").at("name"), "move_interrupted");
  while (client->notification("notify_event").at("kind") != "line_broken") {
  }
  EXPECT_TRUE(has_its_settings_again("x"));
  EXPECT_TRUE(has_its_settings_again("y"));
}

TEST_F(TmcldLine, AnAxisIsOnOneLineAtATime) {
  move({"y", "z"}, {4'000'000, 2'000'000});
  RpcClient other(socket());
  const auto error = other.error(
      "line.move", {{"axes", json::array{"x", "z"}}, {"positions_microsteps", json::array{1, 2}}});
  EXPECT_THAT(std::string(error.at("message").as_string()),
              HasSubstr("is on its way along a line"));
  client->result("axis.stop", {{"axis", "y"}});
  EXPECT_TRUE(has_its_settings_again("z"));
}

TEST_F(TmcldLine, IfOneIsRefusedNoneMoves) {
  const auto refused = [&](json::array axes, json::array positions) {
    const auto error =
        client->error("line.move", {{"axes", axes}, {"positions_microsteps", positions}});
    return std::string(error.at("message").as_string());
  };
  EXPECT_THAT(refused({"y", "z"}, {1000, 9'000'000}), HasSubstr("8388607"));
  EXPECT_THAT(refused({"y", "z"}, {8'000'000, 1}), HasSubstr("too slow for its registers"));
  EXPECT_THAT(refused({"y", "z"}, {1000}), HasSubstr("one position for each axis"));
  EXPECT_THAT(refused({"y", "y"}, {1000, 2000}), HasSubstr("each axis once"));
  for (const auto* axis : {"y", "z"}) {
    EXPECT_EQ(client->result("axis.get_state", {{"axis", axis}}).at("position_microsteps"), 0);
    EXPECT_TRUE(has_its_settings_again(axis));
  }
}

/// Module 1 with x on one pty, module 2 with y and z on another one.
class TmcldLineOnTwoBuses : public TmcldLine {
 protected:
  void SetUp() override {
    start_simulator({"--pty", path("pty1"), "--pty", path("pty2")});
    std::ofstream file(config());
    file << "[daemon]\nsocket = \"" << socket() << "\"\n";
    for (const std::string number : {"1", "2"}) {
      file << "[[bus]]\nname = \"bus" << number << "\"\nlink = \"serial:" << path("pty" + number)
           << "@115200\"\nreply_timeout_ms = 1000\n";
    }
    const auto add = [&](const char* name, int module, int motor) {
      file << "[[axis]]\nname = \"" << name << "\"\nbus = \"bus" << module
           << "\"\naddress = " << module << "\nmotor = " << motor << '\n';
    };
    add("x", 1, 0);
    add("y", 2, 0);
    add("z", 2, 1);
    file.close();
    start_daemon();
    client = std::make_unique<RpcClient>(socket());
  }
};

TEST_F(TmcldLineOnTwoBuses, ForeseesHowFarApartTheStartsAre) {
  set_answer_pause(1, 3, "bus1");
  set_answer_pause(2, 9, "bus2");
  // x starts after half of its exchange, the last of the others after one and a half: 12 ms apart,
  // of which the slow exchange is 9.
  expect_skew_is_foreseen({"x", "y", "z"}, {2000, 4000, -2000}, std::chrono::milliseconds(9));
}

}  // namespace
}  // namespace tmcl::test
