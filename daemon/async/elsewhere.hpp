/// What takes long, on another thread: the reactor goes on meanwhile.
#pragma once

#include <memory>
#include <type_traits>
#include <utility>

#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/asio/use_awaitable.hpp>

#include "async/ordinary_priority.hpp"
#include "async/rest.hpp"
#include "async/workers.hpp"

namespace tmcld {

namespace detail {

// Shared: what a coroutine hands over between threads must be default-constructible.
template <class Work>
boost::asio::awaitable<std::shared_ptr<std::invoke_result_t<Work>>> run_now(Work work) {
  take_ordinary_priority();
  co_return std::make_shared<std::invoke_result_t<Work>>(work());
}

}  // namespace detail

/// What the function gives, or throws. It must hold all that it needs: the caller may be gone
/// before it ends. In virtual time it is done by the reactor, after the time that it takes there.
template <class Work>
boost::asio::awaitable<std::invoke_result_t<Work>> elsewhere(Workers& workers, Work work) {
  const tmcl::ContextClock clock(co_await boost::asio::this_coro::executor);
  if (const auto time = clock.time_for_work()) {
    co_await rest(*time);
    co_return work();
  }
  auto result = co_await boost::asio::co_spawn(workers.pool(), detail::run_now(std::move(work)),
                                               boost::asio::use_awaitable);
  co_return std::move(*result);
}

}  // namespace tmcld
