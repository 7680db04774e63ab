// The two buses, on Asio and blocking, on a real link with a responder behind it.

#include "tmcl/bus.hpp"

#include <array>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
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

/// Takes what is sent to it, and answers nothing.
class SilentConverter {
 public:
  SilentConverter() : listener_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    address_.sin_family = AF_INET;
    address_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address_;
    const bool listens =
        bind(listener_, reinterpret_cast<const sockaddr*>(&address_), sizeof address_) == 0 &&
        listen(listener_, 1) == 0 &&
        getsockname(listener_, reinterpret_cast<sockaddr*>(&address_), &size) == 0;
    if (!listens) throw std::runtime_error("cannot listen");
  }
  SilentConverter(const SilentConverter&) = delete;
  SilentConverter& operator=(const SilentConverter&) = delete;
  ~SilentConverter() { ::close(listener_); }
  std::string link() const { return "tcp:127.0.0.1:" + std::to_string(ntohs(address_.sin_port)); }
  /// With what reading from the connection ends; 0 if that was in order.
  int how_it_ended() const {
    const int caller = accept(listener_, nullptr, nullptr);
    std::array<char, 64> bytes{};
    while (::read(caller, bytes.data(), bytes.size()) > 0) {
    }
    const int error = errno;
    ::close(caller);
    return error;
  }

 private:
  int listener_;
  sockaddr_in address_{};
};

// It would go out when the network comes back, long after somebody wanted it.
TEST(BlockingBus, AMovementWithoutAnAnswerEndsATcpConnection) {
  const SilentConverter converter;
  BusOptions options;
  options.reply_timeout = 20ms;
  blocking::Bus bus(*Link::open(converter.link()), options);
  auto axis = bus.module(ModuleAddress{1}).axis(0);
  auto other = bus.module(ModuleAddress{2}).axis(0);
  EXPECT_NE(other.get(4).error().code, Errc::link_lost);
  ASSERT_TRUE(bus.is_open()) << "of a question it does not matter";
  const auto moved = axis.rotate({100});
  EXPECT_EQ(moved.error().outcome, Outcome::unknown);
  ASSERT_FALSE(bus.is_open());
  EXPECT_EQ(axis.get(4).error().code, Errc::link_lost);
  EXPECT_EQ(converter.how_it_ended(), ECONNRESET);
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
