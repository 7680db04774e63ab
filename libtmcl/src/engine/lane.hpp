/// What is known about the conversation with one module.
///
/// A reply does not say what it answers. A module is in step while every request sent to it has
/// been answered, once; then the next reply of a kind answers the next request of that kind. It
/// falls out of step when a request is given up, or when a reply comes that nothing asked for. A
/// fence brings it back: a read whose command no abandoned request had. Modules answer in order, so
/// when the fence's reply is here, older ones cannot come any more.
///
///     in step ──request given up, unexplained reply──▶ out of step ──fence answered──▶ in step
///                                                       └─fences not answered─▶ silent for a time
#pragma once

#include <bitset>
#include <optional>

#include "tmcl/clock.hpp"
#include "tmcl/datagram.hpp"

namespace tmcl::engine {

class Lane {
 public:
  bool in_step() const { return in_step_; }
  /// Has answered at least once, under its own address.
  bool was_heard() const { return last_answered_.has_value(); }
  bool is_silent(TimePoint now) const { return now < silent_until_; }

  /// A request may or may not be answered later.
  void abandon(Command command, TimePoint now);
  /// Something makes the next reply doubtful although no request was given up.
  void lose_step() { in_step_ = false; }
  /// A fence was answered.
  void prove();
  /// A fence was not answered; true when that was the last try, and the module now counts as
  /// silent.
  bool fence_failed(unsigned tries, TimePoint silent_until);

  /// A late reply of this command may still come.
  bool may_still_answer(Command command, TimePoint now) const;
  bool has_abandoned(Command command) const {
    return abandoned_.test(static_cast<std::size_t>(command));
  }
  /// A read that proves the step: of a command that was not abandoned and is not `next`, which
  /// follows it. Nothing if every suitable read was abandoned lately.
  std::optional<Request> fence(ModuleAddress address, Command next, TimePoint now);

  /// Remembers an exchange that ended well, so that a second reply to it is recognised.
  void answered(Command command, TimePoint now);
  /// A reply came that no request explains. True when that is the first sign for a while that the
  /// module is not the only one to answer, or this program not the only one to ask.
  bool note_surplus(Command command, TimePoint now);
  bool is_duplicate_suspected(TimePoint now) const;

 private:
  bool is_second_reply(Command command, TimePoint now) const;

  bool in_step_ = true;
  unsigned failed_fences_ = 0;
  std::bitset<256> abandoned_;
  TimePoint last_abandoned_{};
  TimePoint silent_until_{};
  std::optional<Command> last_answered_;
  TimePoint last_answered_at_{};
  bool duplicate_suspected_ = false;
  unsigned surplus_ = 0;
  TimePoint surplus_since_{};
  TimePoint last_surplus_{};
};

}  // namespace tmcl::engine
