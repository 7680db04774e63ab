/// One turn at a time, for which many wait: groups have them one after the other, however many of
/// one group wait. Thread safety: none.
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>

#include "async/wake.hpp"

namespace tmcld {

class FairTurns {
 public:
  explicit FairTurns(boost::asio::any_io_executor executor) : executor_(std::move(executor)) {}

  /// Returns when it is the turn of the caller, who gives it back.
  boost::asio::awaitable<void> take(std::string group) {
    if (!std::exchange(is_taken_, true)) co_return;
    const auto wake = std::make_shared<Wake>(executor_);
    waiting_[std::move(group)].push_back(wake);
    co_await wake->wait();
  }
  void give_back() {
    if (waiting_.empty()) {
      is_taken_ = false;
      return;
    }
    auto next = waiting_.upper_bound(last_);
    if (next == waiting_.end()) next = waiting_.begin();
    last_ = next->first;
    const auto wake = std::move(next->second.front());
    next->second.pop_front();
    if (next->second.empty()) waiting_.erase(next);
    wake->notify();
  }

 private:
  boost::asio::any_io_executor executor_;
  std::map<std::string, std::deque<std::shared_ptr<Wake>>> waiting_;
  std::string last_;  ///< The group that had the last turn.
  bool is_taken_ = false;
};

}  // namespace tmcld
