/// A module's own deadman: it stops its motors when no host has sent it a command for so long
/// (global parameter 68, on CAN 82). It works when this computer fails, hangs or is cut off.
///
/// The parameter is a cell of the EEPROM, which wears: it is read when the module is met, written
/// only if it is not as configured, and once in a run of the gateway, whatever comes of that. It
/// is not written to a module that starts a program by itself: that would be stopped.
///
/// A module that has one set is fed: it gets a command in every third of its time.
///
/// That a module keeps the value does not prove that it does anything about it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "config/config.hpp"
#include "tmcl/script.hpp"
#include "tmcl/verbs.hpp"

namespace tmcld {

class GatewayBus;
struct KnownDeadman;

class Deadman {
 public:
  Deadman(GatewayBus& bus, const ModuleConfig& config)
      : bus_(bus), address_(config.address), wanted_ms_(config.deadman_ms) {}

  /// What the module is set to; 0: it is off, or the module has none. Nothing: it was not read.
  const std::optional<std::int32_t>& set_ms() const { return set_ms_; }
  /// By the configuration; nothing: it is left alone.
  const std::optional<std::int32_t>& wanted_ms() const { return wanted_ms_; }
  bool is_set() const { return set_ms_.value_or(0) > 0; }

  /// The module is this one: sets it as configured, if it is configured and that has not been done.
  /// What the module refuses is said in the log, and no error.
  /// Errors: those of the exchanges.
  tmcl::Script<tmcl::Result<void>> adopt(tmcl::FoundModule found);
  /// Asks the module what it is set to; 0 if it refuses to tell. Errors: those of the exchange.
  tmcl::Script<tmcl::Result<std::int32_t>> read();
  /// Whether it has refused to tell.
  bool is_missing() const { return is_missing_; }
  /// Sets it, unless it is so. Errors: those of write(); Errc::bad_argument where there is none.
  tmcl::Script<tmcl::Result<void>> change(std::int32_t ms);
  /// Writes it, and reads it back. Errors: also Errc::bad_argument where a program starts by
  /// itself; Errc::unexpected_value if the module has something else then.
  tmcl::Script<tmcl::Result<void>> write(std::int32_t ms);
  /// Whether the module starts a program by itself. Errors: those of the exchange.
  tmcl::Script<tmcl::Result<bool>> starts_program();
  /// Its link was lost: it may be another module when it comes back.
  void forget_settings() { is_adopted_ = false; }

  /// After how many milliseconds a test has seen it stop, as it is set now; 0: it went on. Nothing:
  /// it was not tested.
  std::optional<std::int32_t> stops_after_ms() const;
  /// Remembers what the module is set to, and what a test has found of that. Not before it has been
  /// read.
  void remember(std::optional<std::int32_t> stops_after_ms);

  // ---- feeding ----

  /// When it must have a command; far away while it is being fed, or needs none.
  tmcl::TimePoint due() const;
  /// Gives the time by which it must have been sent.
  tmcl::TimePoint begin_to_feed(tmcl::TimePoint now);
  void end_feeding() { is_feeding_ = false; }
  /// A question that any module answers.
  tmcl::Script<tmcl::Result<void>> ask();
  /// It has had a command.
  void note_answer(const tmcl::Answer& answer);
  /// When the last time ended for which it may have had no command for too long; long ago if there
  /// was none.
  tmcl::TimePoint last_gap() const { return last_gap_; }

 private:
  std::uint8_t parameter() const;
  const KnownDeadman* known() const;
  tmcl::Script<tmcl::Result<void>> set_as_configured();
  void note_set(std::int32_t ms);
  void say(const std::string& what);

  GatewayBus& bus_;
  tmcl::ModuleAddress address_;
  std::optional<std::int32_t> wanted_ms_;
  std::optional<std::int32_t> set_ms_;
  tmcl::FirmwareVersion version_{};  ///< Of the module that was adopted last.
  bool is_missing_ = false;
  bool is_adopted_ = false;
  std::optional<tmcl::FirmwareVersion> written_to_;  ///< By configuration, in this run.
  std::string said_;
  bool is_feeding_ = false;
  tmcl::TimePoint heard_{};  ///< It has certainly had a command since.
  tmcl::TimePoint fed_{};    ///< When that was tried last.
  tmcl::TimePoint last_gap_{};
};

}  // namespace tmcld
