/// Verbs that need several exchanges, written once, without I/O.
///
/// A Script is a coroutine that asks for steps (an exchange with a module, several at once, a
/// pause) and receives the result of each. Its runner does the I/O: a bus on Asio, a blocking
/// bus, or a test that plays the module. So a verb is the same everywhere, and each of its steps
/// can be made to fail. With each result comes the time, so that a verb can keep to a clock that is
/// the runner's: a test's may be virtual.
///
///     Script<Result<Microsteps>> position(AxisAddress axis) {
///       const auto answer = co_await must(exchange(position_request(axis)));
///       co_return Microsteps{answer.reply.value};
///     }
///
/// What g++ 12 makes wrong code of, in any coroutine, at every level of optimisation (seen with the
/// address sanitizer, in Scripts as in boost::asio::awaitable):
///  - A braced temporary of an aggregate that holds a string, a shared_ptr or the like, in an
///    expression with co_await: `co_await load({.name = name})` destroys the name twice. Name the
///    aggregate first, make it with a function, or give it a constructor.
///  - `condition ? co_await a() : co_await b()`. Use if.
/// `co_return co_await f()` is right, and so is co_await within an expression.
#pragma once

#include <coroutine>
#include <cstdint>
#include <exception>
#include <memory>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "tmcl/clock.hpp"
#include "tmcl/error.hpp"
#include "tmcl/version.hpp"

namespace tmcl {

/// Keeps a module for its maker: from the first exchange that carries it until it is
/// destroyed, commands of others to that module wait in the queue, except stops.
///
/// In download mode a stop's answer looks like a stop's recording. So a stop
/// that comes then ends the download first (END_DOWNLOAD), and with it the hold; so does the engine
/// when the hold is destroyed in the middle of a download, or not used for hold_idle_limit. Only a
/// START_DOWNLOAD that carries a hold is watched over like this.
///
/// It is nothing but its lifetime: the runner of the exchanges sees that it exists, and when it is
/// gone. Exchanges with a hold that has ended are refused.
class Hold {
 public:
  Hold() = default;
  Hold(const Hold&) = delete;
  Hold& operator=(const Hold&) = delete;
};

/// How a value that is read is told from a reply to something else.
enum class Proof : std::uint8_t {
  none,      ///< As long as the line gives no cause for doubt, it is the next reply of its kind.
  followed,  ///< It is given out when an exchange of another command has followed, and no second
             ///< reply of its kind came before that. One such exchange does for several reads that
             ///< wait together.
  twice,     ///< It was read twice, with another command between: for what moves a motor.
};

struct CallOptions {
  /// Refused rather than sent after this instant.
  std::optional<TimePoint> deadline{};
  /// How long to wait for the reply, instead of what the bus waits by default. On CAN it can only
  /// be longer than that: no other call waits meanwhile.
  std::optional<Duration> reply_timeout{};
  /// How often a repeatable command may be sent before it counts as failed; 0: as the bus is set
  /// up.
  unsigned attempts = 0;
  /// Null: an ordinary call, which waits while someone else holds the module.
  std::shared_ptr<const Hold> hold{};
  /// With a hold: the module takes commands of its holder only, until an exchange with the
  /// hold does not say so any more. They end with Errc::in_bootloader instead of waiting; so do
  /// stops, for there is nothing that could obey one.
  bool in_bootloader = false;
  /// To be recorded and not to be executed: sent at most once, and only while the module is in
  /// download mode for this hold. A success has Status::command_loaded.
  bool is_program_line = false;
  /// Of a read, of how sure its value must be.
  Proof proof = Proof::none;
  /// Askers take turns on the bus. A listener of the bus is told this with the request.
  std::uint64_t asker = 0;
  /// Asked each time when the bytes of the request are about to go out: why they must not. The call
  /// ends with that error then. Must not use the bus.
  std::function<std::optional<Error>()> objection{};
};

/// A reply, and what the engine noticed about it.
struct Answer {
  Reply reply;
  /// The firmware version where it came as text: `reply` then holds only the module and the
  /// command.
  std::optional<FirmwareVersion> version_text{};
  /// Foreign replies come from this address: from a second module, or to a second host.
  bool duplicate_suspected = false;
  /// When the request went out that this answers, and when it came. Of a request that was sent
  /// several times, the last.
  TimePoint sent{};
  TimePoint received{};
};

namespace step {
struct Exchange {
  Request request;
  CallOptions options;
};
/// Several exchanges at once; on CAN different modules work on them side by side. Those for which
/// the bus has no room in its queue end with Errc::queue_full.
struct ExchangeAll {
  std::vector<Exchange> exchanges;
};
struct Pause {
  Duration duration;
};
}  // namespace step

using Step = std::variant<step::Exchange, step::ExchangeAll, step::Pause>;
/// One result for each exchange of the step, in its order; none for a pause.
using StepResult = std::vector<Result<Answer>>;

template <class T>
class Script;

namespace detail {

struct ScriptPromiseBase;

/// What a script and the scripts it awaits share with their runner.
struct ScriptState {
  std::optional<Step> step;
  StepResult result;
  TimePoint now{};
  ScriptPromiseBase* innermost = nullptr;
  std::exception_ptr failure;  ///< Of any of them; none goes on after it.
};

struct ScriptPromiseBase {
  ScriptState* state = nullptr;
  std::coroutine_handle<> script;
  ScriptPromiseBase* outer = nullptr;  ///< Of the script that waits for this one.
  bool must_succeed = false;           ///< What the script waits for; see must().

  ScriptPromiseBase() = default;
  ScriptPromiseBase(const ScriptPromiseBase&) = delete;
  ScriptPromiseBase& operator=(const ScriptPromiseBase&) = delete;

  std::suspend_always initial_suspend() noexcept { return {}; }

  struct FinalAwaiter {
    bool await_ready() noexcept { return false; }
    template <class Promise>
    std::coroutine_handle<> await_suspend(std::coroutine_handle<Promise> done) noexcept {
      auto& promise = done.promise();
      if (!promise.outer || promise.state->failure) return std::noop_coroutine();
      return promise.outer->go_on_after(promise.error());
    }
    void await_resume() noexcept {}
  };
  FinalAwaiter final_suspend() noexcept { return {}; }

  /// What is resumed when that which this script waits for has ended, with `error` or with none.
  /// A script that it ends stays suspended where it is: its awaiter destroys it.
  std::coroutine_handle<> go_on_after(Error* error) noexcept {
    auto* waiting = this;
    while (std::exchange(waiting->must_succeed, false) && error != nullptr) {
      error = waiting->fail(std::move(*error));
      waiting = waiting->outer;
      if (waiting == nullptr) return std::noop_coroutine();
    }
    state->innermost = waiting;
    return waiting->script;
  }
  // The library reports errors as values: an exception in a script is a bug, or memory that is not
  // to be had. It ends all scripts that wait for each other here, and is thrown to their runner.
  void unhandled_exception() noexcept { state->failure = std::current_exception(); }

 protected:
  ~ScriptPromiseBase() = default;

 private:
  /// Makes `error` the script's result, and tells where it is now.
  virtual Error* fail(Error error) noexcept = 0;
};

template <class T>
constexpr bool is_result = false;
template <class T>
constexpr bool is_result<Result<T>> = true;

template <class T>
struct ScriptPromise final : ScriptPromiseBase {
  std::optional<T> value;
  Script<T> get_return_object();
  template <class U = T>
  void return_value(U&& result) {
    value.emplace(std::forward<U>(result));
  }
  Error* error() noexcept {
    if constexpr (is_result<T>) return *value ? nullptr : &value->error();
    return nullptr;
  }

 private:
  Error* fail(Error error) noexcept override {
    if constexpr (is_result<T>) value.emplace(tl::unexpected(std::move(error)));
    return this->error();
  }
};

template <class Awaited>
struct StepAwaiter {
  Step step;
  ScriptState* state = nullptr;

  bool await_ready() const noexcept { return false; }
  template <class Promise>
  void await_suspend(std::coroutine_handle<Promise> script) {
    state = script.promise().state;
    state->step = std::move(step);
  }
  Awaited await_resume() {
    if constexpr (std::is_same_v<Awaited, Result<Answer>>) {
      return std::move(state->result.at(0));
    } else if constexpr (std::is_same_v<Awaited, StepResult>) {
      return std::move(state->result);
    }
  }
};

template <class Awaited>
class [[nodiscard]] Must {
 public:
  explicit Must(Awaited awaited) : awaited_(std::move(awaited)) {}

  bool await_ready() const noexcept { return false; }
  template <class T>
  auto await_suspend(std::coroutine_handle<ScriptPromise<T>> script) {
    static_assert(is_result<T>, "the error becomes the result of the script, which has to be one");
    script.promise().must_succeed = true;
    return awaited_.await_suspend(script);
  }
  auto await_resume() {
    auto result = awaited_.await_resume();
    if constexpr (!std::is_void_v<typename decltype(result)::value_type>) return *std::move(result);
  }

 private:
  Awaited awaited_;
};

/// Never suspends: the time came with the last result.
struct TimeAwaiter {
  TimePoint now{};

  bool await_ready() const noexcept { return false; }
  template <class Promise>
  bool await_suspend(std::coroutine_handle<Promise> script) noexcept {
    now = script.promise().state->now;
    return false;
  }
  TimePoint await_resume() const noexcept { return now; }
};

}  // namespace detail

/// A verb in progress, whatever it gives: what its runner steps through. What is thrown in it,
/// start() or resume() throws; all that can be done with it then is to destroy it.
class AnyScript {
 public:
  /// Runs up to the first step; nothing if there was none.
  std::optional<Step> start(TimePoint now) {
    state_ = std::make_unique<detail::ScriptState>();
    state_->now = now;
    promise_->state = state_.get();
    state_->innermost = promise_;
    return proceed(nullptr);
  }
  /// Tells what came of the last step and runs up to the next one; nothing when the script has
  /// ended.
  std::optional<Step> resume(StepResult result, TimePoint now) {
    state_->result = std::move(result);
    state_->now = now;
    auto& results = state_->result;
    return proceed(results.empty() || results.front() ? nullptr : &results.front().error());
  }

 protected:
  explicit AnyScript(detail::ScriptPromiseBase& promise) : promise_(&promise) {}
  AnyScript(AnyScript&& other) noexcept
      : promise_(std::exchange(other.promise_, nullptr)), state_(std::move(other.state_)) {}
  AnyScript& operator=(AnyScript&& other) noexcept {
    std::swap(promise_, other.promise_);
    std::swap(state_, other.state_);
    return *this;
  }
  ~AnyScript() {
    if (promise_ != nullptr) promise_->script.destroy();
  }

  detail::ScriptPromiseBase* promise_;

 private:
  std::optional<Step> proceed(Error* error) {
    state_->step.reset();
    state_->innermost->go_on_after(error).resume();
    if (state_->failure) std::rethrow_exception(std::exchange(state_->failure, nullptr));
    return std::move(state_->step);
  }

  std::unique_ptr<detail::ScriptState> state_;
};

/// The same with what it gives. Move-only; destroying it ends it wherever it is.
template <class T>
class [[nodiscard]] Script : public AnyScript {
 public:
  using promise_type = detail::ScriptPromise<T>;
  using value_type = T;

  explicit Script(promise_type& promise) : AnyScript(promise) {}

  /// What the script returned; once, after it has ended.
  T take() { return std::move(*static_cast<promise_type*>(promise_)->value); }

  // One script waits for another: the inner one's steps go to the same runner.
  bool await_ready() const noexcept { return false; }
  template <class Promise>
  std::coroutine_handle<> await_suspend(std::coroutine_handle<Promise> outer) {
    promise_->state = outer.promise().state;
    promise_->outer = &outer.promise();
    promise_->state->innermost = promise_;
    return promise_->script;
  }
  T await_resume() { return take(); }
};

template <class T>
Script<T> detail::ScriptPromise<T>::get_return_object() {
  script = std::coroutine_handle<ScriptPromise>::from_promise(*this);
  return Script<T>(*this);
}

/// One exchange. An answer with an error status comes back as an Error with Outcome::refused.
inline detail::StepAwaiter<Result<Answer>> exchange(const Request& request,
                                                    const CallOptions& options = {}) {
  return {step::Exchange{request, options}};
}
inline detail::StepAwaiter<StepResult> exchange_all(std::vector<step::Exchange> exchanges) {
  return {step::ExchangeAll{std::move(exchanges)}};
}
inline detail::StepAwaiter<void> pause(Duration duration) { return {step::Pause{duration}}; }
/// What comes of an exchange, or of another verb, if that succeeds; else its error ends the verb
/// that waits for it, as its own result:
///
///     const auto speed = co_await must(velocity(axis));
///
/// A verb that does something about an error awaits without must(), and gets a Result.
template <class Awaited>
detail::Must<Awaited> must(Awaited awaited) {
  return detail::Must<Awaited>(std::move(awaited));
}
/// When the last step ended, or the verb began.
inline detail::TimeAwaiter current_time() { return {}; }

}  // namespace tmcl
