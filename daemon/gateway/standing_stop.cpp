#include "gateway/standing_stop.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "async/rest.hpp"
#include "async/spawn.hpp"
#include "tmcl/parameter.hpp"

namespace tmcld {
namespace {

using namespace std::chrono_literals;

// While the module answers, or its link is gone: neither costs others much.
constexpr tmcl::Duration shortest_pause = 50ms;
// A stop to a module that does not answer keeps a serial line busy for some 300 ms.
constexpr tmcl::Duration longest_pause = 500ms;

/// Errors: those of the stop.
GatewayAxis::Awaitable<bool> stop_and_look(GatewayAxis& axis) {
  const auto stopped = co_await axis.brake();
  if (!stopped) co_return tl::unexpected(stopped.error());
  const auto velocity = co_await axis.get(tmcl::axis_parameter::actual_velocity, {});
  const bool stands = velocity && *velocity == 0;
  co_return stands;
}

boost::asio::awaitable<void> insist(std::shared_ptr<GatewayAxis> axis, Claim claim) {
  // Not the parameter: it may be destroyed after the axis.
  const Claim held = std::move(claim);
  co_await be_stopped(*axis);
  if (axis->bus().is_closed()) co_return;
  auto event =
      event_of(*axis, GatewayEvent::Kind::axis_stopped, "axis '" + axis->name() + "' stands now");
  event.cause = name_of(axis->stop_cause().value_or(StopCause::daemon));
  axis->bus().emit(std::move(event));
}

}  // namespace

boost::asio::awaitable<void> be_stopped(GatewayAxis& axis) {
  auto pause = shortest_pause;
  while (!axis.bus().is_closed()) {
    const auto stands = co_await stop_and_look(axis);
    if (stands && *stands) co_return;
    const bool is_cheap = stands || stands.error().code == tmcl::Errc::link_lost;
    pause = is_cheap ? shortest_pause : std::min(2 * pause, longest_pause);
    co_await rest(pause);
  }
}

void stop_until_it_stands(const std::shared_ptr<GatewayAxis>& axis) {
  if (axis->mover() == Mover::stop) return;
  axis->revoke_movements();
  auto claim = axis->claim({Mover::stop});
  axis->bus().log(LogLevel::warning, axis->bus().name() + ": " + not_stopped(axis->name()) +
                                         ": it is stopped until it stands");
  spawn(axis->bus().executor(), insist(axis, std::move(claim)));
}

std::string not_stopped(const std::string& axis) {
  return "axis '" + axis + "' could not be stopped and may still move";
}

GatewayEvent event_of(const GatewayAxis& axis, GatewayEvent::Kind kind, std::string text) {
  const auto address = axis.address();
  return {kind, axis.bus().name(), number(address.module), 1 << address.motor, std::move(text)};
}

}  // namespace tmcld
