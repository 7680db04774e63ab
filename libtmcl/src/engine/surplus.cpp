// Unrequested replies, and how a value is told from that of another program then.
#include <chrono>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "engine/bus_engine.hpp"
#include "engine/call_errors.hpp"

namespace tmcl::engine {
namespace {

// How often a value is read anew because two replies came.
constexpr unsigned most_doubts = 8;
// So often a value is read that must be the same twice: one that changes never is. The last one
// counts then. If a motor moves by it, it must have gone on as it did before: what is another's is
// anywhere.
constexpr unsigned usual_readings = 3;
constexpr unsigned most_readings = 8;
constexpr double like_factor = 3;

bool are_alike(double change, double other) {
  return change * other > 0 && std::abs(change) <= like_factor * std::abs(other) &&
         std::abs(other) <= like_factor * std::abs(change);
}

/// From one reading to the next, or in the same time: answers that some adapters collect come
/// earlier and later, and a reading that got lost leaves a gap.
bool goes_on(const Call::Change& now, const Call::Change& before) {
  if (are_alike(now.by, before.by)) return true;
  const auto seconds = [](Duration time) { return std::chrono::duration<double>(time).count(); };
  return are_alike(now.by * seconds(before.in), before.by * seconds(now.in));
}

/// After one more reading.
bool is_settled(Call& call, const Answer& answer) {
  const auto value = answer.reply.value;
  const auto last = std::exchange(call.last_value, value);
  const auto last_at = std::exchange(call.last_read, call.read);
  const Call::Change change{last ? static_cast<double>(value) - *last : 0, call.read - last_at};
  const bool is_like_before = goes_on(change, std::exchange(call.change, change));
  if (++call.readings < usual_readings) return false;
  return last == value || is_like_before || call.options.proof != Proof::twice;
}

}  // namespace

void BusEngine::on_unexplained(Conversation& module, const Reply& reply, TimePoint now) {
  auto& lane = module.lane;
  lane.end_silence();
  doubt_answers(module, reply.command);
  const bool is_owed = lane.owes(reply.command, now);
  lane.note_heard(now);
  if (is_owed) {
    ++counters_.late_replies;
    // A fence of long ago may have been taken for the last one.
    if (!lane.may_still_answer(reply.command, now)) lane.lose_step();
    lane.note_late(reply.command);
    // A fence was answered before it: replies overtake each other.
    if (lane.in_step()) lane.suspect(now);
    if (lane.is_duplicate_suspected(now)) lane.note_surplus(reply.command, now);
    return;
  }
  ++counters_.unexpected_replies;
  ++counters_.surplus;
  lane.lose_step();
  if (!lane.note_surplus(reply.command, now)) return;
  actions_.push_back(BusEvent{
      BusEvent::Kind::duplicate_address, module.address, 0,
      fmt::format("more replies come than were asked for: two modules have the address {}, or "
                  "another program asks on this bus",
                  number(module.address))});
}

void BusEngine::doubt_answers(const Conversation& module, Command command) {
  if (!module.lane.holds_back(command)) return;
  queue().for_each([&](Call& call) {
    const bool is_alike = reply_byte(call.request.address) == reply_byte(module.address) &&
                          call.request.command == command;
    if (call.unproven && is_alike) call.is_doubtful = true;
  });
}

/// A value that was read before, and proven then, needs no more proof if it is the same.
///
/// Not versions: several modules of one address are found by asking for those. And a fence must not
/// go to a module that may record it.
bool BusEngine::must_prove(const Call& call, const Reply& reply, TimePoint now) {
  if (call.before && call.before->reply == reply) return false;
  const auto& module = modules_.with(call.request.address);
  const auto& lane = module.lane;
  const bool has_doubts = lane.is_suspect(now) || lane.is_duplicate_suspected(now) ||
                          lane.owes(call.request.command, now);
  return (has_doubts || call.options.proof != Proof::none) && call.effect == Effect::reads &&
         call.may_repeat() && call.request.command != Command::GET_FIRMWARE_VERSION &&
         reply.status != Status::wrong_checksum && !call.options.hold &&
         !module.custody.is_recording();
}

/// What proves it is of another command: whatever comes of this one before that is answered is a
/// second reply. What waits already goes first, and may be proven together with it.
void BusEngine::hold_back(Call call, const Answer& answer, TimePoint now) {
  ++counters_.suspect;
  modules_.with(call.request.address).lane.hold_back(call.request.command);
  call.unproven = answer;
  call.read = now;
  call.is_doubtful = false;
  queue().push_back(std::move(call));
}

/// Where replies overtake each other, what comes may be the late answer to an older question, and
/// its own one too late as well.
bool BusEngine::must_read_twice(const Call& call, const Lane& lane, TimePoint now) {
  return call.options.proof == Proof::twice ||
         ((lane.is_suspect(now) || call.was_slow) && lane.owes(call.request.command, now));
}

/// Modules answer in order, and another command has just been answered: whatever else came in reply
/// to what was asked before it has come by now.
void BusEngine::hand_out_proven(const Conversation& module, TimePoint now) {
  const auto waits_for_it = [&](const Call& call) {
    return call.unproven && reply_byte(call.request.address) == reply_byte(module.address);
  };
  for (auto& call : queue().remove_if(waits_for_it)) {
    const auto answer = *std::exchange(call.unproven, std::nullopt);
    if (call.is_doubtful) {
      call.before.reset();
      if (++call.doubts == most_doubts) {
        fail(call, doubt_error(call));
        continue;
      }
    } else if (must_read_twice(call, module.lane, now) && !is_settled(call, answer)) {
      call.before = answer;
      if (call.readings == most_readings) {
        fail(call, unsettled_error(call));
        continue;
      }
    } else {
      finish(std::move(call), answer);
      continue;
    }
    queue().put_back(std::move(call));
  }
}

}  // namespace tmcl::engine
