// A link that takes nothing now, and what becomes of the calls that it refused.
#include <chrono>

#include <fmt/format.h>

#include "engine/bus_engine.hpp"

namespace tmcl::engine {
namespace {

// A CAN interface at 125 kbit/s gets rid of two frames meanwhile.
constexpr Duration full_link_pause = std::chrono::milliseconds(2);
// In this time even a queue of 1000 frames drains at 125 kbit/s: so long a stop is tried.
constexpr Duration full_link_stop_patience = std::chrono::seconds(2);

}  // namespace

void BusEngine::on_send_refused(const Request& request, TimePoint now) {
  if (!handed_out_ || handed_out_->request != request) return;
  const auto refused = *std::exchange(handed_out_, std::nullopt);
  --counters_.requests;
  link_is_full_ = true;
  full_until_ = now + full_link_pause;
  auto& channel = channel_to(request.address);
  if (channel.in_flight && channel.in_flight->sent == request) {
    take_back(channel);
  } else {
    take_back_shout(refused.place);
  }
  queue_.for_each([&](Call& call) {
    if (!call.refused_since) call.refused_since = now;
  });
  end_refused_calls(now);
  go_on(now);
}

void BusEngine::take_back(Channel& channel) {
  auto refused = std::move(*channel.in_flight);
  channel.in_flight.reset();
  expect_special_replies();
  if (!refused.call && refused.sent.command != Command::END_DOWNLOAD) {
    --counters_.fences;
    return;
  }
  if (!refused.call) {
    // Counted where nobody waits for it: then it is not tried for ever.
    const auto byte = reply_byte(refused.sent.address);
    const auto waits = [&](const Call& call) { return reply_byte(call.request.address) == byte; };
    if (queue_.find(waits) != nullptr) module_of(refused.sent.address).custody.on_end_refused();
    return;
  }
  auto& call = *refused.call;
  --call.times_sent;
  // What came meanwhile found it in flight, and not in the queue.
  const auto ends_it = [&](const Call& queued) {
    return queued.is_stop() && is_ended_by(queued.request, call);
  };
  if (auto error = objection_of_hold(call)) return complete(call, tl::unexpected(*error));
  if (queue_.find(ends_it) != nullptr) return supersede(call);
  queue_.put_back(std::move(call));
}

void BusEngine::take_back_shout(std::uint64_t place) {
  auto* stop = queue_.find([&](const Call& call) { return call.place == place; });
  if (stop != nullptr) stop->shouted = false;
}

/// A stop is worth more patience than anything else.
Duration BusEngine::patience_with_link(const Call& call) const {
  return call.is_stop() ? full_link_stop_patience : patience(call.options);
}

void BusEngine::end_refused_calls(TimePoint now) {
  const auto waited_long = [&](const Call& call) {
    return call.refused_since && now - *call.refused_since >= patience_with_link(call);
  };
  for (const auto& call : queue_.remove_if(waited_long))
    complete(call, tl::unexpected(refusal_of_link(call)));
}

void BusEngine::confirm_last_send() {
  if (!handed_out_) return;
  const auto request = std::exchange(handed_out_, std::nullopt)->request;
  if (link_is_full_) queue_.for_each([](Call& call) { call.refused_since.reset(); });
  link_is_full_ = false;
  if (reply_kind(request.command) != ReplyKind::none) return;
  auto& channel = channel_to(request.address);
  if (!channel.in_flight || channel.in_flight->sent != request) return;
  const auto call = std::move(*channel.in_flight->call);
  channel.in_flight.reset();
  module_of(request.address).lane.lose_step();
  channel.quiet_until = last_now_ + wire_time_ + options_.quiet_time;
  complete(call, Answer{Reply{options_.host_address, reply_byte(request.address), Status::ok,
                              request.command, request.value}});
  go_on(last_now_);
}

Error BusEngine::refusal_of_link(const Call& call) const {
  const auto waited =
      std::chrono::duration_cast<std::chrono::milliseconds>(patience_with_link(call)).count();
  if (framing_ == Framing::can) {
    return error_for(
        call, Errc::queue_full,
        fmt::format("the interface's transmit queue was full for {} ms", waited),
        "is another node on the bus, and the bit rate right? A greater txqueuelen takes more");
  }
  return error_for(
      call, Errc::queue_full,
      fmt::format("the link took nothing for {} ms: what was written before is stuck", waited),
      "is the adapter or the converter still alive, and does anything hold the line?");
}

}  // namespace tmcl::engine
