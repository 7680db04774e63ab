// Calls that try once whether a module is there, as hosts at a port do that speak TMCL themselves.
#include <chrono>

#include "engine/bus_engine.hpp"

namespace tmcl::engine {
namespace {

// Adapters for USB keep what has come for up to 16 ms.
constexpr Duration time_of_adapter = std::chrono::milliseconds(20);

/// Scans set a time of their own.
bool only_tries(const Call& call) {
  return call.options.attempts == 1 && !call.options.reply_timeout && call.options.asker != 0 &&
         (call.effect == Effect::reads || call.effect == Effect::stops);
}

}  // namespace

/// Who tries a module and then asks something else has given the first one up. On a serial line its
/// answer is awaited no longer than a module needs, so that the next one is not late.
void BusEngine::hurry(const Call& next, TimePoint now) {
  auto& line = modules_.line();
  if (!line.is_busy() || !is_given_up_with(line.in_flight(), next)) return;
  const auto needed = wire_time_ + options_.telegram_pause + time_of_adapter;
  line.shorten(line.in_flight().sent_at + needed);
  if (line.is_overdue(now)) on_time_out(line, now);
}

/// So is a fence that no other call waits for.
bool BusEngine::is_given_up_with(const InFlight& in_flight, const Call& next) {
  const auto gives_up = [&](const Call& call) {
    return only_tries(call) && call.options.asker == next.options.asker;
  };
  if (in_flight.call) return gives_up(*in_flight.call);
  const auto byte = reply_byte(in_flight.sent.address);
  const auto keeps_on = [&](const Call& call) {
    return reply_byte(call.request.address) == byte && !gives_up(call);
  };
  return in_flight.is_fence() && queue().find(keeps_on) == nullptr;
}

/// A module on USB takes what is for any address, and answers with its own. That explains the reply
/// to a try at an address that was never heard.
bool BusEngine::is_from_only_module(const Reply& reply, TimePoint now) {
  auto& line = modules_.line();
  if (!line.is_busy() || !line.in_flight().call || !only_tries(*line.in_flight().call))
    return false;
  auto meant = line.in_flight().sent;
  if (modules_.with(meant.address).lane.was_heard()) return false;
  auto* const module = modules_.find(reply.module);
  const bool is_late = module != nullptr && module->lane.may_still_answer(reply.command, now);
  meant.address = ModuleAddress{reply.module};
  return !is_late && line.form_of_answer().is_answer(reply, meant);
}

}  // namespace tmcl::engine
