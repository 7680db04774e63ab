#include "gateway/axis/poller.hpp"

#include <algorithm>
#include <utility>

#include "async/spawn.hpp"

namespace tmcld {
namespace {

bool is_same(const AxisReading& one, const AxisReading& other) {
  const auto& a = one.state;
  const auto& b = other.state;
  return a.position == b.position && a.velocity == b.velocity && a.target == b.target &&
         a.position_reached == b.position_reached && one.velocity_pps == other.velocity_pps &&
         one.user == other.user;
}

}  // namespace

AxisWatch::~AxisWatch() {
  if (poller_) poller_->remove(id_);
}

AxisWatch AxisPoller::watch(std::shared_ptr<GatewayAxis> axis, tmcl::Duration interval,
                            OnReading on_reading) {
  const auto id = ++last_id_;
  watchers_.emplace(id, Watcher{std::clamp(interval, shortest_poll_interval, longest_poll_interval),
                                std::move(on_reading)});
  if (running_) {
    changed_.notify();
  } else {
    running_ = true;
    spawn(executor_, run(shared_from_this(), std::move(axis)));
  }
  return {shared_from_this(), id};
}

void AxisPoller::remove(std::uint64_t id) {
  watchers_.erase(id);
  changed_.notify();
}

tmcl::Duration AxisPoller::interval(const GatewayAxis& axis) const {
  auto shortest = longest_poll_interval;
  for (const auto& [id, watcher] : watchers_) shortest = std::min(shortest, watcher.interval);
  return axis.bus().has_paths() ? std::max(shortest, shortest_poll_interval_beside_path) : shortest;
}

PublishedReading AxisPoller::number(const AxisReading& reading) {
  if (last_.seq == 0 || !is_same(last_.reading, reading)) ++last_.seq;
  last_.reading = reading;
  return last_;
}

void AxisPoller::tell(const PublishedReading& reading, tmcl::TimePoint tick) {
  for (const auto& [id, watcher] : watchers_) watcher.on_reading(reading, tick);
}

boost::asio::awaitable<void> AxisPoller::run(std::shared_ptr<AxisPoller> self,
                                             std::shared_ptr<GatewayAxis> axis) {
  auto tick = self->clock_.now();
  while (true) {
    // Everyone has gone, or a shorter interval came: recomputed after every wake-up.
    while (!self->watchers_.empty()) {
      const auto due = tick + self->interval(*axis);
      if (self->clock_.now() >= due) break;
      co_await self->changed_.wait_until(due);
    }
    if (self->watchers_.empty()) break;
    const auto interval = self->interval(*axis);
    const auto late = self->clock_.now() - tick;
    tick += interval * std::max<tmcl::Duration::rep>(late / interval, 1);
    const auto reading = co_await axis->read_state();
    // Silence is told once, as an event of the module.
    if (reading) self->tell(self->number(*reading), tick);
  }
  self->running_ = false;
}

}  // namespace tmcld
