// ROR, ROL, MST, MVP, RFS.
#include "sim/module/module.hpp"
#include "tmcl/command_type.hpp"

namespace tmcl::sim {

namespace ap = axis_parameter;

Answer Module::rotate(const Request& request, std::int32_t sign) {
  if (!has_motor(request)) return echo(request, Status::invalid_value);
  const auto status = axes_[request.motor].rotate(std::int64_t{sign} * request.value);
  if (status == Status::ok) events_.move_abandoned(request.motor);
  return echo(request, status);
}

Answer Module::stop(const Request& request) {
  if (!has_motor(request)) return echo(request, Status::invalid_value);
  stop_motor(request.motor);
  return echo(request);
}

void Module::stop_motor(std::size_t motor) {
  events_.move_abandoned(motor);
  axes_[motor].stop();
}

void Module::stop_all_motors() {
  for (std::size_t motor = 0; motor < axes_.size(); ++motor) stop_motor(motor);
}

Answer Module::move(const Request& request) {
  if (request.type == move_type::coordinate) return move_to_coordinate(request);
  if (request.type != move_type::absolute && request.type != move_type::relative) {
    return echo(request, Status::wrong_type);
  }
  if (!has_motor(request)) return echo(request, Status::invalid_value);
  if (!axes_[request.motor].can_move(request.value)) return echo(request, Status::invalid_value);
  const bool relative = request.type == move_type::relative;
  for (std::size_t motor = 0; motor < axes_.size(); ++motor) {
    if ((companions(request.motor) >> motor & 1U) == 0) continue;
    if (relative) {
      axes_[motor].move_by(request.value);
    } else {
      axes_[motor].move_to(request.value);
    }
    events_.move_begun(motor);
  }
  return relative && answers_with_target() ? reading(axes_[request.motor].get(ap::target_position))
                                           : echo(request);
}

bool Module::answers_with_target() const {
  return settings_.traits.get<RelativeAnswer>(Trait::relative_answer, *model_) ==
         RelativeAnswer::target;
}

// Facts are few: the numbers of the parameter, and that motors with the same one move together. So
// each does what the command says, and 0, with which all begin, makes no group.
std::uint32_t Module::companions(std::size_t motor) const {
  const auto group = axes_[motor].group();
  std::uint32_t motors = 1U << motor;
  for (std::size_t other = 0; group != 0 && other < axes_.size(); ++other) {
    if (axes_[other].group() == group) motors |= 1U << other;
  }
  return motors;
}

Answer Module::search(const Request& request) {
  if (request.type > search_type::status) return echo(request, Status::wrong_type);
  if (!has_motor(request)) return echo(request, Status::invalid_value);
  auto& axis = axes_[request.motor];
  if (request.type == search_type::status) return reading(axis.search_step());
  if (request.type == search_type::stop) {
    axis.stop_search();
    return echo(request);
  }
  const auto status = axis.start_search();
  if (status == Status::ok) events_.move_abandoned(request.motor);
  return echo(request, status);
}

}  // namespace tmcl::sim
