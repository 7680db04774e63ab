// Exceptions, wherever they come from: one that a call throws is its answer, and one that nobody
// can answer ends the daemon as it should end, with all axes stopped.
#include <boost/asio/post.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <filesystem>
#include <new>
#include <stdexcept>

#include <gmock/gmock.h>

#include "async/elsewhere.hpp"
#include "async/gather.hpp"
#include "async/spawn.hpp"
#include "unit/threaded_daemon.hpp"
#include "unit/throwing_peer.hpp"

namespace tmcld::test {
namespace {

using boost::asio::awaitable;
using testing::HasSubstr;
using tmcl::Command;

// ---- what coroutines are made of ---------------------------------------------------------------

/// Runs a coroutine to its end; what it threw, in words.
std::string thrown_by(awaitable<void> task) {
  boost::asio::io_context context;
  std::string what;
  spawn(context.get_executor(), std::move(task),
        [&](const std::exception_ptr& failure) { what = what_of(failure); });
  context.run();
  return what;
}

TEST(DaemonAsync, WhatIsThrownElsewhereIsThrownHere) {
  Workers pool(1);
  const auto fails = [&](auto work) -> awaitable<void> {
    co_await elsewhere(pool, std::move(work));
  };
  EXPECT_EQ(thrown_by(fails([]() -> int { throw std::bad_alloc(); })), "not enough memory");
  EXPECT_EQ(thrown_by(fails([]() -> int { throw std::runtime_error("injected"); })), "injected");
  EXPECT_EQ(thrown_by(fails([]() -> int { throw 1; })), "an exception that says nothing");
  EXPECT_EQ(thrown_by(fails([] { return 1; })), "");
}

awaitable<int> one(int& ended, bool throws) {
  boost::asio::steady_timer timer(co_await boost::asio::this_coro::executor);
  timer.expires_after(std::chrono::milliseconds(throws ? 0 : 1));
  co_await timer.async_wait(boost::asio::use_awaitable);
  ++ended;
  if (throws) throw std::runtime_error("injected");
  co_return 1;
}

TEST(DaemonAsync, GatherEndsWhenAllHaveAndThrowsWhatOneThrew) {
  int ended = 0;
  int seen = 0;
  const auto gathers = [&]() -> awaitable<void> {
    std::vector<awaitable<int>> tasks;
    for (int i = 0; i < 3; ++i) tasks.push_back(one(ended, i == 1));
    try {
      co_await gather(std::move(tasks));
    } catch (...) {
      seen = ended;
      throw;
    }
  };
  EXPECT_EQ(thrown_by(gathers()), "injected");
  EXPECT_EQ(seen, 3);
}

awaitable<void> throw_later() {
  co_await boost::asio::post(boost::asio::use_awaitable);
  throw std::runtime_error("injected");
}

TEST(DaemonAsync, WhatNobodyWaitsForThrowsOutOfTheReactor) {
  boost::asio::io_context context;
  spawn(context.get_executor(), throw_later());
  EXPECT_THROW(context.run(), std::runtime_error);
}

// ---- calls -------------------------------------------------------------------------------------

class DaemonFailure : public DaemonTest {
 protected:
  Error error_for(const std::string& method, json::object params) {
    const auto result = dispatch_for(daemon, std::make_shared<ThrowingPeer>(0), method, params);
    EXPECT_FALSE(result) << method;
    return result ? Error{} : result.error();
  }
};

TEST_F(DaemonFailure, OfACallIsItsAnswer) {
  const auto error = error_for("subscribe", {});
  EXPECT_EQ(to_json(error).at("code"), -32603);
  EXPECT_EQ(error.name, "internal_error");
  EXPECT_EQ(error.outcome, tmcl::Outcome::unknown);
  EXPECT_THAT(error.message, HasSubstr("subscribe"));
  EXPECT_THAT(error.message, HasSubstr("not enough memory"));
  EXPECT_EQ(client.result("axis.get_state", {{"axis", "x"}}).at("axis"), "x");
}

// The bus, its engine and the module are as they were.
TEST_F(DaemonFailure, InAVerbEndsThatVerbOnly) {
  const auto error = error_for("bus.scan", {{"last", 2}});
  EXPECT_EQ(error.name, "internal_error");
  EXPECT_EQ(client.result("axis.move_to", {{"axis", "x"}, {"position_microsteps", 5}})
                .at("target_microsteps"),
            5);
}

// ---- the reactor -------------------------------------------------------------------------------

// Their stops are counted: a reply that a busy machine delays must not have one repeated.
constexpr std::string_view patient_bus = R"(
[[bus]]
name = "bench"
link = "serial:/dev/none@115200"
reply_timeout_ms = 10000
)";
constexpr std::string_view other_bus = R"(
[[bus]]
name = "other"
link = "serial:/dev/other@115200"
reply_timeout_ms = 10000
[[axis]]
name = "far"
bus = "other"
address = 1
motor = 0
)";

class ReactorFailure : public testing::Test {
 protected:
  ThreadedDaemon daemon{"on_exit = \"keep\"\n" + std::string(patient_bus) + axis_section("x", 0) +
                        axis_section("y", 1) + std::string(other_bus)};

  /// Each axis is stopped at once, and then each motor of the module; clients that wait are told.
  void expect_an_orderly_end(RpcClient& client, int waiting) {
    constexpr std::size_t axes = 2, motors = 3;
    EXPECT_FALSE(daemon.ends_well());
    EXPECT_EQ(daemon.wire().count(Command::MST), axes + motors);
    EXPECT_TRUE(client.answer_to(waiting).contains("error"));
    EXPECT_TRUE(client.is_cut_off());
    EXPECT_FALSE(std::filesystem::exists(daemon.socket().path));
  }
  int begin_to_wait(RpcClient& client) {
    daemon.on_reactor([&] {
      auto& module = daemon.wire().modules.at(1);
      module.parameter(0, 3) = 100;  // it turns, and never arrives
      return module.parameter(0, 8) = 0;
    });
    return client.send("axis.wait", {{"axis", "x"}});
  }
};

TEST_F(ReactorFailure, StopsAllAxesAndEnds) {
  daemon.start();
  RpcClient client(daemon.socket());
  const int waiting = begin_to_wait(client);
  boost::asio::post(daemon.daemon().context(), [] { throw std::runtime_error("injected"); });
  expect_an_orderly_end(client, waiting);
  EXPECT_EQ(daemon.wire("other").count(Command::MST), 1U + 3U);
}

TEST_F(ReactorFailure, AtTheEndDoesNotKeepItFromEnding) {
  daemon.start();
  RpcClient client(daemon.socket());
  const int waiting = begin_to_wait(client);
  boost::asio::post(daemon.daemon().context(), [this] {
    for (int i = 0; i < 3; ++i)
      boost::asio::post(daemon.daemon().context(), [] { throw std::runtime_error("another"); });
    throw std::runtime_error("injected");
  });
  expect_an_orderly_end(client, waiting);
}

TEST_F(ReactorFailure, OfALinkThatThrowsWhenItIsOpened) {
  daemon.start();
  RpcClient client(daemon.socket());
  const int waiting = begin_to_wait(client);
  daemon.on_reactor([&] {
    daemon.wire("other").throws = true;
    daemon.wire("other").unplug();
    return 0;
  });
  expect_an_orderly_end(client, waiting);
}

TEST_F(ReactorFailure, IsNoneInAnOrdinaryEnd) {
  daemon.start();
  daemon.daemon().stop();
  EXPECT_TRUE(daemon.ends_well());
  EXPECT_EQ(daemon.wire().count(Command::MST), 0U);
}

}  // namespace
}  // namespace tmcld::test
