#include "engine/lane.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <utility>

#include "tmcl/command_type.hpp"

namespace tmcl::engine {
namespace {

using namespace std::chrono_literals;

// One unrequested reply may be what another program has left behind. So many within so
// long have a source.
constexpr unsigned most_stray_replies = 2;
constexpr Duration stray_reply_window = 10s;
// So long after the last such reply its source is thought to be gone.
constexpr Duration suspicion_lifetime = 60s;
// What must pass without a sign of trouble, and time_to_trust, before a suspect module is trusted
// again.
constexpr unsigned exchanges_to_trust = 1000;
// A surplus reply that comes while others of its command are awaited is noticed as soon as another
// command goes out: after so many equal ones without a pause.
constexpr unsigned most_equal_in_a_row = 64;
// So many answers are proven together at most, of a module that is not suspect: all are asked for
// again if there is a doubt.
constexpr unsigned most_held_back = 8;

// A fence behind which more replies come is followed by the next one. Two modules of one address,
// or a link that doubles all replies, would go on with that for ever.
constexpr unsigned most_fences_in_a_row = 32;

struct Fence {
  Command command;
  std::uint8_t type;
};
// Reads that every module answers, be it with an error status. So many that, tried one after the
// other, the first is free again before the last has been used.
constexpr std::array fences{Fence{Command::GET_FIRMWARE_VERSION, 1},
                            Fence{Command::GAP, 8},
                            Fence{Command::GGP, 66},
                            Fence{Command::GET_APPLICATION_STATUS, 0},
                            Fence{Command::GIO, 0},
                            Fence{Command::GET_INFO, 1},
                            Fence{Command::GET_AP_MAX, 0},
                            Fence{Command::GET_AP_MIN, 0},
                            Fence{Command::GCO, 0},
                            Fence{Command::MEASURED_SPEED, 0},
                            Fence{Command::RFS, search_type::status},
                            Fence{Command::GET_IDS, 0}};

}  // namespace

void Lane::abandon(Command command, TimePoint now) {
  in_step_ = false;
  std::erase_if(abandoned_, [&](const Abandoned& old) { return !owes(old.command, now); });
  const auto same = std::ranges::find(abandoned_, command, &Abandoned::command);
  if (same == abandoned_.end()) return abandoned_.push_back({command, 1, now});
  ++same->replies;
  same->last = now;
  same->heard.reset();
}

void Lane::hold_back(Command command) {
  held_back_.set(index(command));
  ++answers_held_back_;
}

void Lane::prove() {
  in_step_ = true;
  failed_fences_ = 0;
  held_back_.reset();
  answers_held_back_ = 0;
}

bool Lane::fences_prove_nothing() const { return answered_fences_ >= most_fences_in_a_row; }

bool Lane::fence_failed(unsigned tries, TimePoint now, Duration silence) {
  end_fences();
  if (++failed_fences_ < tries) return false;
  failed_fences_ = 0;
  silent_until_ = now + (stays_silent_ ? silence * 3 / 2 : silence);
  stays_silent_ = true;
  return true;
}

bool Lane::may_still_answer(Command command, TimePoint now) const {
  return std::ranges::any_of(abandoned_, [&](const Abandoned& old) {
    return old.command == command && now - old.last <= reply_lifetime;
  });
}

bool Lane::owes(Command command, TimePoint now) const {
  return std::ranges::any_of(abandoned_, [&](const Abandoned& old) {
    return old.command == command && (!old.heard || now - *old.heard <= reply_lifetime);
  });
}

void Lane::note_heard(TimePoint now) {
  stays_silent_ = false;
  for (auto& old : abandoned_)
    if (!old.heard) old.heard = now;
}

void Lane::note_late(Command command) {
  std::erase_if(abandoned_,
                [&](Abandoned& old) { return old.command == command && --old.replies == 0; });
}

std::optional<Request> Lane::fence(ModuleAddress address, Command next, TimePoint now) {
  if (!is_suspect(now)) next_fence_ = 0;
  for (std::size_t tried = 0; tried < fences.size(); ++tried) {
    const auto& [command, type] = fences[next_fence_++ % fences.size()];
    if (command == next || may_still_answer(command, now) || holds_back(command)) continue;
    return Request{address, command, type, 0, 0};
  }
  return std::nullopt;
}

bool Lane::must_separate(Command command, TimePoint now) const {
  if (answers_held_back_ >= (is_suspect(now) ? 1 : most_held_back)) return true;
  if (last_answered_ != command || holds_back(command)) return false;
  const bool without_pause = now - last_answered_at_ <= second_reply_window;
  return is_suspect(now) || (without_pause && equal_in_a_row_ >= most_equal_in_a_row);
}

void Lane::answered(Command command, TimePoint now) {
  note_heard(now);
  const bool follows = last_answered_ == command && now - last_answered_at_ <= second_reply_window;
  equal_in_a_row_ = follows ? equal_in_a_row_ + 1 : 1;
  if (exchanges_to_trust_ > 0) --exchanges_to_trust_;
  answered_before_ = std::exchange(last_answered_, command);
  last_answered_at_ = now;
}

bool Lane::note_surplus(Command command, TimePoint now) {
  suspect(now);
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

void Lane::suspect(TimePoint now) {
  exchanges_to_trust_ = exchanges_to_trust;
  trusted_from_ = now + time_to_trust;
}

bool Lane::is_suspect(TimePoint now) const {
  return exchanges_to_trust_ > 0 || now < trusted_from_;
}

bool Lane::is_second_reply(Command command, TimePoint now) const {
  const bool was_answered = last_answered_ == command || answered_before_ == command;
  return was_answered && now - last_answered_at_ <= second_reply_window;
}

}  // namespace tmcl::engine
