#include "engine/bus_engine.hpp"

#include <algorithm>

#include "engine/call_errors.hpp"
#include "tmcl/result_copy.hpp"

namespace tmcl::engine {
namespace {

// A lost fence may be the line's fault rather than the module's: one more try tells them apart.
constexpr unsigned fence_tries = 2;

}  // namespace

BusEngine::BusEngine(Framing framing, Duration wire_time, BusOptions options)
    : wire_time_(wire_time),
      options_(std::move(options)),
      modules_(framing),
      decoder_(options_.host_address) {}

// ---- what comes from above ----------------------------------------------------------------------

void BusEngine::submit(Ticket ticket, const Request& request, const CallOptions& options,
                       TimePoint now) {
  Call call{request, options, ticket};
  if (lost_) return fail(call, link_lost_error(call, *lost_));
  if (auto error = objection(call)) return fail(call, std::move(*error));
  if (call.is_stop()) drop_moves_before(request);
  hurry(call, now);
  if (queue().join(call)) return go_on(now);
  if (!queue().has_room_for(call)) return fail(call, queue_overflow(call));
  auto& module = modules_.with(request.address);
  module.custody.on_submitted(call);
  if (call.is_stop() || !module.lane.is_silent(now)) module.custody.try_again();
  queue().push_back(std::move(call));
  go_on(now);
}

std::optional<Error> BusEngine::objection(const Call& call) {
  const unsigned highest = modules_.framing() == Framing::serial ? 0xFF : 0x7FF;
  const auto address = call.request.address;
  if (number(address) > highest) return bad_address(address, highest);
  return objection_of_hold(call);
}

std::optional<Error> BusEngine::objection_of_hold(const Call& call) {
  const auto& hold = call.options.hold;
  if (!hold) return std::nullopt;
  const auto& custody = modules_.with(call.request.address).custody;
  const auto end = custody.end_of(hold);
  if (end != Custody::End::not_yet) return ended_hold_error(call, end);
  // Outside download mode the module would execute it.
  if (call.options.is_program_line && !custody.is_recording_for(hold))
    return no_download_error(call);
  return std::nullopt;
}

void BusEngine::on_link_lost(const std::string& why) {
  if (lost_) return;
  lost_ = why;
  handed_out_.reset();
  const auto error_of = [&](const Call& call) { return link_lost_error(call, why); };
  modules_.for_each_channel([&](Channel& channel) {
    if (!channel.is_busy()) return;
    const auto ended = channel.take();
    if (ended.call) fail(*ended.call, error_of(*ended.call));
  });
  fail_if([](const Call&) { return true; }, error_of);
  actions_.push_back(BusEvent{BusEvent::Kind::link_lost, {}, 0, why});
}

// ---- time ---------------------------------------------------------------------------------------

void BusEngine::on_deadline(TimePoint now) {
  modules_.for_each_channel([&](Channel& channel) {
    if (channel.is_overdue(now)) on_time_out(channel, now);
  });
  go_on(now);
}

void BusEngine::on_time_out(Channel& channel, TimePoint now) {
  auto lost = take_from(channel);
  decoder_.reset();
  if (lost.leaves_ascii) return;
  ++counters_.timeouts;
  // It may have been given up only now, because another asker wants the line.
  channel.keep_quiet_until(lost.deadline + options_.quiet_time);
  auto& module = modules_.with(lost.sent.address);
  module.lane.abandon(lost.sent.command, now);
  doubt_answers(module, lost.sent.command);
  if (lost.is_fence() && module.lane.fence_failed(lost.fence_tries, now, options_.silence_time))
    on_silence(lost.sent.address);
  if (!lost.call) return;
  auto error = timeout_error(*lost.call, reply_time(lost.call->options));
  repeat_or_give_up(std::move(*lost.call), std::move(error));
}

/// A stop that came while the last fence was under way still goes out.
void BusEngine::on_silence(ModuleAddress address) {
  ask_for_rescue(address);
  const auto waits_in_vain = [&](const Call& call) {
    const bool is_new_stop = call.is_stop() && !call.was_on_the_wire();
    const bool is_rescue = call.rescue == Call::Rescue::due;
    return reply_byte(call.request.address) == reply_byte(address) && !is_new_stop && !is_rescue;
  };
  fail_if(waits_in_vain, silence_error);
}

void BusEngine::repeat_or_give_up(Call call, Error error) {
  const unsigned attempts = call.options.attempts == 0 ? options_.attempts : call.options.attempts;
  const bool repeats = call.may_repeat() && call.times_sent < attempts;
  if (!repeats && is_worth_rescue(call)) {
    call.rescue = Call::Rescue::due;
    return queue().push_back(std::move(call));
  }
  if (!repeats) return fail(call, std::move(error));
  // An unanswered stop goes behind those of other motors.
  call.is_stop() ? queue().push_back(std::move(call)) : queue().put_back(std::move(call));
}

// ---- who speaks next ----------------------------------------------------------------------------

void BusEngine::go_on(TimePoint now) {
  scheduler_.begin_round(now);
  end_overdue_calls();
  look_after_downloads();
  end_calls_to_bootloaders();
  scheduler_.look_for_bus_wanted(modules_);
  while (auto* call = scheduler_.next(modules_)) go_on_with(*call);
}

void BusEngine::go_on_with(Call& call) {
  auto& module = modules_.with(call.request.address);
  if (call.rescue == Call::Rescue::due) return start_leaving_ascii(call);
  if (scheduler_.goes_out_early(modules_, call)) return send_early(call);
  if (module.lane.is_silent(scheduler_.now()) && !call.is_stop()) {
    const auto unheard = queue().take(call);
    return fail(unheard, silence_error(unheard));
  }
  if (call.options.objection)
    if (auto objection = call.options.objection()) return refuse(call, std::move(*objection));
  scheduler_.on_turn(modules_.framing(), call);
  if (module.custody.is_recording_for(call.options.hold)) return go_on_recording(call);
  if (module.lane.in_step() && !must_fence(module.lane, call)) return start(queue().take(call));
  module.lane.fences_prove_nothing() ? give_up_proof(call.request.address) : start_fence(call);
}

void BusEngine::give_up_proof(ModuleAddress address) {
  modules_.with(address).lane.end_fences();
  const auto waits_for_it = [&](const Call& call) {
    return reply_byte(call.request.address) == reply_byte(address);
  };
  fail_if(waits_for_it, surplus_error);
}

/// Those that joined it have objections of their own.
void BusEngine::refuse(Call& queued, Error objection) {
  objection.outcome = queued.was_on_the_wire() ? Outcome::unknown : Outcome::not_sent;
  objection.request = queued.request;
  objection.bus = options_.name;
  actions_.push_back(Completion{queued.ticket, tl::unexpected(std::move(objection))});
  if (!CallQueue::pass_on(queued)) queue().take(queued);
}

void BusEngine::end_unwanted_reads(TimePoint now) {
  std::optional<Error> objection;
  const auto is_unwanted = [&](const Call& call) {
    if (call.effect != Effect::reads || !call.options.objection) return false;
    objection = call.options.objection();
    return objection.has_value();
  };
  while (auto* call = queue().find(is_unwanted)) refuse(*call, std::move(*objection));
  go_on(now);
}

void BusEngine::end_overdue_calls() {
  const auto now = scheduler_.now();
  const auto is_overdue = [&](const Call& call) {
    return call.options.deadline && *call.options.deadline <= now;
  };
  fail_if(is_overdue, deadline_error);
}

void BusEngine::look_after_downloads() {
  if (lost_) return;
  const auto now = scheduler_.now();
  for (auto& [byte, module] : modules_.all()) {
    const auto& channel = modules_.channel_of(module);
    module.custody.look_after(now, channel.is_busy());
    if (module.custody.must_end() && channel.is_free(now) && !scheduler_.is_link_full())
      start_end(module);
  }
}

void BusEngine::end_calls_to_bootloaders() {
  const auto is_lost = [&](const Call& call) {
    return modules_.with(call.request.address).custody.is_lost_on_bootloader(call);
  };
  fail_if(is_lost, bootloader_error);
}

/// A stop waits for no fence as long as the module is in step: its answer can be that to another
/// stop, but it was sent.
bool BusEngine::must_fence(const Lane& lane, const Call& call) const {
  if (call.unproven) return true;
  return !call.is_stop() && lane.must_separate(call.request.command, scheduler_.now());
}

/// A fence would become a line of the program: out of step, nothing goes out but the end of the
/// download.
void BusEngine::go_on_recording(const Call& next) {
  const bool in_step = modules_.with(next.request.address).lane.in_step();
  auto call = queue().take(next);
  if (in_step || call.request.command == Command::END_DOWNLOAD) return start(std::move(call));
  fail(call, broken_download_error(call));
}

void BusEngine::send_early(Call& call) {
  call.sent_early = true;
  auto& module = modules_.with(call.request.address);
  module.lane.abandon(call.request.command, scheduler_.now());
  modules_.channel_of(module).keep_quiet_until(scheduler_.now() + wire_time_ + options_.quiet_time);
  ++counters_.requests;
  send({call.request, call.place, call.options.asker});
}

void BusEngine::start(Call call) {
  auto& module = modules_.with(call.request.address);
  ++call.times_sent;
  module.lane.end_fences();
  module.custody.on_sent(call, scheduler_.now());
  const auto request = call.request;
  const auto deadline = scheduler_.now() + reply_time(call.options);
  put_in_flight(modules_.channel_of(module), {request, deadline, std::move(call), 0});
}

void BusEngine::start_fence(const Call& next) {
  const auto now = scheduler_.now();
  const auto address = next.request.address;
  auto& module = modules_.with(address);
  // A scan asks once and goes on; and what a rescue did not bring back, or has been silent before,
  // is most likely not there.
  const bool asks_once = next.options.attempts == 1 || next.rescue == Call::Rescue::tried ||
                         module.lane.stays_silent();
  const unsigned tries = asks_once ? 1 : fence_tries;
  const auto fence = module.lane.fence(address, next.request.command, now);
  if (!fence) {
    module.lane.fence_failed(1, now, options_.silence_time);
    return on_silence(address);
  }
  ++counters_.fences;
  put_in_flight(modules_.channel_of(module),
                {*fence, now + reply_time(next.options), std::nullopt, tries});
}

void BusEngine::start_end(Conversation& module) {
  module.custody.on_end_sent();
  const Request end{module.address, Command::END_DOWNLOAD, 0, 0, 0};
  put_in_flight(modules_.channel_of(module),
                {end, scheduler_.now() + reply_time({}), std::nullopt, 0});
}

void BusEngine::put_in_flight(Channel& channel, InFlight in_flight) {
  ++counters_.requests;
  const auto asker = in_flight.call ? in_flight.call->options.asker : 0;
  send({in_flight.sent, 0, asker, in_flight.leaves_ascii});
  in_flight.sent_at = scheduler_.now();
  channel.put(std::move(in_flight));
  expect_answer();
}

void BusEngine::send(const Send& send) {
  decoder_.begin_exchange();
  if (modules_.framing() == Framing::serial) echo_.begin(send.request);
  actions_.push_back(send);
}

Duration BusEngine::reply_time(const CallOptions& options) const {
  const bool is_serial = modules_.framing() == Framing::serial;
  const auto pause = is_serial ? options_.telegram_pause : Duration{};
  auto wait = options.reply_timeout.value_or(options_.reply_timeout);
  // Impatience pays only where others wait for the line.
  if (!is_serial) wait = std::max(wait, options_.reply_timeout);
  return wire_time_ + pause + wait;
}

// ---- what goes out ------------------------------------------------------------------------------

void BusEngine::complete(const Call& call, const Result<Answer>& result) {
  actions_.push_back(Completion{call.ticket, copy_of(result)});
  for (const auto& other : call.joined)
    actions_.push_back(Completion{other.ticket, copy_of(result)});
}

void BusEngine::fail(const Call& call, Error error) {
  error.bus = options_.name;
  complete(call, tl::unexpected(std::move(error)));
}

std::optional<Action> BusEngine::next_action() {
  confirm_last_send();
  if (actions_given_ == actions_.size()) {
    actions_.clear();
    actions_given_ = 0;
    return std::nullopt;
  }
  auto action = std::move(actions_[actions_given_++]);
  if (const auto* send = std::get_if<Send>(&action)) handed_out_ = *send;
  return action;
}

BusCounters BusEngine::counters() const {
  auto counters = counters_;
  counters.garbage_bytes += decoder_.dropped_bytes();
  return counters;
}

}  // namespace tmcl::engine
