// Reference searches, coordinates, and parameters in the EEPROM: what else an axis can do.
#include "api/handlers.hpp"
#include "api/lookup.hpp"
#include "api/module_choice.hpp"
#include "api/quantity.hpp"
#include "tmcl/parameter_number.hpp"

namespace tmcld::handlers {
namespace {

namespace json = boost::json;
using tmcl::Microsteps;

RpcResult failed(const tmcl::Error& error, const GatewayAxis& axis) {
  return tl::unexpected(call_error(error, axis.name()));
}

RpcResult nothing_or(const tmcl::Result<void>& result, const GatewayAxis& axis) {
  if (!result) return failed(result.error(), axis);
  return json::object{};
}

json::value or_null(std::optional<Microsteps> value) {
  return value ? json::value(value->value) : json::value(nullptr);
}

tmcl::HomeOptions home_options(const Call& call) {
  tmcl::HomeOptions options;
  if (call.params.has("mode")) options.mode = call.params.integer("mode");
  options.timeout = call.timeout_left();
  options.progress = [peer = call.peer, id = call.id,
                      axis = call.params.text("axis")](std::int32_t step) {
    json::object params;
    params["id"] = id;
    params["axis"] = axis;
    params["step"] = step;
    peer->notify("notify_progress", std::move(params));
    return true;
  };
  return options;
}

/// Also ends when the client goes; the search goes on then, like any movement.
RunOptions with_peer(RunOptions movement, std::shared_ptr<Peer> peer) {
  movement.objection = [objection = std::move(movement.objection),
                        peer = std::move(peer)]() -> std::optional<tmcl::Error> {
    if (auto error = objection()) return error;
    if (!peer->is_gone()) return std::nullopt;
    return tmcl::bad_argument("the client is gone");
  };
  return movement;
}

std::uint8_t coordinate_of(const Call& call) {
  return static_cast<std::uint8_t>(call.params.integer("number"));
}

std::optional<std::uint8_t> coordinate_if_given(const Call& call) {
  return call.params.has("number") ? std::optional(coordinate_of(call)) : std::nullopt;
}

Answer position_from(Call& call, tmcl::Script<tmcl::Result<Microsteps>> (*verb)(tmcl::AxisAddress,
                                                                                std::uint8_t)) {
  const auto axis = axis_of(call);
  if (!axis) co_return tl::unexpected(axis.error());
  RunOptions options;
  options.deadline = call.deadline();
  const auto place =
      co_await (*axis)->perform(verb((*axis)->address(), coordinate_of(call)), std::move(options));
  if (!place) co_return failed(place.error(), **axis);
  json::object result;
  result["position_microsteps"] = place->value;
  co_await add_in_unit(result, **axis, "position", *place);
  co_return result;
}

Answer act_on_eeprom(Call& call,
                     tmcl::Script<tmcl::Result<void>> (*verb)(tmcl::ModuleAddress,
                                                              std::optional<std::uint8_t>)) {
  const auto axis = axis_of(call);
  if (!axis) co_return tl::unexpected(axis.error());
  RunOptions options;
  options.deadline = call.deadline();
  const auto done = co_await (*axis)->perform(
      verb((*axis)->address().module, coordinate_if_given(call)), std::move(options));
  co_return nothing_or(done, **axis);
}

using ParameterVerb = GatewayAxis::Awaitable<void> (GatewayAxis::*)(std::uint8_t, RunOptions);

Answer act_on_parameter(Call& call, ParameterVerb verb) {
  // What is restored can move the motor.
  const auto ready = co_await ready_to_move(call);
  if (!ready) co_return tl::unexpected(ready.error());
  auto& axis = *ready->axis;
  const auto choice = parameter_of(call, axis);
  if (!choice) co_return tl::unexpected(choice.error());
  const auto done = co_await (axis.*verb)(choice->number, ready->moves);
  if (!done) co_return failed(done.error(), axis);
  json::object result;
  result["parameter"] = nullptr;
  if (choice->row != nullptr) result["parameter"] = choice->row->name;
  result["number"] = choice->number;
  co_return result;
}

/// A mode that the model has not is not even written.
std::optional<RpcError> check_mode(const Call& call, const GatewayAxis& axis) {
  constexpr auto search_mode = tmcl::number_of("reference_search_mode");
  if (!call.params.has("mode")) return std::nullopt;
  return check_range(find_parameter(axis.parameters(), search_mode), call.params.integer("mode"),
                     "mode");
}

}  // namespace

Answer home(Call& call) {
  const auto ready = co_await ready_to_move(call);
  if (!ready) co_return tl::unexpected(ready.error());
  auto& axis = *ready->axis;
  auto complaint = check_mode(call, axis);
  if (complaint) co_return tl::unexpected(std::move(*complaint));
  const auto homed = co_await axis.home(home_options(call), with_peer(ready->moves, call.peer));
  if (!homed) co_return failed(homed.error(), axis);
  json::object result;
  result["correction_microsteps"] = or_null(homed->correction);
  result["switch_distance_microsteps"] = or_null(homed->switch_distance);
  co_await add_in_unit(result, axis, "correction", homed->correction);
  co_await add_in_unit(result, axis, "switch_distance", homed->switch_distance);
  co_return result;
}

Answer start_home(Call& call) {
  const auto ready = co_await ready_to_move(call);
  if (!ready) co_return tl::unexpected(ready.error());
  auto& axis = *ready->axis;
  auto complaint = check_mode(call, axis);
  if (complaint) co_return tl::unexpected(std::move(*complaint));
  std::optional<std::int32_t> mode;
  if (call.params.has("mode")) mode = call.params.integer("mode");
  const auto started = co_await axis.start_home(mode, ready->moves);
  co_return nothing_or(started, axis);
}

Answer stop_home(Call& call) {
  const auto axis = axis_of(call);
  if (!axis) co_return tl::unexpected(axis.error());
  ++call.gateway->stops_in_progress;
  const auto stopped = co_await (*axis)->stop_home();
  --call.gateway->stops_in_progress;
  co_return nothing_or(stopped, **axis);
}

Answer store_parameter(Call& call) { return act_on_parameter(call, &GatewayAxis::store); }
Answer restore_parameter(Call& call) { return act_on_parameter(call, &GatewayAxis::restore); }

Answer get_coordinate(Call& call) { return position_from(call, tmcl::verbs::coordinate); }
Answer capture_coordinate(Call& call) {
  return position_from(call, tmcl::verbs::capture_coordinate);
}

Answer set_coordinate(Call& call) {
  const auto axis = axis_of(call);
  if (!axis) co_return tl::unexpected(axis.error());
  RunOptions options;
  options.deadline = call.deadline();
  const auto position =
      co_await length_of(call, **axis, "position_microsteps", "position", nullptr);
  if (!position) co_return tl::unexpected(position.error());
  const auto done = co_await (*axis)->perform(
      tmcl::verbs::set_coordinate((*axis)->address(), coordinate_of(call), position->microsteps),
      std::move(options));
  co_return nothing_or(done, **axis);
}

Answer move_to_coordinate(Call& call) {
  const auto ready = co_await ready_to_move(call);
  if (!ready) co_return tl::unexpected(ready.error());
  auto& axis = *ready->axis;
  const auto done = co_await axis.move_to_coordinate(coordinate_of(call), ready->moves);
  co_return nothing_or(done, axis);
}

namespace {

/// Why one of these motors must not go to its coordinate.
boost::asio::awaitable<std::optional<RpcError>> check_limits(const Call& call,
                                                             const ModuleChoice& module,
                                                             tmcl::MotorMask motors) {
  for (const auto& axis : call.gateway->axes()) {
    const auto [address, motor] = axis->address();
    const bool starts = &axis->bus() == module.bus.get() && address == module.address &&
                        motor < 8 && (unsigned{motors.bits} >> motor & 1U) != 0;
    if (!starts) continue;
    RunOptions options;
    options.deadline = call.deadline();
    const auto checked = co_await axis->check_coordinate(coordinate_of(call), std::move(options));
    if (!checked) co_return call_error(checked.error(), axis->name());
  }
  co_return std::nullopt;
}

}  // namespace

Answer start_coordinate(Call& call) {
  const auto module = module_of(call);
  if (!module) co_return tl::unexpected(module.error());
  const tmcl::MotorMask motors{static_cast<std::uint8_t>(call.params.mask("motors"))};
  auto complaint = co_await check_limits(call, *module, motors);
  if (complaint) co_return tl::unexpected(std::move(*complaint));
  const auto together = call.params.boolean_or("interpolated", false)
                            ? tmcl::Together::interpolated
                            : tmcl::Together::each_for_itself;
  auto script = tmcl::verbs::move_motors_to_coordinate(module->address, motors, together,
                                                       coordinate_of(call));
  auto started = co_await run_on(*module, call, std::move(script));
  if (!started) co_return tl::unexpected(std::move(started.error()));
  co_return json::object{};
}

Answer store_coordinates(Call& call) { return act_on_eeprom(call, tmcl::verbs::store_coordinates); }
Answer load_coordinates(Call& call) { return act_on_eeprom(call, tmcl::verbs::load_coordinates); }

}  // namespace tmcld::handlers
