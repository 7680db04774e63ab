/// A named axis: the verbs that clients have, with the rules that hold for all of them.
///
/// Nothing moves before its module has said what it is, and nothing that was asked for before a
/// stop goes out after it: also not the second half of a verb of several exchanges.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <boost/asio/awaitable.hpp>

#include "async/shared_work.hpp"
#include "gateway/authority/axis_admission.hpp"
#include "gateway/axis/axis_units.hpp"
#include "gateway/axis/stop_cause.hpp"
#include "gateway/module/fault_report.hpp"

namespace tmcld {

class AxisPoller;
class AwaitedRun;

/// A move that a module has taken.
struct StartedMove {
  tmcl::Microsteps target;
  /// How long it will take; nothing where that was not asked for or cannot be foreseen.
  std::optional<tmcl::Duration> predicted;
  /// Warnings about its settings, and why the move cannot be foreseen.
  std::vector<std::string> warnings{};
};

/// Where a move has ended.
struct RestingPosition {
  tmcl::Microsteps position;
  std::vector<std::string> warnings{};  ///< Of its settings.
  Faults faults{};                      ///< Of its driver and its supply, when it had arrived.
  Faults unproven{};                    ///< What its driver says that may not be so.
  /// How far from there its encoder says that it is, in its unit, if that is too far by the
  /// configuration.
  std::optional<double> out_of_position{};
};

/// So old what is known of a driver may be when its axis is looked at.
constexpr tmcl::Duration driver_look_interval = std::chrono::milliseconds(500);

/// The farthest that a reference search may go one way; nothing: as far as it likes.
using SearchLimit = std::optional<tmcl::Microsteps>;

/// Ends a call early: gives an error once the caller has lost interest.
using Objection = std::function<std::optional<tmcl::Error>()>;

class GatewayAxis : public std::enable_shared_from_this<GatewayAxis> {
 public:
  template <class T>
  using Awaitable = boost::asio::awaitable<tmcl::Result<T>>;

  GatewayAxis(AxisConfig config, std::shared_ptr<GatewayBus> bus);

  const std::string& name() const { return axis_.name(); }
  tmcl::AxisAddress address() const { return axis_.address(); }
  /// Empty if the configuration gives it none.
  const std::string& unit() const { return axis_.config().scale.unit; }
  /// In its unit a second; without one in microsteps.
  const std::optional<double>& corner_jump() const {
    return axis_.config().motion_limits.corner_jump;
  }
  /// In its unit, in microsteps without one.
  const std::optional<tmcl::SoftLimits>& soft_limits() const { return axis_.config().scale.limits; }
  /// Nothing where what the encoder reads is in microsteps.
  const std::optional<double>& encoder_counts_per_unit() const {
    return axis_.config().scale.encoder_counts_per_unit;
  }
  /// When its moves are done, by its encoder; nothing: when its counter says so.
  const std::optional<InPosition>& in_position() const { return axis_.config().in_position; }
  /// How it comes to the targets of moves; nothing: straight, by move_to().
  const std::optional<ApproachConfig>& approach() const { return axis_.config().approach; }
  bool needs_reference() const { return axis_.config().needs_reference; }
  /// By the configuration, as an exponent of two; nothing: as the module has it.
  const std::optional<std::int32_t>& microstep_resolution() const {
    return axis_.config().scale.microstep_resolution;
  }
  GatewayBus& bus() const { return axis_.bus(); }
  GatewayModule& module() const { return axis_.module(); }
  /// The parameters of its model; empty while that is not known.
  std::span<const tmcl::ParameterInfo> parameters() const { return axis_.parameters(); }
  /// What no client exceeds; null if the configuration says nothing.
  const std::shared_ptr<AxisLimits>& motion_limits() const { return axis_.limits(); }

  /// The module has said what it is, and has such a motor.
  Awaitable<void> be_ready() { return axis_.be_ready(); }

  /// The right of a call to move the axis, until the axis is stopped.
  RunOptions begin_movement(Permit permit, Deadline deadline) const {
    return admission_.begin_movement(permit, deadline);
  }

  /// Of what is run by perform() or write().
  Awaitable<Admitted> admit(AxisAction action, RunOptions movement) {
    return admission_.admit(std::move(action), std::move(movement));
  }
  /// Whether the axis may go to this coordinate of its module.
  Awaitable<void> check_coordinate(std::uint8_t number, RunOptions options);

  /// Whether its soft limits let it go there.
  Awaitable<void> check_target(Length target, RunOptions options);
  /// Where a distance leads to from where the axis is: see move_by().
  Awaitable<Length> end_of(Length distance, RunOptions options);

  // Each of these is admitted first. An axis with soft limits is not sent beyond them: those that
  // might do so end with Errc::beyond_soft_limit, and nothing is sent. Nor is an axis moved that
  // another call moves on a line, on a path or in a search: Errc::axis_claimed.
  /// To predict a move, the axis is looked at before it.
  Awaitable<StartedMove> move_to(Length target, bool predict, RunOptions movement);
  /// From where the axis is. A distance in the axis' unit is added to what the last move in that
  /// unit was to reach, if the axis stands there: what that was rounded by does not add up.
  /// Errors: also Errc::bad_argument for a target outside what the model can hold.
  Awaitable<StartedMove> move_by(Length distance, bool predict, RunOptions movement);
  Awaitable<void> move_to_coordinate(std::uint8_t number, RunOptions movement);
  /// Not for an axis with soft limits, which it would pass sooner or later; zero is. The client of
  /// the call owns it: it stops when that goes, and no other one moves it before it stands; unless
  /// the permit says that it turns unattended.
  Awaitable<void> rotate(tmcl::InternalVelocity velocity, RunOptions movement);
  Awaitable<void> set(std::uint8_t parameter, std::int32_t value, RunOptions movement);
  /// To the EEPROM of its module, and back.
  Awaitable<void> store(std::uint8_t parameter, RunOptions options);
  Awaitable<void> restore(std::uint8_t parameter, RunOptions movement);
  /// What set() does once that is admitted.
  Awaitable<void> write(std::uint8_t parameter, std::int32_t value, Admitted admitted);
  Awaitable<RestingPosition> wait(tmcl::WaitOptions options, Objection objection);
  /// What its settings make of moves, wanted or not. Errors: those of reading them. `client`:
  /// who asks, and has its turn on the bus for it.
  Awaitable<std::vector<std::string>> warnings(std::uint64_t client = 0);
  /// The same of a twin that is set otherwise than the axis.
  std::vector<std::string> warnings_of(const tmcl::plan::AxisTwin& twin) const {
    return units_.warnings_of(twin);
  }
  Awaitable<std::int32_t> get(std::uint8_t parameter, Deadline deadline);
  /// At most so old, and not from before the last command on its bus: answered without the bus if
  /// it was just read. `client`: as for warnings().
  Awaitable<AxisReading> read_state(tmcl::Duration max_age = {}, std::uint64_t client = 0);
  /// A parameter with what it is in the unit of the axis. `client`: as for warnings().
  Awaitable<ParameterSample> sample(std::uint8_t parameter, std::uint64_t client = 0);

  // What AxisUnits knows.
  Awaitable<std::optional<tmcl::ModuleUnits>> module_units();
  Awaitable<std::optional<tmcl::UserScale>> scale();
  Awaitable<tmcl::UserScale> known_scale();
  Awaitable<std::optional<tmcl::plan::AxisTwin>> twin(RunOptions options,
                                                      tmcl::Proof proof = tmcl::Proof::none);
  std::vector<tmcl::plan::Setting> ramp_settings() const { return units_.ramp_settings(); }
  /// When a move that was started in another way should end.
  void expect_arrival(tmcl::TimePoint time) { expected_arrival_ = time; }
  /// What a move that was started in another way was to reach.
  void note_request(Length target) { requested_ = target.in_unit; }
  /// It goes to places before it goes to its target: that is what is told of it. Nothing: no more.
  void note_bound_for(std::optional<tmcl::Microsteps> target) { bound_for_ = target; }
  /// It turns without end, or may: until it is seen to stand.
  bool turns() const { return bus().motors().turning_of(address()).number != 0; }
  /// It turns, and stops for no client that goes.
  bool is_unattended() const { return turns() && holder().client == 0; }
  /// Grows whenever it is stopped, also where it stands.
  std::uint64_t last_stop() const { return bus().motors().last_stop_of(address()); }
  /// Who alone may move it.
  Holder holder() const { return bus().motors().holder_of(address()); }
  /// Who moves it now.
  ClaimKind claim_kind() const { return claim_owner().by; }
  /// Whether it is on a line or path, moved by a Mint program, or not certain to be
  /// stopped.
  bool is_on_journey() const {
    return claim_kind() != ClaimKind::none && claim_kind() != ClaimKind::search;
  }
  /// The one whose end a client waits for; null if there is none.
  std::shared_ptr<AwaitedRun> journey() const { return claim_owner().journey.lock(); }
  /// Returns when the journal, if there is one, says what is held now; otherwise why it does not.
  boost::asio::awaitable<std::string> enter_journal() const;
  /// What it was before its leader changed it, to be set back. False if that is noted.
  bool note_before(tmcl::plan::Setting setting);
  void forget_before() { before_.clear(); }
  void forget_before(std::uint8_t parameter) {
    std::erase_if(before_, [&](const auto& setting) { return setting.parameter == parameter; });
  }
  /// What is to be set back; nothing if that setting is not.
  std::optional<std::int32_t> before(std::uint8_t parameter) const;
  /// A client has set a setting that was to be set back: it stays so. `value`: nothing if that is
  /// not known. False if it was not to be set back.
  bool note_set_by_client(std::uint8_t parameter, std::optional<std::int32_t> value);
  /// Of what was changed, only this was not set back.
  void keep_before(std::vector<tmcl::plan::Setting> settings) { before_ = std::move(settings); }
  const std::vector<tmcl::plan::Setting>& before() const { return before_; }
  /// What is to be set back as soon as its module takes it, as it was.
  std::vector<tmcl::plan::Setting> unrestored() const {
    return claim_kind() == ClaimKind::stop ? before_ : std::vector<tmcl::plan::Setting>{};
  }
  /// No other call moves it while the claim lives. Only for an axis that is not claimed.
  [[nodiscard]] Claim claim(ClaimOwner claim_owner) {
    return bus().motors().claim(address(), std::move(claim_owner));
  }
  /// The error for a call that tries to move a claimed motor.
  tmcl::Error claimed() const { return bus().motors().refusal(address(), Obstacle::claimed); }
  /// A reference search may have ended unseen: the module is asked.
  /// Errors: Errc::axis_claimed if another call moves it.
  Awaitable<void> be_free(RunOptions movement) { return admission_.be_free(std::move(movement)); }

  /// How far a reference search may go one way, by the configuration; nothing: as far as it likes.
  /// Errors: those of knowing what a unit is.
  Awaitable<SearchLimit> search_limit();
  /// Ends with an error when a stop comes; the search ends with it.
  /// Errors: also Errc::move_interrupted if the module has ended the search in vain, or it went
  /// beyond its limit.
  Awaitable<tmcl::Homed> home(tmcl::HomeOptions options, SearchLimit limit, RunOptions movement);
  Awaitable<void> start_home(std::optional<std::int32_t> mode, SearchLimit limit,
                             RunOptions movement);
  /// The one that home() or start_home() was given for this call.
  std::optional<SearchLimit> search_limit_of(Permit permit) const;
  /// The search of this call is still under way, as far as is known.
  bool searches_for(Permit permit) const {
    return claim_owner() == ClaimOwner{ClaimKind::search, permit};
  }
  /// Its search has gone `gone`, which is further than it may: it is stopped.
  Awaitable<void> stop_search(Permit permit, tmcl::Microsteps limit);
  /// A raw command that names it, sent once, with what the module says to it. What moves the axis
  /// or sets it off is admitted like any other movement; a stop is not for this.
  /// A relative move is sent as an absolute one, and answered as the firmware of its model would.
  Awaitable<tmcl::Answer> execute(tmcl::Request request, RunOptions movement);
  /// Any other verb. One that can move the motor needs what admit() gives.
  template <class T>
  Awaitable<T> perform(tmcl::Script<tmcl::Result<T>> script, RunOptions options) {
    auto ready = co_await be_ready();
    if (!ready) co_return tl::unexpected(std::move(ready.error()));
    auto result = co_await axis_.run(std::move(script), std::move(options));
    co_return result;
  }

  /// Goes out before everything else, whatever is known about the module. Ends a reference search
  /// that was begun here, too. `client`: who asks.
  Awaitable<void> stop(StopCause cause = StopCause::client, std::uint64_t client = 0);
  /// The last call that jogged it, and until when a further one goes on with that.
  struct LastJog {
    std::uint64_t client = 0;
    std::uint64_t number = 0;  ///< Of its permit.
    tmcl::TimePoint until{};
  };
  LastJog& last_jog() { return last_jog_; }
  /// The same by the call that moves the axis: calls that began before keep their right to move it.
  Awaitable<void> stop_without_revoking();
  /// Its module has started again, or is another one, and a person has cleared the axis.
  /// Errors: those of be_ready().
  Awaitable<void> recover();
  /// Why nothing moves it; nothing if it may be moved.
  std::optional<tmcl::Error> latched() const { return bus().motors().latched(address()); }
  /// Why it stands short of where it was to go; nothing while it moves, when it has arrived, and
  /// when it was not read.
  std::optional<StopCause> stop_cause() const;
  /// What is wrong with its driver or its supply, as was seen last.
  const Faults& faults() const { return faults_; }
  /// What its driver says that means something only while it turns slowly, and was not seen then.
  const Faults& unproven_faults() const { return open_loads_.unproven(); }
  /// Of its supply, when its driver was looked at last; nothing where its module does not tell.
  const std::optional<double>& supply_volts() const { return supply_volts_; }
  /// Looks at them, unless that was done so lately. Errors: those of the exchanges.
  Awaitable<void> look_at_driver(tmcl::Duration max_age, RunOptions options,
                                 std::optional<tmcl::InternalVelocity> velocity = {});
  /// What its module says is wrong. What that clears is known as the cause of the stop.
  /// `client`: as for warnings().
  Awaitable<FaultReport> read_faults(std::uint64_t client = 0);
  /// Its module knows where zero is, as far as was seen since the daemon started.
  bool is_referenced() const { return bus().motors().is_referenced(address()); }
  /// Ends a reference search of any client.
  Awaitable<void> stop_home();
  /// Calls that began before this have no right to move the axis any more.
  void revoke_movements();

  /// The one who reads this axis for all who watch it.
  const std::shared_ptr<AxisPoller>& poller();

 private:
  /// Where distances lead to.
  struct Ways;
  Awaitable<Ways> ways_by(Length distance);
  /// While it comes to its target from one side: until that is over.
  Awaitable<void> await_approach(Deadline deadline, Objection objection);
  Awaitable<StartedMove> start(tmcl::Script<tmcl::Result<tmcl::Microsteps>> script, bool predict,
                               Admitted admitted);
  /// A movement that nothing is foreseen of.
  template <class T>
  Awaitable<T> move(AxisAction action, tmcl::Script<tmcl::Result<T>> script, RunOptions movement) {
    auto admitted = co_await admit(std::move(action), std::move(movement));
    if (!admitted) co_return tl::unexpected(std::move(admitted.error()));
    forget_move();
    auto result = co_await axis_.run(std::move(script), std::move(*admitted));
    co_return result;
  }
  /// A command to its motor.
  tmcl::Request request(tmcl::Command command, std::uint8_t type, std::int32_t value) const;
  Awaitable<tmcl::Answer> execute_admitted(tmcl::Request request, Admitted admitted);
  /// What the firmware of its model counts relative moves from now.
  Awaitable<std::uint8_t> origin_of_relative_moves();
  Awaitable<AxisReading> look(std::uint64_t client);
  /// Nothing if that failed, and the client has gone: others may wait for it.
  boost::asio::awaitable<std::optional<tmcl::Result<AxisReading>>> look_for(std::uint64_t client);
  const Arrivals& arrivals() const { return *bus().motors().arrivals(); }
  /// Until it stands at its target; for longer where its settings may let it swing about that.
  Awaitable<RestingPosition> stand(tmcl::WaitOptions wait, RunOptions options);
  /// Until its encoder has been near enough for long enough, where the configuration wants that.
  Awaitable<void> await_settling(RestingPosition& arrived, RunOptions options);
  bool is_known(tmcl::Duration max_age) const;
  ClaimOwner claim_owner() const { return bus().motors().claim_owner_of(address()); }
  /// Finds out why an axis stands that was on its way. `client`: as for warnings(), here and below.
  boost::asio::awaitable<void> note_motion(tmcl::AxisState state, std::uint64_t client);
  /// Finds out whether it still turns for a client, and whether it turns for none.
  boost::asio::awaitable<void> note_turning(tmcl::AxisState state, std::uint64_t client);
  boost::asio::awaitable<void> find_cause(std::uint64_t client);
  /// Of an error that says that it stands somewhere else than it should.
  boost::asio::awaitable<void> add_cause(tmcl::Error& error, std::uint64_t client = 0);
  void note_stop(StopCause cause);
  tmcl::Script<tmcl::Result<DriverReading>> read_driver(
      std::optional<tmcl::InternalVelocity> velocity = {});
  void note_driver(DriverReading reading);
  bool is_driver_known(tmcl::Duration max_age) const;
  static tmcl::Script<tmcl::Result<tmcl::Microsteps>> look_at_driver_meanwhile(
      std::shared_ptr<GatewayAxis> self, tmcl::Script<tmcl::Result<tmcl::Microsteps>> wait);
  /// The axis goes, or may go, somewhere else than it was sent before.
  void forget_move();

  std::optional<tmcl::Microsteps> bound_for_;
  /// Where it has arrived by its counter, and when that was seen first.
  struct Arrived {
    tmcl::Microsteps position;
    tmcl::TimePoint at{};
  };
  std::optional<Arrived> arrived_;
  AxisContext axis_;
  AxisUnits units_{axis_};
  AxisAdmission admission_{axis_, units_};
  /// When the move under way should end; in the past if that is not known.
  tmcl::TimePoint expected_arrival_{};
  /// Where the last move was to end, in the unit, before that was rounded.
  std::optional<tmcl::UserPosition> requested_;
  std::shared_ptr<AxisPoller> poller_;

  struct LastReading {
    AxisReading reading;
    std::uint64_t commands = 0;  ///< Of the bus, when the look began.
    std::uint64_t settings = 0;  ///< The same of its module.
  };
  std::optional<LastReading> last_;
  std::vector<tmcl::plan::Setting> before_;  ///< In the order in which they were changed.
  struct Search {
    Permit of{};
    SearchLimit limit{};
    bool went_too_far = false;
  };
  Search search_;
  LastJog last_jog_;
  bool was_moving_ = false;  ///< When it was looked at last.
  tmcl::TimePoint seen_moving_{};
  Faults faults_;
  OpenLoads open_loads_;
  std::optional<tmcl::TimePoint> driver_seen_;
  std::optional<double> supply_volts_;
  std::optional<StopCause> stop_cause_;
  SharedWork<std::optional<tmcl::Result<AxisReading>>> looks_;
};

}  // namespace tmcld
