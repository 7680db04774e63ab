/// Waiting for what another coroutine brings about, by looking at it.
#pragma once

#include <boost/asio/awaitable.hpp>
#include <boost/asio/this_coro.hpp>

#include "async/rest.hpp"

namespace tmcld {

/// Looks every few milliseconds. At least once: what was woken up comes to its end meanwhile.
template <class Condition>
boost::asio::awaitable<void> wait_until(Condition condition, tmcl::Duration at_most) {
  constexpr tmcl::Duration look_interval = std::chrono::milliseconds(5);
  const tmcl::ContextClock clock(co_await boost::asio::this_coro::executor);
  const auto end = clock.now() + at_most;
  do {
    co_await rest(look_interval);
  } while (!condition() && clock.now() < end);
}

}  // namespace tmcld
