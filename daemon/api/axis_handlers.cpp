#include <boost/json/array.hpp>

#include "api/handlers.hpp"
#include "api/lookup.hpp"
#include "api/state_json.hpp"

namespace tmcld::handlers {
namespace {

namespace json = boost::json;
namespace ap = tmcl::axis_parameter;

RpcResult failed(const tmcl::Error& error, const GatewayAxis& axis) {
  return tl::unexpected(call_error(error, axis.name()));
}

RpcResult with(std::string_view key, tmcl::Microsteps value) {
  json::object result;
  result[key] = value.value;
  return result;
}

}  // namespace

Answer list_axes(Call& call) {
  json::array axes;
  for (const auto& axis : call.gateway->axes()) axes.push_back(to_json(*axis));
  json::object result;
  result["axes"] = std::move(axes);
  co_return result;
}

Answer move_to(Call& call) {
  const auto ready = co_await ready_to_move(call);
  if (!ready) co_return tl::unexpected(ready.error());
  auto& axis = *ready->axis;
  const auto target = call.params.integer("position_microsteps");
  const auto* row = find_parameter(axis.parameters(), ap::target_position);
  auto complaint = check_range(row, target, "position_microsteps");
  if (complaint) co_return tl::unexpected(std::move(*complaint));
  const auto moved = co_await axis.move_to(tmcl::Microsteps{target}, ready->moves);
  if (!moved) co_return failed(moved.error(), axis);
  co_return with("target_microsteps", *moved);
}

Answer move_by(Call& call) {
  const auto ready = co_await ready_to_move(call);
  if (!ready) co_return tl::unexpected(ready.error());
  auto& axis = *ready->axis;
  const tmcl::Microsteps distance{call.params.integer("distance_microsteps")};
  const auto moved = co_await axis.move_by(distance, ready->moves);
  if (!moved) co_return failed(moved.error(), axis);
  co_return with("target_microsteps", *moved);
}

Answer rotate(Call& call) {
  const auto ready = co_await ready_to_move(call);
  if (!ready) co_return tl::unexpected(ready.error());
  auto& axis = *ready->axis;
  const auto velocity = call.params.integer("velocity_internal");
  const auto* row = find_parameter(axis.parameters(), ap::target_velocity);
  auto complaint = check_range(row, velocity, "velocity_internal");
  if (complaint) co_return tl::unexpected(std::move(*complaint));
  const auto turned = co_await axis.rotate(tmcl::InternalVelocity{velocity}, ready->moves);
  if (!turned) co_return failed(turned.error(), axis);
  co_return json::object{};
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
  tmcl::WaitOptions options;
  options.timeout = std::chrono::milliseconds(call.params.integer_or("timeout_ms", 0));
  // Nobody else ends a wait without a timeout.
  Objection objection = [peer = call.peer]() -> std::optional<tmcl::Error> {
    if (!peer->is_gone()) return std::nullopt;
    return tmcl::bad_argument("the client is gone");
  };
  const auto arrived = co_await (*axis)->wait(options, std::move(objection));
  if (!arrived) co_return failed(arrived.error(), **axis);
  co_return with("position_microsteps", *arrived);
}

Answer get_state(Call& call) {
  const auto axis = axis_of(call);
  if (!axis) co_return tl::unexpected(axis.error());
  const auto reading = co_await (*axis)->read_state();
  if (!reading) co_return failed(reading.error(), **axis);
  json::object result;
  add_state(result, **axis, *reading);
  co_return result;
}

}  // namespace tmcld::handlers
