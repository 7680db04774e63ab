/// Who speaks next on a bus, what a reply answers, and what is known about a command when none
/// comes.
///
///     submit ──▶ Scheduler ──start──▶ Channel ──reply──▶ done, refused
///                 │    ▲                 │
///                 │    │              deadline ──▶ unknown
///                 │    └─may be repeated─┤
///                 │                   quiet for a while
///                 │                      │
///                 └─module out of step─▶ fence ──reply──▶ in step: go on
///                                        │
///                                     deadline, after the last try: the module is silent, its
///                                              calls end as not_sent (unknown if sent before)
///
/// Its parts: Scheduler, the calls that wait and which of them is next; Conversations, what is
/// known about each module (Lane: in step or not, Custody: whose it is) and what is under way
/// (Channel). ReplyForm: answers that do not look like replies. bus_engine.cpp starts exchanges and
/// gives them up, answers.cpp ends them, stops.cpp is about what a stop makes pointless,
/// ascii_mode.cpp about modules that understand no datagrams, patience.cpp about hosts that ask
/// whether a module is there, full_link.cpp about links that take nothing, surplus.cpp about
/// replies that were not asked for.
///
/// A stop goes first. Where it would have to wait for a fence it is sent at once as well, and then
/// again, provably. A stop also removes every movement that is queued for the same motor.
///
/// A link that takes nothing, such as a CAN interface with a full transmit queue, is tried again
/// shortly after: calls that it refused go back to their places in the queue, and end when it has
/// taken nothing for too long.
///
/// Where more replies come than were asked for, two modules have one address or another program
/// asks on this bus. For a time after that every value that is read is proven: it is given out when
/// a fence has been answered after it and no second reply of its kind came before that one.
///
/// While a module is in download mode everything else waits for the holder of the download, and a
/// stop sends END_DOWNLOAD ahead of itself: see custody.hpp. While a module is in its bootloader
/// everybody else's calls to it end at once.
///
/// Does no I/O and reads no clock: it is told what happened, and says what to do. A value: a copy
/// goes on like the original from where that is. All that the two share is the lifetime of holds,
/// which calls that have not ended prolong.
/// Thread safety: none. Everything it holds is bounded by max_queued_calls and the number of
/// addresses.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "engine/conversation.hpp"
#include "engine/line_echo.hpp"
#include "engine/scheduler.hpp"
#include "tmcl/bus_options.hpp"
#include "tmcl/link.hpp"
#include "tmcl/serial_decoder.hpp"

namespace tmcl::engine {

/// Put this request on the wire.
struct Send {
  Request request;
  std::uint64_t place = 0;  ///< Of the call that it is for, if that stays in the queue.
  std::uint64_t asker = 0;
  /// Not the request, but leaving_ascii_mode() for its module.
  bool leaves_ascii = false;
};
/// The characters that make a module in ASCII mode go back to datagrams: the end of whatever line
/// it takes what it has heard for, and BIN. For an address of 1 to 26.
std::string leaving_ascii_mode(ModuleAddress module);
/// The call is over.
struct Completion {
  Ticket ticket;
  Result<Answer> result;
};
using Action = std::variant<Send, Completion, BusEvent>;

class BusEngine {
 public:
  /// `wire_time`: how long a request and its reply take on the wire.
  BusEngine(Framing framing, Duration wire_time, BusOptions options);

  void submit(Ticket ticket, const Request& request, const CallOptions& options, TimePoint now);
  /// Of all reads that wait: see Bus.
  void end_unwanted_reads(TimePoint now);
  /// Serial: bytes came in.
  void on_bytes(std::span<const std::uint8_t> bytes, TimePoint now);
  /// CAN: a frame came in.
  void on_frame(const CanFrame& frame, TimePoint now);
  /// The time that next_deadline() told has come; harmless at any other time.
  void on_deadline(TimePoint now);
  /// The link had no room for the request that next_action() gave last; nothing of it went out.
  void on_send_refused(const Request& request, TimePoint now);
  /// Something had come in before the request that next_action() gave last went out, so that did
  /// not go out: what is sent is decided anew when the engine has been told what came.
  void on_input_before(const Request& request) { take_back_last_send(request); }
  /// Everything in progress ends, and nothing more will be accepted.
  void on_link_lost(const std::string& why);

  /// What to do next; call it until it gives nothing. A request that is not refused before the next
  /// call counts as sent.
  std::optional<Action> next_action();
  /// When on_deadline() wants to be called.
  std::optional<TimePoint> next_deadline() const { return scheduler_.next_deadline(modules_); }

  const BusOptions& options() const { return options_; }
  BusCounters counters() const;
  /// How many calls wait for their turn.
  std::size_t queued() const { return scheduler_.queue().size(); }

 private:
  friend class EngineState;  ///< Of tests: tells two apart.
  CallQueue& queue() { return scheduler_.queue(); }
  std::optional<Error> objection(const Call& call);
  std::optional<Error> objection_of_hold(const Call& call);

  // stops.cpp
  void drop_moves_before(const Request& stop);
  void end_downloads_for(const Request& stop);

  // patience.cpp
  void hurry(const Call& next, TimePoint now);
  bool is_given_up_with(const InFlight& in_flight, const Call& next);
  bool is_from_only_module(const Reply& reply, TimePoint now);

  // ascii_mode.cpp
  bool is_worth_rescue(const Call& call);
  void ask_for_rescue(ModuleAddress address);
  void ask_for_rescue_again(ModuleAddress address);
  void start_leaving_ascii(const Call& next);

  // Who speaks next
  void go_on(TimePoint now);
  void go_on_with(Call& call);
  void refuse(Call& queued, Error objection);
  void end_overdue_calls();
  void look_after_downloads();
  void end_calls_to_bootloaders();
  bool must_fence(const Lane& lane, const Call& call) const;
  void go_on_recording(const Call& next);
  void send_early(Call& call);
  void start(Call call);
  void start_fence(const Call& next);
  void give_up_proof(ModuleAddress address);
  void start_end(Conversation& module);
  void put_in_flight(Channel& channel, InFlight in_flight);
  void send(const Send& send);
  /// How long an answer may take, the wire included.
  Duration reply_time(const CallOptions& options) const;

  // Time
  void on_time_out(Channel& channel, TimePoint now);
  void on_silence(ModuleAddress address);
  void repeat_or_give_up(Call call, Error error);

  // answers.cpp
  void on_byte(std::uint8_t byte, TimePoint now);
  void tell_of_echo();
  void on_reply(const Reply& reply, bool may_answer, TimePoint now);
  void on_event(const Conversation* module, const Reply& reply);
  void on_unframed_reply(Channel& channel, const Reply& reply, TimePoint now);
  bool is_late_from_other(const Reply& reply, const Request& sent, TimePoint now);
  void on_version_text(Channel& channel, FirmwareVersion version, TimePoint now);
  InFlight settle(Channel& channel, ModuleAddress from, Status status, TimePoint now);
  void conclude(Channel& channel, Answer answer, TimePoint now);
  void finish(Call call, const Answer& answer);
  void on_recorded(Call call, Status status);
  InFlight take_from(Channel& channel);
  void expect_answer();

  // surplus.cpp
  void on_unexplained(Conversation& module, const Reply& reply, TimePoint now);
  void doubt_answers(const Conversation& module, Command command);
  bool must_prove(const Call& call, const Reply& reply, TimePoint now);
  static bool must_read_twice(const Call& call, const Lane& lane, TimePoint now);
  void hold_back(Call call, const Answer& answer, TimePoint now);
  void hand_out_proven(const Conversation& module, TimePoint now);

  // full_link.cpp
  void confirm_last_send();
  bool take_back_last_send(const Request& request);
  void take_back(Channel& channel);
  void take_back_call(Call call);
  void take_back_early_stop(std::uint64_t place);
  void end_refused_calls(TimePoint now);
  Duration time_for_link(const Call& call) const;

  void complete(const Call& call, const Result<Answer>& result);
  void fail(const Call& call, Error error);
  /// Ends every waiting call that satisfies `doomed` with the error that `error_of` makes.
  template <class Doomed, class ErrorOf>
  void fail_if(const Doomed& doomed, const ErrorOf& error_of) {
    for (const auto& call : queue().remove_if(doomed)) fail(call, error_of(call));
  }

  Duration wire_time_;
  BusOptions options_;
  Scheduler scheduler_;
  Conversations modules_;
  SerialDecoder decoder_;
  LineEcho echo_;
  std::vector<Action> actions_;
  std::size_t actions_given_ = 0;  ///< Of `actions_`.
  BusCounters counters_;
  std::optional<std::string> lost_;
  /// What next_action() gave out last: as long as it is not called again, the link may refuse it.
  std::optional<Send> handed_out_;
};

}  // namespace tmcl::engine
