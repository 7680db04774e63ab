// SAP, GAP, STAP, RSAP, SGP, GGP, STGP, RSGP.
#include "sim/module/command_groups.hpp"

namespace tmcl::sim {
namespace {

namespace gp = global_parameter;

}  // namespace

Answer AxisParameterCommands::set(const Request& request) {
  if (!module_.has_motor(request)) {
    const auto* row = find_parameter(axis_parameters(*module_.model), request.type);
    const bool writable = row != nullptr && row->access == Access::read_write;
    return echo(request, writable ? Status::invalid_value : Status::wrong_type);
  }
  return echo(request, module_.axes[request.motor].set(request.type, request.value));
}

Answer AxisParameterCommands::get(const Request& request) {
  if (module_.has_motor(request)) return reading(module_.axes[request.motor].read(request.type));
  const bool known = find_parameter(axis_parameters(*module_.model), request.type) != nullptr;
  return known ? echo(request, Status::invalid_value) : reading(tl::unexpected(Status::wrong_type));
}

Answer AxisParameterCommands::store(const Request& request) {
  const auto* row = find_parameter(axis_parameters(*module_.model), request.type);
  if (row == nullptr || !row->stored) return echo(request, Status::wrong_type);
  if (!module_.has_motor(request)) return echo(request, Status::invalid_value);
  if (module_.globals.eeprom_locked()) return echo(request, Status::eeprom_locked);
  module_.eeprom.write(axis_cell(request.motor, request.type),
                       *module_.axes[request.motor].get(request.type));
  return echo(request);
}

Answer AxisParameterCommands::restore(const Request& request) {
  const auto* row = find_parameter(axis_parameters(*module_.model), request.type);
  if (row == nullptr || !row->stored) return echo(request, Status::wrong_type);
  if (!module_.has_motor(request)) return echo(request, Status::invalid_value);
  const auto kept = module_.eeprom.read(axis_cell(request.motor, request.type));
  return echo(request, module_.axes[request.motor].set(request.type, kept.value_or(row->initial)));
}

Answer GlobalParameterCommands::set(const Request& request) {
  const auto protection = programs_.code_protection();
  const auto status = module_.globals.set(request.motor, request.type, request.value, module_.now);
  programs_.protect(protection, programs_.code_protection());
  if (status == Status::ok && request.motor == Globals::parameter_bank) {
    // The time of both heartbeats begins when they are set, whichever wire that came by.
    if (request.type == gp::serial_heartbeat) module_.serial.heard(module_.now);
    if (request.type == gp::can_heartbeat) module_.can.heard(module_.now);
    if (request.type == gp::end_switch_polarity || request.type == gp::reverse_shaft)
      module_.wire_axes();
  }
  return echo(request, status);
}

Answer GlobalParameterCommands::get(const Request& request) {
  if (request.motor == Globals::parameter_bank) {
    if (const auto value = programs_.parameter(request.type)) return reading(*value);
  }
  const auto result = module_.globals.get(request.motor, request.type, module_.now);
  if (!result && result.error() == Status::invalid_value) return echo(request, result.error());
  return reading(result);
}

Answer GlobalParameterCommands::store(const Request& request) {
  return echo(request, module_.globals.store(request.motor, request.type));
}

Answer GlobalParameterCommands::restore(const Request& request) {
  return echo(request, module_.globals.restore(request.motor, request.type));
}

}  // namespace tmcl::sim
