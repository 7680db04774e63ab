// What happens beside a path: links that are lost, modules that fall silent, others who want the
// reactor and the bus.
#include "gateway/link_patience.hpp"
#include "unit/daemon_path_fixture.hpp"

namespace tmcld::test {
namespace {

using testing::HasSubstr;

TEST_F(DaemonPath, ALinkThatComesBackIsUsedToStop) {
  const auto id = client->send("path.run", order(long_way));
  ASSERT_TRUE(until_x_is_beyond(2));
  daemon.on_reactor([&] {
    daemon.wire().unplug();
    return 0;
  });
  const auto error = error_of(id);
  EXPECT_EQ(name_in(error), "command_failed");
  EXPECT_TRUE(error.at("data").at("run").at("remarks").as_array().empty())
      << json::serialize(error);
  expect_rest_and_own_settings();
}

TEST_F(DaemonPath, ALinkThatComesBackIsUsedToSetBack) {
  const auto id = client->send("path.run", order(long_way, {{"mode", "position"}}));
  ASSERT_TRUE(until_x_is_beyond(2));
  bool stopped = false;
  bool lost = false;
  on_module([&](Played& played) {
    played.before = [&](const tmcl::Request& request) {
      stopped = stopped || request.command == Command::MST;
      if (!stopped || lost || request.command != Command::SAP) return;
      lost = true;
      boost::asio::post(daemon.daemon().context(), [&] { daemon.wire().unplug(); });
    };
    return 0;
  });
  RpcClient other(daemon.socket());
  other.result("path.stop");
  EXPECT_TRUE(error_of(id).at("data").at("run").at("remarks").as_array().empty());
  EXPECT_TRUE(on_module([&](Played&) { return lost; }));
  expect_rest_and_own_settings();
  on_module([](Played& played) { return played.before = {}, 0; });
}

class DaemonPathWithoutLink : public DaemonPath {
 protected:
  void lose_link() {
    daemon.on_reactor([&] {
      daemon.wire().is_absent = true;
      return daemon.wire().unplug(), 0;
    });
  }
  static constexpr const char* both_may_move =
      "axis 'x' could not be stopped and may still move; "
      "axis 'y' could not be stopped and may still move";
};

TEST_F(DaemonPathWithoutLink, NobodyIsToldThatItsAxesStand) {
  RpcClient watching(daemon.socket());
  watching.result("subscribe", {{"axes", json::array{}}});
  RpcClient other(daemon.socket());
  const auto id = client->send("path.run", order(long_way));
  ASSERT_TRUE(until_x_is_beyond(2));
  lose_link();
  const auto asked = std::chrono::steady_clock::now();
  const auto stop = other.error("path.stop");
  EXPECT_LT(std::chrono::steady_clock::now() - asked, time_for_link * 3 / 2) << "waited once";
  EXPECT_EQ(name_in(stop), "not_stopped");
  EXPECT_EQ(text(stop.at("message")), both_may_move);
  EXPECT_EQ(text(stop.at("data").at("outcome")), "unknown");
  EXPECT_EQ(json::serialize(stop.at("data").at("unstopped")), R"(["x","y"])");

  const auto run = error_of(id);
  EXPECT_THAT(text(run.at("message")), HasSubstr(both_may_move));
  EXPECT_THAT(text(run.at("data").at("hint")), testing::Not(HasSubstr("were stopped")));
  EXPECT_EQ(text(run.at("data").at("outcome")), "unknown");
  EXPECT_EQ(json::serialize(run.at("data").at("unstopped")), R"(["x","y"])");

  auto news = watching.notification("notify_event");
  while (text(news.at("kind")) != "path_broken") news = watching.notification("notify_event");
  EXPECT_THAT(text(news.at("text")), HasSubstr(both_may_move));
  EXPECT_THAT(text(news.at("text")), testing::Not(HasSubstr("\n"))) << "a log has lines";
}

TEST_F(DaemonPathWithoutLink, ALinkThatComesBackLateIsUsedToStop) {
  const auto id = client->send("path.run", order("G1 X1000 Y500 F1200\n"));
  ASSERT_TRUE(until_x_is_beyond(2));
  lose_link();
  error_of(id);
  EXPECT_TRUE(on_module([](Played& played) { return played.moves(); }));
  client->result("subscribe", {{"axes", json::array{}}});
  daemon.on_reactor([&] { return daemon.wire().is_absent = false; });
  while (text(client->notification("notify_event").at("text")) != "axis 'x' could be stopped now") {
  }
  EXPECT_TRUE(daemon.eventually([&] { return !module.moves(); }));
}

TEST_F(DaemonPath, ASilentModuleIsTold) {
  const auto id = client->send("path.run", order(long_way));
  ASSERT_TRUE(until_x_is_beyond(2));
  daemon.on_reactor([&] {
    daemon.wire().holds = true;
    return 0;
  });
  const auto error = error_of(id);
  EXPECT_EQ(name_in(error), "command_failed");
  EXPECT_THAT(json::serialize(error.at("data").at("run").at("remarks")),
              HasSubstr("x could not be stopped"));
}

}  // namespace
}  // namespace tmcld::test
