/// What is known about the conversation with one module.
///
/// A reply does not say what it answers. A module is in step while every request sent to it has
/// been answered, once; then the next reply of a kind answers the next request of that kind. It
/// falls out of step when a request is given up, or when a reply comes that nothing asked for. A
/// fence brings it back: a read whose command nothing has whose reply may still come. Modules
/// answer in order, so when the fence's reply is here, older ones cannot come any more.
///
///     in step ──request given up, surplus reply──▶ out of step ──fence answered──▶ in step
///                                                   └─fences not answered─▶ silent for a time
///
/// Replies that overtake each other, or come twice, exist all the same. So for the lifetime of a
/// reply the answers to the command of a request that was given up are proven one by one, behind
/// the fence too; and after a surplus reply the module is suspect for a long time: every answer is
/// proven, and equal commands are kept apart.
#pragma once

#include <bitset>
#include <optional>
#include <vector>

#include "tmcl/clock.hpp"
#include "tmcl/datagram.hpp"

namespace tmcl::engine {

class Lane {
 public:
  bool in_step() const { return in_step_; }
  /// Has answered at least once, under its own address.
  bool was_heard() const { return last_answered_.has_value(); }
  bool is_silent(TimePoint now) const { return now < silent_until_; }
  /// It answers again after all.
  void end_silence() { silent_until_ = {}; }

  /// A request may or may not be answered later.
  void abandon(Command command, TimePoint now);
  /// Something makes the next reply doubtful although no request was given up.
  void lose_step() { in_step_ = false; }
  /// An answer to this command waits until an exchange of another one proves it.
  void hold_back(Command command);
  bool holds_back(Command command) const { return held_back_.test(index(command)); }
  bool holds_back_any() const { return answers_held_back_ > 0; }
  /// A fence was answered, or whatever else could have no other answer.
  void prove();
  void note_answered_fence() { ++answered_fences_; }
  /// Fence after fence was answered, and more replies came behind each before anything else could
  /// go out.
  bool fences_prove_nothing() const;
  /// Something else than a fence goes out, or is given up.
  void end_fences() { answered_fences_ = 0; }
  /// It has been silent since it was heard last: one fence is enough to find out that it still is.
  /// What asks it all the time would take half of a serial line otherwise.
  bool stays_silent() const { return stays_silent_; }
  /// A fence was not answered; true when that was the last try, and the module now counts as
  /// silent: for `silence`, and for half as long again if it stays silent.
  bool fence_failed(unsigned tries, TimePoint now, Duration silence);

  /// A late reply of this command may still come.
  bool may_still_answer(Command command, TimePoint now) const;
  /// The same, also after a silence that was longer than replies live: a module or a converter that
  /// stood still answers all that it was asked meanwhile. As many replies as were given up.
  bool owes(Command command, TimePoint now) const;
  /// It has come.
  void note_late(Command command);
  /// The module says something, whatever it is.
  void note_heard(TimePoint now);
  /// A read that proves the step: of a command that no late reply can have, no answer that waits
  /// for its proof has, and that is not `next`, which follows it. Nothing if there is no such read.
  /// Of a suspect module each is another one than the last: two surplus replies could keep in step
  /// with two commands in turn.
  std::optional<Request> fence(ModuleAddress address, Command next, TimePoint now);
  /// A fence has to come between the last exchange and one of this command.
  bool must_separate(Command command, TimePoint now) const;

  /// Remembers an exchange that ended well, so that a second reply to it is recognised.
  void answered(Command command, TimePoint now);
  /// A reply came that no request explains. True when that is the first sign for a while that the
  /// module is not the only one to answer, or this program not the only one to ask.
  bool note_surplus(Command command, TimePoint now);
  bool is_duplicate_suspected(TimePoint now) const;
  /// Replies may come that are not what they seem: from now on, until many exchanges and a long
  /// time have passed without a sign of that.
  void suspect(TimePoint now);
  bool is_suspect(TimePoint now) const;

 private:
  friend class EngineState;  ///< Of tests: tells two apart.
  /// After so long even a module that was busy writing its EEPROM has answered or never will.
  static constexpr Duration reply_lifetime = std::chrono::seconds(2);
  static constexpr Duration time_to_trust = 10 * reply_lifetime;
  /// Two modules of one address answer within a reply time of each other.
  static constexpr Duration second_reply_window = std::chrono::milliseconds(100);
  struct Abandoned {
    Command command;
    unsigned replies;                  ///< That may still come.
    TimePoint last;                    ///< When the last of them was given up.
    std::optional<TimePoint> heard{};  ///< When the module said something first after that.
  };
  static std::size_t index(Command command) { return static_cast<std::size_t>(command); }
  bool is_second_reply(Command command, TimePoint now) const;

  bool in_step_ = true;
  unsigned failed_fences_ = 0;
  bool stays_silent_ = false;
  unsigned answered_fences_ = 0;  ///< In a row.
  std::size_t next_fence_ = 0;
  std::vector<Abandoned> abandoned_;
  std::bitset<256> held_back_;
  unsigned answers_held_back_ = 0;
  TimePoint silent_until_{};
  std::optional<Command> last_answered_;
  std::optional<Command> answered_before_;  ///< The one before that.
  TimePoint last_answered_at_{};
  unsigned equal_in_a_row_ = 0;
  bool duplicate_suspected_ = false;
  unsigned surplus_ = 0;
  TimePoint surplus_since_{};
  TimePoint last_surplus_{};
  unsigned exchanges_to_trust_ = 0;
  TimePoint trusted_from_{};
};

}  // namespace tmcl::engine
