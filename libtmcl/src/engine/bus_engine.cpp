#include "engine/bus_engine.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>

#include "tmcl/program.hpp"

namespace tmcl::engine {
namespace {

// A lost fence may be the line's fault rather than the module's: one more try tells them apart.
constexpr unsigned fence_tries = 2;
// So soon it is noticed that a hold is gone.
constexpr Duration care_interval = std::chrono::milliseconds(50);

bool wants_version_text(const Request& request) {
  return request.command == Command::GET_FIRMWARE_VERSION &&
         request.type == static_cast<std::uint8_t>(VersionForm::text);
}

bool reads_memory(const Request& request) { return request.command == Command::READ_TMCL_MEMORY; }

Outcome outcome_so_far(const Call& call) {
  return call.times_sent == 0 && !call.shouted ? Outcome::not_sent : Outcome::unknown;
}

std::optional<FirmwareVersion> version_text_in(const CanFrame& frame) {
  std::array<char, version_text_size> text{};
  std::ranges::transform(frame.data, text.begin(),
                         [](std::uint8_t byte) { return static_cast<char>(byte); });
  return version_from_text(std::string_view(text.data(), frame.length));
}

}  // namespace

BusEngine::BusEngine(Framing framing, Duration wire_time, BusOptions options)
    : framing_(framing),
      wire_time_(wire_time),
      options_(std::move(options)),
      decoder_(options_.host_address) {}

// ---- what comes from above
// ------------------------------------------------------------------------------------------

void BusEngine::submit(Ticket ticket, const Request& request, const CallOptions& options,
                       TimePoint now) {
  Call call{request, options, {ticket}};
  if (lost_) return complete(call, tl::unexpected(error_for(call, Errc::link_lost, *lost_, {})));
  if (auto error = objection(call)) return complete(call, tl::unexpected(std::move(*error)));
  if (queue_.join(request, options, ticket)) return;
  const auto room = call.is_stop() ? 2 * max_queued_calls : max_queued_calls;
  if (queue_.size() >= room) {
    return complete(call, tl::unexpected(error_for(
                              call, Errc::queue_full, "too many commands wait for this bus",
                              "send fewer commands at once, or use a faster bus")));
  }
  if (call.is_stop()) {
    drop_movements_before(request);
    end_downloads_for(request);
  }
  auto& module = module_of(request.address);
  if (call.is_stop() || !module.lane.is_silent(now)) module.custody.try_again();
  queue_.push_back(std::move(call));
  go_on(now);
}

std::optional<Error> BusEngine::objection(const Call& call) {
  const auto& request = call.request;
  const unsigned highest = framing_ == Framing::serial ? 0xFF : 0x7FF;
  if (number(request.address) <= highest) return objection_of_hold(call);
  auto error = bad_argument(fmt::format("{} is no module address", number(request.address)),
                            fmt::format("addresses on this bus are 0 to {}", highest));
  error.bus = options_.name;
  return error;
}

std::optional<Error> BusEngine::objection_of_hold(const Call& call) {
  const auto& hold = call.options.hold;
  if (!hold) return std::nullopt;
  if (hold->ended == Hold::End::stop)
    return error_for(call, Errc::superseded_by_stop, "a stop came and ended the download", {});
  if (hold->ended == Hold::End::idle)
    return error_for(call, Errc::deadline_passed, "the module was held without being used", {});
  // Outside download mode the module would execute it.
  if (call.options.is_program_line &&
      !module_of(call.request.address).custody.is_recording_for(hold)) {
    return error_for(call, Errc::download_broken, "the module is not in download mode", {});
  }
  return std::nullopt;
}

/// On a serial line a stop for a module that was never heard may reach another: a module on USB
/// takes what is for any address.
void BusEngine::end_downloads_for(const Request& stop) {
  const bool reaches_others =
      framing_ == Framing::serial && !module_of(stop.address).lane.was_heard();
  for (auto& [byte, module] : modules_) {
    if (byte != reply_byte(stop.address) && !reaches_others) continue;
    const auto ended = module.custody.end_download(Hold::End::stop);
    if (!ended) continue;
    for (const auto& call :
         queue_.remove_if([&](const Call& queued) { return queued.options.hold == ended; })) {
      complete(call, tl::unexpected(*objection_of_hold(call)));
    }
  }
}

void BusEngine::drop_movements_before(const Request& stop) {
  for (const auto& call :
       queue_.remove_if([&](const Call& queued) { return is_ended_by(stop, queued); })) {
    supersede(call);
  }
}

void BusEngine::supersede(const Call& movement) {
  complete(movement,
           tl::unexpected(error_for(movement, Errc::superseded_by_stop, "a stop came first", {})));
}

// ---- what comes from the wire
// ---------------------------------------------------------------------------------------

void BusEngine::on_bytes(std::span<const std::uint8_t> bytes, TimePoint now) {
  for (const auto byte : bytes) {
    const auto item = decoder_.push(byte);
    if (!item) continue;
    if (const auto* reply = std::get_if<Reply>(&*item)) {
      on_reply(*reply, now);
    } else if (line_.in_flight) {
      on_version_text(line_, std::get<VersionText>(*item).version, now);
    }
  }
  go_on(now);
}

void BusEngine::on_frame(const CanFrame& frame, TimePoint now) {
  if (auto* channel = channel_awaiting_version_text()) {
    if (const auto version = version_text_in(frame)) {
      on_version_text(*channel, *version, now);
      return go_on(now);
    }
  }
  if (const auto reply = decode_can_reply(frame)) {
    on_reply(*reply, now);
  } else {
    counters_.garbage_bytes += frame.length;
  }
  go_on(now);
}

void BusEngine::on_reply(const Reply& reply, TimePoint now) {
  const auto known = modules_.find(reply.module);
  if (reply.command == Command::TARGET_REACHED_EVENT && reply.status == Status::delayed) {
    if (known == modules_.end()) {
      ++counters_.unexpected_replies;
      return;
    }
    actions_.push_back(
        BusEvent{BusEvent::Kind::target_reached, known->second.address, reply.value});
    return;
  }
  if (known != modules_.end()) {
    auto& channel = channel_of(known->second);
    if (channel.in_flight && answers(reply, *channel.in_flight))
      return conclude(channel, Answer{reply}, now);
  }
  if (auto* channel = channel_reading_memory()) return on_memory(*channel, reply, now);
  if (known != modules_.end()) return on_unexplained(reply, now);
  ++counters_.unexpected_replies;
}

void BusEngine::on_memory(Channel& channel, const Reply& reply, TimePoint now) {
  const auto& sent = channel.in_flight->sent;
  if (program::refuses_memory(reply, sent)) return conclude(channel, Answer{reply}, now);
  if (is_late_from_other(reply, *channel.in_flight, now)) {
    ++counters_.late_replies;
    return;
  }
  const auto done = settle(channel, Status::ok, now);
  if (done.call) complete(*done.call, Answer{reply});
}

/// Such a reply and a line of a program look alike.
bool BusEngine::is_late_from_other(const Reply& reply, const InFlight& reading,
                                   TimePoint now) const {
  if (reply.module == reply_byte(reading.sent.address)) return false;
  const auto other = modules_.find(reply.module);
  return other != modules_.end() && other->second.lane.may_still_answer(reply.command, now);
}

bool BusEngine::answers(const Reply& reply, const InFlight& in_flight) const {
  if (reply.module != reply_byte(in_flight.sent.address)) return false;
  if (reads_memory(in_flight.sent)) return false;
  // A module that could not read the request does not know which command it was.
  const bool about_checksum = reply.status == Status::wrong_checksum && reply.command == Command{0};
  return about_checksum || reply.command == in_flight.sent.command;
}

void BusEngine::on_version_text(Channel& channel, FirmwareVersion version, TimePoint now) {
  const auto& sent = channel.in_flight->sent;
  conclude(
      channel,
      Answer{Reply{options_.host_address, reply_byte(sent.address), Status::ok, sent.command, 0},
             version},
      now);
}

/// What every answer means, whatever it says.
BusEngine::InFlight BusEngine::settle(Channel& channel, Status status, TimePoint now) {
  auto done = std::move(*channel.in_flight);
  channel.in_flight.reset();
  expect_special_replies();
  ++counters_.replies;
  auto& module = module_of(done.sent.address);
  module.lane.answered(done.sent.command, now);
  module.custody.on_answered(done.sent.command, status, now);
  const bool proves = !done.call || done.sent.command == Command::END_DOWNLOAD;
  if (proves && !module.lane.has_abandoned(done.sent.command)) {
    module.lane.prove();
    hand_out_proven(module);
  }
  return done;
}

void BusEngine::conclude(Channel& channel, Answer answer, TimePoint now) {
  const auto status = answer.reply.status;
  auto done = settle(channel, status, now);
  if (!done.call) return;
  const auto& lane = module_of(done.sent.address).lane;
  answer.duplicate_suspected = lane.is_duplicate_suspected(now);
  if (must_prove(*done.call, status, now)) return hold_back(std::move(*done.call), answer, now);
  finish(std::move(*done.call), answer);
}

void BusEngine::finish(Call call, const Answer& answer) {
  const auto status = answer.reply.status;
  const bool wrongly_recorded = status == Status::command_loaded && !call.options.hold;
  if (is_success(status) && !wrongly_recorded) return complete(call, answer);
  auto error = refusal(call.request, status);
  error.bus = options_.name;
  if (wrongly_recorded) return on_recorded(std::move(call), std::move(error));
  if (status == Status::wrong_checksum) return repeat_or_give_up(std::move(call), std::move(error));
  complete(call, tl::unexpected(std::move(error)));
}

/// Nothing was executed: somebody has left the module in download mode. Only a stop ends that.
void BusEngine::on_recorded(Call call, Error error) {
  error.message = "the module is in download mode: it recorded the command instead of executing it";
  error.hint = "END_DOWNLOAD ends that; so does a stop, and loading a program anew";
  if (call.is_stop()) {
    module_of(call.request.address).custody.found_recording();
    if (call.times_sent < options_.attempts) return queue_.put_back(std::move(call));
  }
  complete(call, tl::unexpected(std::move(error)));
}

void BusEngine::on_link_lost(const std::string& why) {
  if (lost_) return;
  lost_ = why;
  handed_out_.reset();
  const auto end = [&](const Call& call, Outcome outcome) {
    auto error = error_for(call, Errc::link_lost, why, "check the cable and the module's power");
    error.outcome = outcome;
    complete(call, tl::unexpected(std::move(error)));
  };
  const auto end_in_flight = [&](Channel& channel) {
    if (channel.in_flight && channel.in_flight->call)
      end(*channel.in_flight->call, Outcome::unknown);
    channel.in_flight.reset();
  };
  end_in_flight(line_);
  for (auto& [byte, module] : modules_) end_in_flight(module.own_channel);
  for (const auto& call : queue_.remove_if([](const Call&) { return true; }))
    end(call, outcome_so_far(call));
  actions_.push_back(BusEvent{BusEvent::Kind::link_lost, {}, 0, why});
}

// ---- time
// -----------------------------------------------------------------------------------------------------------

void BusEngine::on_deadline(TimePoint now) {
  const auto is_overdue = [&](const Channel& channel) {
    return channel.in_flight && channel.in_flight->deadline <= now;
  };
  if (is_overdue(line_)) on_time_out(line_, now);
  for (auto& [byte, module] : modules_) {
    if (is_overdue(module.own_channel)) on_time_out(module.own_channel, now);
  }
  go_on(now);
}

void BusEngine::on_time_out(Channel& channel, TimePoint now) {
  auto lost = std::move(*channel.in_flight);
  channel.in_flight.reset();
  expect_special_replies();
  decoder_.reset();
  ++counters_.timeouts;
  channel.quiet_until = now + options_.quiet_time;
  auto& module = module_of(lost.sent.address);
  module.lane.abandon(lost.sent.command, now);
  if (!lost.call && lost.sent.command == Command::END_DOWNLOAD) return;
  if (!lost.call) return on_fence_time_out(module, lost.sent.address, lost.fence_tries, now);
  auto error = timeout_error(*lost.call);
  repeat_or_give_up(std::move(*lost.call), std::move(error));
}

void BusEngine::on_fence_time_out(Module& module, ModuleAddress address, unsigned tries,
                                  TimePoint now) {
  if (!module.lane.fence_failed(tries, now + options_.silence_time)) return;
  const auto waits_for_it = [&](const Call& call) {
    return reply_byte(call.request.address) == reply_byte(address);
  };
  for (const auto& call : queue_.remove_if(waits_for_it))
    complete(call, tl::unexpected(silence_error(call)));
}

void BusEngine::end_overdue_calls(TimePoint now) {
  const auto is_overdue = [&](const Call& call) {
    return call.options.deadline && *call.options.deadline <= now;
  };
  for (const auto& call : queue_.remove_if(is_overdue)) {
    complete(call,
             tl::unexpected(error_for(call, Errc::deadline_passed,
                                      "the deadline passed while the command was waiting", {})));
  }
}

std::optional<TimePoint> BusEngine::next_deadline() const {
  std::optional<TimePoint> next = queue_.earliest_deadline();
  const auto consider = [&](TimePoint time) {
    if (!next || time < *next) next = time;
  };
  const auto consider_channel = [&](const Channel& channel) {
    if (channel.in_flight) {
      consider(channel.in_flight->deadline);
    } else if (channel.quiet_until > last_now_ && queue_.size() > 0) {
      consider(channel.quiet_until);
    }
  };
  if (full_until_ > last_now_ && queue_.size() > 0) consider(full_until_);
  consider_channel(line_);
  for (const auto& [byte, module] : modules_) {
    consider_channel(module.own_channel);
    if (module.custody.wants_care()) consider(last_now_ + care_interval);
  }
  return next;
}

// ---- who speaks next
// ------------------------------------------------------------------------------------------------

void BusEngine::go_on(TimePoint now) {
  last_now_ = now;
  end_overdue_calls(now);
  look_after_downloads(now);
  end_calls_to_bootloaders();
  memory_is_wanted_ = find_memory_reader();
  while (auto* call = queue_.find([&](const Call& queued) { return is_next(queued, now); })) {
    const auto& lane = module_of(call->request.address).lane;
    if (must_shout(*call)) {
      shout(*call, now);
    } else if (lane.is_silent(now) && !call->is_stop()) {
      const auto unheard = queue_.take(call);
      complete(unheard, tl::unexpected(silence_error(unheard)));
    } else if (lane.in_step()) {
      start(queue_.take(call), now);
    } else if (module_of(call->request.address).custody.is_recording_for(call->options.hold)) {
      send_held(call, now);
    } else {
      start_fence(*call, now);
    }
  }
}

void BusEngine::look_after_downloads(TimePoint now) {
  if (lost_) return;
  for (auto& [byte, module] : modules_) {
    auto& channel = channel_of(module);
    module.custody.look_after(now, channel.in_flight.has_value());
    if (module.custody.must_end() && channel.is_free(now) && full_until_ <= now)
      start_end(module, now);
  }
}

void BusEngine::end_calls_to_bootloaders() {
  const auto is_lost = [&](const Call& call) {
    return module_of(call.request.address).custody.is_lost_on_bootloader(call);
  };
  for (const auto& call : queue_.remove_if(is_lost)) {
    complete(call, tl::unexpected(error_for(
                       call, Errc::in_bootloader,
                       fmt::format("module {} is in its bootloader and gets new firmware: it can "
                                   "neither start nor stop a motor",
                                   number(call.request.address)),
                       "wait until that has ended")));
  }
}

/// A fence would become a line of the program: out of step, nothing goes out but the end of the
/// download.
void BusEngine::send_held(const Call* found, TimePoint now) {
  auto call = queue_.take(found);
  if (call.request.command == Command::END_DOWNLOAD) return start(std::move(call), now);
  complete(call,
           tl::unexpected(error_for(call, Errc::download_broken,
                                    "nobody can tell any more what the module recorded", {})));
}

bool BusEngine::waits_for_download(const Call& call) {
  auto& module = module_of(call.request.address);
  if (!module.custody.admits(call)) return true;
  if (framing_ != Framing::serial || module.lane.was_heard()) return false;
  // A module on USB takes what is for any address.
  return std::ranges::any_of(modules_, [&](const auto& entry) {
    return &entry.second != &module && entry.second.custody.is_recording() &&
           !entry.second.custody.gave_up();
  });
}

/// On CAN a line of a program looks like a reply of any module: nobody else may expect one.
bool BusEngine::waits_for_memory(const Call& call) {
  if (framing_ != Framing::can || call.is_stop()) return false;
  if (reads_memory(call.request)) {
    return find_channel([](const Request&) { return true; }) != nullptr;
  }
  return memory_is_wanted_ || channel_reading_memory() != nullptr;
}

bool BusEngine::find_memory_reader() {
  if (framing_ != Framing::can) return false;
  return queue_.find([&](const Call& queued) {
    return reads_memory(queued.request) && !waits_for_download(queued) &&
           module_of(queued.request.address).lane.in_step();
  }) != nullptr;
}

bool BusEngine::is_next(const Call& call, TimePoint now) {
  if (full_until_ > now) return false;
  auto& module = module_of(call.request.address);
  if (must_shout(call)) return true;
  if (waits_for_download(call) || waits_for_memory(call)) return false;
  if (module.lane.is_silent(now) && !call.is_stop()) return true;
  // Version texts do not say which module they are from: one at a time.
  if (wants_version_text(call.request) && channel_awaiting_version_text() != nullptr) return false;
  return channel_of(module).is_free(now);
}

bool BusEngine::must_shout(const Call& call) {
  if (!call.is_stop() || call.shouted) return false;
  auto& module = module_of(call.request.address);
  // Before the end of a download a stop would only be recorded.
  if (module.custody.is_recording() && !module.custody.end_was_tried()) return false;
  auto& channel = channel_of(module);
  const bool would_wait = !module.lane.in_step() || channel.quiet_until > last_now_;
  return would_wait && !channel.in_flight;
}

void BusEngine::shout(Call& call, TimePoint now) {
  call.shouted = true;
  auto& module = module_of(call.request.address);
  module.lane.abandon(call.request.command, now);
  auto& channel = channel_of(module);
  channel.quiet_until = std::max(channel.quiet_until, now + wire_time_ + options_.quiet_time);
  ++counters_.requests;
  actions_.push_back(Send{call.request, call.place});
}

void BusEngine::start(Call call, TimePoint now) {
  auto& module = module_of(call.request.address);
  auto& channel = channel_of(module);
  ++call.times_sent;
  module.custody.on_sent(call, now);
  const auto request = call.request;
  const auto deadline = now + patience(call.options);
  put_in_flight(channel, InFlight{request, deadline, std::move(call), 0});
}

void BusEngine::start_fence(const Call& next, TimePoint now) {
  const auto address = next.request.address;
  auto& module = module_of(address);
  // Who scans asks once and goes on.
  const unsigned tries = next.options.attempts == 1 ? 1 : fence_tries;
  const auto fence = module.lane.fence(address, next.request.command, now);
  if (!fence) return on_fence_time_out(module, address, 1, now);
  ++counters_.fences;
  put_in_flight(channel_of(module),
                InFlight{*fence, now + patience(next.options), std::nullopt, tries});
}

void BusEngine::start_end(Module& module, TimePoint now) {
  module.custody.on_end_sent();
  const Request end{module.address, Command::END_DOWNLOAD, 0, 0, 0};
  put_in_flight(channel_of(module), InFlight{end, now + patience({}), std::nullopt, 0});
}

void BusEngine::put_in_flight(Channel& channel, InFlight in_flight) {
  ++counters_.requests;
  actions_.push_back(Send{in_flight.sent});
  channel.in_flight = std::move(in_flight);
  expect_special_replies();
}

Duration BusEngine::patience(const CallOptions& options) const {
  const auto pause = framing_ == Framing::serial ? options_.telegram_pause : Duration{};
  auto wait = options.reply_timeout.value_or(options_.reply_timeout);
  // Impatience pays only where others wait for the line.
  if (framing_ == Framing::can) wait = std::max(wait, options_.reply_timeout);
  return wire_time_ + pause + wait;
}

void BusEngine::expect_special_replies() {
  decoder_.expect_program_line(line_.in_flight && reads_memory(line_.in_flight->sent));
  decoder_.expect_version_text(line_.in_flight && wants_version_text(line_.in_flight->sent));
}

BusEngine::Channel* BusEngine::channel_awaiting_version_text() {
  return find_channel(wants_version_text);
}

BusEngine::Channel* BusEngine::channel_reading_memory() { return find_channel(reads_memory); }

BusEngine::Channel* BusEngine::find_channel(const std::function<bool(const Request&)>& sent) {
  const auto fits = [&](const Channel& channel) {
    return channel.in_flight && sent(channel.in_flight->sent);
  };
  if (fits(line_)) return &line_;
  const auto found = std::ranges::find_if(
      modules_, [&](const auto& entry) { return fits(entry.second.own_channel); });
  return found == modules_.end() ? nullptr : &found->second.own_channel;
}

// ---- how calls end
// --------------------------------------------------------------------------------------------------

void BusEngine::repeat_or_give_up(Call call, Error error) {
  const unsigned attempts = call.options.attempts == 0 ? options_.attempts : call.options.attempts;
  if (call.may_repeat() && call.times_sent < attempts) return queue_.put_back(std::move(call));
  complete(call, tl::unexpected(std::move(error)));
}

Error BusEngine::error_for(const Call& call, Errc code, std::string message,
                           std::string hint) const {
  return {
      code, outcome_so_far(call), std::move(message), std::move(hint), options_.name, call.request,
      {}};
}

Error BusEngine::timeout_error(const Call& call) const {
  const auto waited =
      std::chrono::duration_cast<std::chrono::milliseconds>(patience(call.options)).count();
  const auto times =
      call.times_sent == 1 ? std::string("once") : fmt::format("{} times", call.times_sent);
  return error_for(call, Errc::reply_timeout,
                   fmt::format("no answer within {} ms, asked {}", waited, times),
                   "check address, baud rate and power; `tmclctl scan` shows who answers");
}

Error BusEngine::silence_error(const Call& call) const {
  return error_for(call, Errc::module_silent,
                   fmt::format("module {} does not answer", number(call.request.address)),
                   "check its power and address; `tmclctl scan` shows who answers");
}

void BusEngine::complete(const Call& call, const Result<Answer>& result) {
  for (const auto ticket : call.tickets) actions_.push_back(Completion{ticket, result});
}

std::optional<Action> BusEngine::next_action() {
  confirm_last_send();
  if (actions_.empty()) return std::nullopt;
  auto action = std::move(actions_.front());
  actions_.pop_front();
  if (const auto* send = std::get_if<Send>(&action)) handed_out_ = *send;
  return action;
}

BusCounters BusEngine::counters() const {
  auto counters = counters_;
  counters.garbage_bytes += decoder_.dropped_bytes();
  return counters;
}

}  // namespace tmcl::engine
