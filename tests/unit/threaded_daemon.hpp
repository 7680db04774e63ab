/// A daemon on a thread of its own, in real time: for what it does to that thread.
#pragma once

#include <future>
#include <thread>

#include <boost/asio/post.hpp>

#include "unit/daemon_fixture.hpp"

namespace tmcld::test {

class ThreadedDaemon : public PlayedDaemon {
 public:
  explicit ThreadedDaemon(const std::string& toml)
      : PlayedDaemon(std::make_shared<boost::asio::io_context>(1), toml,
                     tmcl::test::wait_in_real_time) {}
  ~ThreadedDaemon() {
    if (thread_.joinable()) {
      daemon().stop();
      thread_.join();
    }
    unplug_all();
  }

  /// Serves; returns when its modules have been identified.
  void start() {
    thread_ = std::thread([this] { ended_well_ = daemon().run(); });
    while (!on_reactor([&] { return is_ready(); })) std::this_thread::yield();
  }
  /// Waits until the daemon has ended by itself; whether it says that nothing was wrong.
  bool ends_well() {
    thread_.join();
    return ended_well_;
  }
  /// What the function gives, run on the daemon's thread.
  template <class Function>
  std::invoke_result_t<Function> on_reactor(Function function) {
    // Shared, because the reactor is not done with it when the result is there.
    const auto task =
        std::make_shared<std::packaged_task<std::invoke_result_t<Function>()>>(std::move(function));
    auto result = task->get_future();
    boost::asio::post(daemon().context(), [task] { (*task)(); });
    return result.get();
  }

 private:
  std::thread thread_;
  bool ended_well_ = false;
};

}  // namespace tmcld::test
