#include "api/subscriptions.hpp"

#include <utility>

#include "api/views.hpp"

namespace tmcld {

std::uint64_t Subscriptions::add(const std::vector<Start>& axes, tmcl::Duration interval) {
  const auto id = ++last_id_;
  auto& items = subscriptions_[id];
  for (const auto& start : axes) {
    auto& item = *items.emplace_back(std::make_unique<Item>());
    item.axis = start.axis;
    item.interval = interval;
    if (start.reading) item.offered_seq = start.reading->seq;
    item.watch = start.axis->poller()->watch(
        start.axis, interval, [this, &item](const PublishedReading& reading, tmcl::TimePoint tick) {
          on_reading(item, reading, tick);
        });
  }
  return id;
}

void Subscriptions::on_reading(Item& item, const PublishedReading& reading, tmcl::TimePoint tick) {
  if (reading.seq == item.offered_seq || tick - item.offered_at < item.interval) return;
  if (item.pending) ++item.dropped;
  item.pending = reading;
  item.offered_seq = reading.seq;
  item.offered_at = tick;
  on_pending_();
}

bool Subscriptions::has_pending() const {
  for (const auto& [id, items] : subscriptions_) {
    for (const auto& item : items) {
      if (item->pending) return true;
    }
  }
  return false;
}

std::optional<boost::json::object> Subscriptions::take_pending() {
  std::vector<std::pair<std::uint64_t, Item*>> waiting;
  for (const auto& [id, items] : subscriptions_) {
    for (const auto& item : items) {
      if (item->pending) waiting.emplace_back(id, item.get());
    }
  }
  if (waiting.empty()) return std::nullopt;
  auto& [id, item] = waiting[turn_++ % waiting.size()];
  api::NewState news;
  news.subscription = id;
  fill(news, *item->axis, *item->pending);
  news.dropped = std::exchange(item->dropped, 0);
  item->pending.reset();
  // Whose state it is comes first, for people who read it.
  boost::json::object params{{api::name_of<&api::NewState::subscription>(), id}};
  for (auto& [name, value] : api::to_json(news)) params.emplace(name, std::move(value));
  return params;
}

}  // namespace tmcld
