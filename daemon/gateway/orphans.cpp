#include "gateway/orphans.hpp"

#include <chrono>
#include <utility>

#include "async/rest.hpp"
#include "async/spawn.hpp"
#include "gateway/gateway.hpp"
#include "gateway/standing_stop.hpp"
#include "tmcl/mechanics.hpp"
#include "tmcl/parameter_number.hpp"

namespace tmcld {
namespace {

using boost::asio::awaitable;
using std::chrono::milliseconds;

// Before a module that does not answer is asked again.
constexpr tmcl::Duration pause = milliseconds(200);
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
    auto told = co_await set_all_back(*axis);
    text += told;
  }
  axis->forget_before();
  axis->bus().emit(event_of(*axis, GatewayEvent::Kind::orphan_stopped, std::move(text)));
}

// ---- where the journal cannot be read ----------------------------------------------------------

/// Errors: those of the readings.
GatewayAxis::Awaitable<bool> turns_by_velocity(GatewayAxis& axis) {
  const auto velocity = co_await axis.get(tmcl::axis_parameter::actual_velocity, {});
  if (!velocity) co_return tl::unexpected(velocity.error());
  const auto mode = tmcl::mode_parameter(axis.parameters());
  if (*velocity == 0 || !mode) co_return *velocity != 0;
  const auto now = co_await axis.get(mode->number, {});
  if (!now) co_return tl::unexpected(now.error());
  co_return may_turn_in(*mode, *now);
}

awaitable<void> stop_if_it_turns(std::shared_ptr<GatewayAxis> axis, Claim claim) {
  // Not the parameter: it may be destroyed after the axis.
  const Claim held = std::move(claim);
  while (!axis->bus().is_closed()) {
    const auto turns = co_await turns_by_velocity(*axis);
    const bool refuses = !turns && turns.error().outcome == tmcl::Outcome::refused;
    if (refuses || (turns && !*turns)) co_return;
    if (turns) break;
    co_await rest(pause);
  }
  co_await be_stopped(*axis);
  if (axis->bus().is_closed()) co_return;
  axis->bus().emit(
      event_of(*axis, GatewayEvent::Kind::orphan_stopped,
               "axis '" + axis->name() +
                   "' was stopped: it turned when tmcld started, and what another run "
                   "of tmcld had left could not be read; its settings may be changed"));
}

void look_at(const std::shared_ptr<GatewayAxis>& axis) {
  if (axis->claim_kind() != ClaimKind::none) return;
  spawn(axis->bus().executor(), stop_if_it_turns(axis, axis->claim({ClaimKind::stop})));
}

/// Motors of a module that no axis is configured for.
awaitable<void> look_at_others(std::shared_ptr<Gateway> gateway, std::shared_ptr<GatewayBus> bus,
                               GatewayModule& module) {
  auto ready = co_await module.be_ready();
  while (!ready && !bus->is_closed()) {
    co_await rest(pause);
    ready = co_await module.be_ready();
  }
  const auto* model = module.model();
  for (std::uint8_t motor = 0; model != nullptr && motor < model->axes; ++motor) {
    const tmcl::AxisAddress address{module.address(), motor};
    if (bus->motors().may_move(address) || gateway->find_axis(*bus, address)) continue;
    if (const auto axis = gateway->add_axis(bus, address)) look_at(axis);
  }
}

}  // namespace

void stop_what_turns(const std::shared_ptr<Gateway>& gateway,
                     const std::shared_ptr<GatewayBus>& bus) {
  for (const auto& axis : gateway->axes())
    if (&axis->bus() == bus.get()) look_at(axis);
  for (const auto& [address, module] : bus->modules())
    spawn(bus->executor(), look_at_others(gateway, bus, *module));
}

void take_over(const std::shared_ptr<GatewayAxis>& axis, Holding holding) {
  const auto& executor = axis->bus().executor();
  if (holding.why == unattended) {
    axis->bus().motors().note_unattended(axis->address());
    return spawn(executor, find_turning(axis, std::move(holding)));
  }
  if (axis->claim_kind() != ClaimKind::none) return;
  for (const auto& setting : holding.before) axis->note_before(setting);
  spawn(executor, put_in_order(axis, axis->claim({ClaimKind::stop}), std::move(holding)));
}

std::optional<Holding::Seen> last_seen(const GatewayAxis& axis) {
  const auto& last = axis.module().sentinel().last();
  if (!last) return std::nullopt;
  return Holding::Seen{last->value, utc_ms(axis, last->asked), utc_ms(axis, last->answered)};
}

}  // namespace tmcld
