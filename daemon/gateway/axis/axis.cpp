#include "gateway/axis/axis.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "gateway/axis/poller.hpp"
#include "gateway/axis/stop_advice.hpp"
#include "gateway/journey/awaited_run.hpp"
#include "tmcl/command_type.hpp"
#include "tmcl/program_verbs.hpp"
#include "tmcl/relative_move.hpp"

namespace tmcld {
namespace {

using tmcl::Microsteps;

constexpr std::string_view beyond_range_hint = "move less far, or set another actual position";

/// For so long an axis must stand at its target whose settings may let it swing about it.
constexpr tmcl::Duration steady_in_doubt = std::chrono::milliseconds(250);

/// None left would be no limit.
constexpr tmcl::Duration shortest_wait = std::chrono::milliseconds(1);

tmcl::Result<Microsteps> sum(Microsteps here, Microsteps distance, tmcl::ValueRange range) {
  const auto target = std::int64_t{here.value} + distance.value;
  if (target >= range.least && target <= range.greatest)
    return Microsteps{static_cast<std::int32_t>(target)};
  return tl::unexpected(tmcl::bad_argument(
      std::to_string(distance.value) + " microsteps from " + std::to_string(here.value) +
          " ends outside " + std::to_string(range.least) + ".." + std::to_string(range.greatest),
      std::string(beyond_range_hint)));
}

/// To the digits that a number can have: ten tenths are one then, and not a little less, which
/// could be on the other side of the middle between two microsteps.
tmcl::UserPosition sum(tmcl::UserPosition from, tmcl::UserPosition distance) {
  constexpr int digits = std::numeric_limits<double>::digits10;
  const double greater = std::max(std::abs(from.value), std::abs(distance.value));
  if (greater == 0) return {};
  const int before_point = static_cast<int>(std::floor(std::log10(greater))) + 1;
  const auto text =
      fmt::format("{:.{}f}", from.value + distance.value, std::max(digits - before_point, 0));
  tmcl::UserPosition rounded;
  std::from_chars(text.data(), text.data() + text.size(), rounded.value);
  return rounded;
}

/// Where an axis is in its unit: exactly where it was requested to be, if it stands there.
tmcl::UserPosition place_of(Microsteps here, const std::optional<tmcl::UserPosition>& requested,
                            const tmcl::UserScale& scale) {
  const bool stands_there = requested && tmcl::to_microsteps(*requested, scale) == here;
  return stands_there ? *requested : tmcl::to_user(here, scale);
}

tmcl::Error may_change_coordinates(const std::string& axis) {
  return tmcl::not_sent(tmcl::Errc::not_permitted,
                        "axis '" + axis +
                            "' has soft limits, and a program runs in its module, which " +
                            "may change the coordinate after it was checked",
                        "stop the program first, or move the axis alone");
}

}  // namespace

GatewayAxis::GatewayAxis(AxisConfig config, std::shared_ptr<GatewayBus> bus)
    : axis_(std::move(config), std::move(bus)) {}

GatewayAxis::Awaitable<void> GatewayAxis::check_coordinate(std::uint8_t number,
                                                           RunOptions options) {
  auto ready = co_await be_ready();
  if (!ready) co_return ready;
  auto script = admission_.check(action::MoveToCoordinate{number});
  auto checked = co_await axis_.run(std::move(script), options);
  if (!checked || !soft_limits()) co_return checked;
  const auto status = co_await axis_.run(tmcl::verbs::program_status(address().module), options);
  const bool runs = status && status->state != tmcl::ProgramStatus::State::stopped &&
                    status->state != tmcl::ProgramStatus::State::reset;
  if (runs) co_return tl::unexpected(axis_.on_bus(may_change_coordinates(name())));
  co_return checked;
}

GatewayAxis::Awaitable<void> GatewayAxis::check_target(Length target, RunOptions options) {
  auto ready = co_await be_ready();
  if (!ready) co_return ready;
  auto checked = co_await axis_.run(admission_.check(action::MoveTo{target}), std::move(options));
  co_return checked;
}

GatewayAxis::Awaitable<StartedMove> GatewayAxis::move_to(Length target, bool predict,
                                                         RunOptions movement) {
  auto admitted = co_await admit(action::MoveTo{target}, std::move(movement));
  if (!admitted) co_return tl::unexpected(std::move(admitted.error()));
  auto script = tmcl::verbs::move_to(address(), target.microsteps);
  auto result = co_await start(std::move(script), predict, std::move(*admitted));
  if (result) requested_ = target.in_unit;
  co_return result;
}

struct GatewayAxis::Ways {
  tmcl::ValueRange range{};
  std::optional<tmcl::UserScale> scale{};         ///< For a distance in the unit.
  std::optional<tmcl::UserPosition> requested{};  ///< Where it was sent before.

  tmcl::Result<Length> end_of(Length distance, Microsteps here) const {
    if (!distance.in_unit)
      return sum(here, distance.microsteps, range).map([](auto there) { return Length{there}; });
    const auto end = sum(place_of(here, requested, *scale), *distance.in_unit);
    return tmcl::to_microsteps(end, *scale, range)
        .map([&](auto there) {
          return Length{there, end};
        })
        .map_error([](const auto& error) {
          return tmcl::bad_argument(describe(error), std::string(beyond_range_hint));
        });
  }
};

GatewayAxis::Awaitable<GatewayAxis::Ways> GatewayAxis::ways_by(Length distance) {
  Ways ways;
  const auto* row = find_parameter(parameters(), tmcl::axis_parameter::target_position);
  if (row != nullptr) ways.range = {row->minimum, row->maximum};
  ways.requested = requested_;
  if (!distance.in_unit) co_return ways;
  auto scale = co_await known_scale();
  if (!scale) co_return tl::unexpected(std::move(scale.error()));
  ways.scale = std::move(*scale);
  co_return ways;
}

GatewayAxis::Awaitable<Length> GatewayAxis::end_of(Length distance, RunOptions options) {
  auto ready = co_await be_ready();
  if (!ready) co_return tl::unexpected(std::move(ready.error()));
  const auto ways = co_await ways_by(distance);
  if (!ways) co_return tl::unexpected(ways.error());
  auto script = tmcl::verbs::proven_position(address());
  const auto here = co_await axis_.run(std::move(script), std::move(options));
  if (!here) co_return tl::unexpected(here.error());
  co_return ways->end_of(distance, *here);
}

GatewayAxis::Awaitable<StartedMove> GatewayAxis::move_by(Length distance, bool predict,
                                                         RunOptions movement) {
  auto admitted = co_await admit(action::MoveFromHere{}, std::move(movement));
  if (!admitted) co_return tl::unexpected(std::move(admitted.error()));
  const auto ways = co_await ways_by(distance);
  if (!ways) co_return tl::unexpected(ways.error());
  // The script may outlive this call.
  const auto request = std::make_shared<std::optional<tmcl::UserPosition>>();
  const auto destination = [=, ways = *ways,
                            aim = *admitted](Microsteps here) -> tmcl::Result<Microsteps> {
    const auto end = ways.end_of(distance, here);
    if (!end) return tl::unexpected(end.error());
    *request = end->in_unit;
    aim.aim_at(*end);
    return end->microsteps;
  };
  auto script = tmcl::verbs::move_from_here(address(), destination);
  auto result = co_await start(std::move(script), predict, std::move(*admitted));
  if (result) requested_ = *request;
  co_return result;
}

GatewayAxis::Awaitable<void> GatewayAxis::move_to_coordinate(std::uint8_t number,
                                                             RunOptions movement) {
  if (soft_limits()) {
    auto command = request(tmcl::Command::MVP, tmcl::move_type::coordinate, number);
    const auto answer = co_await execute(command, std::move(movement));
    if (!answer) co_return tl::unexpected(answer.error());
    co_return tmcl::Result<void>{};
  }
  auto script = tmcl::verbs::move_to_coordinate(address(), number);
  auto moved =
      co_await move(action::MoveToCoordinate{number}, std::move(script), std::move(movement));
  co_return moved;
}

GatewayAxis::Awaitable<StartedMove> GatewayAxis::start(
    tmcl::Script<tmcl::Result<Microsteps>> script, bool predict, Admitted admitted) {
  StartedMove started;
  std::optional<tmcl::plan::AxisTwin> twin;
  if (predict) {
    // Whatever comes of the readings: they only serve to tell more about the move.
    auto foreseen = co_await this->twin(admitted);
    if (!foreseen) started.warnings.push_back("no prediction: " + foreseen.error().message);
    if (foreseen) twin = std::move(*foreseen);
    if (foreseen && !twin)
      started.warnings.emplace_back("no prediction: the ramps of this module are not described");
  }
  forget_move();
  const auto begin = bus().clock().now();
  const auto target = co_await axis_.run(std::move(script), std::move(admitted));
  if (!target) co_return tl::unexpected(target.error());
  started.target = *target;
  if (twin) {
    twin->move_to(*target);
    for (auto& warning : warnings_of(*twin)) started.warnings.push_back(std::move(warning));
    started.predicted = twin->time_to_arrival();
    if (!started.predicted)
      started.warnings.emplace_back("with these settings it does not come to rest on its target");
  }
  if (started.predicted) expected_arrival_ = begin + *started.predicted;
  co_return started;
}

GatewayAxis::Awaitable<void> GatewayAxis::rotate(tmcl::InternalVelocity velocity,
                                                 RunOptions movement) {
  auto admitted = co_await admit(action::Turn{velocity}, std::move(movement));
  if (!admitted) co_return tl::unexpected(std::move(admitted.error()));
  forget_move();
  admitted->announced = request(tmcl::Command::ROR, 0, velocity.value);
  auto result = co_await axis_.run(tmcl::verbs::rotate(address(), velocity), std::move(*admitted));
  co_return result;
}

tmcl::Request GatewayAxis::request(tmcl::Command command, std::uint8_t type,
                                   std::int32_t value) const {
  return {address().module, command, type, address().motor, value};
}

GatewayAxis::Awaitable<void> GatewayAxis::stop(StopCause cause, std::uint64_t client) {
  revoke_movements();
  // Who stops what it jogs may jog again at once.
  if (client == last_jog_.client) last_jog_ = {};
  note_stop(cause);
  expected_arrival_ = {};
  const bool was_searching = claim_kind() == ClaimKind::search;
  auto result = co_await axis_.run(tmcl::verbs::stop(address()), asked_by(client));
  // A firmware that searches on may start the motor again. What cannot be sent now is sent later.
  if (!was_searching) co_return result;
  auto ended = co_await stop_home();
  co_return std::move(result ? ended : result);
}

GatewayAxis::Awaitable<void> GatewayAxis::stop_without_revoking() {
  note_stop(StopCause::daemon);
  return axis_.run(tmcl::verbs::stop(address()));
}

void GatewayAxis::revoke_movements() {
  bus().motors().stop(address());
  if (const auto on = journey()) on->look();
}

GatewayAxis::Awaitable<void> GatewayAxis::recover() {
  // What is noticed while this waits, its caller does not know of.
  const auto latches = bus().motors().latches(address());
  auto ready = co_await be_ready();
  if (!ready) co_return ready;
  bus().motors().recover(address(), latches);
  if (auto latch = latched()) co_return tl::unexpected(std::move(*latch));
  co_return ready;
}

GatewayAxis::Awaitable<RestingPosition> GatewayAxis::wait(tmcl::WaitOptions wait_options,
                                                          Objection objection) {
  auto ready = co_await be_ready();
  if (!ready) co_return tl::unexpected(std::move(ready.error()));
  RunOptions options;
  options.objection = [this, of_caller = std::move(objection)] {
    auto latch = latched();
    return latch || !of_caller ? latch : of_caller();
  };
  Deadline deadline;
  if (wait_options.timeout != tmcl::Duration{})
    deadline = bus().clock().now() + wait_options.timeout;
  auto there = co_await await_approach(deadline, options.objection);
  if (!there) co_return tl::unexpected(std::move(there.error()));
  if (deadline) wait_options.timeout = std::max(*deadline - bus().clock().now(), shortest_wait);
  const auto left = expected_arrival_ - bus().clock().now();
  wait_options.expected = std::max(left, tmcl::Duration{});
  wait_options.mode = tmcl::mode_parameter(parameters());
  auto result = co_await stand(wait_options, std::move(options));
  // A module that has started again is at its target, which is where it is.
  auto watched = co_await axis_.run(module().watch(movement_sentinel_age));
  if (auto latch = latched()) co_return tl::unexpected(std::move(*latch));
  if (result && !watched) co_return tl::unexpected(std::move(watched.error()));
  if (!result && result.error().code == tmcl::Errc::move_interrupted)
    co_await add_cause(result.error());
  co_return result;
}

GatewayAxis::Awaitable<void> GatewayAxis::await_approach(Deadline deadline, Objection objection) {
  constexpr tmcl::Duration between_looks = std::chrono::seconds(1);
  while (claim_kind() == ClaimKind::approach) {
    arrived_.reset();
    const auto run = journey();
    if (!run || run->has_ended()) break;
    if (auto objects = objection()) co_return tl::unexpected(std::move(*objects));
    const auto now = bus().clock().now();
    if (deadline && now >= *deadline) {
      auto late = tmcl::not_sent(tmcl::Errc::deadline_passed,
                                 "axis '" + name() + "' has not arrived in time");
      co_return tl::unexpected(axis_.on_bus(std::move(late)));
    }
    co_await AwaitedRun::until_told(
        run, std::min(now + between_looks, deadline.value_or(tmcl::TimePoint::max())));
  }
  co_return tmcl::Result<void>{};
}

GatewayAxis::Awaitable<RestingPosition> GatewayAxis::stand(tmcl::WaitOptions wait,
                                                           RunOptions options) {
  Deadline deadline;
  if (wait.timeout != tmcl::Duration{}) deadline = bus().clock().now() + wait.timeout;
  const auto wait_there = [&] {
    return look_at_driver_meanwhile(shared_from_this(),
                                    tmcl::verbs::wait_until_reached(address(), wait));
  };
  auto here = co_await axis_.run(wait_there(), options);
  // There is no time to read anything after a timeout.
  const auto from = here ? RampKnowledge::read : RampKnowledge::as_it_is;
  const auto known = co_await axis_.run(units_.warnings(from), deadline);
  auto warnings = known.value_or(std::vector<std::string>());
  if (here && !warnings.empty()) {
    // It may stand there in passing only.
    if (deadline) wait.timeout = std::max(*deadline - bus().clock().now(), shortest_wait);
    wait.steady = steady_in_doubt;
    here = co_await axis_.run(wait_there(), options);
  }
  if (here) {
    RunOptions in_time;
    in_time.deadline = deadline;
    auto seen = co_await look_at_driver({}, std::move(in_time));
    if (!seen) co_return tl::unexpected(std::move(seen.error()));
    RestingPosition arrived{*here, std::move(warnings), faults_, unproven_faults()};
    options.deadline = deadline;
    auto settled = co_await await_settling(arrived, std::move(options));
    if (!settled) co_return tl::unexpected(std::move(settled.error()));
    co_return arrived;
  }
  if (!warnings.empty()) here.error().hint = std::string(hint_of_settings) + warnings.front();
  co_return tl::unexpected(std::move(here.error()));
}

GatewayAxis::Awaitable<void> GatewayAxis::await_settling(RestingPosition& arrived,
                                                         RunOptions options) {
  const auto& wanted = axis_.config().in_position;
  if (!wanted) co_return tmcl::Result<void>{};
  const auto window = co_await axis_.run(units_.encoder_window(arrived.position, wanted->window));
  if (!window) co_return tl::unexpected(window.error());
  if (!*window) {
    arrived.warnings.emplace_back(
        "its module has no encoder, and 'in_position' of the configuration needs one");
    co_return tmcl::Result<void>{};
  }
  // Clients wait in parts: what passes between two calls counts.
  if (!arrived_ || arrived_->position != arrived.position)
    arrived_ = {arrived.position, bus().clock().now()};
  const auto give_up = arrived_->at + std::max(time_to_settle, wanted->settle);
  auto settling = settle(address(), **window, wanted->settle, give_up);
  const auto off = co_await axis_.run(std::move(settling), std::move(options));
  if (!off) co_return tl::unexpected(off.error());
  arrived_.reset();
  if (*off) arrived.out_of_position = std::abs(**off / (*window)->counts_per_unit);
  co_return tmcl::Result<void>{};
}

GatewayAxis::Awaitable<std::int32_t> GatewayAxis::get(std::uint8_t parameter, Deadline deadline) {
  RunOptions options;
  options.deadline = deadline;
  return perform(tmcl::verbs::get(address(), parameter), std::move(options));
}

GatewayAxis::Awaitable<void> GatewayAxis::set(std::uint8_t parameter, std::int32_t value,
                                              RunOptions movement) {
  auto admitted = co_await admit(action::Write{parameter, value}, std::move(movement));
  if (!admitted) co_return tl::unexpected(std::move(admitted.error()));
  auto result = co_await write(parameter, value, std::move(*admitted));
  co_return result;
}

GatewayAxis::Awaitable<void> GatewayAxis::write(std::uint8_t parameter, std::int32_t value,
                                                Admitted admitted) {
  auto ready = co_await be_ready();
  if (!ready) co_return ready;
  // What is read or checked while it is on its way may be from before it.
  units_.note_set(parameter);
  auto script = tmcl::verbs::set(address(), parameter, value);
  admitted.announced = request(tmcl::Command::SAP, parameter, value);
  auto result = co_await axis_.run(std::move(script), std::move(admitted));
  // Also after a failure: the value may have been set all the same.
  units_.note_set(parameter, result ? std::optional(value) : std::nullopt);
  if (parameter != tmcl::axis_parameter::actual_position) co_return result;
  requested_.reset();
  if (result) bus().motors().set_referenced(address());
  co_return result;
}

GatewayAxis::Awaitable<void> GatewayAxis::restore(std::uint8_t parameter, RunOptions movement) {
  module().note_settings_changed();
  auto admitted = co_await admit(action::Restore{parameter}, std::move(movement));
  if (!admitted) co_return tl::unexpected(std::move(admitted.error()));
  forget_move();
  admitted->announced = request(tmcl::Command::RSAP, parameter, 0);
  auto script = tmcl::verbs::restore(address(), parameter);
  auto result = co_await axis_.run(std::move(script), std::move(*admitted));
  module().note_settings_changed();
  co_return result;
}

GatewayAxis::Awaitable<void> GatewayAxis::store(std::uint8_t parameter, RunOptions options) {
  return perform(tmcl::verbs::store(address(), parameter), std::move(options));
}

GatewayAxis::Awaitable<std::vector<std::string>> GatewayAxis::warnings(std::uint64_t client) {
  return axis_.run(units_.warnings(), asked_by(client));
}

GatewayAxis::Awaitable<std::optional<tmcl::ModuleUnits>> GatewayAxis::module_units() {
  return axis_.run(units_.module_units());
}

GatewayAxis::Awaitable<std::optional<tmcl::UserScale>> GatewayAxis::scale() {
  return axis_.run(units_.scale());
}

GatewayAxis::Awaitable<tmcl::UserScale> GatewayAxis::known_scale() {
  return axis_.run(units_.known_scale());
}

GatewayAxis::Awaitable<std::optional<tmcl::plan::AxisTwin>> GatewayAxis::twin(RunOptions options,
                                                                              tmcl::Proof proof) {
  return axis_.run(units_.twin(proof), std::move(options));
}

bool GatewayAxis::is_known(tmcl::Duration max_age) const {
  return last_ && last_->commands == bus().gate().commands() &&
         last_->settings == module().settings_epoch() &&
         bus().clock().now() - last_->reading.taken < max_age;
}

GatewayAxis::Awaitable<AxisReading> GatewayAxis::read_state(tmcl::Duration max_age,
                                                            std::uint64_t client) {
  auto ready = co_await be_ready();
  if (!ready) co_return tl::unexpected(std::move(ready.error()));
  const auto look_here = [this, client] { return look_for(client); };
  // One in progress may have begun before this was asked for.
  const bool may_join = max_age > tmcl::Duration{} && looks_.in_progress() && !is_known(max_age);
  if (may_join) co_await looks_.join(look_here);
  if (is_known(max_age)) co_return last_->reading;
  while (true) {
    auto reading = co_await looks_.begin(look_here);
    if (reading) co_return std::move(*reading);
    // It was for another client, which has gone.
    if (!arrivals().waits(client)) co_return tl::unexpected(axis_.on_bus(client_gone()));
  }
}

GatewayAxis::Awaitable<ParameterSample> GatewayAxis::sample(std::uint8_t parameter,
                                                            std::uint64_t client) {
  return perform(units_.sample(parameter), asked_by(client));
}

boost::asio::awaitable<std::optional<tmcl::Result<AxisReading>>> GatewayAxis::look_for(
    std::uint64_t client) {
  auto reading = co_await look(client);
  if (!reading && !arrivals().waits(client)) co_return std::nullopt;
  co_return std::optional(std::move(reading));
}

GatewayAxis::Awaitable<AxisReading> GatewayAxis::look(std::uint64_t client) {
  const auto commands = bus().gate().commands();
  const auto settings = module().settings_epoch();
  auto reading = co_await axis_.run(units_.reading(bound_for_), only_asked_by(client));
  // Behind it: what was read is of the module that this one was, or the axis is latched.
  const auto watched = co_await axis_.run(module().watch(movement_sentinel_age), asked_by(client));
  if (!watched) co_return tl::unexpected(watched.error());
  if (!reading) co_return reading;
  // A look is worth more than what goes wrong with the questions about its driver.
  if (!bus().has_paths())
    (void)co_await look_at_driver(driver_look_interval, only_asked_by(client),
                                  reading->state.velocity);
  last_ = {*reading, commands, settings};
  co_await note_turning(reading->state, client);
  co_await note_motion(reading->state, client);
  co_return reading;
}

// ---- what is to be put in order ----------------------------------------------------------------

boost::asio::awaitable<std::string> GatewayAxis::enter_journal() const {
  const auto journal = bus().journal();
  if (!journal) co_return "";
  co_await Journal::write(journal);
  co_return journal->failure();
}

bool GatewayAxis::note_before(tmcl::plan::Setting setting) {
  const auto is_noted = [&](const auto& noted) { return noted.parameter == setting.parameter; };
  if (std::ranges::any_of(before_, is_noted)) return false;
  before_.push_back(setting);
  return true;
}

std::optional<std::int32_t> GatewayAxis::before(std::uint8_t parameter) const {
  const auto found = std::ranges::find(before_, parameter, &tmcl::plan::Setting::parameter);
  return found == before_.end() ? std::nullopt : std::optional(found->value);
}

bool GatewayAxis::note_set_by_client(std::uint8_t parameter, std::optional<std::int32_t> value) {
  if (!before(parameter)) return false;
  // Who still leads the axis may change it once more.
  const bool is_led = claim_kind() != ClaimKind::stop;
  if (!is_led || !value) forget_before(parameter);
  for (auto& setting : before_)
    if (setting.parameter == parameter) setting.value = *value;
  return true;
}

// ---- for whom it turns ------------------------------------------------------------------------

boost::asio::awaitable<void> GatewayAxis::note_turning(tmcl::AxisState state,
                                                       std::uint64_t client) {
  auto& motors = bus().motors();
  const bool moves = state.velocity.value != 0;
  // Whether that can be seen or not: it is looked at again.
  if (turns() && !moves)
    co_await axis_.run(bus().gate().see_turning_end(address()), asked_by(client));
  const bool goes_to_position =
      motors.was_sent_to_position(address()) && !motors.may_run_program(address().module);
  const bool is_known =
      turns() || holder().client != 0 || claim_kind() != ClaimKind::none || goes_to_position;
  if (!moves || is_known) co_return;
  const auto found = co_await axis_.run(bus().gate().may_turn(address()), asked_by(client));
  if (!found || !*found || turns()) co_return;
  motors.note_unattended(address());
  bus().audit("axis=" + name() + " turns unattended: no client owns its motion");
  co_await enter_journal();
}

void GatewayAxis::forget_move() {
  stop_cause_.reset();
  expected_arrival_ = {};
  arrived_.reset();
  requested_.reset();
}

const std::shared_ptr<AxisPoller>& GatewayAxis::poller() {
  if (!poller_) poller_ = std::make_shared<AxisPoller>(bus().executor());
  return poller_;
}

}  // namespace tmcld
