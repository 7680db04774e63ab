// Searches of the reference: see the header.
#include <cmath>
#include <limits>
#include <utility>

#include "gateway/axis/axis.hpp"
#include "gateway/axis/stop_advice.hpp"
#include "gateway/standing_stop.hpp"
#include "tmcl/scale_factor.hpp"

namespace tmcld {
namespace {

using tmcl::Microsteps;

/// A stop has ended the search that was under way: that is known, and who sends stops.
tmcl::Error ended_search(tmcl::Error error) {
  const bool is_stopped = error.code == tmcl::Errc::superseded_by_stop;
  if (!is_stopped || error.outcome == tmcl::Outcome::not_sent) return error;
  error.message = "a stop ended the search of its reference";
  error.hint = advice_on(name_of(StopCause::client));
  return error;
}

tmcl::Error found_no_reference(const std::string& axis) {
  tmcl::Error error;
  error.code = tmcl::Errc::move_interrupted;
  error.outcome = tmcl::Outcome::done;
  error.message = "the search of axis '" + axis +
                  "' has ended, and has found no reference: the axis does not stand at zero";
  error.hint = "another host or its module stopped it; look at its switches, and search again";
  return error;
}

tmcl::Error went_too_far(const std::string& axis, Microsteps limit) {
  tmcl::Error error;
  error.code = tmcl::Errc::move_interrupted;
  error.outcome = tmcl::Outcome::done;
  error.message = "the search of axis '" + axis + "' has gone further one way than the " +
                  std::to_string(limit.value) +
                  " microsteps that it may, and was stopped; cause: search_limit";
  error.hint =
      "look at its switches and the mode of the search; if the way to them is longer, "
      "'home_max_travel' in the configuration or 'max_travel' of the search says so";
  return error;
}

}  // namespace

GatewayAxis::Awaitable<SearchLimit> GatewayAxis::search_limit() {
  // By how much it may be further from one switch to the other than the soft limits are apart.
  constexpr double beyond_soft_limits = 1.1;
  auto travel = axis_.config().home_max_travel;
  const auto& limits = soft_limits();
  if (!travel && limits)
    travel = (limits->greatest.value - limits->least.value) * beyond_soft_limits;
  if (!travel) co_return SearchLimit{};
  const auto scale = co_await axis_.run(units_.known_scale());
  if (!scale) co_return tl::unexpected(scale.error());
  const double microsteps = std::abs(*travel * microsteps_per_unit(*scale));
  constexpr double greatest = std::numeric_limits<std::int32_t>::max();
  co_return SearchLimit{Microsteps{static_cast<std::int32_t>(std::min(microsteps, greatest))}};
}

std::optional<SearchLimit> GatewayAxis::search_limit_of(Permit permit) const {
  if (search_.of != permit) return std::nullopt;
  return std::optional<SearchLimit>(std::in_place, search_.limit);
}

GatewayAxis::Awaitable<tmcl::Homed> GatewayAxis::home(tmcl::HomeOptions options, SearchLimit limit,
                                                      RunOptions movement) {
  bus().motors().let_search(address(), movement.permit);
  search_ = {movement.permit, limit};
  auto script = tmcl::verbs::home(address(), std::move(options));
  const ClaimOwner search{ClaimKind::search, movement.permit};
  auto homed = co_await move(action::Search{}, std::move(script), std::move(movement));
  if (search_.went_too_far && search_.of == search.of)
    co_return tl::unexpected(axis_.on_bus(went_too_far(name(), *search_.limit)));
  if (!homed) co_return tl::unexpected(ended_search(std::move(homed.error())));
  // Another call may have seen the end already, to move the axis.
  if (claim_owner() == search) {
    auto seen =
        co_await axis_.run(bus().gate().see_search_end(address()), asked_by(search.of.client));
    if (!seen) seen.error().outcome = tmcl::Outcome::unknown;
    if (!seen) co_return tl::unexpected(std::move(seen.error()));
  }
  if (auto latch = latched()) {
    // The search was under way then.
    latch->outcome = tmcl::Outcome::unknown;
    co_return tl::unexpected(std::move(*latch));
  }
  if (is_referenced()) co_return homed;
  auto error = found_no_reference(name());
  co_await add_cause(error, search.of.client);
  co_return tl::unexpected(axis_.on_bus(std::move(error)));
}

GatewayAxis::Awaitable<void> GatewayAxis::start_home(std::optional<std::int32_t> mode,
                                                     SearchLimit limit, RunOptions movement) {
  bus().motors().let_search(address(), movement.permit);
  search_ = {movement.permit, limit};
  auto script = tmcl::verbs::start_reference_search(address(), mode);
  return move(action::Search{}, std::move(script), std::move(movement));
}

GatewayAxis::Awaitable<void> GatewayAxis::stop_home() {
  revoke_movements();
  auto result = co_await axis_.run(tmcl::verbs::stop_reference_search(address()));
  co_return result;
}

GatewayAxis::Awaitable<void> GatewayAxis::stop_search(Permit permit, Microsteps limit) {
  search_ = {permit, limit, true};
  auto event = event_of(*this, GatewayEvent::Kind::axis_stopped,
                        "the search of axis '" + name() + "' has gone further one way than the " +
                            std::to_string(limit.value) +
                            " microsteps that it may, and is stopped; cause: search_limit");
  event.cause = name_of(StopCause::search_limit);
  bus().emit(std::move(event));
  auto stopped = co_await stop(StopCause::search_limit);
  co_return stopped;
}

}  // namespace tmcld
