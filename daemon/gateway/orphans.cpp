#include "gateway/orphans.hpp"

#include <chrono>
#include <utility>

#include "async/rest.hpp"
#include "async/spawn.hpp"
#include "gateway/standing_stop.hpp"
#include "tmcl/parameter_number.hpp"

namespace tmcld {
namespace {

using boost::asio::awaitable;
using std::chrono::milliseconds;

constexpr tmcl::Duration pause = std::chrono::milliseconds(200);
constexpr std::string_view unattended = "unattended";

std::int64_t utc_ms(const GatewayAxis& axis, tmcl::TimePoint time) {
  const auto utc = axis.bus().clock().utc_of(time);
  return std::chrono::floor<milliseconds>(utc.time_since_epoch()).count();
}

Sentinel::Reading reading_of(const Holding::Seen& seen) {
  return {seen.value, tmcl::TimePoint(milliseconds(seen.asked_ms)),
          tmcl::TimePoint(milliseconds(seen.answered_ms))};
}

/// Where that cannot be known, it has not.
bool has_restarted_since(const GatewayAxis& axis, const std::optional<Holding::Seen>& before) {
  const auto now = last_seen(axis);
  if (!before || !now) return false;
  auto sentinel = axis.module().sentinel();
  sentinel.forget();
  sentinel.take(reading_of(*before));
  return sentinel.take(reading_of(*now)) == Sentinel::Verdict::restarted;
}

/// Until the module answers; false if the gateway ends before.
awaitable<bool> meet(GatewayAxis& axis) {
  while (!axis.bus().is_closed()) {
    const auto ready = co_await axis.be_ready();
    if (ready) co_return true;
    co_await rest(pause);
  }
  co_return false;
}

/// In the reverse of the order in which they were changed. Gives what became of it, in words.
awaitable<std::string> set_all_back(GatewayAxis& axis, const Holding& holding) {
  if (holding.before.empty()) co_return "no setting had been changed";
  std::string told;
  for (auto setting = holding.before.rbegin(); setting != holding.before.rend(); ++setting) {
    const bool is_back = co_await set_back(axis, *setting);
    const auto* row = find_parameter(axis.parameters(), setting->parameter);
    told += told.empty() ? "" : ", ";
    told +=
        row != nullptr ? std::string(row->name) : "parameter " + std::to_string(setting->parameter);
    told += is_back ? " is set back to " : " could not be set back to ";
    told += std::to_string(setting->value);
  }
  co_return told;
}

awaitable<void> find_turning(std::shared_ptr<GatewayAxis> axis, Holding holding) {
  if (!co_await meet(*axis)) co_return;
  const auto velocity = co_await axis->get(tmcl::axis_parameter::actual_velocity, {});
  const bool stands = velocity && *velocity == 0;
  auto& motors = axis->bus().motors();
  if (axis->is_unattended() && (stands || has_restarted_since(*axis, holding.seen)))
    motors.end_turning(axis->address(), motors.turning_of(axis->address()).number);
}

awaitable<void> put_in_order(std::shared_ptr<GatewayAxis> axis, Claim claim, Holding holding) {
  // Not the parameter: it may be destroyed after the axis.
  const Claim held = std::move(claim);
  co_await be_stopped(*axis);
  if (!co_await meet(*axis)) co_return;
  auto text = "axis '" + axis->name() + "' was stopped: tmcld had ended without being asked to " +
              "while it had to do with it (" + holding.why + "); ";
  if (has_restarted_since(*axis, holding.seen)) {
    const auto module = axis->address().module;
    axis->bus().motors().latch(module, "module " + std::to_string(number(module)) +
                                           " has started again while tmcld was not there");
    text += "its module has started again since, so no setting is set back";
  } else {
    auto told = co_await set_all_back(*axis, holding);
    text += told;
  }
  axis->forget_before();
  axis->bus().emit(event_of(*axis, GatewayEvent::Kind::orphan_stopped, std::move(text)));
}

}  // namespace

awaitable<bool> set_back(GatewayAxis& axis, tmcl::plan::Setting setting) {
  while (!axis.bus().is_closed()) {
    RunOptions options;
    // It was so before.
    options.permit.exceeds_limits = true;
    auto script = tmcl::verbs::set(axis.address(), setting.parameter, setting.value);
    const auto written = co_await axis.perform(std::move(script), std::move(options));
    axis.module().note_settings_changed();
    if (written || written.error().outcome == tmcl::Outcome::refused) co_return written.has_value();
    co_await rest(pause);
  }
  co_return false;
}

void take_over(const std::shared_ptr<GatewayAxis>& axis, Holding holding) {
  const auto& executor = axis->bus().executor();
  if (holding.why == unattended) {
    axis->bus().motors().note_unattended(axis->address());
    return spawn(executor, find_turning(axis, std::move(holding)));
  }
  if (axis->mover() != Mover::nobody) return;
  for (const auto& setting : holding.before) axis->note_before(setting);
  spawn(executor, put_in_order(axis, axis->claim({Mover::stop}), std::move(holding)));
}

std::optional<Holding::Seen> last_seen(const GatewayAxis& axis) {
  const auto& last = axis.module().sentinel().last();
  if (!last) return std::nullopt;
  return Holding::Seen{last->value, utc_ms(axis, last->asked), utc_ms(axis, last->answered)};
}

}  // namespace tmcld
