// What came in over the wire, and what it answers.
#include "engine/bus_engine.hpp"
#include "engine/call_errors.hpp"

namespace tmcl::engine {
namespace {

// One could be a coincidence.
constexpr unsigned echoes_to_tell = 3;

}  // namespace

void BusEngine::on_bytes(std::span<const std::uint8_t> bytes, TimePoint now) {
  const auto echoes_before = echo_.echoes();
  for (const auto byte : bytes) {
    for (const auto left : echo_.pass(byte)) on_byte(left, now);
  }
  if (echoes_before < echoes_to_tell && echo_.echoes() >= echoes_to_tell) tell_of_echo();
  go_on(now);
}

void BusEngine::on_byte(std::uint8_t byte, TimePoint now) {
  const auto item = decoder_.push(byte);
  if (!item) return;
  const bool may_answer = !decoder_.began_before_exchange();
  if (const auto* reply = std::get_if<Reply>(&*item)) {
    on_reply(*reply, may_answer, now);
  } else if (may_answer && modules_.line().is_busy()) {
    on_version_text(modules_.line(), std::get<VersionText>(*item).version, now);
  }
}

void BusEngine::tell_of_echo() {
  actions_.push_back(BusEvent{BusEvent::Kind::link_condition,
                              {},
                              0,
                              "every request comes back: the adapter hears what it sends, which is "
                              "no harm; what comes back is left out"});
}

void BusEngine::on_frame(const CanFrame& frame, TimePoint now) {
  std::optional<FirmwareVersion> text;
  auto* const channel = modules_.find_channel([&](const Channel& busy) {
    if (busy.is_busy()) text = busy.form_of_answer().text_in(frame);
    return text.has_value();
  });
  if (channel != nullptr) {
    on_version_text(*channel, *text, now);
  } else if (const auto reply = decode_can_reply(frame)) {
    on_reply(*reply, true, now);
  } else {
    counters_.garbage_bytes += frame.length;
  }
  go_on(now);
}

/// `may_answer`: it began to come in after the last request had gone out.
void BusEngine::on_reply(const Reply& reply, bool may_answer, TimePoint now) {
  auto* const module = modules_.find(reply.module);
  const bool is_event =
      reply.command == Command::TARGET_REACHED_EVENT && reply.status == Status::delayed;
  if (is_event) return on_event(module, reply);
  if (module != nullptr) {
    auto& channel = modules_.channel_of(*module);
    if (may_answer && channel.is_answered_by(reply)) return conclude(channel, Answer{reply}, now);
  }
  const auto is_disguised = [&](const Channel& channel) {
    return may_answer && channel.is_busy() && channel.form_of_answer().is_unframed();
  };
  if (auto* channel = modules_.find_channel(is_disguised))
    return on_unframed_reply(*channel, reply, now);
  if (may_answer && is_from_only_module(reply, now))
    return conclude(modules_.line(), Answer{reply}, now);
  if (module != nullptr) return on_unexplained(*module, reply, now);
  ++counters_.unexpected_replies;
}

void BusEngine::on_event(const Conversation* module, const Reply& reply) {
  if (module == nullptr) {
    ++counters_.unexpected_replies;
    return;
  }
  actions_.push_back(BusEvent{BusEvent::Kind::target_reached, module->address, reply.value});
}

void BusEngine::on_unframed_reply(Channel& channel, const Reply& reply, TimePoint now) {
  if (channel.is_answered_by(reply)) return conclude(channel, Answer{reply}, now);
  if (is_late_from_other(reply, channel.in_flight().sent, now)) {
    ++counters_.late_replies;
    return;
  }
  const auto done = settle(channel, channel.in_flight().sent.address, Status::ok, now);
  if (done.call) complete(*done.call, Answer{reply});
}

/// Such a reply and a line of a program look alike.
bool BusEngine::is_late_from_other(const Reply& reply, const Request& sent, TimePoint now) {
  if (reply.module == reply_byte(sent.address)) return false;
  const auto* other = modules_.find(reply.module);
  return other != nullptr && other->lane.may_still_answer(reply.command, now);
}

void BusEngine::on_version_text(Channel& channel, FirmwareVersion version, TimePoint now) {
  const auto& sent = channel.in_flight().sent;
  const Reply reply{options_.host_address, reply_byte(sent.address), Status::ok, sent.command, 0};
  conclude(channel, Answer{reply, version}, now);
}

InFlight BusEngine::take_from(Channel& channel) {
  auto taken = channel.take();
  expect_answer();
  return taken;
}

/// Of what is under way on a serial line.
void BusEngine::expect_answer() {
  const auto& line = modules_.line();
  const auto sent = line.is_busy() ? line.in_flight().sent : Request{};
  ReplyForm::of(sent).expect(decoder_);
}

/// What every answer means, whatever it says.
InFlight BusEngine::settle(Channel& channel, ModuleAddress from, Status status, TimePoint now) {
  auto done = take_from(channel);
  ++counters_.replies;
  auto& module = modules_.with(from);
  const auto command = done.sent.command;
  auto& lane = module.lane;
  lane.answered(command, now);
  if (done.is_fence()) lane.note_answered_fence();
  module.custody.on_answered(command, status, now);
  const bool proves_step = !done.call || done.ends_download();
  const bool proves_answers = lane.in_step() && lane.holds_back_any() && !lane.holds_back(command);
  if ((proves_step || proves_answers) && !lane.may_still_answer(command, now)) {
    lane.prove();
    hand_out_proven(module, now);
  }
  return done;
}

void BusEngine::conclude(Channel& channel, Answer answer, TimePoint now) {
  const auto status = answer.reply.status;
  const auto meant = channel.in_flight().sent.address;
  const bool is_meant = answer.reply.module == reply_byte(meant);
  auto done = settle(channel, is_meant ? meant : ModuleAddress{answer.reply.module}, status, now);
  if (!done.call) return;
  answer.sent = done.sent_at;
  answer.received = now;
  const auto& lane = modules_.with(done.sent.address).lane;
  answer.duplicate_suspected = lane.is_duplicate_suspected(now);
  done.call->was_slow = done.deadline - now < reply_time(done.call->options) * 7 / 8;
  if (must_prove(*done.call, answer.reply, now))
    return hold_back(std::move(*done.call), answer, now);
  finish(std::move(*done.call), answer);
}

void BusEngine::finish(Call call, const Answer& answer) {
  const auto status = answer.reply.status;
  const bool wrongly_recorded = status == Status::command_loaded && !call.options.hold;
  if (wrongly_recorded) return on_recorded(std::move(call), status);
  if (is_success(status)) return complete(call, answer);
  auto error = refusal(call.request, status);
  if (status == Status::wrong_checksum) return repeat_or_give_up(std::move(call), std::move(error));
  fail(call, std::move(error));
}

/// Nothing was executed: the module was left in download mode. Only a stop ends that.
void BusEngine::on_recorded(Call call, Status status) {
  if (call.is_stop()) {
    modules_.with(call.request.address).custody.found_recording();
    if (call.times_sent < options_.attempts) return queue().put_back(std::move(call));
  }
  fail(call, recorded_error(call, status));
}

}  // namespace tmcl::engine
