#include "tmcl/coordinates.hpp"

#include <fmt/format.h>

#include "engine/verb_steps.hpp"
#include "tmcl/command_type.hpp"

namespace tmcl {
namespace {

constexpr std::uint8_t eeprom = 255;  // in place of the motor
constexpr std::uint8_t greatest_mask = 0x3F;

}  // namespace

namespace verbs {
namespace {

std::optional<Error> objection(std::uint8_t number) {
  if (number <= greatest_coordinate) return std::nullopt;
  return bad_argument(fmt::format("there is no coordinate {}", number),
                      fmt::format("coordinates are 0 to {}", greatest_coordinate));
}

Script<Result<std::int32_t>> ask_about(std::uint8_t number, Request request) {
  if (auto error = objection(number)) co_return tl::unexpected(std::move(*error));
  co_return co_await ask(request);
}

Script<Result<void>> act_on(std::uint8_t number, Request request) {
  co_await must(ask_about(number, request));
  co_return Result<void>{};
}

/// The form for one coordinate with number 0 means all of them, and 0 is never stored.
Script<Result<void>> act_on_eeprom(ModuleAddress module, Command command,
                                   std::optional<std::uint8_t> number) {
  if (number == 0) {
    co_return tl::unexpected(
        bad_argument("coordinate 0 cannot be stored", "coordinates 1 to 20 can be"));
  }
  const auto chosen = number.value_or(0);
  co_return co_await act_on(chosen, {module, command, chosen, eeprom, 0});
}

}  // namespace

Script<Result<void>> set_coordinate(AxisAddress axis, std::uint8_t number, Microsteps position) {
  return act_on(number, {axis.module, Command::SCO, number, axis.motor, position.value});
}

Script<Result<Microsteps>> coordinate(AxisAddress axis, std::uint8_t number) {
  const auto value =
      co_await must(ask_about(number, {axis.module, Command::GCO, number, axis.motor, 0}));
  co_return Microsteps{value};
}

Script<Result<Microsteps>> capture_coordinate(AxisAddress axis, std::uint8_t number) {
  co_await must(act_on(number, {axis.module, Command::CCO, number, axis.motor, 0}));
  co_return co_await coordinate(axis, number);
}

Script<Result<void>> store_coordinates(ModuleAddress module, std::optional<std::uint8_t> number) {
  return act_on_eeprom(module, Command::SCO, number);
}

Script<Result<void>> load_coordinates(ModuleAddress module, std::optional<std::uint8_t> number) {
  return act_on_eeprom(module, Command::GCO, number);
}

Script<Result<void>> move_to_coordinate(AxisAddress axis, std::uint8_t number) {
  return act_on(number, {axis.module, Command::MVP, move_type::coordinate, axis.motor, number});
}

Script<Result<void>> move_motors_to_coordinate(ModuleAddress module, MotorMask motors,
                                               Together together, std::uint8_t number) {
  if (motors.bits == 0 || motors.bits > greatest_mask) {
    co_return tl::unexpected(bad_argument(fmt::format("{} names no motors", motors.bits),
                                          "a mask has bits for the motors 0 to 5"));
  }
  const auto how =
      together == Together::interpolated ? motor_mask::interpolated : motor_mask::each_for_itself;
  const auto field = static_cast<std::uint8_t>(how | motors.bits);
  co_return co_await act_on(number, {module, Command::MVP, move_type::coordinate, field, number});
}

}  // namespace verbs
}  // namespace tmcl
