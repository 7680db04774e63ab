/// Threads for what takes long; they begin when there is some of it.
///
/// Nothing is allocated on them but what the work itself allocates, and what that throws comes back
/// to who asked for it: no exception ends a thread, and with it the process.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "async/wake.hpp"
#include "tmcl/in_room.hpp"

namespace boost::asio {
class io_context;
}

namespace tmcld {

class Workers {
 public:
  /// One piece of work. All that its way to a thread and back needs is in it.
  class Job {
   public:
    explicit Job(const boost::asio::any_io_executor& executor);
    virtual ~Job() = default;
    Job(const Job&) = delete;
    Job& operator=(const Job&) = delete;

    /// Of the reactor: until the work has ended. Throws what that threw.
    boost::asio::awaitable<void> end();

   protected:
    virtual void work() = 0;

   private:
    friend class Workers;
    void run() noexcept;
    static void come_back(std::shared_ptr<Job> job) noexcept;

    boost::asio::io_context& reactor_;
    Wake ended_;
    bool has_ended_ = false;
    std::exception_ptr failure_;
    /// What the reactor is handed is put here: there may be no other memory then.
    alignas(std::max_align_t) tmcl::InRoom<void>::Room room_{};
  };

  explicit Workers(std::size_t threads) : most_threads_(threads) {}
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;
  /// What has not begun is left out.
  ~Workers();

  /// In the order of these calls. Throws if there is no memory for that, or no thread at all.
  void begin(std::shared_ptr<Job> job);
  /// Waits for what is being done. To be called when no more is asked for.
  void join();

 private:
  void serve() noexcept;
  void add_thread();

  std::size_t most_threads_;
  std::vector<std::thread> threads_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::shared_ptr<Job>> waiting_;
  std::size_t idle_ = 0;
  bool is_ending_ = false;
};

}  // namespace tmcld
