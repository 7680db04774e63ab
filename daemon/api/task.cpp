#include "api/task.hpp"

namespace tmcld::task_detail {

boost::asio::awaitable<void> TaskPromiseBase::run() {
  for (;;) {
    step = nullptr;
    frame.resume();
    if (failure) std::rethrow_exception(failure);
    if (step == nullptr) co_return;
    try {
      co_await step->take(*this);
    } catch (...) {
      step->failure = std::current_exception();
    }
    if (error) co_return;
  }
}

boost::asio::awaitable<void> run_inner(TaskPromiseBase& inner, TaskPromiseBase* outer) {
  co_await inner.run();
  if (outer != nullptr) outer->error = std::move(inner.error);
}

boost::asio::awaitable<boost::asio::any_io_executor> this_executor() {
  auto executor = co_await boost::asio::this_coro::executor;
  co_return executor;
}

}  // namespace tmcld::task_detail
