// A stop always wins: over what is queued, over the second half of a verb, over a client's own
// flood, and over a module that has not said yet what it is.
#include <gmock/gmock.h>

#include "async/spawn.hpp"
#include "unit/daemon_moves_fixture.hpp"

namespace tmcld::test {
namespace {

using tmcl::Command;

std::string name_in(const json::object& answer) {
  return text(answer.at("error").at("data").at("name"));
}

class DaemonStop : public DaemonTest {
 protected:
  void hold() {
    daemon.on_reactor([&] { return daemon.wire().holds = true; });
  }
  void release() {
    daemon.on_reactor([&] { return daemon.wire().release(), 0; });
  }
  void wait_for_held(std::size_t count) {
    ASSERT_TRUE(daemon.eventually([&] { return daemon.wire().held.size() >= count; }));
  }
};

TEST_F(DaemonStop, OvertakesAndEndsQueuedMovements) {
  hold();
  const auto read = client.send("parameter.get", {{"axis", "x"}, {"parameter", 4}});
  wait_for_held(1);
  const auto moves =
      client.send("axis.move_to", {{"axis", "x"}, {"position_microsteps", 1}, {"predict", false}});
  const auto other =
      client.send("axis.move_to", {{"axis", "y"}, {"position_microsteps", 2}, {"predict", false}});
  const auto stop = client.send("axis.stop", {{"axis", "x"}});
  EXPECT_EQ(name_in(client.answer_to(moves)), "superseded_by_stop");
  release();
  client.answer_to(read);
  EXPECT_TRUE(client.answer_to(stop).contains("result"));
  EXPECT_TRUE(client.answer_to(other).contains("result"));
  const auto order = daemon.on_reactor([&] {
    std::vector<Command> commands;
    for (const auto& request : daemon.wire().seen) commands.push_back(request.command);
    return commands;
  });
  ASSERT_GE(order.size(), 2U);
  EXPECT_EQ(order[order.size() - 2], Command::MST);
  EXPECT_EQ(order.back(), Command::MVP);
}

TEST_F(DaemonStop, EndsAMoveThatIsBeingPredicted) {
  hold();
  const auto move = client.send("axis.move_to", {{"axis", "x"}, {"position_microsteps", 1}});
  wait_for_held(1);
  RpcClient other(daemon.socket());
  const auto stop = other.send("axis.stop", {{"axis", "x"}});
  ASSERT_TRUE(daemon.eventually([&] { return daemon.daemon().gateway().stops_in_progress == 1; }));
  release();
  EXPECT_TRUE(other.answer_to(stop).contains("result"));
  EXPECT_EQ(name_in(client.answer_to(move)), "superseded_by_stop");
  EXPECT_EQ(daemon.requests_seen(Command::MVP), 0U);
}

TEST_F(DaemonStop, EndsAMoveByBetweenItsHalves) {
  hold();
  const auto move = client.send("axis.move_by", {{"axis", "x"}, {"distance_microsteps", 1}});
  wait_for_held(1);
  RpcClient other(daemon.socket());
  const auto stop = other.send("axis.stop", {{"axis", "x"}});
  ASSERT_TRUE(daemon.eventually([&] { return daemon.daemon().gateway().stops_in_progress == 1; }));
  release();
  EXPECT_TRUE(other.answer_to(stop).contains("result"));
  const auto answer = client.answer_to(move);
  EXPECT_EQ(name_in(answer), "superseded_by_stop");
  EXPECT_EQ(text(answer.at("error").at("data").at("outcome")), "not_sent");
  EXPECT_EQ(daemon.requests_seen(Command::MVP), 0U);
}

TEST_F(DaemonStop, StopAllEndsMovementsOfEveryAxis) {
  hold();
  const auto x = client.send("axis.move_by", {{"axis", "x"}, {"distance_microsteps", 1}});
  const auto y = client.send("axis.rotate", {{"axis", "y"}, {"velocity_internal", 5}});
  wait_for_held(1);
  const auto stop = client.send("system.stop_all");
  ASSERT_TRUE(daemon.eventually([&] { return daemon.daemon().gateway().stops_in_progress == 1; }));
  release();
  const auto stopped = client.answer_to(stop).at("result").at("stopped").as_array();
  // The module has a motor besides these.
  EXPECT_EQ(stopped.size(), 3U);
  EXPECT_EQ(name_in(client.answer_to(x)), "superseded_by_stop");
  // The turn was on the wire already, or it never went out.
  const auto turned = client.answer_to(y);
  EXPECT_TRUE(turned.contains("result") || name_in(turned) == "superseded_by_stop");
  EXPECT_EQ(daemon.requests_seen(Command::MVP), 0U);
  EXPECT_EQ(daemon.requests_seen(Command::MST), 3U);
}

TEST_F(DaemonStop, RawStopEndsMovementsToo) {
  hold();
  const auto move = client.send("axis.move_by", {{"axis", "x"}, {"distance_microsteps", 1}});
  wait_for_held(1);
  const auto stop =
      client.send("module.execute", {{"bus", "bench"}, {"address", 1}, {"command", "MST"}});
  ASSERT_TRUE(daemon.eventually([&] { return daemon.daemon().gateway().stops_in_progress == 1; }));
  release();
  EXPECT_TRUE(client.answer_to(stop).contains("result"));
  EXPECT_EQ(name_in(client.answer_to(move)), "superseded_by_stop");
  EXPECT_EQ(daemon.requests_seen(Command::MVP), 0U);
}

TEST_F(DaemonStop, StopAllEndsRawMovementsOfMotorsWithoutAnAxis) {
  hold();
  const auto read = client.send("parameter.get", {{"axis", "x"}, {"parameter", 4}});
  wait_for_held(1);
  const auto move = client.send(
      "module.execute", {{"bus", "bench"}, {"address", 1}, {"command", "ROR"}, {"motor", 2}});
  const auto stop = client.send("system.stop_all");
  EXPECT_EQ(name_in(client.answer_to(move)), "superseded_by_stop");
  release();
  client.answer_to(read);
  EXPECT_TRUE(client.answer_to(stop).contains("result"));
  EXPECT_EQ(daemon.requests_seen(Command::ROR), 0U);
  EXPECT_EQ(daemon.requests_seen(Command::MST), 3U);
}

boost::asio::awaitable<void> move_another_module(std::shared_ptr<GatewayBus> bus,
                                                 RunOptions options) {
  auto script = tmcl::verbs::move_to({tmcl::ModuleAddress{7}, 0}, {5});
  co_await bus->run(std::move(script), std::move(options));
}

TEST_F(DaemonStop, StopAllDoesNotStopWhatWasGivenUpBeforeItWasSent) {
  const auto bus = daemon.daemon().gateway().buses()[0];
  daemon.on_reactor([&] {
    RunOptions options;
    options.permit = daemon.daemon().gateway().admit();
    options.objection = [] { return std::optional(tmcl::bad_argument("the client is gone")); };
    spawn(bus->executor(), move_another_module(bus, std::move(options)));
    return 0;
  });
  EXPECT_EQ(client.result("system.stop_all").at("failed").as_array().size(), 0U);
  EXPECT_EQ(daemon.requests_seen(Command::MST), 3U);
}

TEST_F(DaemonStop, GetsThroughAClientsOwnFlood) {
  const auto before = daemon.requests_seen();
  hold();
  std::vector<int> flood;
  for (std::size_t i = 0; i < max_requests_in_flight + 5; ++i) {
    flood.push_back(client.send("parameter.get", {{"axis", "x"}, {"parameter", i}}));
  }
  for (std::size_t i = max_requests_in_flight; i < flood.size(); ++i) {
    EXPECT_EQ(name_in(client.answer_to(flood[i])), "too_many_requests");
  }
  const auto stop = client.send("axis.stop", {{"axis", "x"}});
  ASSERT_TRUE(daemon.eventually([&] { return daemon.daemon().gateway().stops_in_progress == 1; }));
  release();
  EXPECT_TRUE(client.answer_to(stop).contains("result"));
  // One read was on the wire before it, and none of the others.
  const auto second = daemon.on_reactor([&] { return daemon.wire().seen.at(before + 1).command; });
  EXPECT_EQ(second, Command::MST);
}

// The daemon may have to wait for somebody else's path.
TEST(DaemonStopAtTheEnd, WhatIsInPreparationDoesNotStart) {
  for (const auto* method : {"line.move", "axis.move_to"}) {
    MovesBench bench;
    bench.daemon.on_reactor([&] { return bench.daemon.wire().holds = true; });
    const auto id = method == std::string("line.move")
                        ? bench.client->send(method, {{"axes", json::array{"x", "y"}},
                                                      {"positions", json::array{5, 3}}})
                        : bench.client->send(method, {{"axis", "x"}, {"position", 5}});
    ASSERT_TRUE(bench.daemon.eventually([&] { return !bench.daemon.wire().held.empty(); }));
    bench.daemon.on_reactor([&] {
      bench.daemon.daemon().gateway().refuse_new_calls();
      bench.daemon.wire().release();
      return 0;
    });
    const auto answer = bench.client->answer_to(id);
    EXPECT_EQ(name_in(answer), "daemon_ending") << method;
    EXPECT_EQ(answer.at("error").at("code"), -32002);
    EXPECT_EQ(bench.daemon.requests_seen(Command::MVP), 0U);
  }
}

TEST(DaemonStopEarly, GoesOutToAModuleThatHasNotSaidWhatItIs) {
  TestDaemon daemon;
  daemon.wire().holds = true;
  daemon.start(false);
  RpcClient client(daemon.socket());
  ASSERT_TRUE(daemon.eventually([&] { return !daemon.wire().held.empty(); }));
  const auto move = client.send("axis.move_to", {{"axis", "x"}, {"position_microsteps", 1}});
  const auto stop = client.send("axis.stop", {{"axis", "x"}});
  ASSERT_TRUE(daemon.eventually([&] { return daemon.daemon().gateway().stops_in_progress == 1; }));
  daemon.on_reactor([&] { return daemon.wire().release(), 0; });
  EXPECT_TRUE(client.answer_to(stop).contains("result"));
  EXPECT_EQ(name_in(client.answer_to(move)), "superseded_by_stop");
  EXPECT_EQ(daemon.requests_seen(Command::MVP), 0U);
}

}  // namespace
}  // namespace tmcld::test
