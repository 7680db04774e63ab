/// Programs on one computer or on several, each with a reactor of its own, in one virtual time:
/// each may stand still while others go on. The same happens in the same order every time.
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include <boost/asio/io_context.hpp>

#include "async/slept.hpp"
#include "tmcl/virtual_time.hpp"

namespace tmcld::test {

/// What it talks to others by is descriptors, or what they post to it.
class ProgramInTime {
 public:
  boost::asio::io_context context{1};
  tmcl::VirtualTime time{context};
  tmcld::VirtualSleep& sleep = boost::asio::use_service<tmcld::VirtualSleep>(context);

  bool is_frozen() const { return frozen_until_.has_value(); }
  /// How long it stood still until now, altogether.
  tmcl::Duration frozen() const { return frozen_; }

 private:
  friend class ProgramsInTime;

  struct Freeze {
    int after_turns;
    tmcl::Duration duration;
    bool clock_stands;
  };

  std::optional<Freeze> to_come_{};
  std::optional<tmcl::TimePoint> frozen_until_{};
  bool clock_stands_ = false;
  tmcl::Duration behind_{};  ///< Its clock, which may have stood.
  tmcl::Duration frozen_{};
};

class ProgramsInTime {
 public:
  explicit ProgramsInTime(std::vector<ProgramInTime*> programs) : programs_(std::move(programs)) {}

  tmcl::TimePoint now() const { return now_; }
  /// It stands still when it has done so many more things, or has nothing more to do now.
  /// `clock_stands`: as CLOCK_MONOTONIC does while a computer sleeps.
  void freeze(ProgramInTime& program, int after_turns, tmcl::Duration duration,
              bool clock_stands = false) {
    if (program.is_frozen()) return;
    program.to_come_ = ProgramInTime::Freeze{after_turns, duration, clock_stands};
    program.context.stop();
  }
  template <class Condition>
  bool run_while_not(Condition condition, tmcl::Duration at_most) {
    const auto limit = now_ + at_most;
    settle();
    while (!condition())
      if (!step(limit)) return false;
    return true;
  }
  void run_for(tmcl::Duration duration) {
    const auto limit = now_ + duration;
    settle();
    while (step(limit)) {
    }
    advance_to(limit);
  }

 private:
  /// Until each of them, one after the other, has had nothing to do.
  void settle() {
    std::size_t idle = 0;
    for (std::size_t next = 0; idle < programs_.size(); next = (next + 1) % programs_.size())
      idle = poll(*programs_[next]) ? 0 : idle + 1;
  }
  bool poll(ProgramInTime& program) {
    if (program.is_frozen()) return false;
    program.context.restart();
    bool has_done = !program.to_come_ && program.context.poll() > 0;
    while (program.to_come_ && !program.is_frozen()) {
      program.context.restart();
      if (program.to_come_->after_turns-- <= 0 || program.context.poll_one() == 0) {
        stand_still(program);
      } else {
        has_done = true;
      }
    }
    return has_done;
  }
  void stand_still(ProgramInTime& program) {
    program.frozen_until_ = now_ + program.to_come_->duration;
    program.clock_stands_ = program.to_come_->clock_stands;
    program.to_come_.reset();
  }
  std::optional<tmcl::TimePoint> next_of(const ProgramInTime& program) const {
    if (program.frozen_until_) return program.frozen_until_;
    const auto next = program.time.next_due();
    return next ? std::optional(*next + program.behind_) : std::nullopt;
  }
  bool step(tmcl::TimePoint limit) {
    std::optional<tmcl::TimePoint> next;
    for (const auto* program : programs_) {
      const auto due = next_of(*program);
      if (due && (!next || *due < *next)) next = due;
    }
    if (!next || *next > limit) return false;
    advance_to(std::max(*next, now_));
    for (auto* program : programs_) {
      if (next_of(*program) > now_) continue;
      if (program->is_frozen()) {
        program->frozen_until_.reset();
      } else if (program->time.next_due()) {
        program->time.step(now_ - program->behind_);
      }
    }
    settle();
    return true;
  }
  void advance_to(tmcl::TimePoint time) {
    const auto passed = time - now_;
    now_ = time;
    for (auto* program : programs_) {
      if (program->is_frozen()) program->frozen_ += passed;
      if (program->is_frozen() && program->clock_stands_) {
        program->behind_ = now_ - program->time.now();
        program->sleep.slept = program->behind_;
      } else if (now_ - program->behind_ > program->time.now()) {
        program->time.freeze_for(now_ - program->behind_ - program->time.now());
      }
    }
  }

  std::vector<ProgramInTime*> programs_;
  tmcl::TimePoint now_{std::chrono::hours(1)};
};

}  // namespace tmcld::test
