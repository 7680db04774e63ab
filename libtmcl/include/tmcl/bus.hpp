/// A bus for programs on Boost.Asio: coroutines, one executor, no locks.
///
///     auto link = tmcl::Link::open("serial:/dev/ttyACM0@115200");
///     tmcl::Bus bus(co_await boost::asio::this_coro::executor, std::move(*link));
///     auto axis = bus.module(tmcl::ModuleAddress{1}).axis(0);
///     co_await axis.move_to(tmcl::Microsteps{51200});
#pragma once

#include "tmcl/language.hpp"

#include <functional>
#include <memory>
#include <optional>

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>

#include "tmcl/bus_options.hpp"
#include "tmcl/context_clock.hpp"
#include "tmcl/link.hpp"
#include "tmcl/traffic.hpp"
#include "tmcl/verbs.hpp"

namespace tmcl {

struct RunOptions {
  /// Goes into every exchange of the verb that has none of its own.
  std::optional<TimePoint> deadline{};
  /// Asked before every step; an error ends the verb there, before anything more is sent.
  std::function<std::optional<Error>()> objection{};
  /// Told of every answer how long the module took for it, the time in the queue included.
  std::function<void(Duration)> on_answer{};
};

/// Object lifetimes: verbs that have begun (been awaited) keep what they need alive; they end with
/// Errc::link_lost when the bus is closed or destroyed. Thread safety: none. Use it from its
/// executor only, and let that be one thread or a strand. Errors: as values; no member throws.
class Bus {
 public:
  Bus(boost::asio::any_io_executor executor, Link link, BusOptions options = {});
  Bus(Bus&&) noexcept;
  Bus& operator=(Bus&&) noexcept;
  ~Bus();

  BasicModule<Bus> module(ModuleAddress address) { return {*this, address}; }

  /// One exchange. An answer with an error status is an Error with Outcome::refused.
  boost::asio::awaitable<Result<Answer>> execute(Request request, CallOptions options = {});
  /// Runs a verb to its end, or until there is an objection.
  template <class T>
  boost::asio::awaitable<T> run(Script<T> script, RunOptions options = {}) {
    auto objection = co_await run_steps(state_, clock_, script, std::move(options));
    if (objection) co_return tl::unexpected(std::move(*objection));
    co_return script.take();
  }

  /// Called on the executor for everything that comes unasked. At most one handler; an empty one
  /// removes it.
  void on_event(std::function<void(const BusEvent&)> handler);
  /// Called for everything that goes over the bus. At most one handler; an empty one removes it.
  void on_traffic(OnTraffic handler);
  BusCounters counters() const;
  /// How many exchanges wait for their turn.
  std::size_t queued() const;
  const std::string& name() const;
  /// False after the link was lost or closed; the bus cannot be used any more then.
  bool is_open() const;
  /// Ends everything in progress with Errc::link_lost.
  void close();
  /// For a program that has no memory, or an exception to end by: a stop of the motor is on the
  /// wire when this returns, whatever waits, and takes no memory. Whether its module has heard it
  /// is not known. Blocks for some milliseconds on a serial line, and what was on its way there may
  /// get no answer.
  void stop_at_once(AxisAddress motor) noexcept;
  /// Reads that wait and have an objection now end by it at once: they would only when their turn
  /// comes, and keep places in the queue until then.
  void end_unwanted_reads();
  /// Nothing that waits, or is asked for later, sets a motor moving any more.
  void refuse_movements() noexcept;

 private:
  class State;
  /// Keeps what it needs alive: the bus may be gone before the verb has ended.
  static boost::asio::awaitable<std::optional<Error>> run_steps(std::shared_ptr<State> state,
                                                                ContextClock clock,
                                                                AnyScript& script,
                                                                RunOptions options);
  static boost::asio::awaitable<StepResult> perform(std::shared_ptr<State> state, Step step,
                                                    std::optional<TimePoint> deadline);

  ContextClock clock_;
  std::shared_ptr<State> state_;
};

using Module = BasicModule<Bus>;
using Axis = BasicAxis<Bus>;

}  // namespace tmcl
