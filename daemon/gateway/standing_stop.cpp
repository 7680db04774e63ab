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
// Before a module that does not answer is asked again.
constexpr tmcl::Duration time_to_answer = 200ms;

/// Errors: those of the stop.
GatewayAxis::Awaitable<bool> stop_and_look(GatewayAxis& axis) {
  const auto stopped = co_await axis.stop_without_revoking();
  if (!stopped) co_return tl::unexpected(stopped.error());
  const auto velocity = co_await axis.get(tmcl::axis_parameter::actual_velocity, {});
  const bool stands = velocity && *velocity == 0;
  co_return stands;
}

std::string name_of_parameter(const GatewayAxis& axis, std::uint8_t number) {
  const auto* row = find_parameter(axis.parameters(), number);
  return row != nullptr ? std::string(row->name) : "parameter " + std::to_string(number);
}

/// Gives what became of its settings, in words; empty if none had been changed.
boost::asio::awaitable<std::string> restore(GatewayAxis& axis, std::uint64_t latches) {
  if (axis.before().empty() || !co_await meet(axis)) co_return "";
  const bool has_restarted = axis.bus().motors().latches(axis.address()) != latches;
  std::string told = "its module has started again, so no setting is set back";
  if (!has_restarted) {
    auto settings = co_await set_all_back(axis);
    told = std::move(settings);
  }
  axis.forget_before();
  co_return "; " + told;
}

boost::asio::awaitable<void> insist(std::shared_ptr<GatewayAxis> axis, Claim claim) {
  // Not the parameter: it may be destroyed after the axis.
  const Claim held = std::move(claim);
  const auto latches = axis->bus().motors().latches(axis->address());
  co_await be_stopped(*axis);
  auto settings = co_await restore(*axis, latches);
  if (axis->bus().is_closed()) co_return;
  auto event = event_of(*axis, GatewayEvent::Kind::axis_stopped,
                        "axis '" + axis->name() + "' stands now" + settings);
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

boost::asio::awaitable<bool> meet(GatewayAxis& axis) {
  while (!axis.bus().is_closed()) {
    const auto ready = co_await axis.be_ready();
    if (ready) co_return true;
    co_await rest(time_to_answer);
  }
  co_return false;
}

boost::asio::awaitable<std::string> set_all_back(GatewayAxis& axis) {
  if (axis.before().empty()) co_return "no setting had been changed";
  std::string told;
  while (!axis.before().empty()) {
    const auto setting = axis.before().back();
    const auto is_back = co_await set_back(axis, setting.parameter);
    // If the gateway ends, the next run does it.
    if (axis.bus().is_closed()) break;
    axis.forget_before(setting.parameter);
    const auto value = std::to_string(setting.value);
    told += (told.empty() ? "" : ", ") + name_of_parameter(axis, setting.parameter);
    told += !is_back   ? " was set by a client"
            : *is_back ? " is set back to " + value
                       : " could not be set back to " + value;
  }
  co_return told;
}

boost::asio::awaitable<std::optional<bool>> set_back(GatewayAxis& axis, std::uint8_t parameter) {
  while (!axis.bus().is_closed()) {
    const auto value = axis.before(parameter);
    if (!value) co_return std::nullopt;
    RunOptions options;
    // It was so before.
    options.permit.exceeds_limits = true;
    auto script = tmcl::verbs::set(axis.address(), parameter, *value);
    const auto written = co_await axis.perform(std::move(script), std::move(options));
    axis.module().note_settings_changed();
    if (written || written.error().outcome == tmcl::Outcome::refused) co_return written.has_value();
    co_await rest(time_to_answer);
  }
  co_return false;
}

void stop_until_it_stands(const std::shared_ptr<GatewayAxis>& axis) {
  if (axis->claim_kind() == ClaimKind::stop) return;
  axis->revoke_movements();
  auto claim = axis->claim({ClaimKind::stop});
  const auto why =
      axis->before().empty()
          ? not_stopped(axis->name()) + ": it is stopped until it stands"
          : "axis '" + axis->name() + "' is stopped until it stands, and its settings are set back";
  axis->bus().log(LogLevel::warning, axis->bus().name() + ": " + why);
  spawn(axis->bus().executor(), insist(axis, std::move(claim)));
}

std::string not_stopped(const std::string& axis) {
  return "axis '" + axis + "' could not be stopped and may still move";
}

std::vector<UnrestoredSetting> unrestored_of(const GatewayAxis& axis) {
  std::vector<UnrestoredSetting> all;
  for (const auto& [number, value] : axis.unrestored())
    all.push_back({name_of_parameter(axis, number), number, value});
  return all;
}

GatewayEvent event_of(const GatewayAxis& axis, GatewayEvent::Kind kind, std::string text) {
  const auto address = axis.address();
  return {kind, axis.bus().name(), number(address.module), 1 << address.motor, std::move(text)};
}

}  // namespace tmcld
