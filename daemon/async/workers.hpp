/// Threads for what takes long; they begin when there is some of it.
#pragma once

#include <cstddef>
#include <memory>

namespace boost::asio {
class thread_pool;
}

namespace tmcld {

class Workers {
 public:
  explicit Workers(std::size_t threads);
  ~Workers();

  boost::asio::thread_pool& pool();
  /// Waits for what is being done. To be called when no more is asked for.
  void join();

 private:
  std::size_t threads_;
  std::unique_ptr<boost::asio::thread_pool> pool_;
};

}  // namespace tmcld
