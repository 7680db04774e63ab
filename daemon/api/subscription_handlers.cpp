#include <boost/json/array.hpp>

#include "api/handlers.hpp"
#include "api/lookup.hpp"
#include "api/state_json.hpp"
#include "api/subscriptions.hpp"
#include "async/gather.hpp"

namespace tmcld::handlers {
namespace {

namespace json = boost::json;

using Axes = std::vector<std::shared_ptr<GatewayAxis>>;
using Readings = std::vector<tmcl::Result<AxisReading>>;

constexpr std::int32_t default_interval_ms = 50;

boost::asio::awaitable<tmcl::Result<AxisReading>> read_one(std::shared_ptr<GatewayAxis> axis) {
  auto reading = co_await axis->read_state();
  co_return reading;
}

RpcError too_many() {
  return rpc_error(
      rpc_code::overload, "too_many_subscriptions",
      "a connection can have " + std::to_string(max_subscriptions) + " subscriptions at a time",
      "one subscription can name many axes");
}

// Axes that do not answer are watched all the same: they may answer later.
json::object begin(Subscriptions& subscriptions, const Axes& axes, const Readings& readings,
                   tmcl::Duration interval) {
  std::vector<Subscriptions::Start> starts;
  json::array states;
  json::array failed;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    auto& start = starts.emplace_back();
    start.axis = axes[i];
    json::object entry;
    if (readings[i]) {
      start.reading = axes[i]->poller()->number(*readings[i]);
      add_state(entry, *axes[i], *start.reading);
      states.push_back(std::move(entry));
    } else {
      entry["axis"] = axes[i]->name();
      entry["error"] = to_json(call_error(readings[i].error(), axes[i]->name()));
      failed.push_back(std::move(entry));
    }
  }
  json::object result;
  result["subscription"] = subscriptions.add(starts, interval);
  result["states"] = std::move(states);
  result["failed"] = std::move(failed);
  return result;
}

}  // namespace

Answer subscribe(Call& call) {
  const auto axes = axes_of(call);
  if (!axes) co_return tl::unexpected(axes.error());
  if (call.peer->subscriptions().size() >= max_subscriptions) co_return tl::unexpected(too_many());
  std::vector<boost::asio::awaitable<tmcl::Result<AxisReading>>> looks;
  for (const auto& axis : *axes) looks.push_back(read_one(axis));
  const auto readings = co_await gather(std::move(looks));
  if (call.peer->is_gone()) co_return json::object{};
  // Others may have begun meanwhile.
  if (call.peer->subscriptions().size() >= max_subscriptions) co_return tl::unexpected(too_many());
  const std::chrono::milliseconds interval(
      call.params.integer_or("interval_ms", default_interval_ms));
  co_return begin(call.peer->subscriptions(), *axes, readings, interval);
}

Answer unsubscribe(Call& call) {
  const auto number = call.params.integer("subscription");
  if (call.peer->subscriptions().remove(static_cast<std::uint64_t>(number))) {
    co_return json::object{};
  }
  co_return tl::unexpected(
      param_error("unknown_subscription", "subscription",
                  "this connection has no subscription " + std::to_string(number),
                  "subscriptions end with their connection"));
}

}  // namespace tmcld::handlers
