/// Several coroutines at once.
#pragma once

#include <cstddef>
#include <exception>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <boost/asio/this_coro.hpp>

#include "async/spawn.hpp"
#include "async/wake.hpp"

namespace tmcld {

namespace detail {

template <class T>
struct Gathering {
  Gathering(const boost::asio::any_io_executor& executor, std::size_t count)
      : results(count), running(count), ended(executor) {}
  std::vector<std::optional<T>> results;
  std::exception_ptr failure;  ///< Of the first that threw.
  std::size_t running;
  Wake ended;
  void end_one() {
    if (--running == 0) ended.notify();
  }
};

template <class T>
boost::asio::awaitable<void> run_one(std::shared_ptr<Gathering<T>> all, std::size_t index,
                                     boost::asio::awaitable<T> task) {
  auto result = co_await std::move(task);
  all->results[index].emplace(std::move(result));
  all->end_one();
}

}  // namespace detail

/// Runs all of them and gives their results in order when the last one has ended; throws then, if
/// one of them did.
template <class T>
boost::asio::awaitable<std::vector<T>> gather(std::vector<boost::asio::awaitable<T>> tasks) {
  const auto executor = co_await boost::asio::this_coro::executor;
  const auto all = std::make_shared<detail::Gathering<T>>(executor, tasks.size());
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    auto one = detail::run_one(all, i, std::move(tasks[i]));
    spawn(executor, std::move(one), [all](const std::exception_ptr& failure) {
      if (!all->failure) all->failure = failure;
      all->end_one();
    });
  }
  while (all->running > 0) co_await all->ended.wait();
  if (all->failure) std::rethrow_exception(all->failure);
  std::vector<T> results;
  results.reserve(all->results.size());
  for (auto& result : all->results) results.push_back(std::move(*result));
  co_return results;
}

}  // namespace tmcld
