#include "gateway/axis/poller.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "async/spawn.hpp"
#include "gateway/standing_stop.hpp"

namespace tmcld {
namespace {

// Sampling takes one of them, and leaves the others to the look and to who else uses the bus.
constexpr int parts_of_interval = 2;

bool is_same(const AxisReading& one, const AxisReading& other) {
  const auto& a = one.state;
  const auto& b = other.state;
  return a.position == b.position && a.velocity == b.velocity && a.target == b.target &&
         a.position_reached == b.position_reached && one.velocity_pps == other.velocity_pps &&
         one.user == other.user;
}

}  // namespace

AxisStanding::AxisStanding(const GatewayAxis& axis)
    : is_latched(axis.latched().has_value()),
      is_referenced(axis.is_referenced()),
      stop_cause(axis.stop_cause()),
      last_stop(axis.last_stop()),
      is_unattended(axis.is_unattended()),
      unrestored(unrestored_of(axis)),
      faults(axis.faults()) {
  auto holder = axis.holder();
  lease = holder.lease;
  owner = std::move(holder.name);
}

AxisWatch::~AxisWatch() {
  if (poller_) poller_->remove(id_);
}

void AxisWatch::sample(std::vector<std::uint8_t> parameters) {
  poller_->watchers_.at(id_).parameters = std::move(parameters);
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

PublishedReading AxisPoller::number(const GatewayAxis& axis, const AxisReading& reading,
                                    const std::vector<ParameterSample>& samples) {
  for (const auto& sample : samples) keep(sample);
  PublishedReading now{reading, AxisStanding(axis), last_seq_, samples_};
  if (!last_ || !is_same(last_->reading, reading) || last_->standing != now.standing)
    now.seq = ++last_seq_;
  last_ = now;
  return now;
}

std::map<std::uint8_t, tmcl::Duration> AxisPoller::parameters() const {
  std::map<std::uint8_t, tmcl::Duration> all;
  for (const auto& [id, watcher] : watchers_) {
    for (const auto parameter : watcher.parameters) {
      const auto [known, is_new] = all.emplace(parameter, watcher.interval);
      if (!is_new) known->second = std::min(known->second, watcher.interval);
    }
  }
  return all;
}

bool AxisPoller::is_due(std::uint8_t parameter, tmcl::Duration interval) const {
  const auto read = std::ranges::find(samples_, parameter, &ParameterSample::parameter);
  // As late in its own turn as it may be read.
  return read == samples_.end() || clock_.now() - read->taken >= interval / parts_of_interval;
}

void AxisPoller::keep(const ParameterSample& sample) {
  const auto before = std::ranges::find(samples_, sample.parameter, &ParameterSample::parameter);
  if (before == samples_.end()) {
    samples_.push_back(sample);
  } else {
    *before = sample;
  }
}

boost::asio::awaitable<void> AxisPoller::sample(GatewayAxis& axis, tmcl::Duration interval) {
  const auto all = parameters();
  std::erase_if(samples_, [&](const auto& sample) { return !all.contains(sample.parameter); });
  const auto share = axis.bus().has_paths() ? tmcl::Duration{} : interval / parts_of_interval;
  const auto until = clock_.now() + share;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto place = static_cast<std::ptrdiff_t>(turn_++ % all.size());
    const auto& [parameter, wanted_every] = *std::next(all.begin(), place);
    if (!is_due(parameter, wanted_every)) continue;
    const auto read = co_await axis.sample(parameter);
    if (read) keep(*read);
    if (!read || clock_.now() >= until) break;
  }
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
    co_await self->sample(*axis, interval);
    const auto reading = co_await axis->read_state();
    // Silence is told once, as an event of the module.
    if (reading) self->tell(self->number(*axis, *reading), tick);
  }
  self->running_ = false;
}

}  // namespace tmcld
