// Why an axis stands, and what its driver reports: see the header.
#include <algorithm>
#include <functional>
#include <string_view>
#include <utility>

#include "gateway/axis/axis.hpp"
#include "gateway/axis/stop_advice.hpp"
#include "gateway/standing_stop.hpp"
#include "tmcl/status_flags.hpp"

namespace tmcld {

using tmcl::Microsteps;

std::optional<StopCause> GatewayAxis::stop_cause() const {
  return latched() ? StopCause::supply : stop_cause_;
}

void GatewayAxis::note_stop(StopCause cause) {
  was_moving_ = false;
  if (!stop_cause_) stop_cause_ = cause;
}

boost::asio::awaitable<void> GatewayAxis::note_motion(tmcl::AxisState state, std::uint64_t client) {
  const bool moves = state.velocity.value != 0;
  const bool is_stopped = !bus().motors().may_move(address());
  if ((moves && !is_stopped) || state.position == state.target) stop_cause_.reset();
  // Who leads it knows why it stands; and between two directions it does so for a moment.
  const bool stopped = was_moving_ && !moves && state.position != state.target &&
                       claim_kind() == ClaimKind::none && !latched();
  was_moving_ = moves;
  if (moves) seen_moving_ = bus().clock().now();
  if (!stopped) co_return;
  if (is_stopped) co_return note_stop(StopCause::client);
  const auto here = state.position;
  auto again = co_await axis_.run(tmcl::verbs::state(address()), asked_by(client));
  const bool stands = again && again->velocity.value == 0 && again->position == here;
  if (stands && !stop_cause_) co_await find_cause(client);
}

tmcl::Script<tmcl::Result<DriverReading>> GatewayAxis::read_driver(
    std::optional<tmcl::InternalVelocity> velocity) {
  const auto units = co_await units_.module_units();
  auto script = tmcld::read_driver(address(), parameters(), units.value_or(std::nullopt), velocity);
  auto reading = co_await std::move(script);
  co_return reading;
}

GatewayAxis::Awaitable<void> GatewayAxis::look_at_driver(
    tmcl::Duration max_age, RunOptions options, std::optional<tmcl::InternalVelocity> velocity) {
  if (is_driver_known(max_age)) co_return tmcl::Result<void>{};
  auto seen = co_await axis_.run(read_driver(velocity), std::move(options));
  if (!seen) co_return tl::unexpected(std::move(seen.error()));
  note_driver(std::move(*seen));
  co_return tmcl::Result<void>{};
}

bool GatewayAxis::is_driver_known(tmcl::Duration max_age) const {
  return driver_seen_ && bus().clock().now() - *driver_seen_ < max_age;
}

namespace {

/// Pauses until then, and looks each time that a look is due.
tmcl::Script<tmcl::Result<void>> pause_and_look(
    tmcl::TimePoint end, std::function<tmcl::Script<tmcl::Result<void>>()> look) {
  auto left = tmcl::Duration{};
  do {
    co_await look();
    left = std::max(end - co_await tmcl::current_time(), tmcl::Duration{});
    co_await tmcl::pause(std::min(left, driver_look_interval));
  } while (left > driver_look_interval);
  co_return tmcl::Result<void>{};
}

}  // namespace

/// Carries out a wait, and looks at the driver while that pauses: an open load is told only while
/// the axis turns.
tmcl::Script<tmcl::Result<Microsteps>> GatewayAxis::look_at_driver_meanwhile(
    std::shared_ptr<GatewayAxis> self, tmcl::Script<tmcl::Result<Microsteps>> wait) {
  const auto look = [self]() -> tmcl::Script<tmcl::Result<void>> {
    if (self->is_driver_known(driver_look_interval) || self->bus().has_paths())
      co_return tmcl::Result<void>{};
    auto seen = co_await self->read_driver();
    if (seen) self->note_driver(std::move(*seen));
    co_return tmcl::Result<void>{};
  };
  auto now = co_await tmcl::current_time();
  auto step = wait.start(now);
  while (step) {
    tmcl::StepResult results;
    if (const auto* pause = std::get_if<tmcl::step::Pause>(&*step)) {
      co_await pause_and_look(now + pause->duration, look);
    } else if (auto* one = std::get_if<tmcl::step::Exchange>(&*step)) {
      results.push_back(co_await tmcl::exchange(one->request, one->options));
    } else {
      auto& all = std::get<tmcl::step::ExchangeAll>(*step).exchanges;
      results = co_await tmcl::exchange_all(std::move(all));
    }
    now = co_await tmcl::current_time();
    step = wait.resume(std::move(results), now);
  }
  co_return wait.take();
}

void GatewayAxis::note_driver(DriverReading reading) {
  driver_seen_ = bus().clock().now();
  supply_volts_ = reading.supply_volts;
  auto faults = open_loads_.judge(std::move(reading));
  if (std::exchange(faults_, std::move(faults)) == faults_) return;
  const auto text = faults_.empty()
                        ? "the driver of axis '" + name() + "' reports no fault any more"
                        : "axis '" + name() + "': " + words_for(faults_);
  bus().emit(event_of(*this, GatewayEvent::Kind::axis_fault, text));
}

GatewayAxis::Awaitable<FaultReport> GatewayAxis::read_faults(std::uint64_t client) {
  auto ready = co_await be_ready();
  if (!ready) co_return tl::unexpected(std::move(ready.error()));
  auto report = co_await axis_.run(tmcld::read_faults(address(), parameters()), asked_by(client));
  if (!report) co_return report;
  DriverReading reading{report->driver_faults()};
  reading.supply_volts = report->supply_volts;
  if (std::ranges::any_of(reading.faults, is_open_load)) {
    const auto units = co_await axis_.run(units_.module_units(), asked_by(client));
    auto script = turns_slowly(address(), parameters(), units.value_or(std::nullopt));
    const auto slow = co_await axis_.run(std::move(script), asked_by(client));
    reading.turns_slowly = slow.value_or(false);
  }
  note_driver(std::move(reading));
  std::erase_if(report->flags, [this](std::string_view flag) {
    return std::ranges::count(unproven_faults(), flag) != 0;
  });
  if (report->has_flag(tmcl::status_flag::stall)) stop_cause_ = StopCause::stall;
  if (report->has_flag(tmcl::status_flag::deviation)) stop_cause_ = StopCause::deviation;
  co_return report;
}

boost::asio::awaitable<void> GatewayAxis::find_cause(std::uint64_t client) {
  auto cause = co_await axis_.run(find_stop_cause(address(), parameters()), asked_by(client));
  if (!cause || stop_cause_) co_return;
  // Nothing else is to blame, and its module was left alone for too long since it was seen moving.
  const bool says_nothing = *cause == StopCause::unknown || *cause == StopCause::velocity_mode;
  if (says_nothing && module().deadman().last_gap() > seen_moving_) cause = StopCause::deadman;
  stop_cause_ = *cause;
  auto event =
      event_of(*this, GatewayEvent::Kind::axis_stopped,
               "axis '" + name() + "' stands short of its target, and no stop is known; cause: " +
                   std::string(name_of(*cause)));
  event.cause = name_of(*cause);
  bus().emit(std::move(event));
}

boost::asio::awaitable<void> GatewayAxis::add_cause(tmcl::Error& error, std::uint64_t client) {
  if (!stop_cause_) co_await find_cause(client);
  if (!stop_cause_) co_return;
  error.message += "; cause: " + std::string(name_of(*stop_cause_));
  const auto advice = advice_on(name_of(*stop_cause_));
  if (advice.empty()) co_return;
  // What its settings make of its moves is said as well.
  const bool says_more = error.hint.starts_with(hint_of_settings);
  error.hint = std::string(advice) + (says_more ? "; " + error.hint : "");
}

}  // namespace tmcld
