/// Work whose result many coroutines want at once.
#pragma once

#include <exception>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <boost/asio/awaitable.hpp>
#include <boost/asio/this_coro.hpp>

#include "async/wake.hpp"
#include "tmcl/result_copy.hpp"

namespace tmcld {

/// Done once for all of them: one run at a time, and one more for all who ask meanwhile.
template <class T>
class SharedWork {
 public:
  bool in_progress() const { return current_ != nullptr; }

  /// The result of a run that begins after this was called, by the first that asked. Of a run that
  /// throws, all waiters get the exception.
  template <class Work>
  boost::asio::awaitable<T> begin(Work work) {
    if (const auto next = next_) {
      co_await next->end();
      co_return next->found();
    }
    const auto run = std::make_shared<Run>();
    const auto before = current_;
    (before ? next_ : current_) = run;
    const Ending ending(*this, run);
    if (before) co_await before->end();
    try {
      run->result.emplace(co_await work());
    } catch (...) {
      run->failure = std::current_exception();
    }
    co_return run->found();
  }

  /// The result of the run in progress, else of a new one.
  template <class Work>
  boost::asio::awaitable<T> join(Work work) {
    if (const auto run = current_) {
      co_await run->end();
      co_return run->found();
    }
    auto result = co_await begin(std::move(work));
    co_return result;
  }

 private:
  struct Run {
    boost::asio::awaitable<void> end() {
      if (ended) co_return;
      const auto executor = co_await boost::asio::this_coro::executor;
      const auto wake = waiting.emplace_back(std::make_shared<Wake>(executor));
      co_await wake->wait();
    }
    T found() const {
      if (failure) std::rethrow_exception(failure);
      return tmcl::copy_of(*result);
    }

    bool ended = false;
    std::vector<std::shared_ptr<Wake>> waiting;
    std::optional<T> result;
    std::exception_ptr failure;
  };

  /// Lets everybody go on, also when the coroutine that does the work is destroyed.
  class Ending {
   public:
    Ending(SharedWork& work, std::shared_ptr<Run> run) : work_(work), run_(std::move(run)) {}
    Ending(const Ending&) = delete;
    Ending& operator=(const Ending&) = delete;
    ~Ending() {
      if (work_.next_ == run_) work_.next_ = nullptr;
      if (work_.current_ == run_) work_.current_ = std::exchange(work_.next_, nullptr);
      run_->ended = true;
      for (const auto& one : std::exchange(run_->waiting, {})) one->notify();
    }

   private:
    SharedWork& work_;
    std::shared_ptr<Run> run_;
  };

  std::shared_ptr<Run> current_;
  std::shared_ptr<Run> next_;
};

}  // namespace tmcld
