// SAP, GAP, STAP, RSAP, SGP, GGP, STGP, RSGP.
#include "sim/module/module.hpp"

namespace tmcl::sim {
namespace {

namespace gp = global_parameter;

EepromCell cell(std::size_t motor, std::uint8_t number) {
  return {EepromCell::Area::axis_parameter, static_cast<std::uint8_t>(motor), number};
}

}  // namespace

Answer Module::set_axis_parameter(const Request& request) {
  if (!has_motor(request)) {
    const auto* row = find_parameter(axis_parameters(*model_), request.type);
    const bool writable = row != nullptr && row->access == Access::read_write;
    return echo(request, writable ? Status::invalid_value : Status::wrong_type);
  }
  return echo(request, axes_[request.motor].set(request.type, request.value));
}

Answer Module::get_axis_parameter(const Request& request) {
  if (has_motor(request)) return reading(axes_[request.motor].read(request.type));
  const bool known = find_parameter(axis_parameters(*model_), request.type) != nullptr;
  return known ? echo(request, Status::invalid_value) : reading(tl::unexpected(Status::wrong_type));
}

Answer Module::store_axis_parameter(const Request& request) {
  const auto* row = find_parameter(axis_parameters(*model_), request.type);
  if (row == nullptr || !row->stored) return echo(request, Status::wrong_type);
  if (!has_motor(request)) return echo(request, Status::invalid_value);
  if (globals_.eeprom_locked()) return echo(request, Status::eeprom_locked);
  eeprom_.write(cell(request.motor, request.type), *axes_[request.motor].get(request.type));
  return echo(request);
}

Answer Module::restore_axis_parameter(const Request& request) {
  const auto* row = find_parameter(axis_parameters(*model_), request.type);
  if (row == nullptr || !row->stored) return echo(request, Status::wrong_type);
  if (!has_motor(request)) return echo(request, Status::invalid_value);
  const auto kept = eeprom_.read(cell(request.motor, request.type));
  return echo(request, axes_[request.motor].set(request.type, kept.value_or(row->initial)));
}

// The unit mode goes first: what was stored is counted in it. A value that the axis does not take,
// say because it was stored in the other unit, leaves the factory setting.
void Module::restore_axis(std::size_t motor) {
  const auto restore = [&](std::uint8_t number) {
    if (const auto kept = eeprom_.read(cell(motor, number))) axes_[motor].set(number, *kept);
  };
  restore(axis_parameter::unit_mode);
  for (const auto& row : axis_parameters(*model_)) {
    if (row.stored && row.number != axis_parameter::unit_mode) restore(row.number);
  }
}

Answer Module::set_global_parameter(const Request& request) {
  const auto protection = code_protection();
  const auto status = globals_.set(request.motor, request.type, request.value, now_);
  protect_program(protection, code_protection());
  if (status == Status::ok && request.motor == Globals::parameter_bank) {
    // The time of both heartbeats begins when they are set, whichever wire that came by.
    if (request.type == gp::serial_heartbeat) serial_.heard(now_);
    if (request.type == gp::can_heartbeat) can_.heard(now_);
    if (request.type == gp::end_switch_polarity || request.type == gp::reverse_shaft) wire_axes();
  }
  return echo(request, status);
}

// A TMCM-6110 has a bit for each half of its motors.
void Module::wire_axes() {
  const auto* row = find_parameter(global_parameters(*model_), gp::end_switch_polarity);
  const auto groups = row != nullptr && row->maximum > 1 ? std::size_t{2} : std::size_t{1};
  for (std::size_t motor = 0; motor < axes_.size(); ++motor) {
    const auto bit = motor * groups / axes_.size();
    axes_[motor].reverse_limit_polarity((globals_.value(gp::end_switch_polarity) >> bit & 1) != 0);
    axes_[motor].reverse_shaft(globals_.value(gp::reverse_shaft) == 1);
  }
}

Answer Module::get_global_parameter(const Request& request) {
  if (request.motor == Globals::parameter_bank) {
    if (const auto value = application_parameter(request.type)) return reading(*value);
  }
  const auto result = globals_.get(request.motor, request.type, now_);
  if (!result && result.error() == Status::invalid_value) return echo(request, result.error());
  return reading(result);
}

Answer Module::store_global_parameter(const Request& request) {
  return echo(request, globals_.store(request.motor, request.type));
}

Answer Module::restore_global_parameter(const Request& request) {
  return echo(request, globals_.restore(request.motor, request.type));
}

}  // namespace tmcl::sim
