// ROR, ROL, MST, MVP, RFS.
#include "sim/module/command_groups.hpp"
#include "tmcl/command_type.hpp"

namespace tmcl::sim {

namespace ap = axis_parameter;

Answer MotionCommands::rotate(const Request& request, std::int32_t sign) {
  if (!module_.has_motor(request)) return echo(request, Status::invalid_value);
  const auto status = module_.axes[request.motor].rotate(std::int64_t{sign} * request.value);
  if (status == Status::ok) module_.events.move_abandoned(request.motor);
  return echo(request, status);
}

Answer MotionCommands::stop(const Request& request) {
  if (!module_.has_motor(request)) return echo(request, Status::invalid_value);
  module_.stop_motor(request.motor);
  return echo(request);
}

Answer MotionCommands::move(const Request& request) {
  if (request.type != move_type::absolute && request.type != move_type::relative) {
    return echo(request, Status::wrong_type);
  }
  if (!module_.has_motor(request)) return echo(request, Status::invalid_value);
  if (!module_.axes[request.motor].can_move(request.value))
    return echo(request, Status::invalid_value);
  const bool relative = request.type == move_type::relative;
  for (std::size_t motor = 0; motor < module_.axes.size(); ++motor) {
    if ((module_.companions(request.motor) >> motor & 1U) == 0) continue;
    if (relative) {
      module_.axes[motor].move_by(request.value);
    } else {
      module_.axes[motor].move_to(request.value);
    }
    module_.events.move_begun(motor);
  }
  return relative && answers_with_target()
             ? reading(module_.axes[request.motor].get(ap::target_position))
             : echo(request);
}

bool MotionCommands::answers_with_target() const {
  return module_.settings.traits.get<RelativeAnswer>(Trait::relative_answer, *module_.model) ==
         RelativeAnswer::target;
}

Answer MotionCommands::search(const Request& request) {
  if (request.type > search_type::status) return echo(request, Status::wrong_type);
  if (!module_.has_motor(request)) return echo(request, Status::invalid_value);
  auto& axis = module_.axes[request.motor];
  if (request.type == search_type::status) return reading(axis.search_step());
  if (request.type == search_type::stop) {
    axis.stop_search();
    return echo(request);
  }
  const auto status = axis.start_search();
  if (status == Status::ok) module_.events.move_abandoned(request.motor);
  return echo(request, status);
}

}  // namespace tmcl::sim
