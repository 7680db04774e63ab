// Replies that nobody here has asked for, and how a value is told from somebody else's then.
#include <fmt/format.h>

#include "engine/bus_engine.hpp"
#include "engine/call_errors.hpp"

namespace tmcl::engine {
namespace {

// How often a value is read anew because two replies came.
constexpr unsigned most_doubts = 8;

}  // namespace

void BusEngine::on_unexplained(Conversation& module, const Reply& reply, TimePoint now) {
  auto& lane = module.lane;
  if (lane.has_abandoned(reply.command)) {
    ++counters_.late_replies;
    if (lane.is_duplicate_suspected(now)) lane.note_surplus(reply.command, now);
    return doubt_answers_like(reply);
  }
  ++counters_.unexpected_replies;
  lane.lose_step();
  if (!lane.note_surplus(reply.command, now)) return;
  actions_.push_back(BusEvent{
      BusEvent::Kind::duplicate_address, module.address, 0,
      fmt::format("more replies come than were asked for: two modules have the address {}, or "
                  "another program asks on this bus",
                  number(module.address))});
}

void BusEngine::doubt_answers_like(const Reply& reply) {
  queue().for_each([&](Call& call) {
    const bool is_alike =
        reply_byte(call.request.address) == reply.module && call.request.command == reply.command;
    if (call.unproven && is_alike) call.is_doubtful = true;
  });
}

/// Not versions: several modules of one address are found by asking for those. And a fence must not
/// go to a module that may record it.
bool BusEngine::must_prove(const Call& call, Status status, TimePoint now) {
  const auto& module = modules_.with(call.request.address);
  return module.lane.is_duplicate_suspected(now) && call.effect == Effect::reads &&
         call.may_repeat() && call.request.command != Command::GET_FIRMWARE_VERSION &&
         status != Status::wrong_checksum && !call.options.hold && !module.custody.is_recording();
}

/// The fence that follows must be of another command: whatever comes of this one before it is
/// answered is a second reply.
void BusEngine::hold_back(Call call, const Answer& answer, TimePoint now) {
  modules_.with(call.request.address).lane.abandon(call.request.command, now);
  call.unproven = answer;
  call.is_doubtful = false;
  queue().put_back(std::move(call));
}

/// Modules answer in order, and a fence has just been answered: whatever else came in reply to what
/// was asked before it has come by now.
void BusEngine::hand_out_proven(const Conversation& module) {
  const auto waits_for_it = [&](const Call& call) {
    return call.unproven && reply_byte(call.request.address) == reply_byte(module.address);
  };
  for (auto& call : queue().remove_if(waits_for_it)) {
    const auto answer = *std::exchange(call.unproven, std::nullopt);
    if (!call.is_doubtful) {
      finish(std::move(call), answer);
    } else if (++call.doubts < most_doubts) {
      queue().put_back(std::move(call));
    } else {
      fail(call, doubt_error(call));
    }
  }
}

}  // namespace tmcl::engine
