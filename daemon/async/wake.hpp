/// Lets one coroutine wait until another part of the program has something for it.
#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>

#include "tmcl/timer.hpp"

namespace tmcld {

/// A notification that comes without a waiter is kept: no wake-up is lost. At most one waiter.
class Wake {
 public:
  explicit Wake(const boost::asio::any_io_executor& executor) : timer_(executor) {}

  void notify() {
    notified_ = true;
    timer_.cancel();
  }
  boost::asio::awaitable<void> wait() { return wait_until(tmcl::TimePoint::max()); }
  /// Until notified, or until then.
  boost::asio::awaitable<void> wait_until(tmcl::TimePoint then);
  boost::asio::awaitable<void> wait_for(tmcl::Duration duration) {
    return wait_until(timer_.now() + duration);
  }

 private:
  tmcl::Timer timer_;
  bool notified_ = false;
};

}  // namespace tmcld
