// The two buses, on Asio and blocking, on a real link with a responder behind it.

#include "tmcl/bus.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/socket.h>

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>

#include "support/pty.hpp"
#include "support/responder.hpp"
#include "tmcl/blocking.hpp"

namespace tmcl {
namespace {

namespace asio = boost::asio;
using namespace std::chrono_literals;

Link open(const test::Pty& pty) {
  return std::move(*Link::open("serial:" + pty.path() + "@115200"));
}

/// Runs a coroutine to its end.
template <class Body>
void run(Body body) {
  asio::io_context context;
  bool ended = false;
  asio::co_spawn(
      context,
      [&]() -> asio::awaitable<void> {
        co_await body(context);
        ended = true;
      },
      asio::detached);
  context.run();
  EXPECT_TRUE(ended);
}

TEST(BlockingBus, RunsVerbs) {
  const test::Pty pty;
  const test::Responder responder(pty.master());
  blocking::Bus bus(open(pty));
  auto module = bus.module(ModuleAddress{1});
  EXPECT_EQ(module.axis(0).get(4), 0);
  EXPECT_EQ(module.axis(0).move_to(Microsteps{500}), Microsteps{500});
  const auto found = module.identify();
  ASSERT_TRUE(found);
  EXPECT_EQ(found->model, "TMCM-3110");
}

TEST(BlockingBus, ALostLinkEndsTheCallAndEveryLaterOne) {
  test::Pty pty;
  blocking::Bus bus(open(pty));
  std::vector<BusEvent::Kind> events;
  bus.on_event([&](const BusEvent& event) { events.push_back(event.kind); });
  pty.hang_up();
  const auto first = bus.module(ModuleAddress{1}).axis(0).position();
  ASSERT_FALSE(first);
  EXPECT_EQ(first.error().code, Errc::link_lost);
  EXPECT_FALSE(bus.is_open());
  const auto second = bus.module(ModuleAddress{1}).axis(0).position();
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().outcome, Outcome::not_sent);
  EXPECT_THAT(events, testing::ElementsAre(BusEvent::Kind::link_lost));
}

TEST(BlockingBus, SilenceEndsInATimeoutThatNamesTheBus) {
  const test::Pty pty;
  blocking::Bus bus(open(pty), {.name = "bench", .reply_timeout = 10ms, .attempts = 1});
  const auto position = bus.module(ModuleAddress{1}).axis(0).position();
  ASSERT_FALSE(position);
  EXPECT_EQ(position.error().code, Errc::reply_timeout);
  EXPECT_EQ(position.error().bus, "bench");
}

TEST(AsioBus, RunsVerbsSideBySide) {
  const test::Pty pty;
  const test::Responder responder(pty.master());
  run([&](asio::io_context& context) -> asio::awaitable<void> {
    Bus bus(context.get_executor(), open(pty));
    auto axis = bus.module(ModuleAddress{1}).axis(0);
    int ended = 0;
    for (int i = 0; i < 20; ++i) {
      asio::co_spawn(
          context,
          [axis, i, &ended]() mutable -> asio::awaitable<void> {
            const auto target = co_await axis.move_to(Microsteps{i});
            EXPECT_EQ(target, Microsteps{i});
            ++ended;
          },
          asio::detached);
    }
    const auto moved = co_await axis.move_by(Microsteps{7});
    EXPECT_EQ(moved, Microsteps{7});
    while (ended < 20) {
      asio::steady_timer timer(context, 1ms);
      co_await timer.async_wait(asio::use_awaitable);
    }
  });
}

TEST(AsioBus, ClosingItEndsWhatIsInProgress) {
  const test::Pty pty;
  run([&](asio::io_context& context) -> asio::awaitable<void> {
    auto bus = std::make_unique<Bus>(context.get_executor(), open(pty));
    asio::co_spawn(
        context,
        [&]() -> asio::awaitable<void> {
          asio::steady_timer timer(context, 5ms);
          co_await timer.async_wait(asio::use_awaitable);
          bus.reset();
        },
        asio::detached);
    const auto moved = co_await bus->module(ModuleAddress{1}).axis(0).move_to(Microsteps{7});
    EXPECT_FALSE(moved);
    EXPECT_EQ(moved.error().code, Errc::link_lost);
    EXPECT_EQ(moved.error().outcome, Outcome::unknown);
  });
}

Script<Result<void>> wait_for(Duration time) {
  co_await pause(time);
  co_return Result<void>{};
}

TEST(AsioBus, TheLinkCanBeOpenedAgainAsSoonAsItIsClosed) {
  const test::Pty pty;
  run([&](asio::io_context& context) -> asio::awaitable<void> {
    Bus bus(context.get_executor(), open(pty));
    // A verb that knows nothing of it yet, and keeps what it needs.
    asio::co_spawn(context, bus.run(wait_for(50ms)), asio::detached);
    asio::co_spawn(context, bus.module(ModuleAddress{1}).axis(0).position(), asio::detached);
    co_await asio::post(context, asio::use_awaitable);
    bus.close();
    const auto again = Link::open("serial:" + pty.path() + "@115200");
    EXPECT_TRUE(again) << describe(again.error());
    bus.close();
  });
}

TEST(BlockingBus, ALostLinkLetsGoOfThePort) {
  int ends[2];
  ASSERT_EQ(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends), 0);
  const auto far = Link::adopt(ends[1], Framing::serial, "far");
  blocking::Bus bus(Link::adopt(ends[0], Framing::serial, "near"));
  shutdown(ends[1], SHUT_WR);
  EXPECT_FALSE(bus.module(ModuleAddress{1}).axis(0).position());
  EXPECT_EQ(fcntl(ends[0], F_GETFD), -1);
}

TEST(AsioBus, ALostLinkIsAnEvent) {
  test::Pty pty;
  run([&](asio::io_context& context) -> asio::awaitable<void> {
    Bus bus(context.get_executor(), open(pty));
    bool lost = false;
    bus.on_event([&](const BusEvent& event) { lost = event.kind == BusEvent::Kind::link_lost; });
    pty.hang_up();
    for (int i = 0; i < 200 && !lost; ++i) {
      asio::steady_timer timer(context, 1ms);
      co_await timer.async_wait(asio::use_awaitable);
    }
    EXPECT_TRUE(lost);
    EXPECT_FALSE(bus.is_open());
  });
}

TEST(AsioBus, TimesOutWhenNobodyAnswers) {
  const test::Pty pty;
  run([&](asio::io_context& context) -> asio::awaitable<void> {
    Bus bus(context.get_executor(), open(pty), {.reply_timeout = 10ms});
    const auto moved = co_await bus.module(ModuleAddress{1}).axis(0).move_to(Microsteps{7});
    EXPECT_FALSE(moved);
    EXPECT_EQ(moved.error().code, Errc::reply_timeout);
    const auto silent = co_await bus.module(ModuleAddress{1}).axis(0).position();
    EXPECT_EQ(silent.error().code, Errc::module_silent);
  });
}

}  // namespace
}  // namespace tmcl
