/// What a bus lets out. Each command of a verb that moves a motor or sets something is judged
/// before it is queued, and once more when its bytes go out; see judge.hpp.
///
///     judge ──allow──▶ queue ──its turn──▶ judge ──allow──▶ wire
///      ▲ │ │                                │  │
///      │ │ └─refuse──▶ error                │  └─refuse──▶ error
///      └─ask                        changed─┴──▶ judge, most_admissions times
///
/// Stops that were not answered are kept, and sent as soon as their module can be reached.
/// Thread safety: none. Errors: as values.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <boost/asio/awaitable.hpp>

#include "gateway/authority/motors.hpp"
#include "gateway/authority/owed_stops.hpp"
#include "gateway/authority/queue_shares.hpp"
#include "gateway/authority/run_options.hpp"

namespace tmcld {

class AxisLimits;
class GatewayBus;
class GatewayModule;

/// Whether an obstacle is asked about. The holder of a module asks nothing: the answer would wait
/// for the end of its hold.
enum class Asks : std::uint8_t { what_may_have_ended, nothing };

/// Told of each reference search that begins, or may have begun.
using OnSearch = std::function<void(tmcl::AxisAddress motor, Permit permit)>;

/// Told of each axis parameter that a client has set that does not lead the axis. `value`: nothing
/// where it is not known.
using OnSetting = std::function<void(tmcl::AxisAddress motor, std::uint8_t parameter,
                                     std::optional<std::int32_t> value)>;

class Gate {
  template <class T>
  using Script = tmcl::Script<tmcl::Result<T>>;

 public:
  /// The bus has it and outlives it.
  Gate(GatewayBus& bus, const std::string& name, std::shared_ptr<Arrivals> arrivals)
      : bus_(bus), motors_(name, std::move(arrivals)) {}

  /// What is known of the motors of the bus.
  Motors& motors() { return motors_; }
  const Motors& motors() const { return motors_; }
  /// What they are the limits of is kept within them, whatever is sent.
  void add_limits(std::shared_ptr<AxisLimits> limits) { limits_.push_back(std::move(limits)); }
  void on_search(OnSearch on_search) { on_search_ = std::move(on_search); }
  void on_setting(OnSetting on_setting) { on_setting_ = std::move(on_setting); }
  /// Changes with every request that is no question, and with the link: what was read before says
  /// nothing about now.
  std::uint64_t commands() const { return commands_; }
  void note_lost_link() { ++commands_; }

  struct Ended {
    std::optional<tmcl::Error> objection;
    bool broke_off = false;  ///< Something of it went out, and something was refused.
    std::vector<TurningAttempt> turning{};

    /// Where `error` says that nothing was done.
    void withdraw_turning(const tmcl::Error& error) {
      if (error.outcome == tmcl::Outcome::unknown || error.outcome == tmcl::Outcome::done) return;
      for (auto& attempt : turning) attempt.withdraw();
    }
  };
  /// Steps through a verb to its end, or until there is an objection. See GatewayBus::run().
  boost::asio::awaitable<Ended> run(tmcl::AnyScript& script, RunOptions options);
  /// Whether a request may go out for a call: see judge.hpp. What may have ended unseen is asked
  /// about, such as a search that claims a motor.
  /// Errors: those of Motors::refusal() and of the questions; nothing was sent.
  Script<void> may_send(tmcl::Request request, Permit permit,
                        Asks asks = Asks::what_may_have_ended);

  // ---- stops that were not answered
  /// Whether the motor has been stopped, and its module has not answered that yet.
  bool owes_stop(tmcl::AxisAddress motor) const { return owed_stops_.has(motor); }
  bool owes_stop(tmcl::ModuleAddress module) const { return !owed_stops_.of(module).empty(); }
  /// The stop was not answered. False if it cannot be kept.
  bool owe(const tmcl::Request& stop);
  /// Begins to send the stops that the module has not answered; returns at once.
  void send_owed_stops(tmcl::ModuleAddress module);
  /// Those of all modules.
  void send_owed_stops();

  // ---- what may have ended unseen
  /// Of a motor that a search has claimed: frees it if the module says that the search has ended,
  /// and notes whether it has found its reference.
  /// Errors: those of the exchanges; Errc::axis_claimed while it searches.
  Script<void> see_search_end(tmcl::AxisAddress motor);
  /// The motor turns without end, or may: where it stands, too, if it is set to turn, as at a limit
  /// switch. Errors: those of the exchanges.
  Script<bool> may_turn(tmcl::AxisAddress motor);
  /// Notes that a motor does not turn any more, if its module says so.
  Script<void> see_turning_end(tmcl::AxisAddress motor);
  /// For the holder of the coordinates of a module: nothing that changes them is on its way any
  /// more.
  Script<void> hold_still(tmcl::ModuleAddress module);

 private:
  /// What a verb does, and what became of it so far.
  struct Conduct {
    RunOptions options;
    bool acted = false;      ///< Something went out that was no mere question.
    bool refused = false;    ///< Something that can move a motor was not sent: it ends by itself.
    bool owes_stop = false;  ///< A stop of it was not answered.
    GatewayModule* module = nullptr;  ///< The last that it has asked something.
    std::vector<TurningAttempt> turning{};
  };
  /// Of what the verb announces: before it goes out, the journal says whose it is.
  boost::asio::awaitable<void> begin_turning(Conduct& conduct);
  Script<void> step_through(tmcl::AnyScript& script, Conduct& conduct);
  static std::optional<tmcl::Error> objection_to(const tmcl::Step& step, const Conduct& conduct);
  tmcl::Script<tmcl::StepResult> carry_out(tmcl::Step step, Conduct& conduct);
  Script<tmcl::Answer> send(tmcl::step::Exchange exchange, Conduct& conduct);
  Script<void> admit(tmcl::step::Exchange exchange, const RunOptions& options);
  Script<void> keep_limits(tmcl::Request request);
  /// What was admitted must go out before then.
  std::optional<tmcl::TimePoint> admitted_until(const tmcl::step::Exchange& exchange,
                                                const RunOptions& options) const;
  /// Nothing, and nothing was sent, if it has to be admitted again.
  tmcl::Script<std::optional<tmcl::Result<tmcl::Answer>>> send_admitted(
      tmcl::step::Exchange exchange, Conduct& conduct);
  /// Asked when the bytes of a request are about to go out. `has_changed`: what it was admitted on,
  /// so it is to be admitted again.
  std::optional<tmcl::Error> last_objection(const tmcl::step::Exchange& exchange,
                                            const RunOptions& options, bool& has_changed) const;
  Script<tmcl::Answer> send_once(tmcl::step::Exchange exchange, Conduct& conduct);
  tmcl::Script<tmcl::StepResult> exchange_all(std::vector<tmcl::step::Exchange> exchanges);
  GatewayModule* watched_module(const tmcl::step::Exchange& exchange) const;
  void note_answer(const tmcl::Request& request, const tmcl::Result<tmcl::Answer>& answer);
  void tell_setting(const tmcl::Request& request, const Motors::Before& before) const;
  /// The journal says what has changed, soon.
  void write_journal() const;

  /// What a verb that cannot begin would have sent first.
  bool owe_first(tmcl::AnyScript& script);
  /// The stops of motors first; behind the end of a program once more.
  Script<void> pay_stops(tmcl::ModuleAddress module);
  Script<void> pay_stop(tmcl::Request stop);
  static boost::asio::awaitable<void> pay_stops(std::shared_ptr<GatewayBus> bus,
                                                tmcl::ModuleAddress module);
  void tell_paid(const tmcl::Request& stop);

  Motors::Judgement judge(const tmcl::Request& request, Permit permit) const;
  /// The reactor may have stood still since the last look.
  void look_for_gap() const;
  /// What stands in the way may have ended.
  Script<void> ask_about(Motors::Judgement it);
  Script<void> see_end_of_line(tmcl::AxisAddress motor);
  Script<void> look_whether_it_turns(tmcl::AxisAddress motor);
  Script<void> see_coordinates_released(tmcl::ModuleAddress module);

  GatewayBus& bus_;
  Motors motors_;
  OwedStops owed_stops_;
  QueueShares shares_;
  std::vector<std::shared_ptr<AxisLimits>> limits_;
  OnSearch on_search_;
  OnSetting on_setting_;
  std::uint64_t commands_ = 0;
};

}  // namespace tmcld
