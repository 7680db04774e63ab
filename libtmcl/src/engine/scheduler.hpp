/// Which of the calls that wait goes out next, and when to look again.
///
/// Stops come first, then whatever acts, then reads; but no asker is passed over for ever. The
/// calls of one kind of one asker have their turn after `most_passed_over` exchanges of others, and
/// where several have waited for so long, those that have waited for the most exchanges: so the
/// turn of a client depends on how many others ask, and not on how much they ask for. A stop that
/// is no mere repetition comes before that: it waits for nothing but the exchange in flight, and
/// for such stops of other motors that came before it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
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
  /// Those whose calls take turns: an asker and a kind of calls.
  using Party = std::pair<std::uint64_t, std::size_t>;
  /// How often in a row calls of others went out on one channel while one of this party waited.
  struct Waiting {
    Party party;
    unsigned passed_over = 0;
  };
  using PassedOver = std::vector<Waiting>;
  static unsigned times_in(const PassedOver& all, Party party);
  struct SentStop {
    Request request;
    TimePoint at;
  };
  /// A serial line is one channel, on CAN each module has its own.
  static std::uint8_t channel_of(Framing framing, const Call& call) {
    return framing == Framing::serial ? std::uint8_t{0} : reply_byte(call.request.address);
  }
  static Party party_of(const Call& call) { return {call.options.asker, CallQueue::kind_of(call)}; }
  /// How often the party of the call was passed over.
  unsigned passed_over(Framing framing, const Call& call) const;
  /// Of those that were passed over so often, the one that was most often; null if there is none.
  Call* passed_over_most(Conversations& modules, unsigned times);
  bool is_urgent(const Call& call) const;
  void note_stop(const Call& call);
  bool is_next(Conversations& modules, const Call& call) const;
  bool waits_for_download(Conversations& modules, const Call& call) const;
  bool waits_for_bus(Conversations& modules, const Call& call) const;
  static bool is_alike_under_way(Conversations& modules, const Call& call);

  CallQueue queue_;
  TimePoint now_{};
  std::map<std::uint8_t, PassedOver> passed_over_;
  PassedOver spare_;  ///< Room for the next one.
  /// Those of the last `repetition_time` after which nothing that they would end went out.
  std::vector<SentStop> sent_stops_;
  /// CAN: a call that needs the bus for itself waits for the others to end.
  bool bus_is_wanted_ = false;
  /// The link refused something, and has taken nothing since.
  bool link_refused_ = false;
  TimePoint full_until_{};
};

}  // namespace tmcl::engine
