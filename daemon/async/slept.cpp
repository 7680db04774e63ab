#include "async/slept.hpp"

#include <ctime>

#include <boost/asio/execution/context.hpp>
#include <boost/asio/query.hpp>

#include "tmcl/context_clock.hpp"

namespace tmcld {
namespace {

tmcl::Duration read(clockid_t clock) {
  std::timespec time{};
  ::clock_gettime(clock, &time);
  return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

}  // namespace

tmcl::Duration slept(const boost::asio::any_io_executor& executor) {
  auto& context = boost::asio::query(executor, boost::asio::execution::context);
  if (boost::asio::has_service<VirtualSleep>(context))
    return boost::asio::use_service<VirtualSleep>(context).slept;
  if (boost::asio::has_service<tmcl::detail::VirtualTimeline>(context)) return {};
  // In this order, a process that is held up between the two has slept too long, not too little.
  const auto awake = read(CLOCK_MONOTONIC);
  return read(CLOCK_BOOTTIME) - awake;
}

}  // namespace tmcld
