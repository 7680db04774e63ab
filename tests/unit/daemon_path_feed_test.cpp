// Paths that the daemon passes, slowed down, sped up and held by its clients.
#include "tmcl/plan/path_preparation.hpp"
#include "unit/daemon_path_fixture.hpp"

namespace tmcld::test {
namespace {

using testing::HasSubstr;

const std::string longest_way = "G1 X20 Y10 F600\nG1 X40 Y0\nG1 X20 Y-10\nG1 X0 Y0\n";

class DaemonPathFeed : public DaemonPath {
 protected:
  json::object feed(json::object params, RpcClient& by) {
    params["axes"] = json::array{"y"};
    return by.result("path.feed", params).at("paths").as_array().front().as_object();
  }
  json::object feed(json::object params) { return feed(std::move(params), *client); }
  json::object status() {
    const auto paths = client->result("path.status").at("paths").as_array();
    return paths.empty() ? json::object{} : paths.front().as_object();
  }
  double number(const json::object& object, const char* name) {
    return object.at(name).to_number<double>();
  }
  void let_pass(int ms) { daemon.run_for(std::chrono::milliseconds(ms)); }
};

class DaemonPathFeedInEachMode : public DaemonPathFeed,
                                 public testing::WithParamInterface<const char*> {};

TEST_P(DaemonPathFeedInEachMode, AnOverrideSlowsThePathDownAndUpAgain) {
  const auto id =
      client->send("path.run", order(longest_way, {{"mode", GetParam()}, {"name", "part.ngc"}}));
  ASSERT_TRUE(until_x_is_beyond(2));
  const auto told = feed({{"factor", 0.5}});
  EXPECT_EQ(number(told, "factor"), 0.5);
  EXPECT_GT(number(told, "factor_now"), 0.5);
  let_pass(400);
  const auto slow = status();
  EXPECT_EQ(json::serialize(slow.at("axes")), R"(["x","y"])");
  EXPECT_EQ(text(slow.at("name")), "part.ngc");
  EXPECT_EQ(text(slow.at("mode")), GetParam());
  EXPECT_EQ(text(slow.at("phase")), "running");
  EXPECT_EQ(slow.at("line").as_int64(), 1);
  EXPECT_FALSE(slow.at("held").as_bool());
  EXPECT_EQ(number(slow, "factor_now"), 0.5);
  EXPECT_NEAR(number(slow, "planned_feed"), 10, 1e-6);
  EXPECT_NEAR(number(slow, "feed"), 5, 1e-6);
  EXPECT_NEAR(number(slow, "done"), number(slow, "passed_s") / number(slow, "duration_s"), 1e-9);
  EXPECT_NEAR(number(slow, "left_s"), 2 * (number(slow, "duration_s") - number(slow, "passed_s")),
              1e-6);
  EXPECT_LT(number(slow, "off_path"), 0.05);
  const double before = mm(0);
  let_pass(200);
  EXPECT_NEAR(mm(0) - before, 0.2 * 5 * 2 / std::sqrt(5.0), 0.1);
  feed({{"factor", 1}});
  const auto report = client->answer_to(id).at("result").as_object();
  EXPECT_LT(number(report, "off_path"), 0.1);
  EXPECT_EQ(mm(0), 0);
  EXPECT_EQ(mm(1), 0);
  expect_rest_and_own_settings();
}

TEST_P(DaemonPathFeedInEachMode, TheTimeThatIsLeftIsWhatItTakes) {
  const auto id = client->send("path.run", order(longest_way, {{"mode", GetParam()}}));
  ASSERT_TRUE(until_x_is_beyond(2));
  feed({{"factor", 0.4}});
  let_pass(400);
  const double left = number(status(), "left_s");
  let_pass(static_cast<int>(1000 * left) - 60);
  EXPECT_EQ(text(status().at("phase")), "running");
  let_pass(120);
  const auto over = status();
  EXPECT_TRUE(over.empty() || text(over.at("phase")) == "ending");
  EXPECT_TRUE(client->answer_to(id).contains("result"));
}

TEST_P(DaemonPathFeedInEachMode, AHoldStandsOnThePathUntilItIsOver) {
  const auto id = client->send("path.run", order(longest_way, {{"mode", GetParam()}}));
  ASSERT_TRUE(until_x_is_beyond(2));
  EXPECT_TRUE(feed({{"hold", true}}).at("held").as_bool());
  ASSERT_TRUE(daemon.eventually([&] { return !module.moves(); }));
  let_pass(3000);
  const auto held = status();
  EXPECT_TRUE(held.at("left_s").is_null());
  EXPECT_EQ(number(held, "feed"), 0);
  EXPECT_EQ(text(held.at("phase")), "pausing");
  EXPECT_LT(std::abs(mm(0) - 2 * mm(1)) / std::sqrt(5.0), 0.05) << "the tolerance of the path";
  // What it goes on with may be said while it stands.
  feed({{"factor", 0.5}});
  EXPECT_FALSE(module.moves());
  EXPECT_FALSE(feed({{"hold", false}}).at("held").as_bool());
  EXPECT_TRUE(client->answer_to(id).contains("result"));
  EXPECT_EQ(mm(0), 0);
  expect_rest_and_own_settings();
}

TEST_P(DaemonPathFeedInEachMode, AStopWinsOverAHold) {
  RpcClient other(daemon.socket());
  const auto id = client->send("path.run", order(longest_way, {{"mode", GetParam()}}));
  ASSERT_TRUE(until_x_is_beyond(2));
  feed({{"hold", true}});
  ASSERT_TRUE(daemon.eventually([&] { return !module.moves(); }));
  other.result("axis.stop", {{"axis", "y"}});
  EXPECT_EQ(name_in(error_of(id)), "stopped_by_other");
  expect_rest_and_own_settings();
}

INSTANTIATE_TEST_SUITE_P(Modes, DaemonPathFeedInEachMode, testing::Values("velocity", "segments"),
                         [](const auto& mode) { return std::string(mode.param); });

// 20 mm/s are the most that the path was given; it is planned with half of that.
TEST_F(DaemonPathFeed, WhatIsAskedForIsToldApartFromWhatThereIs) {
  const auto id = client->send("path.run", order(longest_way, {{"velocity", 15}}));
  ASSERT_TRUE(until_x_is_beyond(2));
  feed({{"factor", 2}});
  let_pass(300);
  const auto fast = status();
  EXPECT_EQ(number(fast, "factor"), 2);
  // x makes 2 of sqrt(5) parts of the speed.
  const double of_limit = 1 - tmcl::plan::spare_velocity;
  EXPECT_NEAR(number(fast, "factor_now"), of_limit * 1.5 * std::sqrt(5.0) / 2, 0.001);
  EXPECT_TRUE(client->answer_to(id).contains("result"));
  EXPECT_EQ(mm(0), 0);
  expect_rest_and_own_settings();
}

TEST_F(DaemonPathFeed, PositionModeIsHeldWhereThePathStandsAndTakesNoOverride) {
  const auto id = client->send("path.run", order("G61.1\n" + longest_way, {{"mode", "position"}}));
  ASSERT_TRUE(until_x_is_beyond(2));
  const auto error = client->error("path.feed", {{"axes", json::array{"x"}}, {"factor", 0.5}});
  EXPECT_EQ(name_in(error), "wrong_mode");
  EXPECT_THAT(text(error.at("data").at("hint")), HasSubstr("velocity and segments"));
  feed({{"hold", true}});
  ASSERT_TRUE(daemon.eventually([&] { return !module.moves(); }));
  EXPECT_EQ(mm(0), 20);
  EXPECT_TRUE(status().at("held").as_bool());
  feed({{"hold", false}});
  EXPECT_TRUE(client->answer_to(id).contains("result"));
  EXPECT_EQ(mm(0), 0);
}

TEST_F(DaemonPathFeed, WhatMakesALeasedAxisFasterIsForItsHolder) {
  RpcClient other(daemon.socket());
  client->result("lease.acquire", {{"axes", json::array{"x"}}, {"ttl_ms", 60'000}});
  const auto id = client->send("path.run", order(longest_way));
  ASSERT_TRUE(until_x_is_beyond(2));
  EXPECT_EQ(number(feed({{"factor", 0.5}}, other), "factor"), 0.5);
  EXPECT_TRUE(feed({{"hold", true}}, other).at("held").as_bool());
  const auto refused = [&](const char* method, json::object params) {
    params["axes"] = json::array{"y"};
    const auto error = other.error(method, params);
    EXPECT_EQ(name_in(error), "leased") << method;
    EXPECT_THAT(text(error.at("data").at("hint")), HasSubstr("any may slow it down"));
  };
  refused("path.feed", {{"hold", false}});
  refused("path.feed", {{"factor", 0.6}});
  refused("path.resume", {});
  EXPECT_TRUE(status().at("held").as_bool());
  EXPECT_EQ(number(status(), "factor"), 0.5);
  feed({{"hold", false}, {"factor", 1}});
  EXPECT_TRUE(client->answer_to(id).contains("result"));
}

// A hold keeps no axis: what the lease is for, ends with it.
TEST_F(DaemonPathFeed, ALeaseThatIsLostWhileItIsHeldStopsThePath) {
  auto holder = std::make_unique<RpcClient>(daemon.socket());
  holder->result("lease.acquire", {{"axes", json::array{"x", "y"}}, {"ttl_ms", 60'000}});
  holder->send("path.run", order(longest_way));
  ASSERT_TRUE(until_x_is_beyond(2));
  feed({{"hold", true}});
  ASSERT_TRUE(daemon.eventually([&] { return !module.moves(); }));
  holder.reset();
  EXPECT_TRUE(daemon.eventually(
      [&] { return daemon.daemon().gateway().axes().front()->journey() == nullptr; }));
  expect_rest_and_own_settings();
}

TEST_F(DaemonPathFeed, BadRequestsAreNamedAndChangeNothing) {
  const auto none = client->error("path.feed", {{"axes", json::array{"x"}}, {"hold", true}});
  EXPECT_EQ(name_in(none), "no_path");
  EXPECT_EQ(json::serialize(client->result("path.status")), R"({"paths":[]})");
  const auto id = client->send("path.run", order(longest_way));
  ASSERT_TRUE(until_x_is_beyond(1));
  EXPECT_EQ(name_in(client->error("path.feed", {})), "bad_argument");
  for (const double factor : {-1.0, 0.0, 0.09, 2.1, 1e300}) {
    const auto error = client->error("path.feed", {{"factor", factor}});
    EXPECT_EQ(name_in(error), "out_of_range") << factor;
  }
  EXPECT_EQ(number(status(), "factor"), 1);
  EXPECT_TRUE(client->answer_to(id).contains("result"));
}

}  // namespace
}  // namespace tmcld::test
