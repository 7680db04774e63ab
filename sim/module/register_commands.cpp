// WRITE_MC, READ_MC, WRITE_DRV, READ_DRV: registers of the chips, by their addresses.
#include "sim/module/command_groups.hpp"

namespace tmcl::sim {
namespace {

// A TMC429 has three motors. The upper bits of its addresses are the motor, or tell that a register
// belongs to all of them; the lowest tells reading from writing.
constexpr std::uint8_t motors_of_chip = 3;
constexpr std::uint8_t motor_shift = 5;
constexpr std::uint8_t register_bits = 0x1E;

constexpr std::uint8_t greatest_address = 0x7F;
/// What PyTrinamic puts in place of the motor in driver commands: the second chip of a board.
constexpr std::uint8_t second_chip = 1;

bool writes(const Request& request) {
  return request.command == Command::WRITE_MC || request.command == Command::WRITE_DRV;
}

}  // namespace

// The motor field tells the chip. With a TMC429 that is one for three motors, all other motion
// controllers here have one motor each. A register of a TMC429 that belongs to no motor of the
// module is kept with its first.
std::optional<RegisterCommands::ChipRegister> RegisterCommands::controller_register(
    const Request& request) const {
  if (module_.model->family != Family::tmc429) {
    if (!module_.has_motor(request)) return std::nullopt;
    return ChipRegister{request.motor, request.type};
  }
  const std::size_t first = std::size_t{request.motor} * motors_of_chip;
  if (first >= module_.axes.size()) return std::nullopt;
  const std::size_t index = request.type >> motor_shift;
  const bool of_motor = index < motors_of_chip && first + index < module_.axes.size();
  if (of_motor)
    return ChipRegister{first + index, static_cast<std::uint8_t>(request.type & register_bits)};
  return ChipRegister{first, static_cast<std::uint8_t>(request.type & ~1U)};
}

// Where the firmware makes the ramps there is no chip with registers of them.
Answer RegisterCommands::access_controller(const Request& request) {
  if (module_.model->family == Family::firmware)
    return echo(request, Status::command_not_available);
  if (request.type > greatest_address) return echo(request, Status::wrong_type);
  const auto place = controller_register(request);
  if (!place) return echo(request, Status::invalid_value);
  auto& axis = module_.axes[place->motor];
  if (writes(request)) return echo(request, axis.write_chip(place->address, request.value));
  return reading(axis.read_chip(place->address));
}

// In the sixPoint modules the driver is in the same chip. The motor field is the motor; a module
// with only one takes what PyTrinamic sends as well.
Answer RegisterCommands::access_driver(const Request& request) {
  if (request.type > greatest_address) return echo(request, Status::wrong_type);
  const bool only_driver = module_.axes.size() == 1 && request.motor == second_chip;
  const std::size_t motor = only_driver ? 0 : request.motor;
  if (motor >= module_.axes.size()) return echo(request, Status::invalid_value);
  auto& axis = module_.axes[motor];
  const bool same_chip = module_.model->family == Family::sixpoint;
  if (!writes(request)) {
    return reading(same_chip ? axis.read_chip(request.type) : axis.read_driver(request.type));
  }
  if (same_chip) return echo(request, axis.write_chip(request.type, request.value));
  axis.write_driver(request.type, request.value);
  return echo(request);
}

}  // namespace tmcl::sim
