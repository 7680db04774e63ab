#include "async/rest.hpp"

#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>

#include "tmcl/timer.hpp"

namespace tmcld {

boost::asio::awaitable<void> rest(tmcl::Duration duration) {
  tmcl::Timer timer(co_await boost::asio::this_coro::executor);
  timer.expires_after(duration);
  co_await timer.async_wait(boost::asio::use_awaitable);
}

}  // namespace tmcld
