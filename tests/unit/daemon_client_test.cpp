// Clients that do not behave, and what they cost the others: nothing.
#include <gmock/gmock.h>

#include "gateway/poller.hpp"
#include "unit/daemon_fixture.hpp"

namespace tmcld::test {
namespace {

using DaemonClients = DaemonTest;

constexpr auto list_line =
    R"({"jsonrpc":"2.0","id":1,"method":"parameter.list","params":{"axis":"x"}})"
    "\n";

TEST_F(DaemonClients, OneThatNeverReadsIsCutOff) {
  RpcClient deaf(daemon.socket());
  // Answers are some 4 kB long: the socket's buffers fill, then the bound is reached.
  for (int i = 0; i < 2000 && deaf.send_raw(list_line); ++i) {
    if (i % 50 == 0) client.result("axis.list");
  }
  EXPECT_TRUE(deaf.is_cut_off());
  EXPECT_EQ(client.result("axis.list").at("axes").as_array().size(), 2U);
}

TEST_F(DaemonClients, OneThatSendsNoLineEndCostsNoMemory) {
  RpcClient endless(daemon.socket());
  const std::string junk(1 << 20, 'j');
  for (int i = 0; i < 20; ++i) endless.send_raw(junk);
  EXPECT_EQ(text(endless.read().at("error").at("data").at("name")), "line_too_long");
  EXPECT_EQ(endless.read(50), nullptr);  // told once
  endless.send_raw("\n");
  EXPECT_EQ(endless.result("axis.list").at("axes").as_array().size(), 2U);
}

TEST_F(DaemonClients, OneThatGoesWithRequestsInProgressCostsNobodyAnything) {
  daemon.on_reactor([&] { return daemon.wire().holds = true; });
  {
    RpcClient gone(daemon.socket());
    gone.send("axis.get_state", {{"axis", "x"}});
    gone.send("axis.wait", {{"axis", "x"}});
    gone.send("bus.scan");
    gone.send("subscribe");
    ASSERT_TRUE(daemon.eventually([&] { return !daemon.wire().held.empty(); }));
  }
  daemon.on_reactor([&] { return daemon.wire().release(), 0; });
  EXPECT_EQ(client.result("axis.get_state", {{"axis", "x"}}).at("axis"), "x");
  // What the client had begun ends by itself: nothing more is read for it.
  std::size_t before = 0;
  const auto is_quiet = [&] {
    const auto seen = daemon.wire().seen.size();
    return std::exchange(before, seen) == seen;
  };
  bool quiet = false;
  for (int i = 0; i < 100 && !quiet; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    quiet = daemon.on_reactor(is_quiet);
  }
  EXPECT_TRUE(quiet);
}

TEST_F(DaemonClients, OneThatWaitsInVainIsForgottenWhenItGoes) {
  daemon.on_reactor([&] {
    auto& module = daemon.wire().modules.at(1);
    module.parameter(0, 3) = 100;  // it turns, and never arrives
    return module.parameter(0, 8) = 0;
  });
  {
    RpcClient gone(daemon.socket());
    gone.send("axis.wait", {{"axis", "x"}});
    ASSERT_TRUE(daemon.eventually([&] { return daemon.wire().count(tmcl::Command::GAP) > 8; }));
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  const auto before = daemon.requests_seen();
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  EXPECT_EQ(daemon.requests_seen(), before);
}

// ---- subscriptions -----------------------------------------------------------------------------

void turn(TestDaemon& daemon, std::int32_t position) {
  daemon.on_reactor([&] { return daemon.wire().modules.at(1).parameter(0, 1) = position; });
}

TEST_F(DaemonClients, SubscribersAreToldOfChangesOnly) {
  daemon.on_reactor([&] { return daemon.wire().modules.at(1).parameter(0, 154) = 2; });
  turn(daemon, 5);
  const auto answer = client.result("subscribe", {{"axes", json::array{"x"}}, {"interval_ms", 5}});
  EXPECT_EQ(answer.at("subscription"), 1);
  const auto& first = answer.at("states").as_array().at(0);
  EXPECT_EQ(first.at("position_microsteps"), 5);
  const auto seq = first.at("seq").as_int64();
  EXPECT_TRUE(client.notification("notify_state", 60).is_null());
  turn(daemon, 6);
  const auto second = client.notification("notify_state");
  EXPECT_EQ(second.at("position_microsteps"), 6);
  EXPECT_EQ(second.at("seq"), seq + 1);
  EXPECT_EQ(second.at("dropped"), 0);
  EXPECT_EQ(second.at("subscription"), 1);
  client.result("unsubscribe", {{"subscription", 1}});
  turn(daemon, 7);
  EXPECT_TRUE(client.notification("notify_state", 60).is_null());
}

TEST_F(DaemonClients, ManySubscribersCostOnePoller) {
  std::vector<std::unique_ptr<RpcClient>> clients;
  for (int i = 0; i < 20; ++i) {
    clients.push_back(std::make_unique<RpcClient>(daemon.socket()));
    clients.back()->result("subscribe", {{"axes", json::array{"x"}}, {"interval_ms", 100}});
  }
  const auto before = daemon.requests_seen();
  std::this_thread::sleep_for(std::chrono::milliseconds(1000));
  const auto requests = daemon.requests_seen() - before;
  // Four values ten times a second, and a fifth until the divisor is known.
  EXPECT_GE(requests, 4U);
  EXPECT_LE(requests, 5U * 12U);
  turn(daemon, 77);
  for (const auto& each : clients) {
    EXPECT_EQ(each->notification("notify_state").at("position_microsteps"), 77);
  }
}

TEST_F(DaemonClients, TheLastStateReachesSubscribersOfEveryPace) {
  RpcClient fast(daemon.socket());
  fast.result("subscribe", {{"axes", json::array{"x"}}, {"interval_ms", 5}});
  client.result("subscribe", {{"axes", json::array{"x"}}, {"interval_ms", 120}});
  for (int position = 1; position <= 40; ++position) {
    turn(daemon, position);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  int told = 0;
  for (json::value state; state.is_null() || state.at("position_microsteps") != 40; ++told) {
    state = client.notification("notify_state");
    ASSERT_FALSE(state.is_null());
  }
  EXPECT_LE(told, 20);
  json::value state;
  while (state.is_null() || state.at("position_microsteps") != 40) {
    state = fast.notification("notify_state");
    ASSERT_FALSE(state.is_null());
  }
}

TEST_F(DaemonClients, SlowSubscribersGetNewStatesAndACountOfWhatTheyMissed) {
  RpcClient slow(daemon.socket());
  for (std::size_t i = 0; i < max_subscriptions; ++i) {
    slow.result("subscribe", {{"axes", json::array{"x"}}, {"interval_ms", 5}});
  }
  EXPECT_EQ(text(slow.error("subscribe").at("data").at("name")), "too_many_subscriptions");
  // 64 states a round fill the socket's buffers soon.
  std::int32_t position = 0;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(4);
  while (std::chrono::steady_clock::now() < end) {
    turn(daemon, ++position);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  std::uint64_t dropped = 0;
  json::value state;
  do {
    state = slow.notification("notify_state");
    ASSERT_FALSE(state.is_null());
    dropped += static_cast<std::uint64_t>(state.at("dropped").as_int64());
  } while (state.at("position_microsteps") != position);
  EXPECT_GT(dropped, 0U);
}

}  // namespace
}  // namespace tmcld::test
