#include "api/ramp_view.hpp"

#include <cmath>

namespace tmcld {

namespace axis = tmcl::api::axis;

std::vector<axis::RampSetting> view_of(const std::vector<tmcl::plan::Setting>& settings,
                                       std::span<const tmcl::ParameterInfo> parameters) {
  std::vector<axis::RampSetting> views;
  for (const auto& setting : settings) {
    const auto& row = *find_parameter(parameters, setting.parameter);
    views.push_back({std::string(row.name), setting.parameter, setting.value});
  }
  return views;
}

axis::Ramp view_of(const tmcl::plan::PlannedRamp& planned, const tmcl::Model& model,
                   std::optional<double> unit) {
  const auto& choice = planned.choice;
  const auto in_unit = [&](double pulses) {
    return unit ? std::optional(pulses * *unit) : std::nullopt;
  };
  axis::Ramp ramp;
  ramp.model = model.name;
  ramp.velocity_pps = choice.velocity.value;
  ramp.velocity = in_unit(choice.velocity.value);
  ramp.acceleration_pps2 = choice.acceleration.value;
  ramp.acceleration = in_unit(choice.acceleration.value);
  ramp.deceleration_pps2 = choice.deceleration.value;
  ramp.deceleration = in_unit(choice.deceleration.value);
  if (std::isfinite(choice.jerk)) {
    ramp.jerk_pps3 = choice.jerk;
    ramp.jerk = in_unit(choice.jerk);
  }
  const auto [seconds, microsteps] = planned.ramp_up();
  ramp.ramp_s = seconds;
  ramp.ramp_microsteps = microsteps;
  ramp.settings = view_of(choice.settings, axis_parameters(model));
  ramp.remarks = choice.remarks;
  ramp.warnings = planned.warnings;
  return ramp;
}

tmcl::api::ramp::ComparedRamp view_of(const std::vector<tmcl::plan::Setting>& settings,
                                      const tmcl::plan::RampVerdict& verdict,
                                      const tmcl::Model& model, std::optional<double> unit) {
  tmcl::api::ramp::ComparedRamp ramp;
  ramp.settings = view_of(settings, axis_parameters(model));
  ramp.move_s = verdict.seconds;
  ramp.longest_phase_s = verdict.longest_phase_s;
  ramp.swing_microsteps = verdict.swing;
  if (unit && verdict.swing) ramp.swing = *verdict.swing * *unit;
  ramp.settled_s = verdict.settled_s;
  return ramp;
}

tmcl::api::ramp::Found view_of(const tmcl::plan::FoundRamp& found,
                               const tmcl::plan::RampSearch& search,
                               const std::optional<tmcl::plan::MotorWish>& motor,
                               std::optional<double> unit) {
  tmcl::api::ramp::Found view{view_of(found.planned, *search.units.model, unit)};
  view.distance_microsteps = search.distance.value;
  view.move_s = *found.move.seconds;
  view.top_speed_pps = found.move.top_speed;
  if (unit) view.top_speed = found.move.top_speed * *unit;
  if (!motor) return view;
  const auto use = torque_use(found.move, motor->torque, motor->microsteps_per_full_step);
  view.torque_share = use.share;
  view.torque_share_pps = use.speed * motor->microsteps_per_full_step;
  return view;
}

}  // namespace tmcld
