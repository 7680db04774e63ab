// SCO, GCO, CCO, MVP COORD.
#include <algorithm>

#include "sim/module/command_groups.hpp"

namespace tmcl::sim {
namespace {

namespace ap = axis_parameter;

/// In place of a motor's number. For SCO and GCO: between RAM and EEPROM.
constexpr std::uint8_t all_motors = 255;

// Several motors at once for MVP COORD: bit n of the lower six is motor n, and one of the others
// says how. The vendor gives $43 for motors 0 and 1 with interpolation (TMCL-IDE-Nightly, issue 2);
// what stands for none is in no document at hand.
constexpr std::uint32_t most_motors = 0x3F;
constexpr std::uint32_t interpolated = 0x40;  // arriving together
constexpr std::uint32_t at_once = 0x80;       // each as fast as its own parameters say

bool is_coordinate(std::int64_t number) {
  return number >= 0 && number < std::int64_t{coordinates_per_motor};
}

}  // namespace

Answer CoordinateCommands::set(const Request& request) {
  if (!is_coordinate(request.type)) return echo(request, Status::wrong_type);
  if (request.motor == all_motors) return keep(request);
  if (!module_.has_motor(request) || !module_.axes[request.motor].is_position(request.value)) {
    return echo(request, Status::invalid_value);
  }
  return echo(request, put(request.motor, request.type, request.value));
}

Status CoordinateCommands::put(std::uint8_t motor, std::uint8_t number, std::int32_t position) {
  const bool keeps = number != 0 && module_.keeps_coordinates();
  if (keeps && module_.globals.eeprom_locked()) return Status::eeprom_locked;
  module_.coordinates.set(motor, number, position);
  if (keeps) module_.coordinates.keep(motor, number);
  return Status::ok;
}

Answer CoordinateCommands::keep(const Request& request) {
  if (request.value != 0) return echo(request, Status::invalid_value);
  if (module_.globals.eeprom_locked()) return echo(request, Status::eeprom_locked);
  module_.coordinates.keep_all(request.type);
  return echo(request);
}

Answer CoordinateCommands::get(const Request& request) {
  if (!is_coordinate(request.type)) return reading(tl::unexpected(Status::wrong_type));
  if (request.motor == all_motors) {
    module_.coordinates.load_all(request.type);
    return echo(request);
  }
  if (!module_.has_motor(request)) return echo(request, Status::invalid_value);
  return reading(module_.coordinates.get(request.motor, request.type));
}

Answer CoordinateCommands::capture(const Request& request) {
  if (!is_coordinate(request.type)) return echo(request, Status::wrong_type);
  if (request.motor == all_motors) return echo(request, capture_all(request.type));
  if (!module_.has_motor(request)) return echo(request, Status::invalid_value);
  return echo(request, capture(request.motor, request.type));
}

Status CoordinateCommands::capture(std::uint8_t motor, std::uint8_t number) {
  return put(motor, number, *module_.axes[motor].get(ap::actual_position));
}

Status CoordinateCommands::capture_all(std::uint8_t number) {
  auto status = Status::ok;
  for (std::uint8_t motor = 0; motor < module_.axes.size() && status == Status::ok; ++motor) {
    status = capture(motor, number);
  }
  return status;
}

Answer CoordinateCommands::move(const Request& request) {
  const auto group = group_of(request.motor);
  if (!group || !is_coordinate(request.value)) return echo(request, Status::invalid_value);
  const auto number = static_cast<std::uint8_t>(request.value);
  for (std::size_t motor = 0; motor < module_.axes.size(); ++motor) {
    if ((group->motors >> motor & 1U) == 0) continue;
    module_.axes[motor].move_to(module_.coordinates.get(motor, number));
    module_.events.move_begun(motor);
  }
  if (group->together) arrive_together(group->motors);
  return echo(request);
}

// All motors start in this instant, whichever way they are addressed.
std::optional<CoordinateCommands::MotorGroup> CoordinateCommands::group_of(
    std::uint8_t field) const {
  if (field < module_.axes.size()) return MotorGroup{module_.companions(field), false};
  const std::uint32_t motors = field & most_motors;
  const std::uint32_t flags = field & ~most_motors;
  const bool known = flags == at_once || flags == interpolated;
  if (!known || module_.axes.size() < 2 || motors == 0 || motors >> module_.axes.size() != 0)
    return std::nullopt;
  return MotorGroup{motors, flags == interpolated};
}

// The last to arrive rules. One that stands already, or never arrives, is left as it is.
void CoordinateCommands::arrive_together(std::uint32_t motors) {
  auto last = module_.now;
  for (std::size_t motor = 0; motor < module_.axes.size(); ++motor) {
    const auto arrival = module_.axes[motor].outlook().arrival;
    if ((motors >> motor & 1U) != 0 && arrival != never) last = std::max(last, arrival);
  }
  for (std::size_t motor = 0; motor < module_.axes.size(); ++motor) {
    const auto arrival = module_.axes[motor].outlook().arrival;
    if ((motors >> motor & 1U) != 0 && arrival > module_.now && arrival < last) {
      module_.axes[motor].arrive_by(last);
    }
  }
}

}  // namespace tmcl::sim
