/// An engine of the library at one end of a serial line, simulated modules at the other, in virtual
/// time.
#pragma once

#include <algorithm>
#include <chrono>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "engine/bus_engine.hpp"
#include "sim/bench.hpp"
#include "sim/wire/serial_line.hpp"

namespace tmcl::test {

class EngineOnLine {
 public:
  /// Modules are set to 9600 bits per second; at any other rate theirs is that of the host,
  /// whatever they are set to.
  explicit EngineOnLine(unsigned bits_per_second)
      : wire_{.pace = {.bits_per_second = bits_per_second,
                       .to_answer = std::chrono::microseconds(500)},
              .has_rates_of_modules = bits_per_second == 9600},
        line_(
            bench_, [this](auto bytes) { engine_.on_bytes(bytes, clock_.now()); }, wire_),
        engine_(Framing::serial, wire_.pace.of_bytes(2 * serial_datagram_size), {}) {}

  sim::Module& add(std::uint8_t address, std::uint16_t model = 1110) {
    return bench_.add(*find_model(model), ModuleAddress{address});
  }
  /// From another host, past the engine.
  void inject(const Request& request) {
    pass(std::chrono::milliseconds(50));
    line_.receive(encode_serial(request));
    pass(std::chrono::milliseconds(50));
  }
  engine::Ticket submit(const Request& request) {
    engine_.submit(next_, request, {}, clock_.now());
    return next_++;
  }
  Result<Answer> ask(const Request& request) {
    const auto ticket = submit(request);
    const auto limit = clock_.now() + std::chrono::seconds(5);
    while (!results_.contains(ticket) && clock_.now() < limit) pass(std::chrono::milliseconds(1));
    return results_.at(ticket);
  }
  bool has_ended(engine::Ticket ticket) const { return results_.contains(ticket); }
  const Result<Answer>& result(engine::Ticket ticket) const { return results_.at(ticket); }
  void pass(Duration duration) {
    const auto end = clock_.now() + duration;
    while (true) {
      run_actions();
      bench_.run_due();
      run_actions();
      const auto next = std::min(bench_.next_due(), engine_.next_deadline().value_or(end));
      if (clock_.now() >= end) return;
      const auto later = clock_.now() + std::chrono::microseconds(1);
      clock_.advance_to(std::min(std::max(next, later), end));
      engine_.on_deadline(clock_.now());
    }
  }

 private:
  void run_actions() {
    while (auto action = engine_.next_action()) {
      if (const auto* send = std::get_if<engine::Send>(&*action)) {
        const auto text =
            send->leaves_ascii ? engine::leaving_ascii_mode(send->request.address) : std::string();
        if (text.empty()) line_.receive(encode_serial(send->request));
        if (!text.empty()) line_.receive(std::vector<std::uint8_t>(text.begin(), text.end()));
      } else if (auto* done = std::get_if<engine::Completion>(&*action)) {
        results_.emplace(done->ticket, std::move(done->result));
      }
    }
  }

  VirtualClock clock_;
  sim::Bench bench_{clock_};
  sim::SerialWire wire_;
  sim::SerialLine line_;
  engine::BusEngine engine_;
  engine::Ticket next_ = 0;
  std::map<engine::Ticket, Result<Answer>> results_;
};

}  // namespace tmcl::test
