// SAP, GAP, SGP, GGP.
#include "sim/module/module.hpp"

namespace tmcl::sim {
namespace {

namespace gp = global_parameter;

}  // namespace

Answer Module::set_axis_parameter(const Request& request) {
  if (!has_motor(request)) {
    const auto* row = find_parameter(axis_parameters(model_->family), request.type);
    const bool writable = row != nullptr && row->access == Access::read_write;
    return echo(request, writable ? Status::invalid_value : Status::wrong_type);
  }
  return echo(request, axes_[request.motor].set(request.type, request.value));
}

Answer Module::get_axis_parameter(const Request& request) const {
  if (has_motor(request)) return reading(axes_[request.motor].get(request.type));
  const bool known = find_parameter(axis_parameters(model_->family), request.type) != nullptr;
  return known ? echo(request, Status::invalid_value) : reading(tl::unexpected(Status::wrong_type));
}

Answer Module::set_global_parameter(const Request& request) {
  const bool foreign_bank = request.motor != 0 && globals_.get(request.type).has_value();
  const auto status =
      foreign_bank ? Status::invalid_value : globals_.set(request.type, request.value);
  // The time of both heartbeats begins when they are set, whichever wire that came by.
  if (status == Status::ok && request.type == gp::serial_heartbeat) serial_.heard(now_);
  if (status == Status::ok && request.type == gp::can_heartbeat) can_.heard(now_);
  return echo(request, status);
}

Answer Module::get_global_parameter(const Request& request) const {
  const auto result = globals_.get(request.type);
  if (result && request.motor != 0) return echo(request, Status::invalid_value);
  return reading(result);
}

}  // namespace tmcl::sim
