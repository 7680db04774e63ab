#include "gateway/axis_admission.hpp"

#include <utility>

namespace tmcld {

using tmcl::Result;
namespace ap = tmcl::axis_parameter;

RunOptions AxisAdmission::begin_movement(Permit permit, Deadline deadline) const {
  RunOptions options;
  options.deadline = deadline;
  options.permit = permit;
  options.objection = [this, permit] {
    return axis_.bus().motors().objection(axis_.address(), permit);
  };
  return options;
}

AxisAdmission::Awaitable<void> AxisAdmission::be_free(RunOptions movement) {
  const auto [module, motor] = axis_.address();
  const tmcl::Request move{module, tmcl::Command::MVP, 0, motor, 0};
  auto script = axis_.bus().may_send(move, movement.permit);
  return axis_.run(std::move(script), std::move(movement));
}

// ---- soft limits -------------------------------------------------------------------------------

tmcl::Error AxisAdmission::beyond_soft_limit(const std::string& what, std::string hint) const {
  tmcl::Error error;
  error.code = tmcl::Errc::beyond_soft_limit;
  error.outcome = tmcl::Outcome::not_sent;
  error.message = "axis '" + axis_.name() + "': " + what;
  error.hint = std::move(hint);
  return axis_.on_bus(std::move(error));
}

std::optional<tmcl::Error> AxisAdmission::objection_to(const Length& target,
                                                       const tmcl::UserScale& scale) const {
  if (!limits()) return std::nullopt;
  auto beyond = tmcl::beyond(*limits(), target.microsteps, scale);
  if (!beyond) return std::nullopt;
  if (target.in_unit) beyond->position = target.in_unit->value;
  return beyond_soft_limit(describe(*beyond), "the configuration has it: 'soft_limits'");
}

AxisAdmission::Script<void> AxisAdmission::check_target(Length target) {
  if (!limits()) co_return Result<void>{};
  const auto scale = co_await units_.known_scale(target.scale);
  if (!scale) co_return tl::unexpected(scale.error());
  auto objection = objection_to(target, *scale);
  if (objection) co_return tl::unexpected(std::move(*objection));
  co_return Result<void>{};
}

AxisAdmission::Script<void> AxisAdmission::check_coordinate(std::uint8_t number) {
  if (!limits()) co_return Result<void>{};
  const auto place = co_await tmcl::verbs::coordinate(axis_.address(), number);
  if (!place) co_return tl::unexpected(place.error());
  auto checked = co_await check_target({*place});
  co_return checked;
}

Result<void> AxisAdmission::check_endless(std::int32_t velocity) const {
  if (!limits() || velocity == 0) return {};
  return tl::unexpected(
      beyond_soft_limit("it has soft limits, which it would pass by turning without end",
                        "move it to one of them instead, with a lower max_velocity"));
}

AxisAdmission::Script<void> AxisAdmission::check_setting(std::uint8_t parameter,
                                                         std::int32_t value) {
  if (!limits()) co_return Result<void>{};
  switch (tmcl::set_off_by(parameter, axis_.parameters())) {
    case tmcl::SetOff::nothing: co_return Result<void>{};
    case tmcl::SetOff::turning_at_value: co_return check_endless(value);
    case tmcl::SetOff::move_to_value: {
      auto checked = co_await check_target({{value}});
      co_return checked;
    }
    case tmcl::SetOff::held_move: {
      const auto turns = co_await turns_by_velocity();
      if (!turns) co_return tl::unexpected(turns.error());
      if (*turns) co_return Result<void>{};
      break;
    }
    case tmcl::SetOff::held_move_or_turning: {
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

Result<void> AxisAdmission::check_restoring(std::uint8_t parameter) const {
  const bool is_still = tmcl::set_off_by(parameter, axis_.parameters()) == tmcl::SetOff::nothing;
  if (!limits() || is_still) return {};
  return tl::unexpected(
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
  if (*velocity == 0) co_return Result<void>{};
  co_return tl::unexpected(
      beyond_soft_limit("its target_velocity is " + std::to_string(*velocity) +
                            ", and turning without end it would pass its soft limits",
                        "stop it first"));
}

AxisAdmission::Script<void> AxisAdmission::check_held_target(std::optional<std::int32_t> here) {
  const auto target = co_await tmcl::verbs::get(axis_.address(), ap::target_position);
  if (!target) co_return tl::unexpected(target.error());
  if (here == *target) co_return Result<void>{};
  auto checked = co_await check_target({{*target}});
  if (checked || checked.error().code != tmcl::Errc::beyond_soft_limit) co_return checked;
  auto error = std::move(checked.error());
  error.message += ", and it would go on to there: that is its target_position";
  error.hint = "move it to within its limits first";
  co_return tl::unexpected(std::move(error));
}

}  // namespace tmcld
