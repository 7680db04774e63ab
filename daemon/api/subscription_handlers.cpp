#include "api/handlers.hpp"
#include "api/lookup.hpp"
#include "api/subscriptions.hpp"
#include "api/views.hpp"
#include "async/gather.hpp"

namespace tmcld::handlers {
namespace {

using Axes = std::vector<std::shared_ptr<GatewayAxis>>;
using Readings = std::vector<tmcl::Result<AxisReading>>;
using Numbers = std::vector<std::uint8_t>;
using Samples = std::vector<ParameterSample>;

constexpr std::int32_t default_interval_ms = 50;

boost::asio::awaitable<tmcl::Result<AxisReading>> read_one(std::shared_ptr<GatewayAxis> axis) {
  auto reading = co_await axis->read_state();
  co_return reading;
}

boost::asio::awaitable<tmcl::Result<Samples>> sample(std::shared_ptr<GatewayAxis> axis,
                                                     Numbers parameters, std::uint64_t client) {
  Samples samples;
  for (const auto parameter : parameters) {
    const auto read = co_await axis->sample(parameter, client);
    if (!read) co_return tl::unexpected(read.error());
    samples.push_back(*read);
  }
  co_return samples;
}

/// Of each axis that answers, as the subscription begins; nothing of the others. Errors: of a name
/// that the model of one does not have.
Task<std::vector<tmcl::Result<Samples>>> first_samples(const Call& call, const Axes& axes,
                                                       const Readings& readings,
                                                       std::vector<std::string> parameters) {
  std::vector<boost::asio::awaitable<tmcl::Result<Samples>>> reads;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    Numbers numbers;
    if (readings[i]) {
      auto found = co_await must(
          parameters_of(parameters, api::name_of<&Subscribe::parameters>(), *axes[i]));
      numbers = std::move(found);
    }
    reads.push_back(sample(axes[i], std::move(numbers), call.permit.client));
  }
  auto samples = co_await gather(std::move(reads));
  co_return samples;
}

std::optional<Error> objection_to(const std::vector<std::string>& parameters) {
  if (parameters.size() <= api::most_sampled_parameters) return std::nullopt;
  return param_error<&Subscribe::parameters>(
      "too_many_parameters",
      "a subscription reads at most " + std::to_string(api::most_sampled_parameters) +
          " parameters, not " + std::to_string(parameters.size()),
      "each is read over the bus, again and again");
}

Error too_many() {
  return failed(
      "too_many_subscriptions",
      "a connection can have " + std::to_string(max_subscriptions) + " subscriptions at a time",
      "one subscription can name many axes");
}

/// Axes that do not answer are watched all the same: they may answer later.
Subscription begin(Subscriptions& subscriptions, const Axes& axes, const Readings& readings,
                   const std::vector<tmcl::Result<Samples>>& samples,
                   const Subscriptions::Wish& wish) {
  std::vector<Subscriptions::Start> starts;
  Subscription result;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    auto& start = starts.emplace_back();
    start.axis = axes[i];
    if (readings[i] && samples[i]) {
      start.reading = axes[i]->poller()->number(*axes[i], *readings[i], *samples[i]);
      Numbers parameters;
      for (const auto& sample : *samples[i]) parameters.push_back(sample.parameter);
      fill(result.states.emplace_back(), *axes[i], *start.reading, parameters);
    } else {
      const auto& name = axes[i]->name();
      const auto& error = readings[i] ? samples[i].error() : readings[i].error();
      result.failed.push_back({name, to_json(call_error(error, name))});
    }
  }
  result.subscription = subscriptions.add(starts, wish);
  return result;
}

}  // namespace

Answer<Subscribe> subscribe(Call& call, const Subscribe& params) {
  const auto axes = co_await must(axes_of(call, params.axes));
  const auto parameters = params.parameters.value_or(std::vector<std::string>{});
  co_await must_not(objection_to(parameters));
  if (call.peer->subscriptions().size() >= max_subscriptions) co_return tl::unexpected(too_many());
  std::vector<boost::asio::awaitable<tmcl::Result<AxisReading>>> looks;
  for (const auto& axis : axes) looks.push_back(read_one(axis));
  const auto readings = co_await gather(std::move(looks));
  const auto samples = co_await must(first_samples(call, axes, readings, parameters));
  if (call.peer->is_gone()) co_return Subscription{};
  // Others may have begun meanwhile.
  if (call.peer->subscriptions().size() >= max_subscriptions) co_return tl::unexpected(too_many());
  const std::chrono::milliseconds interval(params.interval_ms.value_or(default_interval_ms));
  const Subscriptions::Wish wish{interval, parameters, params.every_look.value_or(false),
                                 !params.axes};
  auto begun = begin(call.peer->subscriptions(), axes, readings, samples, wish);
  // Another configuration may have been loaded meanwhile.
  call.peer->subscriptions().follow(*call.gateway);
  co_return begun;
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
