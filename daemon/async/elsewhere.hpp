/// What takes long, on another thread: the reactor goes on meanwhile.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>

#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/asio/use_awaitable.hpp>

#include "async/ordinary_priority.hpp"
#include "async/rest.hpp"

namespace tmcld {

/// Threads for such work; they begin when there is some.
class Workers {
 public:
  explicit Workers(std::size_t threads) : threads_(threads) {}

  boost::asio::thread_pool& pool() { return pool_ ? *pool_ : pool_.emplace(threads_); }
  /// Waits for what is being done. To be called when no more is asked for.
  void join() {
    if (pool_) pool_->join();
  }

 private:
  std::size_t threads_;
  std::optional<boost::asio::thread_pool> pool_;
};

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
