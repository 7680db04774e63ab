#include "async/workers.hpp"

#include <boost/asio/thread_pool.hpp>

namespace tmcld {

Workers::Workers(std::size_t threads) : threads_(threads) {}

Workers::~Workers() = default;

boost::asio::thread_pool& Workers::pool() {
  if (!pool_) pool_ = std::make_unique<boost::asio::thread_pool>(threads_);
  return *pool_;
}

void Workers::join() {
  if (pool_) pool_->join();
}

}  // namespace tmcld
