#include "io/sparkplug_link.hpp"

#include <chrono>
#include <utility>

#include "async/rest.hpp"
#include "async/spawn.hpp"
#include "log/log.hpp"

namespace tmclmqtt {

using boost::asio::awaitable;

namespace {

constexpr auto until_others_are_there = std::chrono::milliseconds(100);

}  // namespace

SparkplugLink::SparkplugLink(const boost::asio::any_io_executor& executor, BrokerOptions options,
                             ConnectToBroker connect, Sparkplug node,
                             std::function<bool()> may_connect,
                             std::function<void(std::string)> complain)
    : executor_(executor),
      clock_(executor),
      options_(std::move(options)),
      connect_(std::move(connect)),
      node_(std::move(node)),
      may_connect_(std::move(may_connect)),
      complain_(std::move(complain)) {}

void SparkplugLink::start() { tmcld::spawn(executor_, serve(shared_from_this())); }

void SparkplugLink::stop() {
  stopping_ = true;
  disconnect();
}

void SparkplugLink::hear(const boost::json::object& told) {
  node_.hear(told);
  flush();
}

void SparkplugLink::know(const std::string& daemon, const std::vector<ListedAxis>& axes) {
  node_.know(daemon, axes);
  flush();
}

void SparkplugLink::forget() {
  node_.forget();
  flush();
}

awaitable<void> SparkplugLink::serve(std::shared_ptr<SparkplugLink> self) {
  Pauses pauses;
  while (!self->stopping_) {
    if (!self->may_connect_()) {
      co_await tmcld::rest(until_others_are_there);
      continue;
    }
    const auto began = self->clock_.now();
    const auto why = co_await self->use_broker();
    if (self->stopping_) break;
    if (!why.empty()) self->complain_("Sparkplug: broker " + self->options_.host + ": " + why);
    co_await tmcld::rest(pauses.next(self->clock_.now() - began));
  }
}

awaitable<std::string> SparkplugLink::use_broker() {
  auto options = options_;
  options.will = node_.begin(utc());
  // A delayed one could be that of a connection before, or come after the next birth.
  options.will_delay_s = 0;
  options.will_at_end = true;
  auto on_message = [weak = weak_from_this()](const Message& message) {
    if (const auto self = weak.lock()) self->take(message);
  };
  auto on_room = [weak = weak_from_this()] {
    if (const auto self = weak.lock()) self->flush();
  };
  connecting_ = true;
  auto connecting = connect_(std::move(options), on_message, on_room);
  auto connected = co_await std::move(connecting);
  connecting_ = false;
  if (!connected) co_return connected.error();
  if (stopping_) {
    (*connected)->disconnect();
    co_return std::string();
  }
  broker_ = std::move(*connected);
  const auto broker = broker_;
  for (const auto& filter : node_.filters()) broker->subscribe({filter, 1});
  node_.connected();
  tmcld::log(tmcld::LogLevel::info, "Sparkplug: on broker " + options_.host);
  flush();
  auto why = co_await broker->end();
  if (!std::exchange(broker_, nullptr)) why.clear();
  node_.end();
  co_return why;
}

void SparkplugLink::take(const Message& message) {
  if (stopping_) return;
  node_.take(message);
  if (!node_.is_over()) return flush();
  complain_("Sparkplug: the host that births wait for is offline");
  disconnect();
}

void SparkplugLink::flush() {
  while (broker_ && broker_->has_room()) {
    const auto next = node_.next(clock_.now(), utc());
    if (!next) return;
    const auto sent = broker_->publish(*next);
    if (sent == Broker::Sent::yes) continue;
    // A sequence with a gap is worth nothing to hosts: begin anew.
    complain_("Sparkplug: the broker does not take what goes to " + next->topic);
    return disconnect();
  }
}

void SparkplugLink::disconnect() {
  const auto broker = std::exchange(broker_, nullptr);
  if (!broker) return;
  if (const auto farewell = node_.farewell(utc())) broker->publish(*farewell);
  broker->disconnect();
}

}  // namespace tmclmqtt
