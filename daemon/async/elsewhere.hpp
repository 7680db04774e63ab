/// What takes long, on another thread: the reactor goes on meanwhile.
#pragma once

#include <memory>
#include <optional>
#include <type_traits>
#include <utility>

#include <boost/asio/awaitable.hpp>
#include <boost/asio/this_coro.hpp>

#include "async/rest.hpp"
#include "async/workers.hpp"

namespace tmcld {

namespace detail {

template <class Work>
struct Task final : Workers::Job {
  Task(const boost::asio::any_io_executor& executor, Work its_work)
      : Job(executor), does(std::move(its_work)) {}
  void work() override { result.emplace(does()); }

  Work does;
  std::optional<std::invoke_result_t<Work>> result;
};

}  // namespace detail

/// What the function gives, or throws. It must hold all that it needs: the caller may be gone
/// before it ends. In virtual time it is done by the reactor, after the time that it takes there.
template <class Work>
boost::asio::awaitable<std::invoke_result_t<Work>> elsewhere(Workers& workers, Work work) {
  const auto executor = co_await boost::asio::this_coro::executor;
  const tmcl::ContextClock clock(executor);
  if (const auto time = clock.time_for_work()) {
    co_await rest(*time);
    co_return work();
  }
  const auto task = std::make_shared<detail::Task<Work>>(executor, std::move(work));
  workers.begin(task);
  co_await task->end();
  co_return std::move(*task->result);
}

}  // namespace tmcld
