// Timers of one context: in real time and in virtual time.

#include "tmcl/virtual_time.hpp"

#include <gmock/gmock.h>

#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>

#include "tmcl/timer.hpp"

namespace tmcl {
namespace {

namespace asio = boost::asio;
using namespace std::chrono_literals;
using boost::system::error_code;
using testing::ElementsAre;

struct VirtualTimeTest : testing::Test {
  asio::io_context context;
  VirtualTime time{context};
  TimePoint begin = time.now();
  std::vector<int> ended;

  auto note(int number) {
    return [this, number](const error_code& error) { ended.push_back(error ? -number : number); };
  }
};

TEST_F(VirtualTimeTest, NothingHappensBeforeItIsTime) {
  Timer timer(context.get_executor());
  timer.expires_after(1h);
  timer.async_wait(note(1));
  time.run_for(1h - 1ns);
  EXPECT_THAT(ended, ElementsAre());
  time.run_for(1ns);
  EXPECT_THAT(ended, ElementsAre(1));
  EXPECT_EQ(timer.now(), begin + 1h);
  EXPECT_EQ(now(context.get_executor()), begin + 1h);
}

TEST_F(VirtualTimeTest, EqualTimesEndInTheOrderInWhichTheyWereSet) {
  Timer one(context.get_executor()), two(context.get_executor()), three(context.get_executor());
  three.expires_after(5ms);
  one.expires_after(5ms);
  two.expires_after(4ms);
  one.async_wait(note(1));
  two.async_wait(note(2));
  three.async_wait(note(3));
  time.run_for(5ms);
  EXPECT_THAT(ended, ElementsAre(2, 1, 3));
}

TEST_F(VirtualTimeTest, AWaitIsEndedByCancelByANewTimeAndByTheEndOfTheTimer) {
  Timer timer(context.get_executor());
  timer.expires_after(1s);
  timer.async_wait(note(1));
  timer.cancel();
  EXPECT_THAT(ended, ElementsAre()) << "in a turn of its own";
  time.settle();
  EXPECT_THAT(ended, ElementsAre(-1));
  timer.async_wait(note(2));
  timer.expires_after(2s);
  timer.async_wait(note(3));
  {
    Timer short_lived(context.get_executor());
    short_lived.expires_after(1s);
    short_lived.async_wait(note(4));
  }
  time.run_for(2s);
  EXPECT_THAT(ended, ElementsAre(-1, -2, -4, 3));
  timer.cancel();
  time.settle();
  EXPECT_THAT(ended, ElementsAre(-1, -2, -4, 3));
}

TEST_F(VirtualTimeTest, CoroutinesWait) {
  const auto walk = [this](int number, Duration pace) -> asio::awaitable<void> {
    Timer timer(co_await asio::this_coro::executor);
    for (int i = 0; i < 2; ++i) {
      timer.expires_after(pace);
      co_await timer.async_wait(asio::use_awaitable);
      ended.push_back(number);
    }
  };
  asio::co_spawn(context, walk(1, 2s), asio::detached);
  asio::co_spawn(context, walk(2, 3s), asio::detached);
  EXPECT_TRUE(time.run_while_not([&] { return ended.size() == 4; }, 1h));
  EXPECT_THAT(ended, ElementsAre(1, 2, 1, 2));
  EXPECT_EQ(time.now(), begin + 6s);
}

TEST_F(VirtualTimeTest, StandsStillAsSoonAsWhatIsWaitedForHasCome) {
  Timer timer(context.get_executor()), later(context.get_executor());
  timer.expires_after(1s);
  timer.async_wait(note(1));
  later.expires_after(2s);
  later.async_wait(note(2));
  EXPECT_TRUE(time.run_while_not([&] { return !ended.empty(); }, 1h));
  EXPECT_EQ(time.now(), begin + 1s);
  EXPECT_THAT(ended, ElementsAre(1));
}

TEST_F(VirtualTimeTest, WhoeverWaitsUntilTheEndOfTimeKeepsNobody) {
  Timer timer(context.get_executor());
  timer.expires_at(TimePoint::max());
  timer.async_wait(note(1));
  EXPECT_FALSE(time.step());
  EXPECT_FALSE(time.run_while_not([] { return false; }, 1h));
  timer.cancel();
  time.settle();
  EXPECT_THAT(ended, ElementsAre(-1));
}

TEST_F(VirtualTimeTest, WorkTakesAsLongAsTheOwnerOfTheClockSays) {
  const ContextClock clock(context);
  EXPECT_EQ(clock.time_for_work(), Duration{});
  time.set_time_for_work([] { return Duration(3ms); });
  EXPECT_EQ(clock.time_for_work(), 3ms);
}

TEST(VirtualTimeEnd, WhoeverStillWaitsIsForgottenAndNotRun) {
  bool ran = false;
  auto alive = std::make_shared<int>();
  {
    asio::io_context context;
    VirtualTime time(context);
    const auto wait = [&ran](std::shared_ptr<int> held) -> asio::awaitable<void> {
      Timer timer(co_await asio::this_coro::executor);
      Timer other(co_await asio::this_coro::executor);
      other.expires_after(1h);
      other.async_wait([held, &ran](const error_code&) { ran = true; });
      timer.expires_after(2h);
      error_code error;
      co_await timer.async_wait(asio::redirect_error(asio::use_awaitable, error));
      ran = true;
    };
    asio::co_spawn(context, wait(alive), asio::detached);
    time.settle();
    EXPECT_EQ(alive.use_count(), 3);
  }
  EXPECT_FALSE(ran);
  EXPECT_EQ(alive.use_count(), 1);
}

TEST(RealTime, TimersGoByTheComputersClock) {
  asio::io_context context;
  Timer timer(context.get_executor());
  const auto begin = timer.now();
  EXPECT_FALSE(ContextClock(context).time_for_work());
  timer.expires_after(2ms);
  error_code ended, cancelled;
  timer.async_wait([&](const error_code& error) { ended = error; });
  Timer other(context.get_executor());
  other.expires_after(1h);
  other.async_wait([&](const error_code& error) { cancelled = error; });
  other.cancel();
  context.run();
  EXPECT_FALSE(ended);
  EXPECT_EQ(cancelled, asio::error::operation_aborted);
  EXPECT_GE(timer.now(), begin + 2ms);
}

}  // namespace
}  // namespace tmcl
