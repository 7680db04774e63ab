/// What carries out a call: a coroutine that ends with an error as soon as a step is refused.
///
///     Task<Nothing> stop_axis(const Call& call, const std::string& name) {
///       const auto axis = co_await must(axis_of(call, name));
///       co_await must(axis->stop(), *axis);
///       co_return Nothing{};
///     }
///
/// must() takes an answer that is there, one that is waited for, and another task. A task that does
/// something about an error awaits without must(), and gets what the awaitable gives. The locals of
/// a task that was refused a step live until the task is destroyed.
///
/// The rules of tmcl/script.hpp for g++ 12 hold here, too.
#pragma once

#include <coroutine>
#include <exception>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/this_coro.hpp>

#include "api/call.hpp"

namespace tmcld {

template <class T>
class Task;

namespace task_detail {

struct TaskPromiseBase;

inline Error as_answer(Error error, std::string_view /*axis*/) { return error; }
inline Error as_answer(const tmcl::Error& error, std::string_view axis) {
  return call_error(error, axis);
}

/// What a task waits for; it lives in the frame of the task.
class TaskStep {
 public:
  virtual boost::asio::awaitable<void> take(TaskPromiseBase& task) = 0;

  bool await_ready() const noexcept { return false; }
  template <class Promise>
  void await_suspend(std::coroutine_handle<Promise> task) noexcept {
    task.promise().step = this;
  }

  std::exception_ptr failure{};  ///< Thrown where the task waits.

 protected:
  TaskStep() = default;
  TaskStep(TaskStep&&) = default;
  TaskStep& operator=(TaskStep&&) = default;
  ~TaskStep() = default;

  void rethrow() const {
    if (failure) std::rethrow_exception(failure);
  }
};

struct TaskPromiseBase {
  std::coroutine_handle<> frame{};
  TaskStep* step = nullptr;
  std::optional<Error> error{};  ///< That it has ended with.
  std::exception_ptr failure{};

  /// Until it has ended. Throws what is thrown in it.
  boost::asio::awaitable<void> run();

  std::suspend_always initial_suspend() noexcept { return {}; }
  std::suspend_always final_suspend() noexcept { return {}; }
  void unhandled_exception() noexcept { failure = std::current_exception(); }
};

/// Runs a task that another one waits for; with `outer`, that ends by the same error.
boost::asio::awaitable<void> run_inner(TaskPromiseBase& inner, TaskPromiseBase* outer);
boost::asio::awaitable<boost::asio::any_io_executor> this_executor();

template <class T>
class AwaitedStep final : public TaskStep {
 public:
  explicit AwaitedStep(boost::asio::awaitable<T> awaited) : awaited_(std::move(awaited)) {}

  boost::asio::awaitable<void> take(TaskPromiseBase& /*task*/) override {
    if constexpr (std::is_void_v<T>) {
      co_await std::move(awaited_);
    } else {
      auto value = co_await std::move(awaited_);
      value_.emplace(std::move(value));
    }
  }
  T await_resume() {
    rethrow();
    if constexpr (!std::is_void_v<T>) return *std::move(value_);
  }

 private:
  boost::asio::awaitable<T> awaited_;
  std::optional<std::conditional_t<std::is_void_v<T>, bool, T>> value_{};
};

template <class T, class E>
class MustStep final : public TaskStep {
 public:
  MustStep(boost::asio::awaitable<tl::expected<T, E>> awaited, std::string_view axis)
      : awaited_(std::move(awaited)), axis_(axis) {}

  boost::asio::awaitable<void> take(TaskPromiseBase& task) override {
    auto result = co_await std::move(awaited_);
    if (!result) task.error = as_answer(std::move(result.error()), axis_);
    result_.emplace(std::move(result));
  }
  T await_resume() {
    rethrow();
    if constexpr (!std::is_void_v<T>) return *std::move(*result_);
  }

 private:
  boost::asio::awaitable<tl::expected<T, E>> awaited_;
  std::string_view axis_;
  std::optional<tl::expected<T, E>> result_{};
};

/// What is there already, or is not.
template <class T>
class MustHave {
 public:
  explicit MustHave(Result<T> result) : result_(std::move(result)) {}

  bool await_ready() const noexcept { return result_.has_value(); }
  template <class Promise>
  void await_suspend(std::coroutine_handle<Promise> task) {
    task.promise().error = std::move(result_.error());
  }
  T await_resume() {
    if constexpr (!std::is_void_v<T>) return *std::move(result_);
  }

 private:
  Result<T> result_;
};

template <class T, bool must_succeed>
class TaskOfTask final : public TaskStep {
 public:
  explicit TaskOfTask(Task<T> inner) : inner_(std::move(inner)) {}

  boost::asio::awaitable<void> take(TaskPromiseBase& task) override {
    return run_inner(inner_.promise(), must_succeed ? &task : nullptr);
  }
  auto await_resume() {
    rethrow();
    if constexpr (!must_succeed) {
      return inner_.take();
    } else if constexpr (!std::is_void_v<T>) {
      return *inner_.take();
    }
  }

 private:
  Task<T> inner_;
};

template <class T>
struct TaskResult : TaskPromiseBase {
  std::optional<T> value{};

  void return_value(Result<T> result) {
    if (result) {
      value.emplace(std::move(*result));
    } else {
      error = std::move(result.error());
    }
  }
  void return_value(Error refusal) { error = std::move(refusal); }
};
template <>
struct TaskResult<void> : TaskPromiseBase {
  void return_void() noexcept {}
};

template <class T>
struct TaskPromise final : TaskResult<T> {
  Task<T> get_return_object();
  template <class U>
  AwaitedStep<U> await_transform(boost::asio::awaitable<U> awaited) {
    return AwaitedStep<U>(std::move(awaited));
  }
  AwaitedStep<boost::asio::any_io_executor> await_transform(
      boost::asio::this_coro::executor_t /*executor*/) {
    return AwaitedStep(this_executor());
  }
  template <class U>
  TaskOfTask<U, false> await_transform(Task<U> inner) {
    return TaskOfTask<U, false>(std::move(inner));
  }
  template <class U, class E>
  MustStep<U, E> await_transform(MustStep<U, E> must) {
    return must;
  }
  template <class U>
  TaskOfTask<U, true> await_transform(TaskOfTask<U, true> must) {
    return must;
  }
  template <class U>
  MustHave<U> await_transform(MustHave<U> must) {
    return must;
  }
};

}  // namespace task_detail

/// Move-only. It runs when it is awaited.
template <class T>
class [[nodiscard]] Task {
 public:
  using promise_type = task_detail::TaskPromise<T>;

  explicit Task(promise_type& promise) : promise_(&promise) {}
  Task(Task&& other) noexcept : promise_(std::exchange(other.promise_, nullptr)) {}
  Task& operator=(Task&& other) noexcept {
    std::swap(promise_, other.promise_);
    return *this;
  }
  ~Task() {
    if (promise_ != nullptr) promise_->frame.destroy();
  }

  promise_type& promise() { return *promise_; }
  /// What came of it; once, after it has run.
  Result<T> take() {
    if (promise_->error) return tl::unexpected(*std::move(promise_->error));
    if constexpr (std::is_void_v<T>) {
      return {};
    } else {
      return *std::move(promise_->value);
    }
  }

 private:
  promise_type* promise_;
};

template <class T>
Task<T> task_detail::TaskPromise<T>::get_return_object() {
  this->frame = std::coroutine_handle<TaskPromise>::from_promise(*this);
  return Task<T>(*this);
}

template <class T>
task_detail::MustHave<T> must(Result<T> result) {
  return task_detail::MustHave<T>(std::move(result));
}
template <class T>
task_detail::MustHave<T> must(tmcl::Result<T> result, std::string_view axis = {}) {
  return task_detail::MustHave<T>(std::move(result).map_error(
      [&](const tmcl::Error& error) { return call_error(error, axis); }));
}
template <class T, class E>
task_detail::MustStep<T, E> must(boost::asio::awaitable<tl::expected<T, E>> awaited) {
  return {std::move(awaited), {}};
}
/// The error is one about `axis`.
template <class T>
task_detail::MustStep<T, tmcl::Error> must(boost::asio::awaitable<tmcl::Result<T>> awaited,
                                           const GatewayAxis& axis) {
  return {std::move(awaited), axis.name()};
}
template <class T>
task_detail::TaskOfTask<T, true> must(Task<T> task) {
  return task_detail::TaskOfTask<T, true>(std::move(task));
}

/// Ends the task.
inline task_detail::MustHave<void> refuse(Error error) {
  return task_detail::MustHave<void>(tl::unexpected(std::move(error)));
}
/// Ends the task with the objection, if there is one.
inline task_detail::MustHave<void> must_not(std::optional<Error> objection) {
  if (objection) return refuse(*std::move(objection));
  return task_detail::MustHave<void>({});
}
inline task_detail::MustHave<void> must_not(const std::optional<tmcl::Error>& objection) {
  if (objection) return refuse(call_error(*objection));
  return task_detail::MustHave<void>({});
}

}  // namespace tmcld
