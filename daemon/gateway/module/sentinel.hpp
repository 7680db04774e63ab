/// By what it is noticed that a module has restarted, or is another one: something that it holds
/// and that does not survive a failure of its supply.
///
/// The tick timer counts the milliseconds since the module started. It is only read; when it is
/// behind what it should be by now, the module has started again. Its clock may go wrong by one
/// part in a hundred, it may wrap around, and the reading is from some instant between question and
/// answer. So a restart is noticed if the module was on for longer than 20 ms and a hundredth of
/// the time between two readings. A tick timer that is ahead means nothing: this computer may have
/// slept.
///
/// A user variable that is not kept in the EEPROM holds a random number, and 0 after a restart.
///
/// Settings: of a module that has neither, or is not to be asked for them, the target of a motor
/// that has been sent somewhere else than to 0, which is where it is after a restart. Of all that
/// survives none, this alone is certain to differ: other settings in the EEPROM cannot be
/// read without putting them in force. Where a program may set targets, they say nothing.
///
/// Does no I/O.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <set>
#include <string>

#include "config/config.hpp"
#include "tmcl/clock.hpp"
#include "tmcl/datagram.hpp"
#include "tmcl/error.hpp"
#include "tmcl/script.hpp"

namespace tmcld {

/// A movement goes out at most so long after its module was seen to be what it was. A module whose
/// supply fails after that does not execute it: none starts in less than 100 ms, of which a request
/// takes 10 ms at 9600 baud.
constexpr tmcl::Duration movement_sentinel_age = std::chrono::milliseconds(80);

/// The same for what is commanded on a line or a path, many times a second: as its modules answer,
/// none of them has started meanwhile, which takes a real one about a second. They are asked so
/// often while nothing is commanded, too.
constexpr tmcl::Duration journey_sentinel_age = std::chrono::milliseconds(500);

class Sentinel {
 public:
  struct Reading {
    std::int32_t value;
    tmcl::TimePoint asked;
    tmcl::TimePoint answered;
    std::uint8_t motor = 0;  ///< Whose setting it is.

    static Reading of(const tmcl::Request& question, const tmcl::Answer& answer) {
      return {answer.reply.value, answer.sent, answer.received, question.motor};
    }
  };
  enum class Verdict : std::uint8_t {
    same,
    ahead,      ///< Of the time that has passed: another module perhaps.
    restarted,  ///< Or the answer was to another question: to be proven.
    missing,    ///< The module refuses the question: to be proven.
  };

  explicit Sentinel(SentinelConfig config) : config_(config) {}

  /// "tick", "variable:N", "settings" or "none".
  std::string name() const;
  /// False if there is nothing to ask.
  bool watches() const {
    return is_by_settings() ? !may_set_targets() && certainly_away() : kind() != Kind::none;
  }
  tmcl::Request question(tmcl::ModuleAddress module) const;
  /// Whether the answer to another question does not fit. A target may be any number.
  bool is_unmistakable() const { return !is_by_settings(); }
  /// Nothing where that means nothing to another run of the gateway.
  std::optional<Reading> last() const { return is_by_settings() ? std::nullopt : last_; }

  /// Until when what was read last says what the module is. Where answers take longer than that,
  /// it counts for a moment after it has come.
  tmcl::TimePoint counts_until(tmcl::Duration age) const {
    const bool counts = last_ && !in_doubt_;
    return counts ? std::max(last_->asked + age, last_->answered + moment) : tmcl::TimePoint{};
  }

  /// Whether this fits to what was read before; what does, is remembered.
  Verdict take(const Reading& reading);
  /// An answer to its question, from any call. One that does not fit puts it in doubt.
  void overhear(const tmcl::Request& question, const tmcl::Answer& answer);
  /// Something did not fit. From then on what was read before says nothing, and one answer that
  /// fits is not believed: it may be a late one, from before the restart.
  bool in_doubt() const { return in_doubt_; }
  void doubt() { in_doubt_ = true; }
  void end_doubt() { in_doubt_ = false; }
  /// After a reading that did not fit: it is the same as before, so perhaps the timer stands.
  bool may_stand() const { return may_stand_; }
  /// A variable that was not set since the module started.
  bool wants_mark() const { return is_variable() && watches() && last_ && last_->value == 0; }
  /// What was read before says nothing any more.
  void forget();
  /// The module does not have it: its settings are left.
  void give_up() { is_given_up_ = true; }

  /// Whether settings say something is not known, or they do not if the module starts a program.
  bool wants_to_know_programs() const { return is_by_settings() && !starts_program_; }
  void note_programs(bool starts) { starts_program_ = starts; }
  /// Something that can move motors is about to go out.
  void note_sending(const tmcl::Request& request);
  /// It is on its way no more.
  void note_sent(const tmcl::Request& request, tmcl::Outcome outcome);

 private:
  static constexpr tmcl::Duration moment = std::chrono::milliseconds(20);

  using Kind = SentinelConfig::Kind;

  Kind kind() const {
    return is_given_up_ && config_.kind != Kind::none ? Kind::settings : config_.kind;
  }
  bool answers(const tmcl::Request& question) const;
  /// It was found to be as it should be when it was asked then, or later.
  bool was_seen_since(tmcl::TimePoint asked) const { return last_ && last_->asked >= asked; }
  bool is_variable() const { return kind() == Kind::variable; }
  /// The first motor of which that is certain.
  std::optional<std::uint8_t> certainly_away() const;
  /// Another than the gateway: a program, say.
  bool may_set_targets() const { return starts_program_ != false || setting_any_ > 0; }
  bool is_by_settings() const { return kind() == Kind::settings; }
  Verdict judge(const Reading& reading) const;

  SentinelConfig config_;
  bool is_given_up_ = false;
  bool has_run_ = false;
  bool may_stand_ = false;
  bool in_doubt_ = false;
  std::optional<Reading> last_;
  std::optional<bool> starts_program_;
  std::size_t setting_any_ = 0;  ///< Requests on their way after which anything may set a target.
  std::set<std::uint8_t> away_;  ///< Motors whose target is not 0 ...
  std::multiset<std::uint8_t> unsure_;  ///< ... unless what is on its way to them makes it 0.
};

}  // namespace tmcld
