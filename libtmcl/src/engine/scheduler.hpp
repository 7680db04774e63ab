/// Which of the calls that wait goes out next, and when somebody has to look again.
#pragma once

#include "engine/call_queue.hpp"
#include "engine/conversation.hpp"

namespace tmcl::engine {

class Scheduler {
 public:
  CallQueue& queue() { return queue_; }

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

 private:
  bool is_next(Conversations& modules, const Call& call) const;
  bool waits_for_download(Conversations& modules, const Call& call) const;
  bool waits_for_bus(Conversations& modules, const Call& call) const;
  static bool is_alike_under_way(Conversations& modules, const Call& call);

  CallQueue queue_;
  TimePoint now_{};
  /// CAN: a call that needs the bus for itself waits for the others to end.
  bool bus_is_wanted_ = false;
  /// The link refused something, and has taken nothing since.
  bool link_refused_ = false;
  TimePoint full_until_{};
};

}  // namespace tmcl::engine
