// Where the configuration wants it, a single move needs a lease of its axis.
#include <gmock/gmock.h>

#include "unit/daemon_moves_fixture.hpp"

namespace tmcld::test {
namespace {

class MovesNeedLease : public testing::Test {
 protected:
  MovesNeedLease() {
    module_.be_played_by(daemon_.wire().modules.at(1));
    daemon_.start();
    client = std::make_unique<RpcClient>(daemon_.socket());
    other = std::make_unique<RpcClient>(daemon_.socket());
  }
  static std::string error_name(RpcClient& client, const MovingExample& example) {
    json::object answer;
    for (const auto& step : example.steps) answer = client.call(step.method, step.params);
    return answer.contains("error") ? text(answer.at("error").at("data").at("name")) : "";
  }
  static void acquire(RpcClient& client) {
    client.result("lease.acquire", {{"axes", json::array{"x", "y"}}, {"ttl_ms", 60'000}});
  }

 private:
  std::shared_ptr<VirtualReactor> reactor_ = std::make_shared<VirtualReactor>();
  SimulatedModule module_{reactor_->clock};
  TestDaemon daemon_{"moves_need_lease = true\n" + axes_x_and_y(Limits::none), reactor_};

 protected:
  std::unique_ptr<RpcClient> client;
  std::unique_ptr<RpcClient> other;
};

bool is_journey(const MovingExample& example) {
  const auto& method = example.steps.front().method;
  return method == "line.move" || method == "path.run" || method == "mint.run";
}

TEST_F(MovesNeedLease, AreRefusedWithoutOne) {
  for (const auto& example : moving_examples()) {
    // A jog has taken one.
    if (is_journey(example) || example.method() == "axis.jog") continue;
    EXPECT_EQ(error_name(*client, example), "not_permitted") << testing::PrintToString(example);
  }
  const auto answer = client->call("axis.move_to", {{"axis", "x"}, {"position_microsteps", 1}});
  EXPECT_THAT(text(answer.at("error").at("data").at("hint")),
              testing::HasSubstr("tmclctl lease run x"));
}

TEST_F(MovesNeedLease, SettingsDoNot) {
  EXPECT_EQ(error_name(*client,
                       {{{"parameter.set", {{"axis", "x"}, {"parameter", 4}, {"value", 1000}}}}}),
            "");
}

TEST_F(MovesNeedLease, GoWithOne) {
  acquire(*client);
  EXPECT_EQ(error_name(*client, {{{"axis.move_to", {{"axis", "x"}, {"position_microsteps", 1}}}}}),
            "");
  EXPECT_EQ(error_name(*client, {{{"axis.rotate", {{"axis", "y"}, {"velocity_internal", 9}}}}}),
            "");
  EXPECT_EQ(error_name(*other, {{{"axis.move_to", {{"axis", "x"}, {"position_microsteps", 1}}}}}),
            "leased");
}

TEST_F(MovesNeedLease, LinesAndPathsNeedNone) {
  EXPECT_EQ(error_name(*client, {{{"line.move",
                                   {{"axes", json::array{"x", "y"}},
                                    {"positions_microsteps", json::array{512, 256}}}}}}),
            "");
  EXPECT_EQ(error_name(*client, {{{"axis.wait", {{"axis", "x"}}}}}), "");
  EXPECT_EQ(error_name(*client, {{{"axis.wait", {{"axis", "y"}}}}}), "");
  EXPECT_EQ(error_name(
                *client,
                {{{"path.run",
                   {{"axes", json::array{"x", "y"}}, {"text", "G1 X20 Y10 F1200\nG1 X40 Y0\n"}}}}}),
            "");
}

}  // namespace
}  // namespace tmcld::test
