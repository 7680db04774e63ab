#include "gateway/ending.hpp"

#include <fmt/format.h>

#include "async/gather.hpp"
#include "async/rest.hpp"
#include "async/wait_until.hpp"
#include "gateway/standing_stop.hpp"

namespace tmcld {
namespace {

using boost::asio::awaitable;

constexpr tmcl::Duration standing_look_interval = std::chrono::milliseconds(20);

awaitable<void> end_journeys(Gateway& gateway) {
  if (!gateway.has_journeys()) co_return;
  gateway.end_journeys();
  co_await wait_until([&] { return !gateway.has_journeys(); }, time_to_stand);
  if (!gateway.has_journeys()) co_return;
  gateway.log(LogLevel::error,
              "ending, although an axis on a line or path did not come to rest in time");
}

/// What no call has set in motion is only asked first. False if it does not say in time that it
/// stands, or cannot.
awaitable<bool> comes_to_rest(std::shared_ptr<GatewayAxis> axis) {
  const auto& clock = axis->bus().clock();
  const auto limit = clock.now() + time_to_stand;
  bool stopped = !axis->bus().motors().may_move(axis->address());
  while (clock.now() < limit && axis->bus().state() == GatewayBus::State::open) {
    if (stopped) {
      const auto velocity = co_await axis->get(tmcl::axis_parameter::actual_velocity, limit);
      if (velocity && *velocity == 0) co_return true;
      co_await rest(standing_look_interval);
    }
    const auto answer = co_await axis->stop_without_revoking();
    stopped = answer.has_value();
    if (!stopped) co_await rest(standing_look_interval);
  }
  co_return false;
}

/// Who has not answered lately, and was sent nothing, is not waited for.
bool may_move(const GatewayAxis& axis) {
  return axis.module().state() == GatewayModule::State::ready ||
         axis.bus().motors().may_move(axis.address());
}

awaitable<void> bring_to_rest(const Gateway& gateway) {
  std::vector<std::shared_ptr<GatewayAxis>> axes;
  std::vector<awaitable<bool>> rests;
  for (const auto& axis : gateway.all_axes()) {
    if (!may_move(*axis)) continue;
    axes.push_back(axis);
    rests.push_back(comes_to_rest(axis));
  }
  const auto stand = co_await gather(std::move(rests));
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (!stand[i]) gateway.log(LogLevel::error, "ending, although " + not_stopped(axes[i]->name()));
  }
}

awaitable<void> wait_for_uploads(const Gateway& gateway) {
  const auto& uploads = gateway.uploads;
  if (uploads.empty()) co_return;
  gateway.log(
      LogLevel::warning,
      fmt::format("ending later, after the firmware upload to {}: waiting for that for {} s "
                  "at most",
                  fmt::join(uploads, ", "),
                  std::chrono::round<std::chrono::seconds>(time_for_uploads).count()));
  co_await wait_until([&] { return uploads.empty(); }, time_for_uploads);
  if (uploads.empty()) co_return;
  gateway.log(LogLevel::error,
              fmt::format("ending, although the firmware upload to {} is not complete: no firmware "
                          "runs there until it is uploaded again",
                          fmt::join(uploads, ", ")));
}

}  // namespace

awaitable<void> end_gateway(std::shared_ptr<Gateway> gateway) {
  gateway->refuse_new_calls();
  gateway->remove_all_clients();
  co_await end_journeys(*gateway);
  if (gateway->on_exit() == OnExit::stop) co_await bring_to_rest(*gateway);
  co_await wait_for_uploads(*gateway);
  co_await wait_until([&] { return gateway->stops_in_progress == 0; }, time_for_stops);
  co_await gateway->end_journal();
  gateway->close();
}

}  // namespace tmcld
