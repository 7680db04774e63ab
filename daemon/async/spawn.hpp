/// Starts a coroutine without waiting for it.
#pragma once

#include <exception>
#include <utility>

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/post.hpp>

namespace tmcld {

/// `on_failure` is given what the coroutine throws.
template <class OnFailure>
void spawn(const boost::asio::any_io_executor& executor, boost::asio::awaitable<void> task,
           OnFailure on_failure) {
  boost::asio::co_spawn(
      executor, std::move(task),
      [on_failure = std::move(on_failure)](const std::exception_ptr& failure) mutable {
        if (failure) on_failure(failure);
      });
}

/// What it throws comes out of the reactor's run(), where the daemon sees to it: Asio's `detached`
/// would drop it without a word. In a turn of its own, so that it does not tear down the coroutine
/// that woke this one up.
inline void spawn(const boost::asio::any_io_executor& executor, boost::asio::awaitable<void> task) {
  spawn(executor, std::move(task), [executor](const std::exception_ptr& failure) {
    boost::asio::post(executor, [failure] { std::rethrow_exception(failure); });
  });
}

}  // namespace tmcld
