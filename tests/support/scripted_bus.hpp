/// A bus in virtual time, on which every single datagram can be made to go wrong.
///
/// Runs a Script through the real engine, with modules played by the test. Each datagram that the
/// host sends has a number, counted from 0; a fault can be tied to a number.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/bus_engine.hpp"
#include "support/fake_module.hpp"
#include "tmcl/clock.hpp"

namespace tmcl::test {

enum class Fault {
  lost_request,   ///< The module never sees it.
  lost_reply,     ///< The module executes it; silence on the line.
  short_frame,    ///< The reply breaks off.
  bad_checksum,   ///< The reply comes with a wrong checksum.
  wrong_address,  ///< The reply names another module.
  late_reply,     ///< The reply comes when the next request has just gone out.
};

inline constexpr std::array all_faults{Fault::lost_request,  Fault::lost_reply,
                                       Fault::short_frame,   Fault::bad_checksum,
                                       Fault::wrong_address, Fault::late_reply};

inline std::string name_of(Fault fault) {
  constexpr std::array names{"lost request", "lost reply",    "short frame",
                             "bad checksum", "wrong address", "late reply"};
  return names.at(static_cast<std::size_t>(fault));
}

class ScriptedBus {
 public:
  explicit ScriptedBus(Framing framing = Framing::serial, BusOptions options = {.name = "bench"})
      : framing_(framing), engine_(framing, Duration{}, std::move(options)) {}

  FakeModule& add_module(std::uint8_t address, std::uint8_t motors = 3) {
    return modules_.try_emplace(address, address, motors).first->second;
  }
  FakeModule& module(std::uint8_t address) { return modules_.at(address); }

  void fail(std::size_t datagram, Fault fault) { faults_[datagram] = fault; }
  /// How long modules take to answer.
  Duration answer_time = std::chrono::milliseconds(1);
  /// Decides about every datagram that has no fault of its own.
  std::function<std::optional<Fault>(std::size_t datagram)> chance;
  /// How long after a datagram without a fault its reply comes, once for each entry; answer_time,
  /// if nothing is here.
  std::function<std::vector<Duration>(std::size_t datagram)> ways;

  /// Whether the link takes a datagram now; always, if nothing is here.
  std::function<bool(const Request&)> takes;

  const std::vector<Request>& sent() const { return sent_; }
  /// What was said to modules in ASCII mode.
  const std::vector<std::string>& lines() const { return lines_; }
  std::function<void()> on_line;
  const std::vector<BusEvent>& events() const { return events_; }
  BusCounters counters() const { return engine_.counters(); }
  engine::BusEngine& engine() { return engine_; }
  VirtualClock& clock() { return clock_; }

  template <class T>
  T run(Script<T> script) {
    auto step = script.start(clock_.now());
    while (step) {
      auto result = perform(*step);
      step = script.resume(std::move(result), clock_.now());
    }
    return script.take();
  }

  /// One step of a script, to its end.
  StepResult perform(const Step& step) {
    if (const auto* rest = std::get_if<step::Pause>(&step)) {
      pass(rest->duration);
      return {};
    }
    std::vector<step::Exchange> exchanges;
    if (const auto* one = std::get_if<step::Exchange>(&step)) exchanges.push_back(*one);
    if (const auto* many = std::get_if<step::ExchangeAll>(&step)) exchanges = many->exchanges;
    std::vector<engine::Ticket> tickets;
    for (const auto& exchange : exchanges)
      tickets.push_back(submit(exchange.request, exchange.options));
    settle(tickets);
    StepResult results;
    for (const auto ticket : tickets) results.push_back(ended_.at(ticket));
    return results;
  }

  /// Submits without waiting.
  engine::Ticket submit(const Request& request, const CallOptions& options = {}) {
    const auto ticket = next_ticket_++;
    engine_.submit(ticket, request, options, clock_.now());
    return ticket;
  }
  /// Lets time pass until every submitted call has ended; gives up, loudly, after an hour of
  /// virtual time.
  void settle() {
    const auto limit = clock_.now() + std::chrono::hours(1);
    run_actions();
    while (ended_.size() < next_ticket_ && clock_.now() < limit) go_on_until(limit);
  }
  void settle(const std::vector<engine::Ticket>& tickets) {
    const auto limit = clock_.now() + std::chrono::hours(1);
    run_actions();
    const auto has_all = [&] {
      return std::ranges::all_of(tickets, [&](auto ticket) { return has_ended(ticket); });
    };
    while (!has_all() && clock_.now() < limit) go_on_until(limit);
  }
  const Result<Answer>& result(engine::Ticket ticket) const { return ended_.at(ticket); }
  bool has_ended(engine::Ticket ticket) const { return ended_.contains(ticket); }
  /// In the order in which they ended.
  const std::vector<engine::Ticket>& order() const { return order_; }

  void pass(Duration duration) {
    const auto end = clock_.now() + duration;
    while (clock_.now() < end) go_on_until(end);
  }
  void deliver(const Reply& reply) {
    if (framing_ == Framing::serial) {
      const auto bytes = encode_serial(reply);
      engine_.on_bytes(bytes, clock_.now());
    } else {
      engine_.on_frame(encode_can(reply, default_can_reply_id), clock_.now());
    }
  }
  /// Does what the engine wants done now.
  void run_actions() {
    while (auto action = engine_.next_action()) {
      if (auto* send = std::get_if<engine::Send>(&*action)) {
        if (send->leaves_ascii) {
          lines_.push_back(engine::leaving_ascii_mode(send->request.address));
          if (on_line) on_line();
        } else if (takes && !takes(send->request)) {
          engine_.on_send_refused(send->request, clock_.now());
        } else {
          on_sent(send->request);
        }
      } else if (auto* completion = std::get_if<engine::Completion>(&*action)) {
        order_.push_back(completion->ticket);
        ended_.emplace(completion->ticket, std::move(completion->result));
      } else {
        events_.push_back(std::get<BusEvent>(*action));
      }
    }
  }

 private:
  struct Delivery {
    TimePoint at;
    Reply reply;
    std::optional<Fault> fault;
  };

  void on_sent(const Request& request) {
    const auto datagram = sent_.size();
    sent_.push_back(request);
    if (late_) {
      deliver(*late_);
      late_.reset();
    }
    auto fault = faults_.contains(datagram) ? std::optional(faults_[datagram]) : std::nullopt;
    if (!fault && chance) fault = chance(datagram);
    const auto module = modules_.find(reply_byte(request.address));
    if (module == modules_.end() || fault == Fault::lost_request) return;
    const auto reply = module->second.execute(request);
    if (fault == Fault::lost_reply || reply_kind(request.command) == ReplyKind::none) return;
    if (fault == Fault::late_reply) {
      late_ = reply;
      return;
    }
    const auto delays = ways ? ways(datagram) : std::vector{answer_time};
    for (const auto delay : delays) deliveries_.push_back({clock_.now() + delay, reply, fault});
  }

  void arrive(const Delivery& delivery) {
    if (!delivery.fault) return deliver(delivery.reply);
    auto reply = delivery.reply;
    if (delivery.fault == Fault::wrong_address) {
      reply.module = static_cast<std::uint8_t>(reply.module + 100);
      return deliver(reply);
    }
    if (framing_ == Framing::can) {
      // CAN knows no broken frames, its controllers sort them out: a frame that is too short stands
      // for them.
      auto frame = encode_can(reply, default_can_reply_id);
      frame.length = 5;
      return engine_.on_frame(frame, clock_.now());
    }
    auto bytes = encode_serial(reply);
    bytes[8] = static_cast<std::uint8_t>(bytes[8] + 1);
    const std::size_t size = delivery.fault == Fault::short_frame ? 5 : bytes.size();
    engine_.on_bytes(std::span(bytes).first(size), clock_.now());
  }

  void go_on_until(TimePoint limit) {
    run_actions();
    const auto next = std::ranges::min_element(deliveries_, {}, &Delivery::at);
    auto wake = limit;
    if (next != deliveries_.end()) wake = std::min(wake, next->at);
    if (const auto deadline = engine_.next_deadline()) wake = std::min(wake, *deadline);
    clock_.advance_to(std::max(wake, clock_.now()));
    if (next != deliveries_.end() && next->at <= clock_.now()) {
      const auto delivery = *next;
      deliveries_.erase(next);
      arrive(delivery);
    } else {
      engine_.on_deadline(clock_.now());
    }
    run_actions();
  }

  Framing framing_;
  VirtualClock clock_;
  engine::BusEngine engine_;
  std::map<std::uint8_t, FakeModule> modules_;
  std::map<std::size_t, Fault> faults_;
  std::vector<Request> sent_;
  std::vector<std::string> lines_;
  std::vector<BusEvent> events_;
  std::vector<Delivery> deliveries_;
  std::optional<Reply> late_;
  engine::Ticket next_ticket_ = 0;
  std::map<engine::Ticket, Result<Answer>> ended_;
  std::vector<engine::Ticket> order_;
};

}  // namespace tmcl::test
