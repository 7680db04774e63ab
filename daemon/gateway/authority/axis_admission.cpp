#include "gateway/authority/axis_admission.hpp"

#include <utility>

#include "tmcl/command_type.hpp"

namespace tmcld {

namespace ap = tmcl::axis_parameter;

RunOptions AxisAdmission::begin_movement(Permit permit, Deadline deadline) const {
  RunOptions options;
  options.deadline = deadline;
  options.permit = permit;
  options.objection = [this, permit] {
    const auto& bus = axis_.bus();
    return bus.motors().objection(axis_.address(), permit, bus.clock().now());
  };
  return options;
}

tmcl::Request AxisAdmission::any_move() const {
  return {axis_.address().module, tmcl::Command::MVP, tmcl::move_type::absolute,
          axis_.address().motor, 0};
}

AxisAdmission::Awaitable<void> AxisAdmission::be_free(RunOptions movement) {
  movement.permit.needs_no_reference = true;
  auto script = axis_.bus().gate().may_send(any_move(), movement.permit);
  auto free = co_await axis_.run(std::move(script), std::move(movement));
  co_return free;
}

AxisAdmission::Awaitable<Admitted> AxisAdmission::admit(AxisAction action, RunOptions movement) {
  auto ready = co_await axis_.be_ready();
  if (!ready) co_return tl::unexpected(std::move(ready.error()));
  movement.permit.needs_no_reference = !goes_to_position(action);
  const auto aim = std::make_shared<Admitted::Aim>();
  // The epoch from before the check: what changes while it reads is checked again.
  *aim = {action, units_.epoch()};
  auto allowed = co_await axis_.run(check_now(action, movement.permit), movement);
  if (!allowed) co_return tl::unexpected(std::move(allowed.error()));
  movement.premise = {[this, aim] { return limits() && aim->checked != units_.epoch(); },
                      [this, aim] {
                        aim->checked = units_.epoch();
                        return check(aim->action);
                      }};
  if (needs_free_axis(action)) {
    // Nothing of the verb goes out any more, its settings neither.
    movement.objection = [this, of = movement.permit,
                          stopped = std::move(movement.objection)]() -> std::optional<tmcl::Error> {
      auto objection = stopped ? stopped() : std::nullopt;
      const auto& motors = axis_.bus().motors();
      const auto it = motors.judge(any_move(), of, axis_.bus().clock().now());
      const bool refuses = it.verdict.ruling == Ruling::refuse || is_claim(it.verdict.because);
      if (objection || !refuses) return objection;
      return motors.refusal(it.motor, it.verdict.because);
    };
  }
  co_return Admitted(std::move(movement), aim);
}

tmcl::Setpoint AxisAdmission::setpoint_of(std::uint8_t parameter) const {
  const auto motor = axis_.address();
  const tmcl::Request write{motor.module, tmcl::Command::SAP, parameter, motor.motor, 1};
  return intent_of(write, axis_.bus().model_of(motor.module)).sets;
}

bool AxisAdmission::needs_free_axis(const AxisAction& action) const {
  const auto* write = std::get_if<action::Write>(&action);
  // A path depends on the settings of its axes; other movements have read them.
  return write == nullptr ||
         axis_.bus().motors().claim_owner_of(axis_.address()).by == ClaimKind::path ||
         setpoint_of(write->parameter) != tmcl::Setpoint::none;
}

bool AxisAdmission::goes_to_position(const AxisAction& action) const {
  const auto* write = std::get_if<action::Write>(&action);
  return std::holds_alternative<action::MoveTo>(action) ||
         std::holds_alternative<action::MoveToCoordinate>(action) ||
         std::holds_alternative<action::FollowPath>(action) ||
         (write != nullptr && setpoint_of(write->parameter) == tmcl::Setpoint::position);
}

AxisAdmission::Script<void> AxisAdmission::check_now(AxisAction action, Permit permit) {
  if (needs_free_axis(action)) {
    // First: a search that has ended unseen may have found the reference.
    auto free = co_await axis_.bus().gate().may_send(any_move(), permit);
    if (!free) co_return free;
  }
  auto checked = co_await check(std::move(action));
  co_return checked;
}

// ---- soft limits -------------------------------------------------------------------------------

tmcl::Error AxisAdmission::beyond_soft_limit(const std::string& what, std::string hint) const {
  auto error = tmcl::not_sent(tmcl::Errc::beyond_soft_limit, "axis '" + axis_.name() + "': " + what,
                              std::move(hint));
  return axis_.on_bus(std::move(error));
}

AxisAdmission::Script<void> AxisAdmission::check(AxisAction action) {
  if (!limits()) co_return tmcl::Result<void>{};
  auto script = std::visit([this](const auto& one) { return check_one(one); }, action);
  auto checked = co_await std::move(script);
  co_return checked;
}

AxisAdmission::Script<void> AxisAdmission::check_one(action::MoveTo move) {
  const auto scale = co_await units_.known_scale();
  if (!scale) co_return tl::unexpected(scale.error());
  auto beyond = tmcl::beyond(*limits(), move.target.microsteps, *scale);
  if (!beyond) co_return tmcl::Result<void>{};
  if (move.target.in_unit) beyond->position = move.target.in_unit->value;
  co_return tl::unexpected(
      beyond_soft_limit(describe(*beyond), "the configuration has it: 'soft_limits'"));
}

AxisAdmission::Script<void> AxisAdmission::check_one(action::MoveToCoordinate move) {
  const auto place = co_await tmcl::verbs::coordinate(axis_.address(), move.number);
  if (!place) co_return tl::unexpected(place.error());
  auto checked = co_await check_one(action::MoveTo{{*place}});
  co_return checked;
}

AxisAdmission::Script<void> AxisAdmission::check_one(action::Turn turn) {
  if (turn.velocity.value == 0) co_return tmcl::Result<void>{};
  co_return tl::unexpected(
      beyond_soft_limit("it has soft limits, which it would pass by turning without end",
                        "move it to one of them instead, with a lower max_velocity"));
}

AxisAdmission::Script<void> AxisAdmission::check_one(action::Write write) {
  const auto [parameter, value] = write;
  switch (setpoint_of(parameter)) {
    case tmcl::Setpoint::none: co_return tmcl::Result<void>{};
    case tmcl::Setpoint::velocity: {
      auto checked = co_await check_one(action::Turn{{value}});
      co_return checked;
    }
    case tmcl::Setpoint::position: {
      auto checked = co_await check_one(action::MoveTo{{{value}}});
      co_return checked;
    }
    case tmcl::Setpoint::here: {
      const auto turns = co_await turns_by_velocity();
      if (!turns) co_return tl::unexpected(turns.error());
      if (*turns) co_return tmcl::Result<void>{};
      break;
    }
    case tmcl::Setpoint::mode: {
      auto checked = co_await check_held_velocity();
      if (!checked) co_return checked;
      break;
    }
  }
  // An axis that is told to be at its target does not leave.
  const bool may_be_there = parameter == ap::actual_position;
  auto checked = co_await check_held_target(may_be_there ? std::optional(value) : std::nullopt);
  co_return checked;
}

AxisAdmission::Script<void> AxisAdmission::check_one(action::Restore restore) {
  if (setpoint_of(restore.parameter) == tmcl::Setpoint::none) co_return tmcl::Result<void>{};
  co_return tl::unexpected(
      beyond_soft_limit("it has soft limits, and what the EEPROM holds could send it anywhere",
                        "set the parameter to a value instead"));
}

AxisAdmission::Script<bool> AxisAdmission::turns_by_velocity() {
  const auto mode = tmcl::mode_parameter(axis_.parameters());
  if (!mode) co_return false;
  const auto value = co_await tmcl::verbs::get(axis_.address(), mode->number);
  co_return value.map([&](std::int32_t now) { return now == mode->velocity; });
}

AxisAdmission::Script<void> AxisAdmission::check_held_velocity() {
  const auto velocity = co_await tmcl::verbs::get(axis_.address(), ap::target_velocity);
  if (!velocity) co_return tl::unexpected(velocity.error());
  if (*velocity == 0) co_return tmcl::Result<void>{};
  co_return tl::unexpected(
      beyond_soft_limit("its target_velocity is " + std::to_string(*velocity) +
                            ", and turning without end it would pass its soft limits",
                        "stop it first"));
}

AxisAdmission::Script<void> AxisAdmission::check_held_target(std::optional<std::int32_t> here) {
  const auto target = co_await tmcl::verbs::get(axis_.address(), ap::target_position);
  if (!target) co_return tl::unexpected(target.error());
  if (here == *target) co_return tmcl::Result<void>{};
  auto checked = co_await check_one(action::MoveTo{{{*target}}});
  if (checked || checked.error().code != tmcl::Errc::beyond_soft_limit) co_return checked;
  auto error = std::move(checked.error());
  error.message += ", and it would go on to there: that is its target_position";
  error.hint = "move it to within its limits first";
  co_return tl::unexpected(std::move(error));
}

}  // namespace tmcld
