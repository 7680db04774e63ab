// SCO, GCO, CCO, MVP COORD.
#include "sim/module/module.hpp"

namespace tmcl::sim {
namespace {

namespace ap = axis_parameter;

constexpr std::uint8_t coordinate_storage = 84;
/// In place of a motor's number: between RAM and EEPROM, for all motors.
constexpr std::uint8_t eeprom_copy = 255;

bool is_coordinate(std::int64_t number) {
  return number >= 0 && number < std::int64_t{coordinates_per_motor};
}

}  // namespace

// As the manual of the TMCM-142 has it, these modules leave no choice.
bool Module::keeps_coordinates() const {
  return model_->family == Family::tmc457 || globals_.value(coordinate_storage) == 1;
}

Answer Module::set_coordinate(const Request& request) {
  if (!is_coordinate(request.type)) return echo(request, Status::wrong_type);
  if (request.motor == eeprom_copy) return keep_coordinates(request);
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
  if (request.motor == eeprom_copy) {
    coordinates_.load_all(request.type);
    return echo(request);
  }
  if (!has_motor(request)) return echo(request, Status::invalid_value);
  return reading(coordinates_.get(request.motor, request.type));
}

Answer Module::capture_coordinate(const Request& request) {
  if (!is_coordinate(request.type)) return echo(request, Status::wrong_type);
  if (!has_motor(request)) return echo(request, Status::invalid_value);
  const auto position = *axes_[request.motor].get(ap::actual_position);
  return echo(request, put_coordinate(request.motor, request.type, position));
}

Answer Module::move_to_coordinate(const Request& request) {
  if (!has_motor(request) || !is_coordinate(request.value)) {
    return echo(request, Status::invalid_value);
  }
  const auto number = static_cast<std::uint8_t>(request.value);
  const auto status = axes_[request.motor].move_to(coordinates_.get(request.motor, number));
  if (status == Status::ok) events_.move_begun(request.motor);
  return echo(request, status);
}

}  // namespace tmcl::sim
