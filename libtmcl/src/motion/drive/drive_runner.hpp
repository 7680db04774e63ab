/// What is behind a Drive: a script whose steps are commands to axes, and pauses.
#pragma once

#include <array>
#include <map>

#include "tmcl/plan/arrival.hpp"
#include "tmcl/plan/drive.hpp"
#include "tmcl/script.hpp"

namespace tmcl::plan {

/// Between two looks at axes that are on their way.
constexpr Duration drive_look_interval = std::chrono::milliseconds(20);

/// The settings of an axis, as they were and as they are.
class KeptSettings {
 public:
  void know(Setting setting);
  bool is_known(std::uint8_t parameter) const { return before_.contains(parameter); }
  /// As it was; it must be known.
  std::int32_t before(std::uint8_t parameter) const { return before_.at(parameter); }
  /// As it is, if that is known.
  std::optional<std::int32_t> now(std::uint8_t parameter) const;
  /// From now on it may be what it was or what is written.
  void begin_write(std::uint8_t parameter);
  void wrote(Setting setting) { now_[setting.parameter] = setting.value; }
  /// Those that are not as they were, the last one that was written first: in that order, each
  /// goes with those that are there. Speeds are kept in_safe_order(), whatever was written between.
  std::vector<Setting> to_restore() const;
  /// See plan::in_safe_order(); as they come if it is not known what divides the speed now.
  std::vector<Setting> in_safe_order(std::vector<Setting> settings) const;

 private:
  std::map<std::uint8_t, std::int32_t> before_;
  std::map<std::uint8_t, std::int32_t> now_;
  std::vector<std::uint8_t> written_;  // in the order of the first time
};

class DriveRunner {
 public:
  explicit DriveRunner(std::size_t axes) : settings_(axes), under_way_(axes + 1) {}
  virtual ~DriveRunner() = default;

  DriveStep next(TimePoint now);
  void answered(TimePoint now, std::size_t axis, Result<std::int32_t> answer);
  void stop(DriveFault why) {
    if (!stop_asked_) stop_asked_ = std::move(why);
  }

 protected:
  using Fault = std::optional<DriveFault>;
  using Kind = DriveCommand::Kind;

  struct Exchange {
    DriveCommand command;
    TimePoint asked{};
    TimePoint ended{};
    Result<std::int32_t> answer = 0;
  };

  struct Awaiter {
    bool ready;
    bool await_ready() const noexcept { return ready; }
    template <class Promise>
    void await_suspend(std::coroutine_handle<Promise> script) {
      script.promise().state->step = step::Pause{};
    }
    void await_resume() const noexcept {}
  };
  /// Leaves the answer in answer_, and the times in asked_at_ and now_.
  Awaiter command(DriveCommand command);
  Awaiter until(TimePoint time);
  /// The wait that is under way is over at the next step.
  void end_wait() { until_ = {}; }
  /// Each lane one command after the other, all lanes side by side. Leaves in done_ what came of
  /// those that were given. `all_or_none`: after a failure, or when it is to stop, nothing more is
  /// begun.
  Awaiter side_by_side(std::vector<DriveCommands>&& lanes, bool all_or_none);

  virtual Script<Fault> whole() = 0;
  virtual void on_answered(Duration /*took*/) {}

  std::size_t axes() const { return settings_.size(); }
  /// What is seen of axes after the reason to stop them is none of its own: see refusal(), too.
  Fault fault(DriveFault::Kind kind, std::optional<std::size_t> axis, std::string message) const;
  Fault refusal(std::size_t axis, const Error& error) const;
  Fault refusal(std::size_t axis) const { return refusal(axis, answer_.error()); }
  const Fault& asked_to_stop() const { return stop_asked_; }
  /// The middle between the last command and its answer.
  TimePoint middle() const { return asked_at_ + (now_ - asked_at_) / 2; }

  /// Reads the parameter, unless it is known.
  Script<Fault> know(std::size_t axis, std::uint8_t parameter);
  /// Writes it, unless it is so already; it is known then as it was.
  Script<Fault> set(std::size_t axis, Setting setting);
  virtual void on_written(std::size_t /*axis*/, Setting /*setting*/) {}
  /// The M words that are to be carried out beside the stops; none when asked again.
  virtual std::vector<std::uint8_t> take_words_at_stop() { return {}; }
  /// What cannot be stopped is tried again, so many times in all.
  Script<Fault> stop_all(DriveReport& report, int attempts);
  /// All of them; those that can be stopped are waited for. Gives the first that does not come to
  /// rest.
  Script<Fault> stop_and_rest(DriveReport& report);
  Script<Fault> come_to_rest(std::size_t axis, TimePoint limit);
  /// Of those that could be stopped. An axis that is not seen to stand counts as not stopped.
  Script<Fault> see_all_stand(DriveReport& report, TimePoint limit);
  /// `unstopped_ones`: also the settings of axes that may still move.
  Script<Fault> restore(DriveReport& report, bool unstopped_ones = true);

  struct Goal {
    std::size_t axis;
    Microsteps target;
  };
  /// Whose arrival is watched; nothing once it has arrived.
  struct Watched {
    Goal goal;
    std::optional<Arrival> arrival;
  };
  Script<Fault> look(Watched& watched, TimePoint limit);
  /// Until all of them stand at their targets. `begin`: when they were started; `limit`: when they
  /// should have arrived.
  Script<Fault> arrive(std::vector<Goal> goals, TimePoint begin, TimePoint limit);

  std::vector<KeptSettings> settings_;
  Result<std::int32_t> answer_ = 0;
  std::vector<Exchange> done_;
  TimePoint now_{};
  TimePoint asked_at_{};
  Fault stop_asked_;
  bool heeds_stop_ = true;  ///< A wait ends when it is to stop.
  bool stopping_ = false;   ///< From the first stop on: what is read may wait.

 private:
  void proceed(const std::optional<Step>& step);
  void send_next(std::size_t lane);
  void note_stops(DriveReport& report);
  Fault short_of(const Goal& goal, Microsteps position) const;
  bool has_other_reason() const { return stop_asked_ && !stopping_; }

  std::optional<Script<Fault>> script_;
  std::vector<DriveCommands> lanes_;  // each in reverse
  DriveCommands to_send_;
  struct UnderWay {
    Exchange exchange;
    std::size_t lane;
  };
  std::vector<std::optional<UnderWay>> under_way_;  // of the axes, and of none of them
  std::size_t awaited_ = 0;
  bool all_or_none_ = false;
  TimePoint until_{};
  bool ended_ = false;
};

}  // namespace tmcl::plan
