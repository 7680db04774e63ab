/// Where one exchange at a time is under way: a serial line, or on CAN one module.
///
///     free ──request sent──▶ in flight ──answer──▶ free
///      ▲                         │
///      │                         └─deadline─▶ quiet
///      └──────────time passes──────────────────┘
#pragma once

#include <algorithm>
#include <optional>

#include "engine/call_queue.hpp"
#include "engine/reply_form.hpp"
#include "tmcl/ensure.hpp"

namespace tmcl::engine {

/// A request whose answer is awaited.
struct InFlight {
  Request sent;
  TimePoint deadline;
  std::optional<Call>
      call;  ///< Nothing for a fence, and for the end of a download that no call asked for.
  unsigned fence_tries = 0;
  TimePoint sent_at{};
  bool leaves_ascii = false;  ///< No request: the line that ends the ASCII mode of its module.

  bool ends_download() const { return sent.command == Command::END_DOWNLOAD; }
  bool is_fence() const { return !call && !ends_download() && !leaves_ascii; }
};

class Channel {
 public:
  bool is_busy() const { return in_flight_.has_value(); }
  bool is_quiet(TimePoint now) const { return quiet_until_ > now; }
  bool is_free(TimePoint now) const { return !is_busy() && !is_quiet(now); }
  bool is_overdue(TimePoint now) const { return is_busy() && in_flight_->deadline <= now; }
  bool awaits(const ReplyForm& form) const { return is_busy() && &form_of_answer() == &form; }
  bool has_sent(const Request& request) const { return is_busy() && in_flight_->sent == request; }

  /// Of a busy channel.
  const InFlight& in_flight() const {
    ensure(is_busy());
    return *in_flight_;
  }
  const ReplyForm& form_of_answer() const { return ReplyForm::of(in_flight().sent); }
  bool is_answered_by(const Reply& reply) const {
    return is_busy() && !in_flight_->leaves_ascii &&
           form_of_answer().is_answer(reply, in_flight_->sent);
  }

  void put(InFlight in_flight) {
    ensure(!is_busy());
    in_flight_ = std::move(in_flight);
  }
  InFlight take() {
    ensure(is_busy());
    auto taken = std::move(*in_flight_);
    in_flight_.reset();
    return taken;
  }
  /// The answer is not awaited any longer than that.
  void shorten(TimePoint deadline) {
    ensure(is_busy());
    in_flight_->deadline = std::min(in_flight_->deadline, deadline);
  }
  void keep_quiet_until(TimePoint time) { quiet_until_ = std::max(quiet_until_, time); }
  /// Until when it is busy or quiet; a quiet channel matters to calls that wait.
  std::optional<TimePoint> deadline(TimePoint now, bool calls_wait) const {
    if (is_busy()) return in_flight_->deadline;
    return is_quiet(now) && calls_wait ? std::optional(quiet_until_) : std::nullopt;
  }

 private:
  friend class EngineState;  ///< Of tests: tells two apart.
  std::optional<InFlight> in_flight_;
  TimePoint quiet_until_{};
};

}  // namespace tmcl::engine
