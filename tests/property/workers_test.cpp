// Work on other threads, where memory runs out at every place that takes some. Sanitizers see to
// memory by operators of their own.
#if !defined(__SANITIZE_ADDRESS__)

#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <new>
#include <optional>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>

#include "async/elsewhere.hpp"
#include "async/spawn.hpp"

namespace tmcld::test {
namespace {

enum class Side { reactor, worker };

// Which allocation fails, of which side; -1: none.
std::atomic<int> failing_at = -1;
std::atomic<Side> failing_side = Side::reactor;
std::atomic<bool> has_failed = false;
thread_local bool is_reactor = false;
thread_local bool counts = false;

bool fails_now() {
  if (!counts || failing_at.load() < 0) return false;
  if (is_reactor != (failing_side.load() == Side::reactor)) return false;
  if (failing_at.fetch_sub(1) != 0) return false;
  has_failed = true;
  return true;
}

}  // namespace
}  // namespace tmcld::test

// Of this test program alone.
void* operator new(std::size_t size) {
  if (tmcld::test::fails_now()) throw std::bad_alloc();
  if (void* memory = std::malloc(size == 0 ? 1 : size)) return memory;
  throw std::bad_alloc();
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return tmcld::test::fails_now() ? nullptr : std::malloc(size == 0 ? 1 : size);
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace tmcld::test {
namespace {

/// A result that takes memory to make, on the worker.
std::string work_of(std::string text) {
  counts = true;
  for (int i = 0; i < 3; ++i) text += text;
  counts = false;
  return text;
}

struct Outcome {
  std::optional<std::string> result;
  std::string thrown;
};

boost::asio::awaitable<void> ask(Workers& workers, Outcome& outcome) {
  try {
    auto work = [text = std::string(100, 'x')] { return work_of(text); };
    counts = true;
    auto result = co_await elsewhere(workers, std::move(work));
    outcome.result = std::move(result);
  } catch (const std::bad_alloc&) {
    outcome.thrown = "bad_alloc";
  }
  counts = false;
}

Outcome run_with_failure(boost::asio::io_context& context, Workers& workers, Side side, int at) {
  is_reactor = true;
  has_failed = false;
  failing_side = side;
  Outcome outcome;
  context.restart();
  spawn(context.get_executor(), ask(workers, outcome));
  failing_at = at;
  context.run();
  failing_at = -1;
  counts = false;
  return outcome;
}

/// Each failure is what the caller sees, and the next one is served.
void expect_answers(Side side) {
  // It outlives the threads: a piece of work may come back after its caller has given up.
  boost::asio::io_context context(1);
  Workers workers(2);
  int failures = 0;
  for (int at = 0; at < 1000; ++at) {
    const auto outcome = run_with_failure(context, workers, side, at);
    ASSERT_NE(outcome.result.has_value(), !outcome.thrown.empty()) << at;
    if (!has_failed) break;
    ++failures;
    EXPECT_EQ(outcome.thrown, "bad_alloc") << at;
  }
  EXPECT_GT(failures, 2);
  const auto after = run_with_failure(context, workers, side, -1);
  EXPECT_EQ(after.result, std::string(800, 'x'));
}

TEST(Workers, WhereTheWorkHasNoMemoryItsCallerIsTold) { expect_answers(Side::worker); }

TEST(Workers, WhereTheReactorHasNoMemoryItsCallerIsTold) { expect_answers(Side::reactor); }

/// Everything of the way to a thread and back but what the work itself does.
TEST(Workers, TakeNoMemoryOnTheThreadOfTheWork) {
  boost::asio::io_context context(1);
  Workers workers(1);
  std::atomic<bool> counted = false;
  is_reactor = true;
  Outcome outcome;
  const auto asks = [&]() -> boost::asio::awaitable<void> {
    // From here on everything on that thread counts, also the way back.
    auto work = [&counted] {
      counts = true;
      counted = true;
      return 1;
    };
    const auto one = co_await elsewhere(workers, work);
    const auto two = co_await elsewhere(workers, work);
    outcome.result = std::to_string(one + two);
  };
  has_failed = false;
  failing_side = Side::worker;
  failing_at = 0;
  spawn(context.get_executor(), asks());
  context.run();
  failing_at = -1;
  EXPECT_TRUE(counted);
  EXPECT_EQ(outcome.result, "2");
  EXPECT_FALSE(has_failed);
}

TEST(Workers, DoWhatWaitsInOrderAndEndWithIt) {
  std::vector<int> done;
  boost::asio::io_context context(1);
  {
    Workers workers(1);
    for (int i = 0; i < 20; ++i) {
      const auto asks = [&, i]() -> boost::asio::awaitable<void> {
        const auto result = co_await elsewhere(workers, [i] { return i; });
        done.push_back(result);
      };
      spawn(context.get_executor(),
            [](auto what) -> boost::asio::awaitable<void> { co_await what(); }(asks));
    }
    context.run();
    workers.join();
  }
  EXPECT_EQ(done.size(), 20U);
  EXPECT_TRUE(std::ranges::is_sorted(done));
}

}  // namespace
}  // namespace tmcld::test

#endif
