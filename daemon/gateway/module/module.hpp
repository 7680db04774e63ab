/// A module: what it said it is, and whether it answers.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/awaitable.hpp>

#include "async/shared_work.hpp"
#include "gateway/event.hpp"
#include "gateway/module/deadman.hpp"
#include "gateway/module/sentinel.hpp"
#include "tmcl/model.hpp"
#include "tmcl/settings.hpp"
#include "tmcl/verbs.hpp"

namespace tmcld {

class GatewayBus;

class GatewayModule {
 public:
  enum class State : std::uint8_t {
    unknown,        ///< Not asked yet, or the link is not open.
    ready,          ///< Has said what it is, and answers.
    silent,         ///< Did not answer when last asked.
    in_bootloader,  ///< Answers, but runs no firmware: it executes nothing.
  };

  GatewayModule(GatewayBus& bus, const ModuleConfig& config)
      : bus_(bus),
        address_(config.address),
        as_(config.as),
        sentinel_(config.sentinel),
        settings_(config.settings),
        deadman_(bus, config) {}

  tmcl::ModuleAddress address() const { return address_; }
  /// An axis of it is in the configuration. Others are only asked what they are when a call
  /// names them.
  bool is_configured() const { return is_configured_; }
  void note_configured() { is_configured_ = true; }
  State state() const { return state_; }
  /// What it said last, perhaps some time ago.
  const std::optional<tmcl::FoundModule>& identity() const { return identity_; }
  /// Null for a model that is not known, and before the module has said what it is.
  const tmcl::Model* model() const;
  /// What the configuration says that it is like; nothing if it is of another model.
  tmcl::ModuleTraits traits() const;
  bool duplicate_suspected() const { return duplicate_suspected_; }
  /// Changes whenever its settings may have been changed by something else than parameter calls.
  std::uint64_t settings_epoch() const { return settings_epoch_; }

  /// Asks a module what it is unless that is known: nothing else goes to a module whose identity
  /// is not known, except stops and raw commands.
  /// Errors: those of the exchange, with Outcome::not_sent for what was to follow;
  /// Errc::in_bootloader.
  boost::asio::awaitable<tmcl::Result<void>> be_ready();

  /// Makes sure that it has not started again, and is no other one, since it was ready: asked at
  /// most `max_age` ago. If it has, its axes are latched when this ends.
  /// Errors: those of the exchange, with Outcome::not_sent for what was to follow.
  tmcl::Script<tmcl::Result<void>> watch(tmcl::Duration max_age);
  const Sentinel& sentinel() const { return sentinel_; }
  /// It is identified, and its sentinel would show a restart: not after a reset by tmcld.
  bool is_watched() const {
    return (state_ == State::ready || state_ == State::silent) && sentinel_.watches();
  }
  /// Something that can move its motors is about to go out, and is on its way no more.
  void note_sending(const tmcl::Request& request) { sentinel_.note_sending(request); }
  void note_moved(const tmcl::Request& request, tmcl::Outcome outcome) {
    sentinel_.note_sent(request, outcome);
  }
  /// A request may write to it.
  void note_sent(const tmcl::Request& request);
  /// This question of its sentinel was asked along with others.
  void note_sentinel(const tmcl::Request& question, const tmcl::Result<tmcl::Answer>& answer);
  /// It has answered a call.
  void note_answer(const tmcl::Request& request, const tmcl::Answer& answer);

  /// What stops its motors when no host sends it anything.
  Deadman& deadman() { return deadman_; }
  const Deadman& deadman() const { return deadman_; }
  /// When it must have a command again; far away if it needs none.
  tmcl::TimePoint feeding_due() const;
  /// Sends it something, unless that takes longer.
  boost::asio::awaitable<void> feed(tmcl::TimePoint deadline);

  /// What it is to be set to.
  const SettingsConfig& settings_config() const { return settings_; }
  /// How its settings differ from those; nothing if that is not known.
  const std::optional<std::vector<tmcl::SettingDifference>>& drift() const { return drift_; }
  void note_drift(std::vector<tmcl::SettingDifference> drift) { drift_ = std::move(drift); }
  /// They are to be compared now, by the caller. False while others do so.
  bool begin_to_compare_settings();
  /// `failed`: they are to be compared when it answers again.
  void end_comparing_settings(bool failed);

  /// The last thing that its data logger was told to record; 0: nothing since the daemon started.
  std::int32_t capture() const { return capture_; }
  void begin_capture() { ++capture_; }

  /// Learns from how a call ended.
  void note(const tmcl::Error& error);
  void note_duplicate() { duplicate_suspected_ = true; }
  void note_settings_changed() { ++settings_epoch_; }
  /// Its link was lost: it may be another module when it comes back.
  void forget_state();

 private:
  /// Asks what it is, and whether it has started again.
  tmcl::Script<tmcl::Result<void>> meet();
  tmcl::Script<tmcl::Result<void>> look_after();
  tmcl::Script<tmcl::Result<Sentinel::Verdict>> look_at_sentinel();
  tmcl::Script<tmcl::Result<Sentinel::Verdict>> judge_sentinel(tmcl::Proof proof);
  tmcl::Script<tmcl::Result<Sentinel::Verdict>> give_up_sentinel(std::string why);
  /// Writes to a user variable that was not set since the module started.
  tmcl::Script<tmcl::Result<void>> mark();
  void adopt(const tmcl::FoundModule& found);
  void forget_drift();
  void latch(GatewayEvent::Kind kind, const std::string& what);

  GatewayBus& bus_;
  tmcl::ModuleAddress address_;
  MeasuredModule as_;
  bool is_configured_ = false;
  State state_ = State::unknown;
  std::optional<tmcl::FoundModule> identity_;
  bool duplicate_suspected_ = false;
  std::uint64_t settings_epoch_ = 0;
  Sentinel sentinel_;
  SettingsConfig settings_;
  std::optional<std::vector<tmcl::SettingDifference>> drift_;
  bool is_compared_ = false;
  bool is_comparing_ = false;
  SharedWork<tmcl::Result<void>> meetings_;
  Deadman deadman_;
  std::int32_t capture_ = 0;
};

std::string_view name_of(GatewayModule::State state);

}  // namespace tmcld
