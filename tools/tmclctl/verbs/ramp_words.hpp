/// The parts of `ramp`: set on an axis, compared, sought, and computed for a model.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "axis/offline_axis.hpp"
#include "tmcl/api/axis.hpp"
#include "tmcl/plan/ramp_wish.hpp"
#include "verbs.hpp"

namespace tmclctl {

/// A method of tmcld with what was typed of a ramp.
template <class Method>
Method method_of(const verb::Ramp& verb) {
  const auto typed = [&](const std::string& text) { return Typed{text, verb.internal}; };
  Method method;
  method.axis = verb.axis;
  method.velocity = typed(verb.velocity).amount();
  method.velocity_internal = typed(verb.velocity).counted();
  method.acceleration = typed(verb.acceleration).amount();
  method.acceleration_internal = typed(verb.acceleration).counted();
  method.deceleration = typed(verb.deceleration).amount();
  method.deceleration_internal = typed(verb.deceleration).counted();
  method.jerk = typed(verb.jerk).amount();
  method.bow = typed(verb.jerk).counted();
  return method;
}

/// "gives 20 mm/s, ...; up to speed in 0.2 s and 12 microsteps"
std::string gives_text(const verb::Ramp& verb, const tmcl::api::axis::Ramp& ramp);

inline bool is_sought(const verb::Ramp& verb) { return verb.time_s || verb.fastest; }
inline bool has_figures(const tmcl::plan::MotorTorque& motor) {
  return motor != tmcl::plan::MotorTorque{};
}

// ---- as words say it, of an axis that need not be there

Result<tmcl::Microsteps> length_of(const std::string& text, const AxisUnits& units);
/// Of the move that a ramp is for; 0 is refused.
Result<tmcl::Microsteps> way_of(const std::string& text, const AxisUnits& units);
/// What is typed without a unit is what the module counts; it is told in microsteps.
Result<Quantity> rate_of(const std::string& text, const AxisUnits& units,
                         tmcl::Dimension dimension);
Result<std::optional<tmcl::plan::JerkWish>> jerk_of(const std::string& text, bool internal);
std::int32_t initial_bow(const AxisUnits& units);

// ---- by what is asked; `unit`: how many of it a microstep is

Result<ExitCode> compare_on_axis(const verb::Ramp& verb, Context& context);
Result<ExitCode> compare_on_model(const verb::Ramp& verb, const tmcl::plan::PlannedRamp& planned,
                                  const AxisUnits& units, std::optional<double> unit,
                                  Output& output);
Result<ExitCode> find_on_axis(const verb::Ramp& verb, Context& context);
Result<ExitCode> find_on_model(const verb::Ramp& verb, const AxisUnits& units,
                               std::optional<double> unit, Output& output);
Result<ExitCode> run_on_model(const verb::Ramp& verb, Output& output);
/// Of one motor of the model, for other programs.
Result<void> print_export(const verb::Ramp& verb, const tmcl::api::axis::Ramp& ramp,
                          const tmcl::Model& model, Output& output);

}  // namespace tmclctl
