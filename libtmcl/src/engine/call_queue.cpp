#include "engine/call_queue.hpp"

#include "tmcl/coordinates.hpp"

namespace tmcl::engine {
namespace {

bool has_defaults(const CallOptions& options) {
  return !options.deadline && !options.reply_timeout && options.attempts == 0 && !options.hold;
}

}  // namespace

bool is_ended_by(const Request& stop, const Call& call) {
  const auto& request = call.request;
  if (reply_byte(request.address) != reply_byte(stop.address)) return false;
  if (call.effect != Effect::moves) return false;
  // Commands above 127 control programs and chips: they know no motor, so they may concern any.
  return request.motor == stop.motor || moves_together(request, stop.motor) ||
         static_cast<std::uint8_t>(request.command) >= 128;
}

CallQueue::Calls& CallQueue::level_of(const Call& call) {
  switch (call.effect) {
    case Effect::stops: return levels_[0];
    case Effect::reads: return levels_[2];
    default: return levels_[1];
  }
}

void CallQueue::insert(Calls& level, Calls::const_iterator before, Call call) {
  if (spare_.empty()) spare_.emplace_back();
  spare_.front() = std::move(call);
  level.splice(before, spare_, spare_.begin());
  ++size_;
}

void CallQueue::push_back(Call call) {
  call.place = next_place_++;
  auto& level = level_of(call);
  insert(level, level.end(), std::move(call));
}

void CallQueue::put_back(Call call) {
  auto& level = level_of(call);
  const auto later = std::ranges::upper_bound(level, call.place, {}, &Call::place);
  insert(level, later, std::move(call));
}

bool CallQueue::join(const Request& request, const CallOptions& options, Ticket ticket) {
  // Acts go out before reads, so a read that still waits will see everything that was asked for
  // before it.
  if (effect_of(request.command, request.type) != Effect::reads || !has_defaults(options))
    return false;
  auto& reads = levels_[2];
  const auto twin = std::ranges::find_if(reads, [&](const Call& call) {
    return call.request == request && has_defaults(call.options) && !call.unproven;
  });
  if (twin == reads.end()) return false;
  twin->joined.push_back(ticket);
  return true;
}

Call CallQueue::take(const Call& found) {
  auto& level = level_of(found);
  const auto position =
      std::ranges::find_if(level, [&](const Call& call) { return &call == &found; });
  Call call = std::move(*position);
  spare_.splice(spare_.end(), level, position);
  --size_;
  return call;
}

std::optional<TimePoint> CallQueue::earliest_deadline() const {
  std::optional<TimePoint> earliest;
  for (const auto& level : levels_) {
    for (const auto& call : level) {
      const auto deadline = call.options.deadline;
      if (deadline && (!earliest || *deadline < *earliest)) earliest = deadline;
    }
  }
  return earliest;
}

}  // namespace tmcl::engine
