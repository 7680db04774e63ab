// The ramp of an axis: what makes it, which parameters would make another, and setting them.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "api/comparison_handlers.hpp"
#include "api/lookup.hpp"
#include "api/number_within.hpp"
#include "api/quantity.hpp"
#include "api/ramp_view.hpp"
#include "api/resonance_request.hpp"
#include "async/rest.hpp"
#include "tmcl/module_traits.hpp"
#include "tmcl/parameter_number.hpp"
#include "tmcl/plan/ramp_comparison.hpp"
#include "tmcl/plan/ramp_search.hpp"
#include "tmcl/plan/ramp_wish.hpp"

namespace tmcld::handlers {
namespace {

namespace plan = tmcl::plan;
using boost::asio::awaitable;
using plan::Setting;

constexpr auto max_bow = tmcl::number_of("max_bow");
constexpr auto pulse_divisor = tmcl::number_of("pulse_divisor");
constexpr std::string_view jerk_param = api::name_of<&axis::OfRamp::jerk>();

/// What was asked for, where it was said, and what its axis is measured in.
struct Wish {
  plan::RampWish ramp;
  std::array<std::string_view, 5> params;  ///< By plan::RampObjection::Part.
  tmcl::AxisUnits units;
};

/// What the settings are to give, and of which axis.
struct ChosenRamp {
  const tmcl::Model* model = nullptr;
  plan::PlannedRamp ramp;
};

/// Nothing: as it is. `params` are those of a method that takes a ramp.
template <class Params>
Task<std::optional<plan::JerkWish>> jerk_asked_for(GatewayAxis& axis, const Params& params,
                                                   tmcl::AxisUnits& units) {
  if (params.jerk && params.bow) {
    co_return param_error("bad_argument", jerk_param, "give 'jerk' or 'bow', not both");
  }
  if (params.bow) co_return plan::JerkWish{.bow = *params.bow};
  if (!params.jerk) co_return std::nullopt;
  const auto* text = std::get_if<std::string>(&params.jerk->said);
  if (text != nullptr && *text == "max") co_return plan::JerkWish{.highest = true};
  auto jerk = co_await must(jerk_of(axis, *params.jerk));
  if (jerk.units.scale) units.scale = std::move(jerk.units.scale);
  co_return plan::JerkWish{.quantity = std::move(jerk.quantity)};
}

/// What the module counts is told in microsteps, since the ramp may change what it counts.
template <class Value>
tmcl::Quantity said(const ParsedRate<Value>& rate, const char* in_microsteps) {
  return rate.quantity.unit.empty() ? tmcl::Quantity{rate.in_pulses.value, in_microsteps}
                                    : rate.quantity;
}

Task<Wish> wish_of(GatewayAxis& axis, const axis::OfRamp& params) {
  using axis::OfRamp;
  constexpr auto pps2 = "microsteps/s^2";
  Wish wish;
  const auto take = [&](const auto& rate, plan::RampObjection::Part part) {
    wish.params.at(static_cast<std::size_t>(part)) = rate.param;
    if (rate.units.scale) wish.units.scale = rate.units.scale;
  };
  using Part = plan::RampObjection::Part;
  const auto velocity = co_await must(velocity_rate_of(
      axis, raw_or_quantity<&OfRamp::velocity_internal, &OfRamp::velocity>(params)));
  const auto acceleration = co_await must(acceleration_rate_of(
      axis, raw_or_quantity<&OfRamp::acceleration_internal, &OfRamp::acceleration>(params)));
  wish.units.axis = axis.name();
  take(velocity, Part::velocity);
  take(acceleration, Part::acceleration);
  take(acceleration, Part::deceleration);
  wish.ramp.velocity = said(velocity, "microsteps/s");
  wish.ramp.acceleration = said(acceleration, pps2);
  if (params.deceleration || params.deceleration_internal) {
    const auto deceleration = co_await must(acceleration_rate_of(
        axis, raw_or_quantity<&OfRamp::deceleration_internal, &OfRamp::deceleration>(params)));
    take(deceleration, Part::deceleration);
    wish.ramp.deceleration = said(deceleration, pps2);
  }
  auto jerk = co_await must(jerk_asked_for(axis, params, wish.units));
  wish.ramp.jerk = std::move(jerk);
  wish.params.at(static_cast<std::size_t>(Part::jerk)) = jerk_param;
  wish.params.at(static_cast<std::size_t>(Part::bow)) = api::name_of<&OfRamp::bow>();
  co_return wish;
}

std::vector<axis::ModuleTrait> view_of(const tmcl::ModuleTraits& traits) {
  std::vector<axis::ModuleTrait> views;
  for (const auto& info : tmcl::trait_table()) {
    if (const auto variant = traits.find(info.trait))
      views.push_back({std::string(info.name), std::string(info.variants[*variant])});
  }
  return views;
}

/// With a model, and what its module counts in.
Task<tmcl::AxisUnits> units_of_ready(GatewayAxis& axis) {
  co_await must(axis.be_ready(), axis);
  const auto* model = axis.module().model();
  const auto units = co_await must(axis.module_units(), axis);
  if (model == nullptr || !units) {
    co_return param_error<&axis::OfRamp::axis>(
        "unknown_model", "the model of axis " + axis.name() +
                             " is not known, so what its parameters mean is not, either");
  }
  co_return tmcl::AxisUnits{axis.name(), model, units};
}

/// 0 where the module has none.
Task<std::int32_t> present_bow_of(GatewayAxis& axis, const tmcl::Model& model) {
  if (model.family != tmcl::Family::tmc457) co_return 0;
  const auto bow = co_await must(axis.get(max_bow, {}), axis);
  co_return bow;
}

Task<ChosenRamp> choose(GatewayAxis& axis, const axis::OfRamp& params) {
  const auto units = co_await must(units_of_ready(axis));
  auto wish = co_await must(wish_of(axis, params));
  wish.units.model = units.model;
  wish.units.module = units.module;
  const auto present_bow = co_await must(present_bow_of(axis, *units.model));
  auto planned = plan::plan_ramp(wish.ramp, wish.units, present_bow);
  if (!planned) {
    const auto& [part, error] = planned.error();
    co_return quantity_error(wish.params.at(static_cast<std::size_t>(part)), error);
  }
  co_return ChosenRamp{units.model, std::move(*planned)};
}

// The table has a row for everything that is chosen from it.
const tmcl::ParameterInfo& row_of(Setting setting, const GatewayAxis& axis) {
  return *find_parameter(axis.parameters(), setting.parameter);
}

/// How many of the axis' unit a microstep is; nothing without a unit.
awaitable<std::optional<double>> unit_per_microstep(GatewayAxis& axis) {
  if (axis.unit().empty()) co_return std::nullopt;
  auto scale = co_await axis.scale();
  if (!scale || !*scale) co_return std::nullopt;
  (*scale)->reverse = false;
  co_return to_user(tmcl::PulsesPerSecond{1}, **scale).value;
}

std::vector<axis::RampSetting> view_of(const std::vector<Setting>& settings,
                                       const GatewayAxis& axis) {
  return tmcld::view_of(settings, axis.parameters());
}

awaitable<axis::Ramp> view_of(GatewayAxis& axis, ChosenRamp chosen) {
  const auto unit = co_await unit_per_microstep(axis);
  auto ramp = tmcld::view_of(chosen.ramp, *chosen.model, unit);
  ramp.axis = axis.name();
  if (unit) ramp.unit = axis.unit();
  co_return ramp;
}

/// A ramp that changes on the way would end at an unknown position.
Task<void> refuse_in_motion(GatewayAxis& axis) {
  const auto reading = co_await must(axis.read_state(), axis);
  if (reading.state.velocity.value == 0) co_return;
  co_await refuse(not_now(
      "moving",
      "axis " + axis.name() + " moves; a ramp is changed at standstill, and nothing was written",
      "axis.stop stops it"));
}

/// The order in which to write them, with what the module has now.
Task<std::vector<Setting>> in_safe_order(GatewayAxis& axis, std::vector<Setting> settings) {
  if (std::ranges::find(settings, pulse_divisor, &Setting::parameter) == settings.end())
    co_return settings;
  const auto present = co_await must(axis.get(pulse_divisor, {}), axis);
  co_return plan::in_safe_order(std::move(settings), present);
}

Task<void> write_all(GatewayAxis& axis, const std::vector<Setting>& settings,
                     const RunOptions& movement) {
  std::string written;
  for (const auto& setting : settings) {
    const auto assignment =
        std::string(row_of(setting, axis).name) + " = " + std::to_string(setting.value);
    const auto done = co_await axis.set(setting.parameter, setting.value, movement);
    if (!done) {
      auto error = call_error(done.error(), axis.name());
      error.message += "; it was about " + assignment;
      if (!written.empty()) error.message += ", and these were written before: " + written;
      co_await refuse(std::move(error));
    }
    written += (written.empty() ? "" : ", ") + assignment;
  }
}

/// They are set by now.
Task<void> store_all(GatewayAxis& axis, const std::vector<Setting>& settings, const Call& call) {
  for (const auto& setting : settings) {
    RunOptions options;
    options.permit = call.permit;
    const auto stored = co_await axis.store(setting.parameter, std::move(options));
    if (stored) continue;
    auto error = call_error(stored.error(), axis.name());
    error.message = fmt::format("the ramp is set, but {} could not be stored: {}",
                                row_of(setting, axis).name, error.message);
    co_await refuse(std::move(error));
  }
}

Error not_foreseeable(const GatewayAxis& axis, const std::string& why) {
  return param_error<&axis::GetRamp::axis>(
      "not_foreseeable", "how " + axis.name() + " will move cannot be foreseen: " + why);
}

using api::ramp::Compare;

/// Of the move that a ramp is for.
template <class Method>
Task<tmcl::Microsteps> way_of(GatewayAxis& axis, const Method& params) {
  const auto said = co_await must(
      distance_of(axis, raw_or_quantity<&Method::distance_microsteps, &Method::distance>(params)));
  if (said.microsteps == tmcl::Microsteps{}) {
    co_return param_error<&Method::distance>("not_foreseeable",
                                             "'distance' is 0: such a move has no ramp");
  }
  co_return said.microsteps;
}

/// What swings behind the motor; nothing if no resonance was said.
Task<std::optional<plan::LoadWish>> load_of(GatewayAxis& axis, const Compare& params,
                                            double distance) {
  const auto resonance = co_await must(resonance_of(params.resonance_hz, params.damping));
  if (!resonance) co_return std::nullopt;
  plan::LoadWish load;
  load.resonance = *resonance;
  load.tolerance = plan::usual_load_tolerance * distance;
  if (params.tolerance || params.tolerance_microsteps) {
    const auto said = co_await must(distance_of(
        axis, raw_or_quantity<&Compare::tolerance_microsteps, &Compare::tolerance>(params)));
    load.tolerance = std::abs(static_cast<double>(said.microsteps.value));
  }
  co_return load;
}

using api::ramp::Find;

/// 0 if it was not said.
Task<double> figure_of(std::string_view param, std::optional<double> said) {
  constexpr double greatest = 1e9;
  if (!said) co_return 0.0;
  const auto figure = co_await must(number_within(param, *said, 0, greatest));
  co_return figure;
}

/// Nothing where a ramp is sought for a time, and no figures are said.
Task<std::optional<plan::MotorWish>> motor_of(GatewayAxis& axis, const Find& params) {
  constexpr double greatest_margin = 100;
  const bool any = params.load || params.load_per_velocity || params.inertia || params.corner_speed;
  if (!any && params.time_s) co_return std::nullopt;
  plan::MotorWish motor;
  motor.torque.load = co_await must(figure_of(api::name_of<&Find::load>(), params.load));
  motor.torque.load_per_velocity =
      co_await must(figure_of(api::name_of<&Find::load_per_velocity>(), params.load_per_velocity));
  motor.torque.inertia = co_await must(figure_of(api::name_of<&Find::inertia>(), params.inertia));
  if (params.corner_speed) {
    motor.torque.corner_speed =
        co_await must(figure_of(api::name_of<&Find::corner_speed>(), params.corner_speed));
  }
  motor.margin = co_await must(number_within(
      api::name_of<&Find::margin>(), params.margin.value_or(motor.margin), 0, greatest_margin));
  const auto resolution =
      co_await must(axis.get(tmcl::axis_parameter::microstep_resolution, {}), axis);
  motor.microsteps_per_full_step =
      std::ldexp(1, std::clamp(resolution, 0, tmcl::max_microstep_resolution));
  co_return motor;
}

/// The move, and what of its ramp is not sought.
Task<plan::RampSearch> search_of(GatewayAxis& axis, const Find& params) {
  plan::RampSearch search;
  auto units = co_await must(units_of_ready(axis));
  search.units = std::move(units);
  const auto distance = co_await must(way_of(axis, params));
  search.distance = distance;
  auto jerk = co_await must(jerk_asked_for(axis, params, search.units));
  search.jerk = std::move(jerk);
  if (params.velocity || params.velocity_internal) {
    const auto fastest = co_await must(
        velocity_rate_of(axis, raw_or_quantity<&Find::velocity_internal, &Find::velocity>(params)));
    search.fastest = fastest.in_pulses;
  }
  const auto present_bow = co_await must(present_bow_of(axis, *search.units.model));
  search.present_bow = present_bow;
  const auto twin = co_await must(axis.twin({}), axis);
  if (!twin) {
    co_return not_foreseeable(
        axis, "the ramps of a " + std::string(search.units.model->name) + " are not described");
  }
  search.held = axis.ramp_settings();
  co_return search;
}

Error why_not_found(const GatewayAxis& axis, const plan::RampSearch& search,
                    const plan::RampSearchFault& fault) {
  using Kind = plan::RampSearchFault::Kind;
  switch (fault.kind) {
    case Kind::objection: return quantity_error(jerk_param, fault.objection->error);
    case Kind::too_quick:
      return param_error<&Find::time_s>("out_of_range", describe(fault, search));
    case Kind::too_little_torque:
      return param_error<&Find::load>("out_of_range", describe(fault, search));
    case Kind::not_foreseeable: break;
  }
  return not_foreseeable(axis, describe(fault, search));
}

}  // namespace

Answer<api::ramp::Compare> compare_ramps(Call& call, const api::ramp::Compare& params) {
  const auto found = co_await must(axis_of(call, params.axis));
  auto& axis = *found;
  auto chosen = co_await must(choose(axis, params));
  const auto distance = co_await must(way_of(axis, params));
  const auto load =
      co_await must(load_of(axis, params, std::abs(static_cast<double>(distance.value))));
  const auto twin = co_await must(axis.twin({}), axis);
  const auto& model = *chosen.model;
  if (!twin) {
    co_return not_foreseeable(axis,
                              "the ramps of a " + std::string(model.name) + " are not described");
  }
  auto settings = axis.ramp_settings();
  const auto& more = chosen.ramp.choice.settings;
  settings.insert(settings.end(), more.begin(), more.end());
  const auto unit = co_await unit_per_microstep(axis);
  api::ramp::Comparison comparison{axis.name(), std::string(model.name)};
  if (unit) comparison.unit = axis.unit();
  comparison.distance_microsteps = distance.value;
  if (load) comparison.tolerance_microsteps = load->tolerance;
  std::vector<plan::RampVerdict> verdicts;
  for (const auto& variant : plan::ramp_variants(model, settings)) {
    const auto verdict = plan::judge_variant(model, settings, variant, distance, load);
    if (!verdict) {
      co_return param_error<&Compare::distance>(
          "out_of_range", fmt::format("a {} makes no move by {} microsteps with such a ramp",
                                      model.name, distance.value));
    }
    verdicts.push_back(*verdict);
    comparison.ramps.push_back(tmcld::view_of(variant, verdicts.back(), model, unit));
    // Others go on meanwhile: each takes well below a millisecond.
    co_await rest({});
  }
  if (const auto first = plan::first_settled(verdicts))
    comparison.proposed = static_cast<std::int32_t>(*first);
  co_return comparison;
}

Answer<Find> find_ramp(Call& call, const Find& params) {
  constexpr double least_s = 1e-6;
  constexpr double greatest_s = 86'400;
  const auto called = co_await must(axis_of(call, params.axis));
  auto& axis = *called;
  if (params.time_s) {
    co_await must(
        number_within(api::name_of<&Find::time_s>(), *params.time_s, least_s, greatest_s));
  }
  const auto search = co_await must(search_of(axis, params));
  const auto motor = co_await must(motor_of(axis, params));
  auto seek = [search, motor, time = params.time_s] {
    return time ? plan::gentlest_ramp(search, *time) : plan::quickest_ramp(search, *motor);
  };
  auto found = co_await call.gateway->planner.plan(std::move(seek));
  if (!found) co_return why_not_found(axis, search, found.error());
  const auto unit = co_await unit_per_microstep(axis);
  auto view = tmcld::view_of(*found, search, motor, unit);
  view.axis = axis.name();
  if (unit) view.unit = axis.unit();
  co_return view;
}

Answer<axis::GetRamp> get_ramp(Call& call, const axis::GetRamp& params) {
  const auto found = co_await must(axis_of(call, params.axis));
  auto& axis = *found;
  co_await must(axis.be_ready(), axis);
  const auto* model = axis.module().model();
  if (model == nullptr) co_return not_foreseeable(axis, "the model of its module is not known");
  const auto twin = co_await must(axis.twin({}), axis);
  if (!twin) {
    co_return not_foreseeable(axis,
                              "the ramps of a " + std::string(model->name) + " are not described");
  }
  const auto motion = twin->motion();
  // Where it is when a command comes could only be guessed.
  if (motion.velocity.value != 0 && !params.in_motion.value_or(false))
    co_return not_foreseeable(axis, "it moves already");
  co_return axis::HeldRamp{std::string(model->name), motion.position.value,
                           view_of(axis.ramp_settings(), axis), view_of(axis.module().traits())};
}

Answer<axis::PlanRamp> plan_ramp(Call& call, const axis::PlanRamp& params) {
  const auto axis = co_await must(axis_of(call, params.axis));
  auto chosen = co_await must(choose(*axis, params));
  auto ramp = co_await view_of(*axis, std::move(chosen));
  co_return ramp;
}

Answer<axis::SetRamp> set_ramp(Call& call, const axis::SetRamp& params) {
  const auto ready = co_await must(ready_to_move(call, params.axis, {}));
  auto& axis = *ready.axis;
  auto chosen = co_await must(choose(axis, params));
  co_await must(refuse_in_motion(axis));
  auto settings = co_await must(in_safe_order(axis, chosen.ramp.choice.settings));
  chosen.ramp.choice.settings = std::move(settings);
  co_await must(write_all(axis, chosen.ramp.choice.settings, ready.moves));
  if (params.store.value_or(false))
    co_await must(store_all(axis, chosen.ramp.choice.settings, call));
  auto warnings = co_await axis.warnings();
  if (!warnings) warnings = std::vector{"no prediction: " + warnings.error().message};
  chosen.ramp.warnings.insert(chosen.ramp.warnings.end(), warnings->begin(), warnings->end());
  auto ramp = co_await view_of(axis, std::move(chosen));
  co_return ramp;
}

}  // namespace tmcld::handlers
