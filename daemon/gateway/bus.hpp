/// A configured bus: opened, lost and opened again, for as long as the daemon runs.
///
///     opening ──opened──▶ open ──link lost──▶ lost ──opened──▶ open
///        │ ▲                                   │ ▲
///        └─┘ failed: again after 100 ms..1 s   └─┘
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>

#include "async/wake.hpp"
#include "async/workers.hpp"
#include "config/config.hpp"
#include "gateway/authority/motors.hpp"
#include "gateway/authority/owed_stops.hpp"
#include "gateway/authority/queue_shares.hpp"
#include "gateway/event.hpp"
#include "gateway/module/module.hpp"
#include "gateway/store/journal.hpp"
#include "gateway/traffic_log.hpp"
#include "log/audit.hpp"
#include "log/limiter.hpp"
#include "log/sink.hpp"
#include "tmcl/bus.hpp"

namespace tmcld {

class AxisLimits;
class DeadmanMemory;

/// How a link is opened. May block; called on a thread of its own.
using OpenLink = std::function<tmcl::Result<tmcl::Link>(const BusConfig&)>;

/// What a movement was admitted on, and that may change before it goes out.
struct Premise {
  /// It has changed since the last check.
  std::function<bool()> has_changed{};
  /// Checks it anew.
  std::function<tmcl::Script<tmcl::Result<void>>()> check{};
};

/// Whether an obstacle is asked about. The holder of a module asks nothing: the answer would wait
/// for the end of its hold.
enum class Asks : std::uint8_t { what_may_have_ended, nothing };

struct RunOptions : tmcl::RunOptions {
  /// Of the call that it is for: see Motors.
  Permit permit{};
  /// What a movement was checked against, such as soft limits.
  Premise premise{};
  /// What the verb sends, if that may set a motor turning without end: before it goes out, that has
  /// an owner, and the journal says so.
  std::optional<tmcl::Request> announced{};
  /// How lately a module must have been seen to be what it was, when something goes out that can
  /// move it.
  tmcl::Duration sentinel_age = movement_sentinel_age;
};

/// For what needs no permit.
inline RunOptions asked_by(std::uint64_t client) {
  RunOptions options;
  options.permit.client = client;
  return options;
}

/// Told of each reference search that begins, or may have begun.
using OnSearch = std::function<void(tmcl::AxisAddress motor, Permit permit)>;

/// Told of each axis parameter that a client has set that does not lead the axis. `value`: nothing
/// where it is not known.
using OnSetting = std::function<void(tmcl::AxisAddress motor, std::uint8_t parameter,
                                     std::optional<std::int32_t> value)>;

class GatewayBus : public std::enable_shared_from_this<GatewayBus> {
 public:
  enum class State : std::uint8_t { opening, open, lost };

  GatewayBus(const boost::asio::any_io_executor& executor, BusConfig config, OpenLink open_link,
             LogSink log, OnGatewayEvent on_event, std::shared_ptr<Arrivals> arrivals);

  /// Opens the link before start() does; blocks meanwhile.
  tmcl::Result<void> open_now();
  /// Begins to open the link, unless it is open, and to look after the modules; returns at once.
  void start();
  /// Ends everything in progress with Errc::link_lost and stays closed.
  void close();
  bool is_closed() const { return closed_; }
  /// A stop of each motor goes out at once, past all queues, and takes no memory; see
  /// tmcl::Bus::stop_at_once().
  void stop_at_once() const noexcept;
  /// What waits, and was admitted, moves nothing any more.
  void refuse_movements() const noexcept {
    if (bus_) bus_->refuse_movements();
  }
  /// The same, because the configuration has no such bus any more: those who use it are told.
  void retire();

  const std::string& name() const { return config_.name; }
  const BusConfig& config() const { return config_; }
  const boost::asio::any_io_executor& executor() const { return executor_; }
  const tmcl::ContextClock& clock() const { return clock_; }
  State state() const { return state_; }
  /// Why the link is not open; empty while it is.
  const std::string& error() const { return error_; }
  /// Since the daemon started, over all openings.
  tmcl::BusCounters counters() const;
  /// How many exchanges wait for their turn.
  std::size_t queued() const { return bus_ ? bus_->queued() : 0; }
  /// What went over it lately.
  const TrafficLog& traffic() const { return *traffic_; }
  /// A thread may be blocked in the system, and cannot be called back.
  bool is_opening_link() const { return opening_link_; }
  /// Waits for that thread. After this no link is opened any more.
  void wait_for_opener() { opener_.join(); }
  bool is_can() const { return std::holds_alternative<tmcl::CanName>(config_.link); }

  /// The module of this address, if add_module() has made it: for axes, configured or not.
  GatewayModule* find_module(tmcl::ModuleAddress address) const;
  GatewayModule& add_module(tmcl::ModuleAddress address);
  /// Null where it is not known.
  const tmcl::Model* model_of(tmcl::ModuleAddress address) const;
  const std::map<tmcl::ModuleAddress, std::unique_ptr<GatewayModule>>& modules() const {
    return modules_;
  }

  /// What they are the limits of is kept within them, whatever is sent.
  void add_limits(std::shared_ptr<AxisLimits> limits) { limits_.push_back(std::move(limits)); }
  /// What has to be put in order if the process ends; null without a journal.
  const std::shared_ptr<Journal>& journal() const { return journal_; }
  void keep_journal(std::shared_ptr<Journal> journal) { journal_ = std::move(journal); }
  /// For lines about what the gateway itself sets.
  void keep_audit(AuditSink audit) { audit_ = std::move(audit); }
  void audit(std::string line) const;
  /// What is known of the deadmen of modules. Null before the gateway has given it.
  const std::shared_ptr<DeadmanMemory>& deadmen() const { return deadmen_; }
  void keep_deadmen(std::shared_ptr<DeadmanMemory> deadmen) { deadmen_ = std::move(deadmen); }
  /// A module may need a command at another time than before.
  void look_at_feeding() { feeding_.notify(); }
  /// Stops and claims of its motors.
  Motors& motors() { return motors_; }
  const Motors& motors() const { return motors_; }
  /// Whether a request may go out for a call: see judge.hpp. What may have ended unseen is asked
  /// about, such as a search that claims a motor.
  /// Errors: those of Motors::refusal() and of the questions; nothing was sent.
  tmcl::Script<tmcl::Result<void>> may_send(tmcl::Request request, Permit permit,
                                            Asks asks = Asks::what_may_have_ended);
  /// Whether the motor has been stopped, and its module has not answered that yet.
  bool owes_stop(tmcl::AxisAddress motor) const { return owed_stops_.has(motor); }
  bool owes_stop(tmcl::ModuleAddress module) const { return !owed_stops_.of(module).empty(); }
  /// Begins to send the stops that the module has not answered; returns at once.
  void send_owed_stops(tmcl::ModuleAddress module);
  /// Of a motor that a search has claimed: frees it if the module says that the search has ended,
  /// and notes whether it has found its reference.
  /// Errors: those of the exchanges; Errc::axis_claimed while it searches.
  tmcl::Script<tmcl::Result<void>> see_search_end(tmcl::AxisAddress motor);

  /// The motor turns without end, or may: where it stands, too, if it is set to turn, as at a limit
  /// switch. Errors: those of the exchanges.
  tmcl::Script<tmcl::Result<bool>> may_turn(tmcl::AxisAddress motor);
  /// Notes that a motor does not turn any more, if its module says so.
  tmcl::Script<tmcl::Result<void>> see_turning_end(tmcl::AxisAddress motor);
  /// To be asked by who holds the coordinates of a module: nothing that changes them is on its way
  /// any more.
  tmcl::Script<tmcl::Result<void>> hold_still(tmcl::ModuleAddress module);

  /// One exchange, exactly as given.
  boost::asio::awaitable<tmcl::Result<tmcl::Answer>> execute(tmcl::Request request,
                                                             RunOptions options);
  /// Runs a verb to its end, or until there is an objection. What moves a motor or sets something
  /// is judged before it is queued, and again when its bytes go out: see judge.hpp. So are limits,
  /// the premise and the objection. For the verb it is as if the module had refused it. A verb that
  /// ends like this has Outcome::unknown if something of it went out before that was no mere
  /// question.
  /// Errors: besides those of the verb and of may_send(), Errc::link_lost while the link is not
  /// open.
  template <class T>
  boost::asio::awaitable<T> run(tmcl::Script<T> script, RunOptions options) {
    auto ended = co_await run_steps(script, std::move(options));
    if (ended.objection) {
      ended.withdraw_turning(*ended.objection);
      co_return tl::unexpected(std::move(*ended.objection));
    }
    auto result = script.take();
    if (!result && ended.broke_off) result.error().outcome = tmcl::Outcome::unknown;
    if (!result) ended.withdraw_turning(result.error());
    co_return result;
  }

  /// Changes with every request that is no question, and with the link: what was read before says
  /// nothing about now.
  std::uint64_t commands() const { return commands_; }
  /// One scan at a time: set while one runs.
  bool scanning = false;
  /// Axes of this bus are on paths. What can wait, waits then: see the poller.
  bool has_paths() const { return motors_.claimed_by(Mover::path) > 0; }

  // For the parts of this bus.
  /// Tells everyone.
  void emit(GatewayEvent event);
  void on_search(OnSearch on_search) { on_search_ = std::move(on_search); }
  void on_setting(OnSetting on_setting) { on_setting_ = std::move(on_setting); }
  /// Not more often than a LogLimiter allows.
  void log(LogLevel level, const std::string& line);

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
  /// Of what the verb announces: before it goes out, the journal says whose it is.
  boost::asio::awaitable<void> begin_turning(Conduct& conduct);
  /// Steps through a verb to its end, or until there is an objection.
  boost::asio::awaitable<Ended> run_steps(tmcl::AnyScript& script, RunOptions options);
  tmcl::Script<tmcl::Result<void>> judged(tmcl::AnyScript& script, Conduct& conduct);
  static std::optional<tmcl::Error> objection_to(const tmcl::Step& step, const Conduct& conduct);
  tmcl::Script<tmcl::StepResult> carry_out(tmcl::Step step, Conduct& conduct);
  tmcl::Script<tmcl::Result<tmcl::Answer>> send(tmcl::step::Exchange exchange, Conduct& conduct);
  /// What was admitted must go out before then.
  std::optional<tmcl::TimePoint> admitted_until(const tmcl::step::Exchange& exchange,
                                                const RunOptions& options) const;
  /// Nothing, and nothing was sent, if it has to be admitted again.
  tmcl::Script<std::optional<tmcl::Result<tmcl::Answer>>> send_admitted(
      tmcl::step::Exchange exchange, Conduct& conduct);
  Motors::Judgement judge(const tmcl::Request& request, Permit permit) const;
  /// What stands in the way may have ended.
  tmcl::Script<tmcl::Result<void>> ask_about(Motors::Judgement it);
  tmcl::Script<tmcl::Result<void>> see_end_of_line(tmcl::AxisAddress motor);
  tmcl::Script<tmcl::Result<void>> look_whether_it_turns(tmcl::AxisAddress motor);
  tmcl::Script<tmcl::Result<void>> see_coordinates_released(tmcl::ModuleAddress module);
  tmcl::Script<tmcl::Result<void>> keep_limits(tmcl::Request request);
  /// Asked when the bytes of a request are about to go out. `has_changed`: what it was admitted on,
  /// so it is to be admitted again.
  std::optional<tmcl::Error> last_objection(const tmcl::step::Exchange& exchange,
                                            const RunOptions& options, bool& has_changed) const;
  tmcl::Script<tmcl::Result<void>> admit(tmcl::step::Exchange exchange, const RunOptions& options);
  tmcl::Script<tmcl::Result<tmcl::Answer>> send_once(tmcl::step::Exchange exchange,
                                                     Conduct& conduct);
  tmcl::Script<tmcl::StepResult> exchange_all(std::vector<tmcl::step::Exchange> exchanges);
  GatewayModule* watched_module(const tmcl::step::Exchange& exchange) const;
  /// The stop was not answered. False if it cannot be kept.
  bool owe(const tmcl::Request& stop);
  /// What a verb that cannot begin would have sent first.
  bool owe_first(tmcl::AnyScript& script);
  tmcl::Script<tmcl::Result<void>> pay_stops(tmcl::ModuleAddress module);
  static boost::asio::awaitable<void> pay_stops(std::shared_ptr<GatewayBus> self,
                                                tmcl::ModuleAddress module);
  void tell_paid(const tmcl::Request& stop);

  tmcl::Error not_open() const;
  std::string names_of_moving() const;
  boost::asio::awaitable<void> rest(tmcl::Duration duration);

  static boost::asio::awaitable<void> serve(std::shared_ptr<GatewayBus> self);
  boost::asio::awaitable<bool> open();
  boost::asio::awaitable<void> look_after_modules();
  static boost::asio::awaitable<void> feed_modules(std::shared_ptr<GatewayBus> self);
  static boost::asio::awaitable<void> feed(std::shared_ptr<GatewayBus> self, GatewayModule& module,
                                           tmcl::TimePoint deadline);
  void tell_setting(const tmcl::Request& request, const Motors::Before& before) const;
  void note_answer(const tmcl::Request& request, const tmcl::Result<tmcl::Answer>& answer);
  void attach(tmcl::Link link);
  void detach();
  void on_bus_event(const tmcl::BusEvent& event);
  void report_failure(const tmcl::Error& error);

  boost::asio::any_io_executor executor_;
  BusConfig config_;
  OpenLink open_link_;
  LogSink log_;
  OnGatewayEvent on_event_;
  OnSearch on_search_;
  OnSetting on_setting_;
  tmcl::ContextClock clock_;
  Workers opener_{1};
  bool opening_link_ = false;
  Wake changed_;
  bool closed_ = false;
  bool retired_ = false;
  State state_ = State::opening;
  std::string error_;
  std::shared_ptr<tmcl::Bus> bus_;
  tmcl::BusCounters earlier_counters_;
  std::shared_ptr<TrafficLog> traffic_;
  std::map<tmcl::ModuleAddress, std::unique_ptr<GatewayModule>> modules_;
  Wake feeding_;
  std::shared_ptr<Journal> journal_;
  AuditSink audit_;
  std::shared_ptr<DeadmanMemory> deadmen_;
  Motors motors_;
  OwedStops owed_stops_;
  QueueShares shares_;
  std::vector<std::shared_ptr<AxisLimits>> limits_;
  std::uint64_t commands_ = 0;
  LogLimiter log_limiter_;
};

std::string_view name_of(GatewayBus::State state);

}  // namespace tmcld
