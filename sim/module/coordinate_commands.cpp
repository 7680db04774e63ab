// SCO, GCO, CCO, MVP COORD.
#include <algorithm>

#include "sim/module/module.hpp"

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

// As the manual of the TMCM-142 has it, these modules leave no choice.
bool Module::keeps_coordinates() const {
  return model_->family == Family::tmc457 ||
         globals_.value(global_parameter::coordinate_storage) == 1;
}

Answer Module::set_coordinate(const Request& request) {
  if (!is_coordinate(request.type)) return echo(request, Status::wrong_type);
  if (request.motor == all_motors) return keep_coordinates(request);
  if (!has_motor(request) || !axes_[request.motor].is_position(request.value)) {
    return echo(request, Status::invalid_value);
  }
  return echo(request, put_coordinate(request.motor, request.type, request.value));
}

Status Module::put_coordinate(std::uint8_t motor, std::uint8_t number, std::int32_t position) {
  const bool keeps = number != 0 && keeps_coordinates();
  if (keeps && globals_.eeprom_locked()) return Status::eeprom_locked;
  coordinates_.set(motor, number, position);
  if (keeps) coordinates_.keep(motor, number);
  return Status::ok;
}

Answer Module::keep_coordinates(const Request& request) {
  if (request.value != 0) return echo(request, Status::invalid_value);
  if (globals_.eeprom_locked()) return echo(request, Status::eeprom_locked);
  coordinates_.keep_all(request.type);
  return echo(request);
}

Answer Module::get_coordinate(const Request& request) {
  if (!is_coordinate(request.type)) return reading(tl::unexpected(Status::wrong_type));
  if (request.motor == all_motors) {
    coordinates_.load_all(request.type);
    return echo(request);
  }
  if (!has_motor(request)) return echo(request, Status::invalid_value);
  return reading(coordinates_.get(request.motor, request.type));
}

Answer Module::capture_coordinate(const Request& request) {
  if (!is_coordinate(request.type)) return echo(request, Status::wrong_type);
  if (request.motor == all_motors) return echo(request, capture_all(request.type));
  if (!has_motor(request)) return echo(request, Status::invalid_value);
  return echo(request, capture(request.motor, request.type));
}

Status Module::capture(std::uint8_t motor, std::uint8_t number) {
  return put_coordinate(motor, number, *axes_[motor].get(ap::actual_position));
}

Status Module::capture_all(std::uint8_t number) {
  auto status = Status::ok;
  for (std::uint8_t motor = 0; motor < axes_.size() && status == Status::ok; ++motor) {
    status = capture(motor, number);
  }
  return status;
}

Answer Module::move_to_coordinate(const Request& request) {
  const auto group = group_of(request.motor);
  if (!group || !is_coordinate(request.value)) return echo(request, Status::invalid_value);
  const auto number = static_cast<std::uint8_t>(request.value);
  for (std::size_t motor = 0; motor < axes_.size(); ++motor) {
    if ((group->motors >> motor & 1U) == 0) continue;
    axes_[motor].move_to(coordinates_.get(motor, number));
    events_.move_begun(motor);
  }
  if (group->together) arrive_together(group->motors);
  return echo(request);
}

// All motors start in this instant, whichever way they are addressed.
std::optional<Module::MotorGroup> Module::group_of(std::uint8_t field) const {
  if (field < axes_.size()) return MotorGroup{companions(field), false};
  const std::uint32_t motors = field & most_motors;
  const std::uint32_t flags = field & ~most_motors;
  const bool known = flags == at_once || flags == interpolated;
  if (!known || axes_.size() < 2 || motors == 0 || motors >> axes_.size() != 0) return std::nullopt;
  return MotorGroup{motors, flags == interpolated};
}

// The last to arrive rules. One that stands already, or never arrives, is left as it is.
void Module::arrive_together(std::uint32_t motors) {
  auto last = now_;
  for (std::size_t motor = 0; motor < axes_.size(); ++motor) {
    const auto arrival = axes_[motor].outlook().arrival;
    if ((motors >> motor & 1U) != 0 && arrival != never) last = std::max(last, arrival);
  }
  for (std::size_t motor = 0; motor < axes_.size(); ++motor) {
    const auto arrival = axes_[motor].outlook().arrival;
    if ((motors >> motor & 1U) != 0 && arrival > now_ && arrival < last) {
      axes_[motor].arrive_by(last);
    }
  }
}

}  // namespace tmcl::sim
