#include "gateway/axis.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "gateway/path_run.hpp"
#include "gateway/poller.hpp"
#include "tmcl/prediction.hpp"
#include "tmcl/relative_move.hpp"
#include "tmcl/units.hpp"

namespace tmcld {
namespace {

using tmcl::Microsteps;
using tmcl::Result;

constexpr std::string_view beyond_range_hint = "move less far, or set another actual position";

Result<Microsteps> sum(Microsteps here, Microsteps distance, tmcl::ValueRange range) {
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

/// Where an axis is in its unit: exactly where it was wished to be, if it stands there.
tmcl::UserPosition place_of(Microsteps here, const std::optional<tmcl::UserPosition>& wished,
                            const tmcl::UserScale& scale) {
  const bool stands_there = wished && tmcl::to_microsteps(*wished, scale) == here;
  return stands_there ? *wished : tmcl::to_user(here, scale);
}

tmcl::Error beyond_soft_limit(const AxisConfig& axis, const std::string& what, std::string hint) {
  tmcl::Error error;
  error.code = tmcl::Errc::beyond_soft_limit;
  error.outcome = tmcl::Outcome::not_sent;
  error.message = "axis '" + axis.name + "': " + what;
  error.hint = std::move(hint);
  error.bus = axis.bus;
  return error;
}

std::optional<tmcl::Error> objection_to(const Length& target, const AxisConfig& axis,
                                        const tmcl::UserScale& scale) {
  auto beyond = tmcl::beyond(*axis.scale.limits, target.microsteps, scale);
  if (!beyond) return std::nullopt;
  if (target.in_unit) beyond->position = target.in_unit->value;
  return beyond_soft_limit(axis, describe(*beyond), "the configuration has it: 'soft_limits'");
}

/// Not a failure of this one exchange: the module does not have what it was asked for.
bool has_no_such_value(const tmcl::Error& error) {
  return error.code == tmcl::Errc::refused_by_module &&
         error.status != tmcl::Status::wrong_checksum &&
         error.status != tmcl::Status::command_loaded;
}

/// Nothing where the module does not have it.
template <class T>
Result<std::optional<T>> if_it_tells(Result<T> told) {
  if (told) return std::optional(std::move(*told));
  if (has_no_such_value(told.error())) return std::optional<T>();
  return tl::unexpected(std::move(told.error()));
}

}  // namespace

GatewayAxis::GatewayAxis(AxisConfig config, std::shared_ptr<GatewayBus> bus)
    : config_(std::move(config)),
      bus_(std::move(bus)),
      module_(bus_->add_module(config_.address.module)) {
  bus_->motors().add(config_.address, config_.name);
}

std::span<const tmcl::ParameterInfo> GatewayAxis::parameters() const {
  const auto* model = module_.model();
  return model == nullptr ? std::span<const tmcl::ParameterInfo>{} : tmcl::axis_parameters(*model);
}

template <class T>
GatewayAxis::Awaitable<T> GatewayAxis::run(tmcl::Script<Result<T>> script, RunOptions options) {
  auto result = co_await bus_->run(std::move(script), std::move(options));
  note(result);
  co_return result;
}

RunOptions GatewayAxis::begin_movement(Permit permit, Deadline deadline) const {
  RunOptions options;
  options.deadline = deadline;
  options.permit = permit;
  options.objection = [this, permit] { return bus_->motors().objection(address(), permit); };
  return options;
}

GatewayAxis::Awaitable<void> GatewayAxis::be_ready() {
  auto ready = co_await module_.be_ready();
  if (!ready) co_return ready;
  const auto* model = module_.model();
  const auto motor = config_.address.motor;
  if (model == nullptr || motor < model->axes) co_return ready;
  auto error = tmcl::bad_argument(
      "axis '" + name() + "' is configured as motor " + std::to_string(motor) + ", but a " +
          std::string(model->name) + " has " + std::to_string(model->axes),
      "motors count from 0; correct the configuration");
  error.bus = config_.bus;
  co_return tl::unexpected(std::move(error));
}

GatewayAxis::Awaitable<tmcl::UserScale> GatewayAxis::known_scale() {
  if (config_.scale.unit.empty()) co_return tmcl::microsteps_scale();
  auto scale = co_await this->scale();
  if (!scale) co_return tl::unexpected(std::move(scale.error()));
  if (*scale) co_return std::move(**scale);
  auto error = tmcl::bad_argument(
      "the module of axis '" + name() + "' does not tell its microstep resolution",
      "the configuration can: 'microsteps'");
  error.bus = config_.bus;
  co_return tl::unexpected(std::move(error));
}

GatewayAxis::Awaitable<void> GatewayAxis::check_limits(Length target) {
  if (!config_.scale.limits) co_return Result<void>{};
  const auto scale = co_await known_scale();
  if (!scale) co_return tl::unexpected(scale.error());
  auto objection = objection_to(target, config_, *scale);
  if (objection) co_return tl::unexpected(std::move(*objection));
  co_return Result<void>{};
}

Result<void> GatewayAxis::check_endless(std::int32_t velocity) const {
  if (!config_.scale.limits || velocity == 0) return {};
  return tl::unexpected(
      beyond_soft_limit(config_, "it has soft limits, which it would pass by turning without end",
                        "move it to one of them instead, with a lower max_velocity"));
}

GatewayAxis::Awaitable<void> GatewayAxis::be_free(RunOptions movement) {
  const auto [module, motor] = address();
  const tmcl::Request move{module, tmcl::Command::MVP, 0, motor, 0};
  auto script = bus_->may_send(move, movement.permit);
  auto result = co_await run(std::move(script), std::move(movement));
  co_return result;
}

GatewayAxis::Awaitable<void> GatewayAxis::check_setting(std::uint8_t parameter, std::int32_t value,
                                                        RunOptions options) {
  if (!config_.scale.limits) co_return Result<void>{};
  switch (tmcl::set_off_by(parameter, parameters())) {
    case tmcl::SetOff::nothing: co_return Result<void>{};
    case tmcl::SetOff::turning_at_value: co_return check_endless(value);
    case tmcl::SetOff::move_to_value: {
      auto checked = co_await check_limits({{value}});
      co_return checked;
    }
    case tmcl::SetOff::held_move: {
      const auto turns = co_await turns_by_velocity(options);
      if (!turns) co_return tl::unexpected(turns.error());
      if (*turns) co_return Result<void>{};
      break;
    }
    case tmcl::SetOff::held_move_or_turning: {
      auto checked = co_await check_held_velocity(options);
      if (!checked) co_return checked;
      break;
    }
  }
  // An axis that is told to be at its target does not leave.
  const bool may_be_there = parameter == tmcl::axis_parameter::actual_position;
  auto checked = co_await check_held_target(may_be_there ? std::optional(value) : std::nullopt,
                                            std::move(options));
  co_return checked;
}

Result<void> GatewayAxis::check_restoring(std::uint8_t parameter) const {
  const bool is_still = tmcl::set_off_by(parameter, parameters()) == tmcl::SetOff::nothing;
  if (!config_.scale.limits || is_still) return {};
  return tl::unexpected(beyond_soft_limit(
      config_, "it has soft limits, and what the EEPROM holds could send it anywhere",
      "set the parameter to a value instead"));
}

GatewayAxis::Awaitable<bool> GatewayAxis::turns_by_velocity(RunOptions options) {
  const auto mode = tmcl::mode_parameter(parameters());
  if (!mode) co_return false;
  auto value = co_await run(tmcl::verbs::get(address(), mode->number), std::move(options));
  co_return value.map([&](std::int32_t now) { return now == mode->velocity; });
}

GatewayAxis::Awaitable<void> GatewayAxis::check_held_velocity(RunOptions options) {
  auto script = tmcl::verbs::get(address(), tmcl::axis_parameter::target_velocity);
  const auto velocity = co_await run(std::move(script), std::move(options));
  if (!velocity) co_return tl::unexpected(velocity.error());
  if (*velocity == 0) co_return Result<void>{};
  co_return tl::unexpected(
      beyond_soft_limit(config_,
                        "its target_velocity is " + std::to_string(*velocity) +
                            ", and turning without end it would pass its soft limits",
                        "stop it first"));
}

GatewayAxis::Awaitable<void> GatewayAxis::check_held_target(std::optional<std::int32_t> here,
                                                            RunOptions options) {
  auto script = tmcl::verbs::get(address(), tmcl::axis_parameter::target_position);
  const auto target = co_await run(std::move(script), std::move(options));
  if (!target) co_return tl::unexpected(target.error());
  if (here == *target) co_return Result<void>{};
  auto checked = co_await check_limits({Microsteps{*target}});
  if (checked || checked.error().code != tmcl::Errc::beyond_soft_limit) co_return checked;
  auto error = std::move(checked.error());
  error.message += ", and it would go on to there: that is its target_position";
  error.hint = "move it to within its limits first";
  co_return tl::unexpected(std::move(error));
}

GatewayAxis::Awaitable<void> GatewayAxis::check_coordinate(std::uint8_t number,
                                                           RunOptions options) {
  if (!config_.scale.limits) co_return Result<void>{};
  auto ready = co_await be_ready();
  if (!ready) co_return ready;
  const auto place = co_await run(tmcl::verbs::coordinate(address(), number), std::move(options));
  if (!place) co_return tl::unexpected(place.error());
  auto checked = co_await check_limits({*place});
  co_return checked;
}

GatewayAxis::Awaitable<StartedMove> GatewayAxis::move_to(Length target, bool predict,
                                                         RunOptions movement) {
  auto ready = co_await be_ready();
  if (!ready) co_return tl::unexpected(std::move(ready.error()));
  auto checked = co_await check_limits(target);
  if (!checked) co_return tl::unexpected(std::move(checked.error()));
  auto script = tmcl::verbs::move_to(address(), target.microsteps);
  auto result = co_await start(std::move(script), predict, movement);
  if (result) wished_ = target.in_unit;
  co_return result;
}

GatewayAxis::Awaitable<StartedMove> GatewayAxis::move_by(Length distance, bool predict,
                                                         RunOptions movement) {
  auto ready = co_await be_ready();
  if (!ready) co_return tl::unexpected(std::move(ready.error()));
  tmcl::ValueRange range;
  const auto* row = find_parameter(parameters(), tmcl::axis_parameter::target_position);
  if (row != nullptr) range = {row->minimum, row->maximum};
  std::optional<tmcl::UserScale> scale;
  if (distance.in_unit || config_.scale.limits) {
    auto known = co_await known_scale();
    if (!known) co_return tl::unexpected(std::move(known.error()));
    scale = std::move(*known);
  }
  // The script may outlive this call.
  const auto wish = std::make_shared<std::optional<tmcl::UserPosition>>();
  const auto in_unit = [=, before = wished_](Microsteps here) -> Result<Microsteps> {
    const auto from = place_of(here, before, *scale);
    *wish = sum(from, *distance.in_unit);
    return tmcl::to_microsteps(**wish, *scale, range).map_error([](const auto& error) {
      return tmcl::bad_argument(describe(error), std::string(beyond_range_hint));
    });
  };
  const auto destination = [=, config = config_](Microsteps here) -> Result<Microsteps> {
    const auto there = distance.in_unit ? in_unit(here) : sum(here, distance.microsteps, range);
    if (!there || !config.scale.limits) return there;
    auto objection = objection_to({*there, *wish}, config, *scale);
    if (objection) return tl::unexpected(std::move(*objection));
    return there;
  };
  auto result =
      co_await start(tmcl::verbs::move_from_here(address(), destination), predict, movement);
  if (result) wished_ = *wish;
  co_return result;
}

GatewayAxis::Awaitable<void> GatewayAxis::move_to_coordinate(std::uint8_t number,
                                                             RunOptions movement) {
  auto ready = co_await be_ready();
  if (!ready) co_return ready;
  auto free = co_await be_free(movement);
  if (!free) co_return free;
  auto checked = co_await check_coordinate(number, movement);
  if (!checked) co_return checked;
  forget_move();
  auto script = tmcl::verbs::move_to_coordinate(address(), number);
  auto result = co_await run(std::move(script), std::move(movement));
  co_return result;
}

GatewayAxis::Awaitable<StartedMove> GatewayAxis::start(tmcl::Script<Result<Microsteps>> script,
                                                       bool predict, RunOptions movement) {
  auto free = co_await be_free(movement);
  if (!free) co_return tl::unexpected(std::move(free.error()));
  std::optional<tmcl::plan::AxisTwin> twin;
  if (predict) {
    // Whatever comes of the readings: they only serve to tell more about the move.
    auto foreseen = co_await this->twin(movement);
    if (foreseen) twin = std::move(*foreseen);
  }
  forget_move();
  const auto begin = bus_->clock().now();
  const auto target = co_await run(std::move(script), std::move(movement));
  if (!target) co_return tl::unexpected(target.error());
  StartedMove started{*target, {}};
  if (twin) {
    twin->move_to(*target);
    started.predicted = twin->time_to_arrival();
  }
  if (started.predicted) expected_arrival_ = begin + *started.predicted;
  co_return started;
}

GatewayAxis::Awaitable<std::optional<tmcl::plan::AxisTwin>> GatewayAxis::twin(RunOptions options) {
  using Twin = std::optional<tmcl::plan::AxisTwin>;
  const auto* model = module_.model();
  if (model == nullptr) co_return Twin{};
  const auto epoch = ramp_epoch();
  if (!ramp_ || ramp_->epoch != epoch) {
    auto read = co_await run(tmcl::verbs::read_ramp(address(), *model), options);
    auto ramp = if_it_tells(std::move(read));
    if (!ramp) co_return tl::unexpected(std::move(ramp.error()));
    if (!*ramp) co_return Twin{};
    ramp_ = Known<std::vector<tmcl::plan::Setting>>{epoch, std::move(**ramp)};
  }
  auto script = tmcl::verbs::read_twin(address(), *model, ramp_->value);
  auto twin = co_await run(std::move(script), std::move(options));
  // Nobody has described its ramps.
  if (!twin && twin.error().code == tmcl::Errc::bad_argument) co_return Twin{};
  co_return if_it_tells(std::move(twin));
}

GatewayAxis::Awaitable<void> GatewayAxis::rotate(tmcl::InternalVelocity velocity,
                                                 RunOptions movement) {
  auto ready = co_await be_ready();
  if (!ready) co_return ready;
  auto free = co_await be_free(movement);
  if (!free) co_return free;
  auto checked = check_endless(velocity.value);
  if (!checked) co_return checked;
  forget_move();
  auto result = co_await run(tmcl::verbs::rotate(address(), velocity), std::move(movement));
  co_return result;
}

GatewayAxis::Awaitable<void> GatewayAxis::stop() {
  revoke_movements();
  expected_arrival_ = {};
  const bool was_searching = mover() == Mover::search;
  RunOptions options;
  auto result = co_await run(tmcl::verbs::stop(address()), std::move(options));
  // A firmware that searches on may start the motor again.
  if (!was_searching || !result) co_return result;
  auto ended = co_await stop_home();
  co_return ended;
}

GatewayAxis::Awaitable<void> GatewayAxis::brake() {
  RunOptions options;
  auto result = co_await run(tmcl::verbs::stop(address()), std::move(options));
  co_return result;
}

void GatewayAxis::revoke_movements() {
  bus_->motors().stop(address());
  if (const auto path = path_.lock()) path->look();
}

GatewayAxis::Awaitable<void> GatewayAxis::stop_home() {
  revoke_movements();
  RunOptions options;
  auto result = co_await run(tmcl::verbs::stop_reference_search(address()), std::move(options));
  co_return result;
}

GatewayAxis::Awaitable<tmcl::Homed> GatewayAxis::home(tmcl::HomeOptions home_options,
                                                      RunOptions movement) {
  auto free = co_await be_free(movement);
  if (!free) co_return tl::unexpected(std::move(free.error()));
  forget_move();
  auto result =
      co_await run(tmcl::verbs::home(address(), std::move(home_options)), std::move(movement));
  co_return result;
}

GatewayAxis::Awaitable<void> GatewayAxis::start_home(std::optional<std::int32_t> mode,
                                                     RunOptions movement) {
  auto free = co_await be_free(movement);
  if (!free) co_return free;
  forget_move();
  auto script = tmcl::verbs::start_reference_search(address(), mode);
  auto result = co_await run(std::move(script), std::move(movement));
  co_return result;
}

GatewayAxis::Awaitable<Microsteps> GatewayAxis::wait(tmcl::WaitOptions wait_options,
                                                     Objection objection) {
  auto ready = co_await be_ready();
  if (!ready) co_return tl::unexpected(std::move(ready.error()));
  RunOptions options;
  options.objection = std::move(objection);
  const auto left = expected_arrival_ - bus_->clock().now();
  wait_options.expected = std::max(left, tmcl::Duration{});
  auto script = tmcl::verbs::wait_until_reached(address(), wait_options);
  auto result = co_await run(std::move(script), std::move(options));
  co_return result;
}

GatewayAxis::Awaitable<std::int32_t> GatewayAxis::get(std::uint8_t parameter, Deadline deadline) {
  auto ready = co_await be_ready();
  if (!ready) co_return tl::unexpected(std::move(ready.error()));
  RunOptions options;
  options.deadline = deadline;
  auto result = co_await run(tmcl::verbs::get(address(), parameter), std::move(options));
  co_return result;
}

GatewayAxis::Awaitable<void> GatewayAxis::set(std::uint8_t parameter, std::int32_t value,
                                              RunOptions movement) {
  // A path depends on the settings of its axes; whoever moves them otherwise has read them.
  if (mover() == Mover::path) {
    auto free = co_await be_free(movement);
    if (!free) co_return free;
  }
  auto ready = co_await be_ready();
  if (!ready) co_return ready;
  auto checked = co_await check_setting(parameter, value, movement);
  if (!checked) co_return checked;
  auto result = co_await write(parameter, value, std::move(movement));
  co_return result;
}

GatewayAxis::Awaitable<void> GatewayAxis::write(std::uint8_t parameter, std::int32_t value,
                                                RunOptions movement) {
  auto ready = co_await be_ready();
  if (!ready) co_return ready;
  auto result = co_await run(tmcl::verbs::set(address(), parameter, value), std::move(movement));
  // Also after a failure: the value may have been set all the same.
  note_set(parameter);
  co_return result;
}

GatewayAxis::Awaitable<void> GatewayAxis::store(std::uint8_t parameter, RunOptions options) {
  auto result = co_await perform(tmcl::verbs::store(address(), parameter), std::move(options));
  co_return result;
}

GatewayAxis::Awaitable<void> GatewayAxis::restore(std::uint8_t parameter, RunOptions movement) {
  auto ready = co_await be_ready();
  if (!ready) co_return ready;
  auto free = co_await be_free(movement);
  if (!free) co_return free;
  auto checked = check_restoring(parameter);
  if (!checked) co_return checked;
  forget_move();
  auto result = co_await run(tmcl::verbs::restore(address(), parameter), std::move(movement));
  module_.note_settings_changed();
  co_return result;
}

GatewayAxis::Awaitable<AxisReading> GatewayAxis::read_state() {
  auto ready = co_await be_ready();
  if (!ready) co_return tl::unexpected(std::move(ready.error()));
  AxisReading reading;
  reading.taken = bus_->clock().now();
  RunOptions options;
  auto state = co_await run(tmcl::verbs::state(address()), std::move(options));
  if (!state) co_return tl::unexpected(std::move(state.error()));
  reading.state = *state;
  auto units = co_await add_units(reading);
  if (!units) co_return tl::unexpected(std::move(units.error()));
  co_return reading;
}

GatewayAxis::Awaitable<void> GatewayAxis::add_units(AxisReading& reading) {
  std::optional<tmcl::PulsesPerSecond> velocity;
  const auto units = co_await module_units();
  if (!units) co_return tl::unexpected(units.error());
  if (*units) {
    velocity = tmcl::to_pps(reading.state.velocity, **units);
    reading.velocity_pps = velocity->value;
  }
  if (config_.scale.unit.empty()) co_return Result<void>{};
  const auto scale = co_await this->scale();
  if (!scale) co_return tl::unexpected(scale.error());
  if (!*scale) co_return Result<void>{};
  reading.user = {tmcl::to_user(reading.state.position, **scale),
                  tmcl::to_user(reading.state.target, **scale),
                  {}};
  if (velocity) reading.user->velocity = tmcl::to_user(*velocity, **scale);
  co_return Result<void>{};
}

GatewayAxis::Awaitable<std::optional<tmcl::ModuleUnits>> GatewayAxis::module_units() {
  using Units = std::optional<tmcl::ModuleUnits>;
  const auto* model = module_.model();
  if (model == nullptr) co_return Units{};
  const auto epoch = units_epoch();
  if (module_units_ && module_units_->epoch == epoch) co_return Units{module_units_->value};
  std::vector<std::int32_t> values;
  for (const auto parameter : tmcl::unit_parameters(*model)) {
    RunOptions options;
    auto read = co_await run(tmcl::verbs::get(address(), parameter), std::move(options));
    auto value = if_it_tells(std::move(read));
    if (!value) co_return tl::unexpected(std::move(value.error()));
    if (!*value) co_return Units{};
    values.push_back(**value);
  }
  const auto units = tmcl::module_units(*model, values);
  if (units) module_units_ = Known<tmcl::ModuleUnits>{epoch, *units};
  co_return units;
}

GatewayAxis::Awaitable<std::optional<tmcl::UserScale>> GatewayAxis::scale() {
  using Scale = std::optional<tmcl::UserScale>;
  const auto& config = config_.scale;
  if (config.microstep_resolution)
    co_return Scale{config.with_resolution(*config.microstep_resolution)};
  const auto epoch = units_epoch();
  if (!microstep_resolution_ || microstep_resolution_->epoch != epoch) {
    auto script = tmcl::verbs::get(address(), tmcl::axis_parameter::microstep_resolution);
    RunOptions options;
    auto read = co_await run(std::move(script), std::move(options));
    auto told = if_it_tells(std::move(read));
    if (!told) co_return tl::unexpected(std::move(told.error()));
    const auto value = *told;
    if (!value || *value < 0 || *value > tmcl::max_microstep_resolution) co_return Scale{};
    microstep_resolution_ = Known<std::int32_t>{epoch, *value};
  }
  co_return Scale{config.with_resolution(microstep_resolution_->value)};
}

void GatewayAxis::forget_move() {
  expected_arrival_ = {};
  wished_.reset();
}

void GatewayAxis::note_set(std::uint8_t parameter) {
  ++changes_;
  if (parameter == tmcl::axis_parameter::actual_position) wished_.reset();
  bool counts = parameter == tmcl::axis_parameter::microstep_resolution;
  if (const auto* model = module_.model()) {
    const auto units = tmcl::unit_parameters(*model);
    counts = counts || std::ranges::count(units, parameter) != 0;
  }
  if (counts) ++unit_changes_;
}

const std::shared_ptr<AxisPoller>& GatewayAxis::poller() {
  if (!poller_) poller_ = std::make_shared<AxisPoller>(bus_->executor());
  return poller_;
}

}  // namespace tmcld
