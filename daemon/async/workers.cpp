#include "async/workers.hpp"

#include <utility>

#include <boost/asio/bind_allocator.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>

#include "async/ordinary_priority.hpp"

namespace tmcld {
namespace {

boost::asio::io_context& context_of(const boost::asio::any_io_executor& executor) {
  return static_cast<boost::asio::io_context&>(
      boost::asio::query(executor, boost::asio::execution::context));
}

}  // namespace

// ---- one piece of work -------------------------------------------------------------------------

Workers::Job::Job(const boost::asio::any_io_executor& executor)
    : reactor_(context_of(executor)), ended_(executor) {}

boost::asio::awaitable<void> Workers::Job::end() {
  while (!has_ended_) co_await ended_.wait();
  if (failure_) std::rethrow_exception(failure_);
}

void Workers::Job::run() noexcept {
  try {
    work();
  } catch (...) {
    failure_ = std::current_exception();
  }
}

/// The reactor lets go of it last: a thread must not destroy what belongs to the reactor.
void Workers::Job::come_back(std::shared_ptr<Job> job) noexcept {
  auto& here = *job;
  auto back = [job = std::move(job)] {
    job->has_ended_ = true;
    job->ended_.notify();
  };
  boost::asio::post(here.reactor_.get_executor(),
                    boost::asio::bind_allocator(tmcl::InRoom<void>(here.room_), std::move(back)));
}

// ---- the threads -------------------------------------------------------------------------------

Workers::~Workers() {
  {
    const std::lock_guard lock(mutex_);
    waiting_.clear();
  }
  join();
}

void Workers::begin(std::shared_ptr<Job> job) {
  const std::lock_guard lock(mutex_);
  waiting_.push_back(std::move(job));
  if (waiting_.size() > idle_ && threads_.size() < most_threads_) add_thread();
  changed_.notify_one();
}

/// One thread at least is needed; without the others it takes longer.
void Workers::add_thread() {
  try {
    threads_.reserve(most_threads_);
    threads_.emplace_back([this] { serve(); });
  } catch (...) {
    if (!threads_.empty()) return;
    waiting_.pop_back();
    throw;
  }
}

void Workers::join() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
    changed_.notify_all();
  }
  for (auto& thread : threads_) thread.join();
  threads_.clear();
  is_ending_ = false;
}

void Workers::serve() noexcept {
  take_ordinary_priority();
  std::unique_lock lock(mutex_);
  while (true) {
    ++idle_;
    changed_.wait(lock, [&] { return is_ending_ || !waiting_.empty(); });
    --idle_;
    if (waiting_.empty()) return;
    auto job = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    job->run();
    Job::come_back(std::move(job));
    lock.lock();
  }
}

}  // namespace tmcld
