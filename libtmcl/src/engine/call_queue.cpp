#include "engine/call_queue.hpp"

#include <utility>

#include "tmcl/address.hpp"
#include "tmcl/intent.hpp"

namespace tmcl::engine {
namespace {

bool has_defaults(const CallOptions& options) {
  return !options.deadline && !options.reply_timeout && options.attempts == 0 && !options.hold &&
         options.proof == Proof::none;
}

}  // namespace

bool is_ended_by(const Request& stop, const Call& call) {
  const auto& request = call.request;
  if (reply_byte(request.address) != reply_byte(stop.address)) return false;
  return call.effect == Effect::moves && can_move(request, {request.address, stop.motor});
}

std::size_t CallQueue::kind_of(const Call& call) {
  switch (call.effect) {
    case Effect::stops: return 0;
    case Effect::reads: return 2;
    default: return 1;
  }
}

std::size_t CallQueue::size() const {
  std::size_t size = 0;
  for (const auto& level : levels_) size += level.size();
  return size;
}

void CallQueue::insert(Calls& level, Calls::const_iterator before, Call call) {
  if (spare_.empty()) spare_.emplace_back();
  spare_.front() = std::move(call);
  level.splice(before, spare_, spare_.begin());
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

// Of calls that wait at the same time none is known to be first: so a read may be joined by
// a later one, and a stop goes out before every movement that could lie between. A stop that went
// out before may have been lost, or be at its last try.
bool CallQueue::join(const Call& newcomer) {
  const auto kind = kind_of(newcomer);
  if (kind == 1 || !has_defaults(newcomer.options)) return false;
  const auto twin = std::ranges::find_if(levels_[kind], [&](const Call& call) {
    const bool is_last_try =
        call.is_stop() && (call.was_on_the_wire() || call.rescue != Call::Rescue::none);
    const bool is_fresh = !call.unproven && !is_last_try;
    return call.request == newcomer.request && has_defaults(call.options) && is_fresh;
  });
  if (twin == levels_[kind].end()) return false;
  const auto& options = newcomer.options;
  twin->joined.push_back({newcomer.ticket, options.asker, options.objection});
  return true;
}

bool CallQueue::pass_on(Call& call) {
  if (call.joined.empty()) return false;
  auto& next = call.joined.front();
  call.ticket = next.ticket;
  call.options.asker = next.asker;
  call.options.objection = std::move(next.objection);
  call.joined.erase(call.joined.begin());
  return true;
}

Call CallQueue::take(const Call& found) {
  auto& level = level_of(found);
  const auto position =
      std::ranges::find_if(level, [&](const Call& call) { return &call == &found; });
  Call call = std::move(*position);
  spare_.splice(spare_.end(), level, position);
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
