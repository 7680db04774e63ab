#include <utility>

#include "api/common_params.hpp"
#include "api/handlers.hpp"
#include "api/lookup.hpp"
#include "async/gather.hpp"
#include "tmcl/seconds.hpp"

namespace tmcld::handlers {
namespace {

using namespace std::chrono_literals;

std::vector<std::string> names_of(const std::vector<std::shared_ptr<GatewayAxis>>& axes) {
  std::vector<std::string> names;
  for (const auto& axis : axes) names.push_back(axis->name());
  return names;
}

std::int64_t milliseconds(tmcl::Duration duration) {
  return std::chrono::ceil<std::chrono::milliseconds>(duration).count();
}

lease::Granted granted(const tmcld::Lease& lease) {
  lease::Granted told{lease.number, lease.epoch, names_of(lease.axes),
                      milliseconds(lease.terms.ttl)};
  if (lease.terms.stops && !lease.journal_failure.empty())
    told.warnings = std::vector{journal_warning(lease.journal_failure)};
  return told;
}

lease::Lease view_of(const tmcld::Lease& lease, tmcl::TimePoint now) {
  return {lease.number, names_of(lease.axes), lease.holder.name, tmcl::seconds(now - lease.since),
          milliseconds(lease.expires - now)};
}

/// Says who has it, and until when, where that is known.
Error refusal_of(const Call& call, const tmcl::Error& failure) {
  auto error = call_error(failure);
  if (failure.code != tmcl::Errc::leased) return error;
  const auto axis = axis_of(call, failure.axis);
  const auto* holding = axis ? call.gateway->leases()->of(**axis) : nullptr;
  if (holding == nullptr) return error;
  const auto view = api::to_json(view_of(*holding, call.gateway->clock().now()));
  error.subject.insert(view.begin(), view.end());
  return error;
}

Result<LeaseTerms> terms_of(const lease::Acquire& params) {
  const auto on_loss = params.on_loss.value_or("stop");
  if (on_loss != "stop" && on_loss != "keep") {
    return tl::unexpected(
        param_error<&lease::Acquire::on_loss>("bad_argument", "'on_loss' is stop or keep"));
  }
  return LeaseTerms{std::chrono::milliseconds(params.ttl_ms.value_or(lease::usual_ttl_ms)),
                    on_loss == "stop"};
}

boost::asio::awaitable<tmcl::Result<void>> stop_one(std::shared_ptr<GatewayAxis> axis) {
  auto stopped = co_await axis->stop();
  co_return stopped;
}

}  // namespace

Answer<lease::Acquire> acquire_lease(Call& call, const lease::Acquire& params) {
  const auto axes = co_await must(axes_of(call, params.axes));
  auto terms = co_await must(terms_of(params));
  if (axes.empty())
    co_return param_error<&lease::Acquire::axes>("bad_argument", "a lease is of one axis at least");
  auto holder = call.peer->client();
  auto acquired =
      Leases::acquire(call.gateway->leases(), std::move(holder), axes, terms, call.permit);
  const auto result = co_await std::move(acquired);
  if (!result) co_return refusal_of(call, result.error());
  co_return granted(*result);
}

Answer<lease::Renew> renew_lease(Call& call, const lease::Renew& params) {
  auto& leases = *call.gateway->leases();
  const auto held = co_await must(find_lease(leases, {params.lease, params.epoch}));
  const auto ttl = params.ttl_ms ? std::chrono::milliseconds(*params.ttl_ms) : held.terms.ttl;
  co_return granted(leases.renew(held.number, ttl));
}

Answer<lease::Release> release_lease(Call& call, const lease::Release& params) {
  auto& leases = *call.gateway->leases();
  const auto held = co_await must(find_lease(leases, {params.lease, params.epoch}));
  // Until the stops are through no other client moves the axes.
  std::vector<boost::asio::awaitable<tmcl::Result<void>>> stops;
  if (params.stop.value_or(true))
    for (const auto& axis : held.axes) stops.push_back(stop_one(axis));
  const StopInProgress in_progress(call.gateway);
  const auto stopped = co_await gather(std::move(stops));
  for (std::size_t i = 0; i < stopped.size(); ++i) {
    if (!stopped[i]) co_return call_error(stopped[i].error(), held.axes[i]->name());
  }
  leases.release(held.number);
  co_return Nothing{};
}

Answer<lease::List> list_leases(Call& call, const lease::List&) {
  lease::Leases result;
  const auto now = call.gateway->clock().now();
  for (const auto& [number, lease] : call.gateway->leases()->all())
    result.leases.push_back(view_of(lease, now));
  co_return result;
}

Answer<lease::Break> break_lease(Call& call, const lease::Break& params) {
  const auto axis = co_await must(axis_of(call, params.axis));
  call.gateway->leases()->break_lease(*axis, call.peer->client().name);
  co_return Nothing{};
}

}  // namespace tmcld::handlers
