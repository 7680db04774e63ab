// What several wait for, where there is no memory to give it to each.
#include <gtest/gtest.h>

#include <chrono>

#include "async/rest.hpp"
#include "async/shared_work.hpp"
#include "async/spawn.hpp"
#include "memory/allocations.hpp"
#include "tmcl/virtual_time.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using boost::asio::awaitable;
using tmcl::Result;

awaitable<Result<void>> fail_later() {
  co_await rest(1s);
  co_return tl::unexpected(
      tmcl::bad_argument("a message that is too long to be kept without memory of its own"));
}

awaitable<void> wait_for(SharedWork<Result<void>>& work, int& told) {
  const auto failed = co_await work.join([] { return fail_later(); });
  if (!failed) ++told;
}

TEST(MemoryOfSharedWork, ThatIsMissingIsTold) {
  for (std::uint64_t n = 1;; ++n) {
    boost::asio::io_context context(1);
    tmcl::VirtualTime time(context);
    SharedWork<Result<void>> work;
    int told = 0;
    int thrown = 0;
    for (int i = 0; i < 3; ++i)
      spawn(context.get_executor(), wait_for(work, told), [&](const auto&) { ++thrown; });
    time.settle();
    try {
      const Watched watched;
      fail_allocation(n);
      time.run_for(2s);
    } catch (const std::bad_alloc&) {
      ++thrown;
    }
    const bool has_failed = end_failures();
    time.run_for(10s);  // nothing is under way when the context goes
    if (!has_failed) {
      EXPECT_EQ(told, 3);
      EXPECT_GT(n, 3U);
      return;
    }
    EXPECT_GE(thrown, 1) << n;
  }
}

}  // namespace
}  // namespace tmcld::test
