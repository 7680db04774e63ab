/// A bus for scripts and small tools: every call waits for its end. The same engine as Bus, without
/// Asio.
///
///     auto bus = tmcl::blocking::Bus::open("serial:/dev/ttyACM0@115200");
///     if (!bus) return complain(describe(bus.error()));
///     auto axis = bus->module(tmcl::ModuleAddress{1}).axis(0);
///     axis.move_to(tmcl::Microsteps{51200});
///     axis.wait_until_reached();
#pragma once

#include "tmcl/language.hpp"

#include <functional>
#include <memory>
#include <string_view>

#include "tmcl/bus_options.hpp"
#include "tmcl/link.hpp"
#include "tmcl/verbs.hpp"

namespace tmcl::blocking {

/// Thread safety: none. Errors: as values; no member throws.
class Bus {
 public:
  static Result<Bus> open(std::string_view link_name, const LinkOptions& link_options = {},
                          BusOptions options = {});
  explicit Bus(Link link, BusOptions options = {});
  Bus(Bus&&) noexcept;
  Bus& operator=(Bus&&) noexcept;
  ~Bus();

  BasicModule<Bus> module(ModuleAddress address) { return {*this, address}; }

  /// One exchange. An answer with an error status is an Error with Outcome::refused.
  Result<Answer> execute(const Request& request, const CallOptions& options = {});
  /// Runs a verb to its end.
  template <class T>
  T run(Script<T> script) {
    const RealClock clock;
    auto step = script.start(clock.now());
    while (step) {
      auto result = perform(std::move(*step));
      step = script.resume(std::move(result), clock.now());
    }
    return script.take();
  }

  /// Called, during calls, for everything that comes unasked. At most one handler; an empty one
  /// removes it.
  void on_event(std::function<void(const BusEvent&)> handler);
  BusCounters counters() const;
  const std::string& name() const;
  bool is_open() const;

 private:
  StepResult perform(Step step);

  class State;
  std::unique_ptr<State> state_;
};

using Module = BasicModule<Bus>;
using Axis = BasicAxis<Bus>;

}  // namespace tmcl::blocking
