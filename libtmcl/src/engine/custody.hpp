/// Whose a module is, and whether it records what it is sent instead of executing it.
///
///     free ──call with a hold goes out──▶ held ──START_DOWNLOAD goes out──▶ recording
///       ▲                                  │ ▲                               │    │
///       └────────────hold gone─────────────┘ └───────END_DOWNLOAD answered───┘    │
///       │                                                       stop, hold gone or idle
///       └──END_DOWNLOAD answered── must end ◀─────────────────────────────────────┘
///
/// In download mode everything that a module is sent may become a line of its program: then only
/// its holder's calls go out, and no fences. When a download must end, END_DOWNLOAD is all that
/// goes out.
#pragma once

#include <memory>
#include <vector>

#include "engine/call_queue.hpp"

namespace tmcl::engine {

class Custody {
 public:
  /// Why a hold has ended although it is still there.
  enum class End : std::uint8_t { not_yet, stop, idle };

  /// Whether the module takes this call now, as far as custody is concerned.
  bool admits(const Call& call) const;
  /// Waiting would not help this call: the module's holder has it in its bootloader.
  bool is_lost_on_bootloader(const Call& call) const;
  bool is_recording() const { return recording_; }
  bool is_recording_for(const SharedHold& hold) const {
    return recording_ && hold && hold == holder();
  }
  End end_of(const SharedHold& hold) const;

  void on_submitted(const Call& call);
  void on_sent(const Call& call, TimePoint now);
  void on_answered(Command command, Status status, TimePoint now);
  /// A module recorded what was meant to be executed: someone else had begun a download.
  void found_recording();

  /// A stop takes the module away from its holder if it is recording for one; gives back that hold.
  SharedHold end_download();
  /// Notices that a hold is gone, or has been idle for too long.
  void look_after(TimePoint now, bool in_flight);
  /// Something may have to be noticed soon.
  bool wants_care() const { return has_holder_ || must_end(); }

  /// END_DOWNLOAD is to go out, without anyone asking for it.
  bool must_end() const { return recording_ && !holder() && !gave_up(); }
  void on_end_sent() { ++ends_sent_; }
  /// It did not go out after all.
  void on_end_refused() { ends_sent_ -= ends_sent_ > 0 ? 1 : 0; }
  bool end_was_tried() const { return ends_sent_ > 0; }
  /// END_DOWNLOAD was not answered, as often as it was sent.
  bool gave_up() const;
  void try_again() { ends_sent_ = 0; }

 private:
  friend class EngineState;  ///< Of tests: tells two apart.
  struct Ended {
    std::weak_ptr<const Hold> hold;
    End why;
  };
  SharedHold holder() const;
  void end(const SharedHold& hold, End why);

  std::weak_ptr<const Hold> holder_;
  std::vector<Ended> ended_;  ///< Those that are still there.
  bool has_holder_ = false;
  bool in_bootloader_ = false;
  bool recording_ = false;
  unsigned ends_sent_ = 0;
  TimePoint last_used_{};
};

}  // namespace tmcl::engine
