/// Who speaks next on a bus, what a reply answers, and what is known about a command when none
/// comes.
///
/// A serial line carries one exchange at a time; on CAN each module has its own. Each such place is
/// a channel:
///
///     free ──call picked, module in step──▶ waiting ──reply──▶ free                       done /
///     refused
///      │                                      └─deadline─▶ quiet ─time passes─▶ free      unknown,
///      or queued again └─call picked, out of step─▶ fencing ──reply──▶ free, module in step
///                                      └─deadline─▶ quiet ─▶ free; after the last try: module
///                                      silent,
///                                                             its calls end as not_sent (unknown
///                                                             if sent before)
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
/// Does no I/O and reads no clock: it is told what happened, and says what to do.
/// Thread safety: none. Everything it holds is bounded by max_queued_calls and the number of
/// addresses.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <variant>

#include "engine/call_queue.hpp"
#include "engine/custody.hpp"
#include "engine/lane.hpp"
#include "tmcl/bus_options.hpp"
#include "tmcl/link.hpp"
#include "tmcl/serial_decoder.hpp"

namespace tmcl::engine {

/// Put this request on the wire.
struct Send {
  Request request;
  std::uint64_t place = 0;  ///< Of the call that it is for, if that stays in the queue.
};
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
  /// Serial: bytes came in.
  void on_bytes(std::span<const std::uint8_t> bytes, TimePoint now);
  /// CAN: a frame came in.
  void on_frame(const CanFrame& frame, TimePoint now);
  /// The time that next_deadline() told has come; harmless at any other time.
  void on_deadline(TimePoint now);
  /// The link had no room for the request that next_action() gave last; nothing of it went out.
  void on_send_refused(const Request& request, TimePoint now);
  /// Everything in progress ends, and nothing more will be accepted.
  void on_link_lost(const std::string& why);

  /// What to do next; call it until it gives nothing. A request that is not refused before the next
  /// call counts as sent.
  std::optional<Action> next_action();
  /// When on_deadline() wants to be called.
  std::optional<TimePoint> next_deadline() const;

  const BusOptions& options() const { return options_; }
  BusCounters counters() const;

 private:
  struct InFlight {
    Request sent;
    TimePoint deadline;
    std::optional<Call> call;  ///< Nothing for a fence.
    unsigned fence_tries = 0;
  };
  struct Channel {
    std::optional<InFlight> in_flight;
    TimePoint quiet_until{};
    bool is_free(TimePoint now) const { return !in_flight && quiet_until <= now; }
  };
  struct Module {
    Lane lane;
    Custody custody;
    Channel own_channel;
    ModuleAddress address{};
  };

  Module& module_of(ModuleAddress address) {
    return modules_.try_emplace(reply_byte(address), Module{{}, {}, {}, address}).first->second;
  }
  Channel& channel_of(Module& module) {
    return framing_ == Framing::serial ? line_ : module.own_channel;
  }
  Channel& channel_to(ModuleAddress address) { return channel_of(module_of(address)); }

  std::optional<Error> objection(const Call& call);
  std::optional<Error> objection_of_hold(const Call& call);
  void drop_movements_before(const Request& stop);
  void supersede(const Call& movement);
  void end_downloads_for(const Request& stop);
  void end_overdue_calls(TimePoint now);
  void confirm_last_send();
  void take_back(Channel& channel);
  void take_back_shout(std::uint64_t place);
  void end_refused_calls(TimePoint now);
  Duration patience_with_link(const Call& call) const;
  void look_after_downloads(TimePoint now);
  void end_calls_to_bootloaders();

  void go_on(TimePoint now);
  bool is_next(const Call& call, TimePoint now);
  bool waits_for_download(const Call& call);
  bool waits_for_memory(const Call& call);
  bool find_memory_reader();
  void send_held(const Call* found, TimePoint now);
  bool must_shout(const Call& call);
  void shout(Call& call, TimePoint now);
  void start(Call call, TimePoint now);
  void start_fence(const Call& next, TimePoint now);
  void start_end(Module& module, TimePoint now);
  void put_in_flight(Channel& channel, InFlight in_flight);
  Duration patience(const CallOptions& options) const;

  void on_time_out(Channel& channel, TimePoint now);
  void on_fence_time_out(Module& module, ModuleAddress address, unsigned tries, TimePoint now);
  void repeat_or_give_up(Call call, Error error);

  void on_reply(const Reply& reply, TimePoint now);
  void on_memory(Channel& channel, const Reply& reply, TimePoint now);
  void on_recorded(Call call, Error error);
  bool is_late_from_other(const Reply& reply, const InFlight& reading, TimePoint now) const;
  void on_version_text(Channel& channel, FirmwareVersion version, TimePoint now);
  void on_unexplained(const Reply& reply, TimePoint now);
  void doubt_answers_like(const Reply& reply);
  bool must_prove(const Call& call, Status status, TimePoint now);
  void hold_back(Call call, const Answer& answer, TimePoint now);
  void hand_out_proven(const Module& module);
  bool answers(const Reply& reply, const InFlight& in_flight) const;
  void conclude(Channel& channel, Answer answer, TimePoint now);
  void finish(Call call, const Answer& answer);
  InFlight settle(Channel& channel, Status status, TimePoint now);
  void expect_special_replies();
  Channel* channel_awaiting_version_text();
  Channel* channel_reading_memory();
  Channel* find_channel(const std::function<bool(const Request&)>& sent);

  Error error_for(const Call& call, Errc code, std::string message, std::string hint) const;
  Error timeout_error(const Call& call) const;
  Error silence_error(const Call& call) const;
  Error refusal_of_link(const Call& call) const;
  Error doubt_error(const Call& call) const;
  void complete(const Call& call, const Result<Answer>& result);

  Framing framing_;
  Duration wire_time_;
  BusOptions options_;
  CallQueue queue_;
  Channel line_;
  std::map<std::uint8_t, Module> modules_;
  SerialDecoder decoder_;
  std::deque<Action> actions_;
  BusCounters counters_;
  std::optional<std::string> lost_;
  /// What next_action() gave out last: as long as it is not called again, the link may refuse it.
  std::optional<Send> handed_out_;
  /// The link refused something, and has taken nothing since.
  bool link_is_full_ = false;
  TimePoint full_until_{};
  /// CAN: a call that needs the bus for itself waits for the others to end.
  bool memory_is_wanted_ = false;
  /// The state has been acted upon as of this instant.
  TimePoint last_now_{};
};

}  // namespace tmcl::engine
