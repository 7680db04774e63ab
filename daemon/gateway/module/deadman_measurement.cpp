#include "gateway/module/deadman_measurement.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>
#include <vector>

#include "async/rest.hpp"
#include "async/spawn.hpp"
#include "async/wait_until.hpp"
#include "gateway/authority/axis_limits.hpp"
#include "gateway/authority/claim.hpp"
#include "gateway/axis/axis_range.hpp"
#include "gateway/gateway.hpp"
#include "gateway/orphans.hpp"
#include "gateway/standing_stop.hpp"
#include "tmcl/seconds.hpp"

namespace tmcld {
namespace {

using namespace std::chrono_literals;
using boost::asio::awaitable;
using tmcl::Microsteps;
namespace ap = tmcl::axis_parameter;

constexpr int silences_per_deadman = 4;
constexpr double most_turns_per_second = 0.1;
constexpr double most_turns = 1;
// To come to its speed; the way is long enough for twice that.
constexpr tmcl::Duration time_to_speed_up = 1s;
constexpr tmcl::Duration measuring_interval = 20ms;
// Of its speed that it may be off: one in so many.
constexpr std::int32_t speed_tolerance = 100;
constexpr tmcl::Duration longest_braking = 10s;
// What an answer waits for the axis to stand: it is stopped all the same.
constexpr tmcl::Duration time_to_set_back = 2s;

tl::unexpected<tmcl::Error> failed(tmcl::Errc code, std::string message, std::string hint) {
  return tl::unexpected(tmcl::not_sent(code, std::move(message), std::move(hint)));
}

tmcl::Script<tmcl::Result<std::int32_t>> ask_held(tmcl::AxisAddress axis, std::uint8_t parameter,
                                                  std::shared_ptr<const tmcl::Hold> hold) {
  tmcl::CallOptions options;
  options.hold = std::move(hold);
  const auto answer = co_await must(
      tmcl::exchange({axis.module, tmcl::Command::GAP, parameter, axis.motor, 0}, options));
  co_return answer.reply.value;
}

tmcl::Script<tmcl::Result<std::int32_t>> ask_twice(tmcl::AxisAddress axis, std::uint8_t parameter) {
  tmcl::CallOptions options;
  options.proof = tmcl::Proof::twice;
  const auto answer = co_await must(
      tmcl::exchange({axis.module, tmcl::Command::GAP, parameter, axis.motor, 0}, options));
  co_return answer.reply.value;
}

/// Its module stops all of its motors, and a move of another one would be stopped with it.
tmcl::Script<tmcl::Result<void>> expect_standstill(tmcl::ModuleAddress module,
                                                   std::uint8_t motors) {
  for (std::uint8_t motor = 0; motor < motors; ++motor) {
    const auto velocity = co_await must(tmcl::verbs::get({module, motor}, ap::actual_velocity));
    if (velocity != 0)
      co_return failed(tmcl::Errc::axis_claimed,
                       "motor " + std::to_string(motor) + " of the module moves",
                       "a deadman stops all motors of its module: stop them first");
  }
  co_return tmcl::Result<void>{};
}

class Measurement {
 public:
  Measurement(std::shared_ptr<GatewayAxis> axis, Permit permit)
      : axis_(std::move(axis)), permit_(permit) {}

  GatewayAxis::Awaitable<DeadmanPlan> plan(std::int32_t set_ms);
  GatewayAxis::Awaitable<DeadmanFinding> carry_out(DeadmanPlan plan);
  /// What was set, if anything was.
  const std::optional<tmcl::plan::Setting>& before() const { return before_; }

 private:
  GatewayAxis::Awaitable<std::int32_t> slow_speed(double greatest_pps, tmcl::PulsesPerSecond unit);
  tmcl::Result<Microsteps> target_of(std::int32_t way, Microsteps from,
                                     const tmcl::UserScale& scale);
  GatewayAxis::Awaitable<void> set_out(DeadmanPlan plan);
  GatewayAxis::Awaitable<std::int32_t> be_silent(tmcl::Duration duration);
  GatewayAxis::Awaitable<DeadmanFinding> look(DeadmanPlan plan, std::int32_t heard_at);
  awaitable<double> braking_way(DeadmanPlan plan);
  std::optional<tmcl::Error> objection() const;
  GatewayAxis& axis() const { return *axis_; }

  std::shared_ptr<GatewayAxis> axis_;
  Permit permit_;
  std::optional<tmcl::plan::Setting> before_;
};

// ---- the plan -----------------------------------------------------------------------------------

GatewayAxis::Awaitable<std::int32_t> Measurement::slow_speed(double greatest_pps,
                                                             tmcl::PulsesPerSecond unit) {
  auto set = co_await axis().get(ap::max_velocity, {});
  if (!set) co_return set;
  auto slow = std::min(*set, static_cast<std::int32_t>(greatest_pps / unit.value));
  if (const auto limits = axis().motion_limits()) {
    const auto greatest = co_await axis().perform(limits->greatest(), {});
    if (!greatest) co_return tl::unexpected(greatest.error());
    slow = std::min(slow, greatest->velocity.value_or(slow));
  }
  if (*set > 0) co_return std::max(slow, 1);
  co_return failed(tmcl::Errc::bad_argument, "axis '" + axis().name() + "' has a speed of 0",
                   "set its max_velocity first");
}

tmcl::Result<Microsteps> Measurement::target_of(std::int32_t way, Microsteps from,
                                                const tmcl::UserScale& scale) {
  const auto bounds = range_of(axis(), scale);
  const auto above = bounds.greatest - std::int64_t{from.value};
  const auto below = from.value - std::int64_t{bounds.least};
  if (std::max(above, below) < way) {
    return failed(tmcl::Errc::beyond_soft_limit,
                  "axis '" + axis().name() + "' may have to go " + std::to_string(way) +
                      " microsteps, and has " + std::to_string(std::max(above, below)) +
                      " at most to where it may not go",
                  "a shorter deadman needs less way");
  }
  return Microsteps{above >= way ? from.value + way : from.value - way};
}

GatewayAxis::Awaitable<DeadmanPlan> Measurement::plan(std::int32_t set_ms) {
  const auto units = co_await axis().module_units();
  if (!units) co_return tl::unexpected(units.error());
  const auto scale = co_await axis().scale();
  if (!scale) co_return tl::unexpected(scale.error());
  if (!*units || !*scale)
    co_return failed(tmcl::Errc::bad_argument, "what the module counts speeds in is not known", {});
  DeadmanPlan plan{set_ms};
  plan.silence = silences_per_deadman * std::chrono::milliseconds(set_ms);
  const auto seconds = tmcl::seconds(plan.silence + 2 * time_to_speed_up);
  const auto turn = static_cast<double>((*scale)->steps.per_revolution());
  const auto speed = co_await slow_speed(
      turn * std::min(most_turns_per_second, most_turns / seconds), (*units)->velocity);
  if (!speed) co_return tl::unexpected(speed.error());
  plan.speed = {ap::max_velocity, *speed};
  plan.pps = *speed * (*units)->velocity.value;
  const auto here = co_await axis().perform(ask_twice(axis().address(), ap::actual_position), {});
  if (!here) co_return tl::unexpected(here.error());
  plan.from = {*here};
  const auto way = static_cast<std::int32_t>(std::ceil(plan.pps * seconds));
  const auto target = target_of(way, plan.from, **scale);
  if (!target) co_return tl::unexpected(target.error());
  plan.target = *target;
  co_return plan;
}

// ---- the movement -------------------------------------------------------------------------------

std::optional<tmcl::Error> Measurement::objection() const {
  const auto& motors = axis().bus().motors();
  return motors.objection(axis().address(), permit_, axis().bus().clock().now());
}

GatewayAxis::Awaitable<void> Measurement::set_out(DeadmanPlan plan) {
  const auto speed = co_await axis().get(ap::max_velocity, {});
  if (!speed) co_return tl::unexpected(speed.error());
  before_ = {ap::max_velocity, *speed};
  axis().note_before(*before_);
  co_await axis().enter_journal();
  auto set =
      co_await axis().set(ap::max_velocity, plan.speed.value, axis().begin_movement(permit_, {}));
  if (!set) co_return set;
  const auto moves =
      co_await axis().move_to({plan.target}, false, axis().begin_movement(permit_, {}));
  if (!moves) co_return tl::unexpected(moves.error());
  const auto tolerance = std::max(plan.speed.value / speed_tolerance, 1);
  const auto limit = axis().bus().clock().now() + time_to_speed_up;
  while (axis().bus().clock().now() < limit) {
    const auto velocity = co_await axis().get(ap::actual_velocity, {});
    if (!velocity) co_return tl::unexpected(velocity.error());
    if (std::abs(std::abs(*velocity) - plan.speed.value) <= tolerance)
      co_return tmcl::Result<void>{};
    if (auto ended = objection()) co_return tl::unexpected(std::move(*ended));
    co_await rest(measuring_interval);
  }
  co_return failed(tmcl::Errc::move_interrupted,
                   "axis '" + axis().name() + "' does not come to the speed of the test",
                   "see its switches, its acceleration, and whether it is free to move");
}

/// Gives where it was when its module heard the last command.
GatewayAxis::Awaitable<std::int32_t> Measurement::be_silent(tmcl::Duration duration) {
  const auto hold = std::make_shared<const tmcl::Hold>();
  auto script = ask_held(axis().address(), ap::actual_position, hold);
  auto heard_at = co_await axis().perform(std::move(script), {});
  if (!heard_at) co_return heard_at;
  const auto until = axis().bus().clock().now() + duration;
  while (axis().bus().clock().now() < until) {
    if (auto ended = objection()) co_return tl::unexpected(std::move(*ended));
    if (axis().bus().state() != GatewayBus::State::open)
      co_return failed(tmcl::Errc::link_lost, "the link was lost during the test", {});
    co_await rest(std::min(measuring_interval, until - axis().bus().clock().now()));
  }
  co_return heard_at;
}

/// From when it begins to stop; 0 where its generator is not known: then it is taken for short.
awaitable<double> Measurement::braking_way(DeadmanPlan plan) {
  auto twin = co_await axis().twin({});
  if (!twin || !*twin) co_return 0;
  (*twin)->place({}, {plan.speed.value});
  const auto begin = (*twin)->motion().position.value;
  (*twin)->stop();
  for (auto braked = tmcl::Duration(0); braked < longest_braking; braked += measuring_interval) {
    if ((*twin)->motion().velocity.value == 0) break;
    (*twin)->advance(measuring_interval);
  }
  co_return (*twin)->motion().position.value - begin;
}

GatewayAxis::Awaitable<DeadmanFinding> Measurement::look(DeadmanPlan plan, std::int32_t heard_at) {
  auto& module = axis().module();
  const auto watched = co_await axis().perform(module.watch(movement_sentinel_age), {});
  if (!watched) co_return tl::unexpected(watched.error());
  if (auto ended = objection()) co_return tl::unexpected(std::move(*ended));
  const auto velocity =
      co_await axis().perform(ask_twice(axis().address(), ap::actual_velocity), {});
  if (!velocity) co_return tl::unexpected(velocity.error());
  const auto here = co_await axis().perform(ask_twice(axis().address(), ap::actual_position), {});
  if (!here) co_return tl::unexpected(here.error());
  DeadmanFinding finding{plan.set_ms};
  finding.way = {static_cast<std::int32_t>(std::abs(std::int64_t{*here} - plan.from.value))};
  if (*velocity != 0) {
    finding.reason = "the motor went on for " +
                     std::to_string(plan.silence / std::chrono::milliseconds(1)) +
                     " ms without a command";
    co_return finding;
  }
  const auto cause =
      co_await axis().perform(find_stop_cause(axis().address(), axis().parameters()), {});
  if (!cause) co_return tl::unexpected(cause.error());
  if (*cause != StopCause::unknown && *cause != StopCause::velocity_mode)
    co_return failed(tmcl::Errc::move_interrupted,
                     "axis '" + axis().name() +
                         "' was stopped by something else: " + std::string(name_of(*cause)),
                     "see to that, and test again");
  const auto braking = co_await braking_way(plan);
  const auto way = static_cast<double>(std::abs(std::int64_t{*here} - heard_at)) - braking;
  constexpr double milliseconds = 1000;
  const auto ms = std::llround(way / plan.pps * milliseconds);
  finding.stops_after_ms = static_cast<std::int32_t>(std::max(ms, 1LL));
  co_return finding;
}

GatewayAxis::Awaitable<DeadmanFinding> Measurement::carry_out(DeadmanPlan plan) {
  const auto moves = co_await set_out(plan);
  if (!moves) co_return tl::unexpected(moves.error());
  const auto heard_at = co_await be_silent(plan.silence);
  if (!heard_at) co_return tl::unexpected(heard_at.error());
  auto finding = co_await look(plan, *heard_at);
  co_return finding;
}

// ---- who else has to do with the module ---------------------------------------------------------

using Axes = std::vector<std::shared_ptr<GatewayAxis>>;

/// How many it has, as far as that is known.
std::uint8_t motors_of(const GatewayAxis& axis) {
  const auto* model = axis.module().model();
  return model != nullptr ? model->axes : static_cast<std::uint8_t>(axis.address().motor + 1);
}

Axes axes_of_module(const Gateway& gateway, const GatewayAxis& axis) {
  Axes axes;
  for (const auto& one : gateway.all_axes()) {
    const bool exists = one->address().motor < motors_of(axis);
    if (exists && &one->module() == &axis.module()) axes.push_back(one);
  }
  return axes;
}

awaitable<void> put_in_order(std::shared_ptr<GatewayAxis> axis, std::vector<Claim> claims,
                             std::optional<tmcl::plan::Setting> before,
                             std::shared_ptr<bool> ended) {
  // Not the parameter: it may be destroyed after the axis.
  const auto held = std::move(claims);
  co_await be_stopped(*axis);
  // What has started again has its own.
  if (before && !axis->latched()) co_await set_back(*axis, before->parameter);
  axis->forget_before();
  *ended = true;
}

}  // namespace

GatewayAxis::Awaitable<DeadmanFinding> measure_deadman(
    std::shared_ptr<Gateway> gateway, std::shared_ptr<GatewayAxis> axis, Permit permit,
    std::function<void(const DeadmanPlan& plan)> tell) {
  // It is a slow movement for any client.
  permit.exceeds_limits = false;
  permit.ends_with_client = true;
  auto& deadman = axis->module().deadman();
  const auto set_ms = co_await axis->perform(deadman.read(), {});
  if (!set_ms) co_return tl::unexpected(set_ms.error());
  if (*set_ms == 0) {
    co_return DeadmanFinding{
        0, {}, deadman.is_missing() ? "the module has none" : "it is switched off"};
  }
  const ClaimOwner claim_owner{ClaimKind::deadman_test, permit};
  auto claims = co_await claim_all(axes_of_module(*gateway, *axis), claim_owner);
  if (!claims) co_return tl::unexpected(std::move(claims.error()));
  auto stand =
      co_await axis->perform(expect_standstill(axis->address().module, motors_of(*axis)), {});
  if (!stand) co_return tl::unexpected(std::move(stand.error()));
  Measurement measurement(axis, permit);
  const auto plan = co_await measurement.plan(*set_ms);
  if (!plan) co_return tl::unexpected(plan.error());
  tell(*plan);
  auto finding = co_await measurement.carry_out(*plan);
  // Whatever has ended it, the axis may have moved.
  if (!finding && measurement.before()) finding.error().outcome = tmcl::Outcome::unknown;
  const auto ended = std::make_shared<bool>(false);
  spawn(axis->bus().executor(),
        put_in_order(axis, std::move(*claims), measurement.before(), ended));
  co_await wait_until([&] { return *ended; }, time_to_set_back);
  // Another call may have waited to set it to something else.
  if (!finding || deadman.set_ms() != finding->set_ms) co_return finding;
  deadman.remember(finding->stops_after_ms.value_or(0));
  co_await DeadmanMemory::write(gateway->deadmen());
  co_return finding;
}

}  // namespace tmcld
