/// Which of the calls that wait goes out next, and when somebody has to look again.
///
/// Stops come first, then whatever acts, then reads; but no kind is passed over for ever. After
/// `most_passed_over` exchanges of other kinds one call of a kind that waits has its turn, unless a
/// stop waits that is no mere repetition: that one waits for nothing but the exchange in flight,
/// and for such stops of other motors that came before it.
#pragma once

#include <array>
#include <map>
#include <vector>

#include "engine/call_queue.hpp"
#include "engine/conversation.hpp"

namespace tmcl::engine {

class Scheduler {
 public:
  CallQueue& queue() { return queue_; }
  const CallQueue& queue() const { return queue_; }

  /// What follows is as of this instant.
  void begin_round(TimePoint now) { now_ = now; }
  /// To be asked once in a round, before next().
  void look_for_bus_wanted(Conversations& modules);
  TimePoint now() const { return now_; }
  /// The next call that can go out, or end, now; null if all have to wait.
  Call* next(Conversations& modules);
  /// A stop that would have to wait for a fence: it goes out unproven first, and then again.
  bool goes_out_early(Conversations& modules, const Call& call) const;
  std::optional<TimePoint> next_deadline(const Conversations& modules) const;

  /// The link refused something; it is left in peace until then.
  void on_link_full(TimePoint until);
  void on_link_took();
  bool is_link_full() const { return full_until_ > now_; }
  /// The request of a call that was queued goes out, or the fence that it needs.
  void on_turn(Framing framing, const Call& call);

 private:
  friend class EngineState;  ///< Of tests: tells two apart.
  /// How often in a row other kinds of calls went out on one channel while one of this kind waited.
  using PassedOver = std::array<unsigned, CallQueue::kinds>;
  struct SentStop {
    Request request;
    TimePoint at;
  };
  /// A serial line is one channel, on CAN each module has its own.
  static std::uint8_t channel_of(Framing framing, const Call& call) {
    return framing == Framing::serial ? std::uint8_t{0} : reply_byte(call.request.address);
  }
  bool was_passed_over(Framing framing, const Call& call, unsigned times) const;
  bool is_urgent(const Call& call) const;
  void note_stop(const Call& call);
  bool is_next(Conversations& modules, const Call& call) const;
  bool waits_for_download(Conversations& modules, const Call& call) const;
  bool waits_for_bus(Conversations& modules, const Call& call) const;
  static bool is_alike_under_way(Conversations& modules, const Call& call);

  CallQueue queue_;
  TimePoint now_{};
  std::map<std::uint8_t, PassedOver> passed_over_;
  /// Those of the last `repetition_time` after which nothing that they would end went out.
  std::vector<SentStop> sent_stops_;
  /// CAN: a call that needs the bus for itself waits for the others to end.
  bool bus_is_wanted_ = false;
  /// The link refused something, and has taken nothing since.
  bool link_refused_ = false;
  TimePoint full_until_{};
};

}  // namespace tmcl::engine
