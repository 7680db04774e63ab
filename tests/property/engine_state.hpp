/// What an engine has in mind, as bytes: two of equal bytes do the same from now on, however they
/// got there.
///
/// Times count from now. What only counts is left out, and what is forgotten by now. A new member
/// of the engine's parts does not compile until it has a place here.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "engine/bus_engine.hpp"

namespace tmcl::engine {

/// Of a serial line on which whole replies come and nobody holds a module, when the engine has
/// said all that it wants.
class EngineState {
 public:
  EngineState(const BusEngine& engine, TimePoint now) : now_(now) { add(engine); }

  template <class Number>
  requires std::is_arithmetic_v<Number> || std::is_enum_v<Number>
  void add(Number number) { bytes_.append(reinterpret_cast<const char*>(&number), sizeof number); }
  void add(TimePoint time) { add((time - now_).count()); }
  void add(const Reply& reply) { add_all(reply.module, reply.status, reply.command, reply.value); }

  void add(const Request& request) {
    const auto& [address, command, type, motor, value] = request;
    add_all(address, command, type, motor, value);
  }

  const std::string& bytes() const { return bytes_; }

 private:
  template <class... Parts>
  void add_all(const Parts&... parts) {
    (add(parts), ...);
  }
  template <class Part>
  void add(const std::optional<Part>& part) {
    add(part.has_value());
    if (part) add(*part);
  }
  template <class Parts, class Add>
  void add_each(const Parts& parts, const Add& add_part) {
    add(std::ranges::distance(parts));
    std::ranges::for_each(parts, add_part);
  }
  void add_until(TimePoint time) { add(std::max(time, now_)); }
  bool is_over(TimePoint time, Duration lasts) const { return now_ - time > lasts; }

  void add(const BusEngine& engine) {
    const auto& [wire_time, options, scheduler, modules, decoder, echo, actions, given, counters,
                 lost, handed_out] = engine;
    find_places(scheduler, modules);
    add(scheduler);
    add(modules.line_);
    for (const auto& [byte, module] : modules.all()) add(module);
    add(echo);
    add(lost.has_value());
  }

  /// Of those that calls have in the queue only the order counts.
  void find_places(const Scheduler& scheduler, const Conversations& modules) {
    for (const auto& level : scheduler.queue_.levels_) {
      for (const auto& call : level) places_.push_back(call.place);
    }
    const auto& in_flight = modules.line_.in_flight_;
    if (in_flight && in_flight->call) places_.push_back(in_flight->call->place);
    std::ranges::sort(places_);
  }

  void add(const Scheduler& scheduler) {
    const auto& [queue, now, passed_over, spare, sent_stops, bus_is_wanted, link_refused,
                 full_until] = scheduler;
    const auto& [levels, spare_calls, next_place] = queue;
    for (const auto& level : levels) add_each(level, [&](const Call& call) { add(call); });
    for (const auto& [channel, parties] : passed_over) {
      for (const auto& [party, times] : parties) add_all(party.first, party.second, times);
    }
    add_each(sent_stops, [&](const Scheduler::SentStop& stop) {
      add(stop.request);
      add(stop.at);
    });
    add_all(bus_is_wanted, link_refused);
    add_until(full_until);
  }
  void add(const Call& call) {
    const auto& [request, options, ticket, joined, times_sent, sent_early, rescue, place,
                 refused_since, unproven, is_doubtful, doubts, was_slow, before, last_value, read,
                 last_read, change, readings, effect] = call;
    add_all(ticket, times_sent, sent_early, rescue);
    add_each(joined, [&](const Joined& other) { add(other.ticket); });
    add(std::ranges::lower_bound(places_, place) - places_.begin());
    add(refused_since);
    add_answer(unproven);
    add_all(is_doubtful, doubts, was_slow);
    add_answer(before);
    add_all(last_value, readings);
    if (unproven) add(read);
    if (last_value) add(last_read);
    add(change.by);
    if (change.by != 0) add(change.in.count());
  }
  void add_answer(const std::optional<Answer>& answer) {
    add(answer.has_value());
    if (answer) add(answer->reply);
  }

  void add(const Channel& channel) {
    const auto& [in_flight, quiet_until] = channel;
    add(in_flight);
    add_until(quiet_until);
  }
  void add(const InFlight& in_flight) {
    const auto& [sent, deadline, call, fence_tries, sent_at, leaves_ascii] = in_flight;
    add(sent);
    add(deadline);
    add(call);
    add_all(fence_tries, leaves_ascii);
  }
  void add(const LineEcho& echo) {
    const auto& [expected, held, seen, expects, echoes] = echo;
    add(expects);
    if (expects) add_all(seen, echoes);
  }

  void add(const Conversation& module) {
    const auto& [address, lane, custody, own_channel] = module;
    add(address);
    add(lane);
    const auto& [holder, ended, has_holder, in_bootloader, recording, ends_sent, last_used] =
        custody;
    add_all(has_holder, recording, ends_sent);
  }
  void add(const Lane& lane) {
    const auto& [in_step, failed_fences, stays_silent, answered_fences, next_fence, abandoned,
                 held_back, answers_held_back, silent_until, last_answered, answered_before,
                 last_answered_at, equal_in_a_row, duplicate_suspected, surplus, surplus_since,
                 last_surplus, exchanges_to_trust, trusted_from] = lane;
    add_all(in_step, failed_fences, stays_silent, answered_fences, answers_held_back, last_answered,
            answered_before);
    for (const auto& [command, replies, last, heard] : abandoned) {
      if (!lane.owes(command, now_) && is_over(last, Lane::reply_lifetime)) continue;
      add_all(command, replies, last, heard);
    }
    bytes_.append(reinterpret_cast<const char*>(&held_back), sizeof held_back);
    add_until(silent_until);
    const bool is_long_ago = is_over(last_answered_at, Lane::second_reply_window);
    add(is_long_ago);
    if (!is_long_ago) add_all(last_answered_at, equal_in_a_row);
    add_all(duplicate_suspected, surplus, exchanges_to_trust, lane.is_suspect(now_));
    if (surplus > 0) add_all(surplus_since, last_surplus);
    if (lane.is_suspect(now_)) add_all(next_fence, trusted_from);
  }

  TimePoint now_;
  std::string bytes_;
  std::vector<std::uint64_t> places_;
};

}  // namespace tmcl::engine
