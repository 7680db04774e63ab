// Reference searches.
#include "api/handlers.hpp"
#include "api/lookup.hpp"
#include "api/quantity.hpp"
#include "tmcl/parameter_number.hpp"

namespace tmcld::handlers {
namespace {

using tmcl::Microsteps;

Lookup<Nothing> nothing_or(const tmcl::Result<void>& result, const GatewayAxis& axis) {
  if (!result) return tl::unexpected(call_error(result.error(), axis.name()));
  return Nothing{};
}

std::optional<std::int32_t> if_known(std::optional<Microsteps> value) {
  return value ? std::optional(value->value) : std::nullopt;
}

tmcl::HomeOptions home_options(const Call& call, const axis::Home& params) {
  tmcl::HomeOptions options;
  options.mode = params.mode;
  options.timeout = call.timeout_left(params.timeout_ms);
  options.progress = [tell = call.teller(), axis = params.axis](std::int32_t step) {
    tell(SearchProgress{axis, step});
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

/// A mode that the model has not is not even written.
std::optional<RpcError> check_mode(std::optional<std::uint8_t> mode, const GatewayAxis& axis) {
  constexpr auto search_mode = tmcl::number_of("reference_search_mode");
  if (!mode) return std::nullopt;
  return check_range(find_parameter(axis.parameters(), search_mode), *mode,
                     api::name_of<&axis::Home::mode>());
}

}  // namespace

Answer<axis::Home> home(Call& call, const axis::Home& params) {
  const auto ready = co_await ready_to_move(call, params);
  if (!ready) co_return tl::unexpected(ready.error());
  auto& axis = *ready->axis;
  auto complaint = check_mode(params.mode, axis);
  if (complaint) co_return tl::unexpected(std::move(*complaint));
  const auto homed =
      co_await axis.home(home_options(call, params), with_peer(ready->moves, call.peer));
  if (!homed) co_return tl::unexpected(call_error(homed.error(), axis.name()));
  auto correction = co_await in_unit(axis, homed->correction);
  const auto distance = co_await in_unit(axis, homed->switch_distance);
  co_return axis::HomedAxis{if_known(homed->correction), if_known(homed->switch_distance),
                            std::move(correction.unit), correction.number, distance.number};
}

Answer<axis::StartHome> start_home(Call& call, const axis::StartHome& params) {
  const auto ready = co_await ready_to_move(call, params);
  if (!ready) co_return tl::unexpected(ready.error());
  auto& axis = *ready->axis;
  auto complaint = check_mode(params.mode, axis);
  if (complaint) co_return tl::unexpected(std::move(*complaint));
  const auto started = co_await axis.start_home(params.mode, ready->moves);
  co_return nothing_or(started, axis);
}

Answer<axis::StopHome> stop_home(Call& call, const axis::StopHome& params) {
  const auto axis = axis_of(call, params.axis);
  if (!axis) co_return tl::unexpected(axis.error());
  const StopInProgress in_progress(call.gateway);
  const auto stopped = co_await (*axis)->stop_home();
  co_return nothing_or(stopped, **axis);
}

Answer<axis::Recover> recover(Call& call, const axis::Recover& params) {
  const auto axis = axis_of(call, params.axis);
  if (!axis) co_return tl::unexpected(axis.error());
  const auto recovered = co_await (*axis)->recover();
  co_return nothing_or(recovered, **axis);
}

}  // namespace tmcld::handlers
