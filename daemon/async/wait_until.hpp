/// Waiting for what somebody else brings about, by looking at it.
#pragma once

#include <chrono>

#include <boost/asio/awaitable.hpp>

#include "async/rest.hpp"

namespace tmcld {

/// Looks every few milliseconds. At least once: whoever was woken up comes to an end meanwhile.
template <class Condition>
boost::asio::awaitable<void> wait_until(Condition condition, tmcl::Duration at_most) {
  constexpr tmcl::Duration look_interval = std::chrono::milliseconds(5);
  const auto end = std::chrono::steady_clock::now() + at_most;
  do {
    co_await rest(look_interval);
  } while (!condition() && std::chrono::steady_clock::now() < end);
}

}  // namespace tmcld
