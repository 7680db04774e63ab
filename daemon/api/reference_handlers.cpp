// Reference searches.
#include <cstdlib>
#include <optional>

#include "api/handlers.hpp"
#include "api/lookup.hpp"
#include "api/quantity.hpp"
#include "api/with_peer.hpp"
#include "gateway/standing_stop.hpp"
#include "tmcl/parameter_number.hpp"

namespace tmcld::handlers {
namespace {

using tmcl::Microsteps;

std::optional<std::int32_t> if_known(std::optional<Microsteps> value) {
  return value ? std::optional(value->value) : std::nullopt;
}

template <class Params>
Task<SearchLimit> limit_of_search(GatewayAxis& axis, const Params& params) {
  if (!params.max_travel && !params.max_travel_microsteps) {
    const auto limit = co_await must(axis.search_limit(), axis);
    co_return limit;
  }
  const auto said = raw_or_quantity<&Params::max_travel_microsteps, &Params::max_travel>(params);
  const auto travel = co_await must(distance_of(axis, said));
  const auto microsteps = travel.microsteps.value;
  const bool is_distance = travel.in_unit ? travel.in_unit->value > 0 : microsteps > 0;
  if (microsteps == 0 || !is_distance)
    co_return param_error("out_of_range", said.amount_name,
                          "the way that a search may go is greater than 0",
                          "it is the same in both directions: say it without a sign");
  co_return SearchLimit{Microsteps{std::abs(microsteps)}};
}

/// What an answer says of the limit of a search.
template <class Result>
boost::asio::awaitable<void> tell_limit(GatewayAxis& axis, SearchLimit limit, Result& result) {
  result.max_travel_microsteps = if_known(limit);
  auto told = co_await distance_in_unit(axis, limit);
  if (told.number) result.max_travel = std::abs(*told.number);
  result.unit = std::move(told.unit);
  if (!limit)
    result.warnings.emplace_back(
        "nothing bounds the search if its switch is dead: give 'home_max_travel' or 'soft_limits' "
        "in the configuration, or 'max_travel'");
}

tmcl::HomeOptions home_options(const Call& call, const axis::Home& params) {
  tmcl::HomeOptions options;
  options.mode = params.mode;
  options.timeout = call.timeout_left(params.timeout_ms);
  options.progress = [tell = call.progress_reporter(), axis = params.axis](std::int32_t step) {
    tell(SearchProgress{axis, step});
    return true;
  };
  return options;
}

/// A mode that the model has not is not even written.
std::optional<Error> check_mode(std::optional<std::uint8_t> mode, const GatewayAxis& axis) {
  constexpr auto search_mode = tmcl::number_of("reference_search_mode");
  if (!mode) return std::nullopt;
  return check_range(find_parameter(axis.parameters(), search_mode), *mode,
                     api::name_of<&axis::Home::mode>());
}

/// No client waits for it any more, so it is stopped.
boost::asio::awaitable<void> end_late_search(const Call& call, std::shared_ptr<GatewayAxis> axis,
                                             tmcl::Error& error) {
  const StopInProgress in_progress(call.gateway);
  const auto stopped = co_await axis->stop(StopCause::client, call.permit.client);
  if (!stopped) stop_until_it_stands(axis);
  error.message += stopped ? ", and was stopped" : "; " + not_stopped(axis->name());
  error.hint =
      "give it more time, or check the switches and parameter 193; with 'leave' it goes on";
}

}  // namespace

Answer<axis::Home> home(Call& call, const axis::Home& params) {
  const auto ready = co_await must(ready_to_move(call, params));
  auto& axis = *ready.axis;
  co_await must_not(check_mode(params.mode, axis));
  const auto limit = co_await must(limit_of_search(axis, params));
  auto homed =
      co_await axis.home(home_options(call, params), limit, with_peer(ready.moves, call.peer));
  const bool is_late = !homed && homed.error().code == tmcl::Errc::deadline_passed &&
                       homed.error().outcome != tmcl::Outcome::not_sent;
  if (is_late && !params.leave.value_or(false))
    co_await end_late_search(call, ready.axis, homed.error());
  if (!homed) co_return call_error(homed.error(), axis.name());
  auto correction = co_await in_unit(axis, homed->correction);
  const auto distance = co_await distance_in_unit(axis, homed->switch_distance);
  axis::HomedAxis result{if_known(homed->correction),
                         if_known(homed->switch_distance),
                         {},
                         correction.number,
                         distance.number};
  co_await tell_limit(axis, limit, result);
  result.unit = std::move(correction.unit);
  co_return result;
}

Answer<axis::StartHome> start_home(Call& call, const axis::StartHome& params) {
  const auto ready = co_await must(ready_to_move(call, params));
  auto& axis = *ready.axis;
  co_await must_not(check_mode(params.mode, axis));
  const auto limit = co_await must(limit_of_search(axis, params));
  co_await must(axis.start_home(params.mode, limit, ready.moves), axis);
  axis::StartedSearch result;
  co_await tell_limit(axis, limit, result);
  co_return result;
}

Answer<axis::StopHome> stop_home(Call& call, const axis::StopHome& params) {
  const auto axis = co_await must(axis_of(call, params.axis));
  const StopInProgress in_progress(call.gateway);
  co_await must(axis->stop_home(), *axis);
  co_return Nothing{};
}

Answer<axis::Recover> recover(Call& call, const axis::Recover& params) {
  const auto axis = co_await must(axis_of(call, params.axis));
  co_await must(axis->recover(), *axis);
  co_return Nothing{};
}

}  // namespace tmcld::handlers
