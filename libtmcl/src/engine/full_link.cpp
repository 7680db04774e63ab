// A link that takes nothing now, and what becomes of the calls that it refused.
#include <chrono>

#include "engine/bus_engine.hpp"
#include "engine/call_errors.hpp"
#include "tmcl/ensure.hpp"

namespace tmcl::engine {
namespace {

// A CAN interface at 125 kbit/s gets rid of two frames meanwhile.
constexpr Duration full_link_pause = std::chrono::milliseconds(2);
// In this time even a queue of 1000 frames drains at 125 kbit/s: so long a stop is tried.
constexpr Duration full_link_stop_time = std::chrono::seconds(2);

}  // namespace

void BusEngine::on_send_refused(const Request& request, TimePoint now) {
  if (!take_back_last_send(request)) return;
  scheduler_.on_link_full(now + full_link_pause);
  queue().for_each([&](Call& call) {
    if (!call.refused_since) call.refused_since = now;
  });
  end_refused_calls(now);
  go_on(now);
}

bool BusEngine::take_back_last_send(const Request& request) {
  if (!handed_out_ || handed_out_->request != request) return false;
  const auto unsent = *std::exchange(handed_out_, std::nullopt);
  --counters_.requests;
  auto& channel = modules_.channel_to(request.address);
  if (channel.has_sent(request)) {
    take_back(channel);
  } else {
    take_back_early_stop(unsent.place);
  }
  return true;
}

void BusEngine::take_back(Channel& channel) {
  auto refused = take_from(channel);
  if (refused.call) return take_back_call(std::move(*refused.call));
  if (refused.leaves_ascii) return ask_for_rescue_again(refused.sent.address);
  if (refused.is_fence()) {
    --counters_.fences;
    return;
  }
  // Counted where no call waits for it: then it is not tried for ever.
  const auto byte = reply_byte(refused.sent.address);
  const auto waits = [&](const Call& call) { return reply_byte(call.request.address) == byte; };
  if (queue().find(waits) != nullptr) modules_.with(refused.sent.address).custody.on_end_refused();
}

void BusEngine::take_back_call(Call call) {
  --call.times_sent;
  // What came meanwhile found it in flight, and not in the queue.
  const auto ends_it = [&](const Call& queued) {
    return queued.is_stop() && is_ended_by(queued.request, call);
  };
  if (auto error = objection_of_hold(call)) return fail(call, std::move(*error));
  if (queue().find(ends_it) != nullptr) return fail(call, superseded_error(call));
  queue().put_back(std::move(call));
}

void BusEngine::take_back_early_stop(std::uint64_t place) {
  auto* stop = queue().find([&](const Call& call) { return call.place == place; });
  if (stop == nullptr) return;
  stop->sent_early = false;
  modules_.with(stop->request.address).lane.note_late(stop->request.command);
}

/// A stop is tried longer than anything else.
Duration BusEngine::time_for_link(const Call& call) const {
  return call.is_stop() ? full_link_stop_time : reply_time(call.options);
}

void BusEngine::end_refused_calls(TimePoint now) {
  const auto waited_long = [&](const Call& call) {
    return call.refused_since && now - *call.refused_since >= time_for_link(call);
  };
  fail_if(waited_long, [&](const Call& call) {
    return full_link_error(call, modules_.framing(), time_for_link(call));
  });
}

void BusEngine::confirm_last_send() {
  if (!handed_out_) return;
  const auto request = std::exchange(handed_out_, std::nullopt)->request;
  scheduler_.on_link_took();
  if (reply_kind(request.command) != ReplyKind::none) return;
  auto& module = modules_.with(request.address);
  auto& channel = modules_.channel_of(module);
  if (!channel.has_sent(request)) return;
  auto sent = channel.take();
  ensure(sent.call.has_value());
  const auto call = std::move(*sent.call);
  module.lane.lose_step();
  channel.keep_quiet_until(scheduler_.now() + wire_time_ + options_.quiet_time);
  complete(call, Answer{Reply{options_.host_address, reply_byte(request.address), Status::ok,
                              request.command, request.value}});
  go_on(scheduler_.now());
}

}  // namespace tmcl::engine
