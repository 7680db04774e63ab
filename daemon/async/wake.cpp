#include "async/wake.hpp"

#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>

namespace tmcld {

boost::asio::awaitable<void> Wake::wait_until(tmcl::TimePoint then) {
  boost::system::error_code ignored;
  while (!notified_ && timer_.now() < then) {
    timer_.expires_at(then);
    co_await timer_.async_wait(boost::asio::redirect_error(boost::asio::use_awaitable, ignored));
  }
  notified_ = false;
}

}  // namespace tmcld
