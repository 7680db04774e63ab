#include <boost/json/array.hpp>

#include "api/handlers.hpp"
#include "api/lookup.hpp"
#include "api/quantity.hpp"
#include "api/state_json.hpp"
#include "tmcl/seconds.hpp"

namespace tmcld::handlers {
namespace {

namespace json = boost::json;
namespace ap = tmcl::axis_parameter;

RpcResult failed(const tmcl::Error& error, const GatewayAxis& axis) {
  return tl::unexpected(call_error(error, axis.name()));
}

bool wants_prediction(const Call& call) { return call.params.boolean_or("predict", true); }

boost::asio::awaitable<json::object> to_result(GatewayAxis& axis, StartedMove started,
                                               const tmcl::UserScale* scale) {
  json::object result;
  result["target_microsteps"] = started.target.value;
  co_await add_in_unit(result, axis, "target", started.target, scale);
  result["predicted_s"] = nullptr;
  if (started.predicted) result["predicted_s"] = tmcl::seconds(*started.predicted);
  co_return result;
}

}  // namespace

Answer list_axes(Call& call) {
  json::array axes;
  const bool all = call.params.boolean_or("all", false);
  for (const auto& axis : all ? call.gateway->all_axes() : call.gateway->axes())
    axes.push_back(to_json(*axis));
  json::object result;
  result["axes"] = std::move(axes);
  co_return result;
}

Answer move_to(Call& call) {
  const auto ready = co_await ready_to_move(call);
  if (!ready) co_return tl::unexpected(ready.error());
  auto& axis = *ready->axis;
  const auto* row = find_parameter(axis.parameters(), ap::target_position);
  const auto target = co_await length_of(call, axis, "position_microsteps", "position", row);
  if (!target) co_return tl::unexpected(target.error());
  const auto moved = co_await axis.move_to(target->length(), wants_prediction(call), ready->moves);
  if (!moved) co_return failed(moved.error(), axis);
  auto result = co_await to_result(axis, *moved, target->known_scale());
  co_return result;
}

Answer move_by(Call& call) {
  const auto ready = co_await ready_to_move(call);
  if (!ready) co_return tl::unexpected(ready.error());
  auto& axis = *ready->axis;
  const auto distance = co_await length_of(call, axis, "distance_microsteps", "distance", nullptr);
  if (!distance) co_return tl::unexpected(distance.error());
  const auto moved =
      co_await axis.move_by(distance->length(), wants_prediction(call), ready->moves);
  if (!moved) co_return failed(moved.error(), axis);
  auto result = co_await to_result(axis, *moved, distance->known_scale());
  co_return result;
}

Answer rotate(Call& call) {
  const auto ready = co_await ready_to_move(call);
  if (!ready) co_return tl::unexpected(ready.error());
  auto& axis = *ready->axis;
  const auto velocity = co_await velocity_of(call, axis);
  if (!velocity) co_return tl::unexpected(velocity.error());
  const auto turned = co_await axis.rotate({velocity->value}, ready->moves);
  if (!turned) co_return failed(turned.error(), axis);
  json::object result;
  result["velocity_internal"] = velocity->value;
  co_await add_velocity_in_unit(result, axis, *velocity);
  co_return result;
}

Answer stop(Call& call) {
  const auto axis = axis_of(call);
  if (!axis) co_return tl::unexpected(axis.error());
  ++call.gateway->stops_in_progress;
  const auto stopped = co_await (*axis)->stop();
  --call.gateway->stops_in_progress;
  if (!stopped) co_return failed(stopped.error(), **axis);
  co_return json::object{};
}

Answer wait(Call& call) {
  const auto axis = axis_of(call);
  if (!axis) co_return tl::unexpected(axis.error());
  const auto ready = co_await (*axis)->be_ready();
  if (!ready) co_return failed(ready.error(), **axis);
  tmcl::WaitOptions options;
  options.timeout = call.timeout_left();
  // Nobody else ends a wait without a timeout.
  Objection objection = [peer = call.peer]() -> std::optional<tmcl::Error> {
    if (!peer->is_gone()) return std::nullopt;
    return tmcl::bad_argument("the client is gone");
  };
  const auto arrived = co_await (*axis)->wait(options, std::move(objection));
  if (!arrived) co_return failed(arrived.error(), **axis);
  json::object result;
  result["position_microsteps"] = arrived->value;
  co_await add_in_unit(result, **axis, "position", *arrived);
  co_return result;
}

Answer get_units(Call& call) {
  const auto axis = axis_of(call);
  if (!axis) co_return tl::unexpected(axis.error());
  const auto ready = co_await (*axis)->be_ready();
  if (!ready) co_return failed(ready.error(), **axis);
  const auto module = co_await (*axis)->module_units();
  if (!module) co_return failed(module.error(), **axis);
  const auto scale = co_await (*axis)->scale();
  if (!scale) co_return failed(scale.error(), **axis);
  co_return units_json(**axis, *module, *scale);
}

Answer get_state(Call& call) {
  const auto axis = axis_of(call);
  if (!axis) co_return tl::unexpected(axis.error());
  const std::chrono::milliseconds max_age(call.params.integer_or("max_age_ms", 0));
  const auto reading = co_await (*axis)->read_state(max_age);
  if (!reading) co_return failed(reading.error(), **axis);
  json::object result;
  add_state(result, **axis, *reading);
  co_return result;
}

}  // namespace tmcld::handlers
