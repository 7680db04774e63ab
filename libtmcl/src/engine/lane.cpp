#include "engine/lane.hpp"

#include <array>
#include <chrono>

namespace tmcl::engine {
namespace {

using namespace std::chrono_literals;

// After so long even a module that was busy writing its EEPROM has answered or never will.
constexpr Duration reply_lifetime = 2s;
// Two modules of one address answer within a reply time of each other.
constexpr Duration second_reply_window = 100ms;
// One reply that nobody asked for may be what another program has left behind. So many within so
// long have a source.
constexpr unsigned most_stray_replies = 2;
constexpr Duration stray_reply_window = 10s;
// So long after the last such reply its source is thought to be gone.
constexpr Duration suspicion_lifetime = 60s;

struct Fence {
  Command command;
  std::uint8_t type;
};
// Reads that every module answers, be it with an error status.
constexpr std::array fences{Fence{Command::GET_FIRMWARE_VERSION, 1}, Fence{Command::GAP, 8},
                            Fence{Command::GGP, 66}, Fence{Command::GET_APPLICATION_STATUS, 0},
                            Fence{Command::GIO, 0}};

}  // namespace

void Lane::abandon(Command command, TimePoint now) {
  abandoned_.set(static_cast<std::size_t>(command));
  last_abandoned_ = now;
  in_step_ = false;
}

void Lane::prove() {
  in_step_ = true;
  failed_fences_ = 0;
  abandoned_.reset();
}

bool Lane::fence_failed(unsigned tries, TimePoint silent_until) {
  if (++failed_fences_ < tries) return false;
  failed_fences_ = 0;
  silent_until_ = silent_until;
  return true;
}

std::optional<Request> Lane::fence(ModuleAddress address, Command next, TimePoint now) {
  if (now - last_abandoned_ > reply_lifetime) abandoned_.reset();
  for (const auto& candidate : fences) {
    if (candidate.command == next || has_abandoned(candidate.command)) continue;
    return Request{address, candidate.command, candidate.type, 0, 0};
  }
  return std::nullopt;
}

bool Lane::may_still_answer(Command command, TimePoint now) const {
  return has_abandoned(command) && now - last_abandoned_ <= reply_lifetime;
}

void Lane::answered(Command command, TimePoint now) {
  last_answered_ = command;
  last_answered_at_ = now;
}

bool Lane::note_surplus(Command command, TimePoint now) {
  const bool was_suspected = is_duplicate_suspected(now);
  if (now - surplus_since_ > stray_reply_window) surplus_ = 0;
  if (surplus_++ == 0) surplus_since_ = now;
  last_surplus_ = now;
  duplicate_suspected_ =
      was_suspected || is_second_reply(command, now) || surplus_ > most_stray_replies;
  return duplicate_suspected_ && !was_suspected;
}

bool Lane::is_duplicate_suspected(TimePoint now) const {
  return duplicate_suspected_ && now - last_surplus_ <= suspicion_lifetime;
}

bool Lane::is_second_reply(Command command, TimePoint now) const {
  return last_answered_ == command && now - last_answered_at_ <= second_reply_window;
}

}  // namespace tmcl::engine
