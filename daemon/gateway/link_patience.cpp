#include "gateway/link_patience.hpp"

#include <utility>

#include "async/spawn.hpp"

namespace tmcld {
namespace {

boost::asio::awaitable<void> stop_late(std::shared_ptr<GatewayAxis> axis, GatewayEvent::Kind kind) {
  auto stopped = co_await axis->stop();
  while (!stopped && stopped.error().code == tmcl::Errc::link_lost) {
    co_await rest(link_look_interval);
    stopped = co_await axis->stop();
  }
  if (!stopped) co_return;
  axis->bus().emit(event_of(*axis, kind, "axis '" + axis->name() + "' could be stopped now"));
}

}  // namespace

GatewayEvent event_of(const GatewayAxis& axis, GatewayEvent::Kind kind, std::string text) {
  const auto address = axis.address();
  return {kind, axis.bus().name(), number(address.module), 1 << address.motor, std::move(text)};
}

std::string not_stopped(const std::string& axis) {
  return "axis '" + axis + "' could not be stopped and may still move";
}

void stop_as_soon_as_possible(std::shared_ptr<GatewayAxis> axis, GatewayEvent::Kind kind) {
  const auto executor = axis->bus().executor();
  spawn(executor, stop_late(std::move(axis), kind));
}

}  // namespace tmcld
