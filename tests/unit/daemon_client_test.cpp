// Clients that do not behave, and what they cost the others: nothing.
#include <map>

#include <gmock/gmock.h>

#include "api/subscriptions.hpp"
#include "gateway/axis/poller.hpp"
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

std::string requests(std::string_view method, std::size_t count, std::size_t first_id = 0) {
  std::string lines;
  for (auto id = first_id; id < first_id + count; ++id) {
    lines += R"({"jsonrpc":"2.0","id":)" + std::to_string(id) + R"(,"method":")" +
             std::string(method) + "\"}\n";
  }
  return lines;
}

/// Reads so many answers; how many of each kind there are, "" being a result.
std::map<std::string, std::size_t> kinds_of_answers(RpcClient& from, std::size_t count) {
  std::map<std::string, std::size_t> kinds;
  while (count > 0) {
    const auto answer = from.read();
    if (!answer.is_object()) break;
    if (answer.as_object().contains("method")) continue;
    --count;
    const auto* error = answer.as_object().if_contains("error");
    ++kinds[error == nullptr ? "" : text(error->at("data").at("name"))];
  }
  return kinds;
}

TEST_F(DaemonClients, OneThatReadsGetsAsManyLongAnswersAsItMayAskForAtOnce) {
  // Each is some 40 kB long: together far more than may be left unread.
  for (int round = 0; round < 3; ++round) {
    client.send_raw(requests("rpc.discover", max_requests_in_flight));
    EXPECT_EQ(kinds_of_answers(client, max_requests_in_flight)[""], max_requests_in_flight);
  }
}

TEST_F(DaemonClients, OneThatReadsIsNotCutOffForAskingTooMuchAtOnce) {
  constexpr std::size_t count = 4 * max_requests_in_flight;
  client.send_raw(requests("rpc.discover", count));
  auto kinds = kinds_of_answers(client, count);
  EXPECT_GE(kinds[""], max_requests_in_flight);
  EXPECT_EQ(kinds[""] + kinds["too_many_requests"], count);
}

TEST_F(DaemonClients, AStopBehindAFloodThatIsNotReadIsServed) {
  client.send_raw(requests("rpc.discover", max_requests_in_flight - 1, 1000));
  const auto move =
      client.send("axis.move_to", {{"axis", "x"}, {"position_microsteps", 1}, {"predict", false}});
  const auto stop = client.send("axis.stop", {{"axis", "x"}});
  ASSERT_TRUE(daemon.eventually([&] { return daemon.wire().count(tmcl::Command::MST) == 1; }));
  EXPECT_TRUE(client.answer_to(stop).contains("result"));
  client.answer_to(move);
  // Nor does the movement wait, and go out after it.
  const auto last = daemon.on_reactor([&] { return daemon.wire().seen.back().command; });
  EXPECT_EQ(last, tmcl::Command::MST);
}

TEST_F(DaemonClients, AMovementBehindLongAnswersGoesOutAtOnce) {
  client.send_raw(requests("rpc.discover", max_requests_in_flight - 1, 1000));
  const auto move =
      client.send("axis.move_to", {{"axis", "x"}, {"position_microsteps", 1}, {"predict", false}});
  ASSERT_TRUE(daemon.eventually([&] { return daemon.wire().count(tmcl::Command::MVP) == 1; }));
  EXPECT_TRUE(client.answer_to(move).contains("result"));
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
    daemon.run_for(std::chrono::milliseconds(100));
    quiet = daemon.on_reactor(is_quiet);
  }
  EXPECT_TRUE(quiet);
}

TEST_F(DaemonClients, OneThatWaitsInVainIsForgottenWhenItGoes) {
  // A call that is in progress holds its axis.
  const auto users_of_x = [&] { return daemon.daemon().gateway().axes().front().use_count(); };
  const auto before = daemon.on_reactor(users_of_x);
  daemon.on_reactor([&] {
    auto& module = daemon.wire().modules.at(1);
    module.parameter(0, 3) = 100;  // it turns, and never arrives
    return module.parameter(0, 8) = 0;
  });
  {
    RpcClient gone(daemon.socket());
    gone.send("axis.wait", {{"axis", "x"}});
    ASSERT_TRUE(daemon.eventually([&] { return daemon.wire().count(tmcl::Command::GAP) > 8; }));
    EXPECT_GT(daemon.on_reactor(users_of_x), before);
  }
  EXPECT_TRUE(daemon.eventually([&] { return users_of_x() == before; }));
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
  // A look reads the position.
  std::vector<tmcl::TimePoint> looks;
  daemon.wire().modules.at(1).before = [&](FakeModule&, const tmcl::Request& request) {
    if (request.command == tmcl::Command::GAP && request.type == 1) looks.push_back(daemon.now());
  };
  ASSERT_TRUE(daemon.eventually([&] { return looks.size() >= 11; }));
  daemon.wire().modules.at(1).before = {};
  for (std::size_t i = 1; i < looks.size(); ++i)
    EXPECT_EQ(looks[i] - looks[i - 1], std::chrono::milliseconds(100));
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
    daemon.run_for(std::chrono::milliseconds(5));
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

TEST_F(DaemonClients, NoneHasMoreSubscriptionsThanItMayHoweverItAsks) {
  constexpr std::size_t before = max_subscriptions - 1;
  for (std::size_t i = 0; i < before; ++i) client.result("subscribe");
  // They wait for the same answer of the module.
  client.send_raw(requests("subscribe", 60, 1000));
  auto kinds = kinds_of_answers(client, 60);
  EXPECT_EQ(kinds[""], max_subscriptions - before);
  EXPECT_EQ(kinds["too_many_subscriptions"], 60 - (max_subscriptions - before));
}

TEST_F(DaemonClients, SubscriptionsTakeTurns) {
  daemon.on_reactor([&] { return daemon.wire().modules.at(1).parameter(0, 154) = 2; });
  // One state after the other, each for two subscriptions, of which one is told each time.
  turn(daemon, 1);
  int offers = 0;
  std::vector<std::int64_t> told;
  const auto watching = daemon.on_reactor([&] {
    auto both = std::make_shared<Subscriptions>([&] { ++offers; });
    const auto axis = daemon.daemon().gateway().find_axis("x");
    for (int i = 0; i < 2; ++i) both->add({{axis, {}}}, {shortest_poll_interval});
    return both;
  });
  for (int position = 1; position <= 8; ++position) {
    turn(daemon, position);
    ASSERT_TRUE(daemon.eventually([&] { return offers >= 2 * position; }));
    const auto state = daemon.on_reactor([&] { return *watching->take_pending(); });
    told.push_back(state.at("subscription").to_number<std::int64_t>());
    EXPECT_EQ(state.at("position_microsteps"), position);
  }
  EXPECT_THAT(told, testing::ElementsAre(1, 2, 1, 2, 1, 2, 1, 2));
  daemon.on_reactor([&] { return watching->clear(), 0; });
}

TEST_F(DaemonClients, SlowSubscribersGetNewStatesAndACountOfWhatTheyMissed) {
  RpcClient slow(daemon.socket());
  for (std::size_t i = 0; i < max_subscriptions; ++i) {
    slow.result("subscribe", {{"axes", json::array{"x"}}, {"interval_ms", 5}});
  }
  EXPECT_EQ(text(slow.error("subscribe").at("data").at("name")), "too_many_subscriptions");
  // 64 states a round fill the socket's buffers soon.
  std::int32_t position = 0;
  const auto end = daemon.now() + std::chrono::seconds(4);
  while (daemon.now() < end) {
    turn(daemon, ++position);
    daemon.run_for(std::chrono::milliseconds(2));
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
