#include "api/handlers.hpp"
#include "api/lookup.hpp"
#include "api/subscriptions.hpp"
#include "api/views.hpp"
#include "async/gather.hpp"

namespace tmcld::handlers {
namespace {

using Axes = std::vector<std::shared_ptr<GatewayAxis>>;
using Readings = std::vector<tmcl::Result<AxisReading>>;

constexpr std::int32_t default_interval_ms = 50;

boost::asio::awaitable<tmcl::Result<AxisReading>> read_one(std::shared_ptr<GatewayAxis> axis) {
  auto reading = co_await axis->read_state();
  co_return reading;
}

Error too_many() {
  return failed(
      "too_many_subscriptions",
      "a connection can have " + std::to_string(max_subscriptions) + " subscriptions at a time",
      "one subscription can name many axes");
}

/// Axes that do not answer are watched all the same: they may answer later.
Subscription begin(Subscriptions& subscriptions, const Axes& axes, const Readings& readings,
                   tmcl::Duration interval) {
  std::vector<Subscriptions::Start> starts;
  Subscription result;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    auto& start = starts.emplace_back();
    start.axis = axes[i];
    if (readings[i]) {
      start.reading = axes[i]->poller()->number(*readings[i]);
      fill(result.states.emplace_back(), *axes[i], *start.reading);
    } else {
      const auto& name = axes[i]->name();
      result.failed.push_back({name, to_json(call_error(readings[i].error(), name))});
    }
  }
  result.subscription = subscriptions.add(starts, interval);
  return result;
}

}  // namespace

Answer<Subscribe> subscribe(Call& call, const Subscribe& params) {
  const auto axes = co_await must(axes_of(call, params.axes));
  if (call.peer->subscriptions().size() >= max_subscriptions) co_return tl::unexpected(too_many());
  std::vector<boost::asio::awaitable<tmcl::Result<AxisReading>>> looks;
  for (const auto& axis : axes) looks.push_back(read_one(axis));
  const auto readings = co_await gather(std::move(looks));
  if (call.peer->is_gone()) co_return Subscription{};
  // Others may have begun meanwhile.
  if (call.peer->subscriptions().size() >= max_subscriptions) co_return tl::unexpected(too_many());
  const std::chrono::milliseconds interval(params.interval_ms.value_or(default_interval_ms));
  co_return begin(call.peer->subscriptions(), axes, readings, interval);
}

Answer<Unsubscribe> unsubscribe(Call& call, const Unsubscribe& params) {
  if (call.peer->subscriptions().remove(static_cast<std::uint64_t>(params.subscription)))
    co_return Nothing{};
  co_return param_error<&Unsubscribe::subscription>(
      "unknown_subscription",
      "this connection has no subscription " + std::to_string(params.subscription),
      "subscriptions end with their connection");
}

}  // namespace tmcld::handlers
