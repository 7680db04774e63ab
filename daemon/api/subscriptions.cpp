#include "api/subscriptions.hpp"

#include <algorithm>
#include <utility>

#include "api/lookup.hpp"
#include "api/raw_name.hpp"
#include "api/views.hpp"

namespace tmcld {

std::uint64_t Subscriptions::add(const std::vector<Start>& axes, const Wish& wish) {
  const auto id = ++last_id_;
  auto& watched = subscriptions_.emplace(id, Watched{wish}).first->second;
  for (const auto& start : axes) {
    auto& item = add_item(watched, start.axis);
    if (!start.reading) continue;
    sample(item);
    item.offered_seq = start.reading->seq;
    item.offered_values = values_of(item, *start.reading);
  }
  return id;
}

Subscriptions::Item& Subscriptions::add_item(Watched& watched, std::shared_ptr<GatewayAxis> axis) {
  auto& item = *watched.items.emplace_back(std::make_unique<Item>());
  item.wish = &watched.wish;
  watch(item, std::move(axis));
  return item;
}

void Subscriptions::watch(Item& item, std::shared_ptr<GatewayAxis> axis) {
  item.axis = std::move(axis);
  item.watch = item.axis->poller()->watch(
      item.axis, item.wish->interval,
      [this, &item](const PublishedReading& reading, tmcl::TimePoint tick) {
        on_reading(item, reading, tick);
      });
}

namespace {

/// The axis that has the name now; null if none has.
std::shared_ptr<GatewayAxis> successor_of(const GatewayAxis& axis, Gateway& gateway) {
  if (auto named = gateway.find_axis(axis.name())) return named;
  auto* bus = gateway.find_bus(axis.bus().name());
  if (bus == nullptr || !is_raw_name(axis.name())) return nullptr;
  if (auto known = gateway.find_axis(*bus, axis.address())) return known;
  return gateway.add_axis(bus->shared_from_this(), axis.address());
}

}  // namespace

void Subscriptions::follow(Gateway& gateway) {
  for (auto& [id, watched] : subscriptions_) follow(watched, gateway);
}

void Subscriptions::follow(Watched& watched, Gateway& gateway) {
  for (auto& item : watched.items) {
    auto axis = successor_of(*item->axis, gateway);
    if (axis == item->axis) continue;
    item->parameters.reset();
    item->pending.reset();
    item->offered_seq = 0;
    axis ? watch(*item, std::move(axis)) : item.reset();
  }
  std::erase(watched.items, nullptr);
  if (!watched.wish.all) return;
  for (const auto& axis : gateway.axes()) {
    const auto is_it = [&](const auto& item) { return item->axis == axis; };
    if (std::ranges::none_of(watched.items, is_it)) add_item(watched, axis);
  }
}

void Subscriptions::sample(Item& item) {
  const auto name = api::name_of<&api::Subscribe::parameters>();
  // A module that has come to answer since then may be of a model that has not all of them.
  auto numbers = parameters_of(item.wish->parameters, name, *item.axis);
  item.parameters = std::move(numbers).value_or(std::vector<std::uint8_t>{});
  item.watch.sample(*item.parameters);
}

std::vector<std::int32_t> Subscriptions::values_of(const Item& item,
                                                   const PublishedReading& reading) {
  std::vector<std::int32_t> values;
  for (const auto& sample : reading.samples)
    if (std::ranges::count(*item.parameters, sample.parameter) > 0) values.push_back(sample.value);
  return values;
}

void Subscriptions::on_reading(Item& item, const PublishedReading& reading, tmcl::TimePoint tick) {
  if (!item.parameters) sample(item);
  auto values = values_of(item, reading);
  const bool is_new = reading.seq != item.offered_seq || values != item.offered_values;
  if (!(is_new || item.wish->every_look) || tick - item.offered_at < item.wish->interval) return;
  if (item.pending) ++item.dropped;
  item.pending = reading;
  item.offered_seq = reading.seq;
  item.offered_values = std::move(values);
  item.offered_at = tick;
  on_pending_();
}

bool Subscriptions::has_pending() const {
  for (const auto& [id, watched] : subscriptions_) {
    for (const auto& item : watched.items) {
      if (item->pending) return true;
    }
  }
  return false;
}

std::optional<boost::json::object> Subscriptions::take_pending() {
  std::vector<std::pair<std::uint64_t, Item*>> waiting;
  for (const auto& [id, watched] : subscriptions_) {
    for (const auto& item : watched.items) {
      if (item->pending) waiting.emplace_back(id, item.get());
    }
  }
  if (waiting.empty()) return std::nullopt;
  auto& [id, item] = waiting[turn_++ % waiting.size()];
  api::NewState news;
  news.subscription = id;
  fill(news, *item->axis, *item->pending, *item->parameters);
  news.dropped = std::exchange(item->dropped, 0);
  item->pending.reset();
  // Whose state it is comes first, for people who read it.
  boost::json::object params{{api::name_of<&api::NewState::subscription>(), id}};
  for (auto& [name, value] : api::to_json(news)) params.emplace(name, std::move(value));
  return params;
}

}  // namespace tmcld
