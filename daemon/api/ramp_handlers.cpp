// The ramp of an axis: what makes it, which parameters would make another, and setting them.
#include <algorithm>
#include <cmath>

#include "api/handlers.hpp"
#include "api/lookup.hpp"
#include "api/quantity.hpp"
#include "tmcl/module_traits.hpp"
#include "tmcl/parameter_number.hpp"
#include "tmcl/plan/ramp_choice.hpp"

namespace tmcld::handlers {
namespace {

namespace plan = tmcl::plan;
using boost::asio::awaitable;
using plan::RampChoice;
using plan::Setting;
using Rate = ParsedRate<tmcl::PulsesPerSecond>;
using Rate2 = ParsedRate<tmcl::PulsesPerSecond2>;

constexpr auto max_bow = tmcl::number_of("max_bow");
constexpr auto pulse_divisor = tmcl::number_of("pulse_divisor");
constexpr std::string_view jerk_param = api::name_of<&axis::OfRamp::jerk>();

/// What was asked for, as it was said and in microsteps.
struct Wish {
  Rate velocity;
  Rate2 acceleration;
  Rate2 deceleration;
  plan::RampRequest request;
};

/// What the settings are to give, and of which axis.
struct ChosenRamp {
  const tmcl::Model* model = nullptr;
  RampChoice choice;
  std::vector<std::string> warnings;
};

/// What was asked for; nothing: as it is.
struct JerkWish {
  std::optional<double> in_pulses;
  plan::WishUnit unit{1, "microsteps/s^3"};
};
Task<JerkWish> jerk_asked_for(GatewayAxis& axis, const axis::OfRamp& params) {
  if (params.jerk && params.bow) {
    co_return param_error("bad_argument", jerk_param, "give 'jerk' or 'bow', not both");
  }
  if (params.bow) co_return JerkWish{tmcl::to_pps3(*params.bow).value};
  if (!params.jerk) co_return JerkWish{};
  const auto* text = std::get_if<std::string>(&params.jerk->said);
  if (text != nullptr && *text == "max") co_return JerkWish{plan::highest_jerk};
  const auto jerk = co_await must(jerk_of(axis, *params.jerk));
  co_return JerkWish{jerk.in_pulses.value,
                     {jerk.quantity.number / jerk.in_pulses.value, jerk.quantity.unit}};
}

/// What the module counts itself may count something else with the ramp that is chosen.
template <class Value>
plan::WishUnit unit_of(const ParsedRate<Value>& rate, std::string_view in_pulses) {
  if (rate.quantity.unit.empty()) return {1, std::string(in_pulses)};
  return {rate.quantity.number / rate.in_pulses.value, rate.quantity.unit};
}

Task<Wish> wish_of(GatewayAxis& axis, const axis::OfRamp& params) {
  using axis::OfRamp;
  auto velocity = co_await must(velocity_rate_of(
      axis, raw_or_quantity<&OfRamp::velocity_internal, &OfRamp::velocity>(params)));
  auto acceleration = co_await must(acceleration_rate_of(
      axis, raw_or_quantity<&OfRamp::acceleration_internal, &OfRamp::acceleration>(params)));
  auto deceleration = acceleration;
  if (params.deceleration || params.deceleration_internal) {
    deceleration = co_await must(acceleration_rate_of(
        axis, raw_or_quantity<&OfRamp::deceleration_internal, &OfRamp::deceleration>(params)));
  }
  const auto jerk = co_await must(jerk_asked_for(axis, params));
  plan::RampRequest request{velocity.in_pulses, acceleration.in_pulses, deceleration.in_pulses,
                            jerk.in_pulses};
  request.said_in = {unit_of(velocity, "microsteps/s"), unit_of(acceleration, "microsteps/s^2"),
                     unit_of(deceleration, "microsteps/s^2"), jerk.unit};
  co_return Wish{std::move(velocity), std::move(acceleration), std::move(deceleration), request};
}

/// With fewer microsteps, by which what was said in them stays as it is.
std::string hint_of_microsteps(const Wish& wish, const tmcl::Model& model,
                               const tmcl::ModuleUnits& units) {
  const tmcl::UserScale* scale = nullptr;
  const auto look = [&](const auto& rate) {
    if (!is_in_microsteps(rate.quantity) && rate.units.scale) scale = &*rate.units.scale;
  };
  look(wish.velocity);
  look(wish.acceleration);
  look(wish.deceleration);
  if (scale == nullptr) return {};
  return tmcl::hint_of_resolution(scale->steps.resolution, [&](double share) {
    auto request = wish.request;
    const auto shrink = [&](const auto& rate, auto& pulses) {
      if (!is_in_microsteps(rate.quantity)) pulses.value *= share;
    };
    shrink(wish.velocity, request.velocity);
    shrink(wish.acceleration, request.acceleration);
    shrink(wish.deceleration, request.deceleration);
    return choose_ramp(model, request, units).has_value();
  });
}

/// Which of them the module does not have.
Error too_far(const tmcl::OutOfReach& fault, const Wish& wish, const tmcl::Model& model,
              const tmcl::ModuleUnits& units) {
  const auto error_at = [&](const auto& said) {
    auto error = out_of_reach(said.quantity, said.units, fault);
    error.hint.clear();
    if (fault.wished > fault.nearest) error.hint = hint_of_microsteps(wish, model, units);
    return quantity_error(said.param, error);
  };
  if (fault.is_velocity()) return error_at(wish.velocity);
  const auto off = [&](const Rate2& rate) { return std::abs(fault.wished - rate.in_pulses.value); };
  const bool is_braking = off(wish.deceleration) < off(wish.acceleration);
  return error_at(is_braking ? wish.deceleration : wish.acceleration);
}

/// What no bow keeps would be exceeded in silence.
std::optional<Error> jerk_refusal(const GatewayAxis& axis, const axis::OfRamp& params,
                                  const tmcl::Model& model, const plan::RampRequest& request) {
  const auto& jerk = request.jerk;
  if (!jerk || *jerk == plan::highest_jerk) return std::nullopt;
  const auto fault = plan::jerk_out_of_reach(model, *jerk);
  if (!fault) return std::nullopt;
  if (std::isinf(fault->nearest)) {
    return param_error("out_of_range", params.bow ? api::name_of<&axis::OfRamp::bow>() : jerk_param,
                       "the module of axis " + axis.name() + " is a " + std::string(model.name) +
                           ": it has no bow, and its acceleration changes at once",
                       "leave 'jerk' and 'bow' away, or give 'max' as 'jerk'");
  }
  return param_error("out_of_range", jerk_param, describe(in_unit(*fault, request.said_in.jerk)),
                     "give a higher jerk, or leave 'jerk' away");
}

tmcl::RampLength ramp_up(const RampChoice& choice) {
  return tmcl::ramp_length(choice.velocity, choice.acceleration, {choice.jerk});
}

/// What comes of a move that gets up to speed. A TMC429 whose ramp ticks are long may pass its
/// target again and again, whatever its data sheet allows.
std::vector<std::string> foreseen(const RampChoice& choice, const tmcl::Model& model) {
  constexpr double farthest = 8e6;
  if (model.family != tmcl::Family::tmc429) return {};
  auto twin = plan::AxisTwin::of(model);
  if (!twin || !twin->set(choice.settings)) return {};
  const double way = std::min(3 * ramp_up(choice).microsteps + 1, farthest);
  twin->move_to({static_cast<std::int32_t>(way)});
  if (twin->time_to_arrival()) return {};
  return {
      "with these settings a move may not come to rest on its target; another acceleration does"};
}

std::vector<axis::ModuleTrait> view_of(const tmcl::ModuleTraits& traits) {
  std::vector<axis::ModuleTrait> views;
  for (const auto& info : tmcl::trait_table()) {
    if (const auto variant = traits.find(info.trait))
      views.push_back({std::string(info.name), std::string(info.variants[*variant])});
  }
  return views;
}

Task<ChosenRamp> choose(GatewayAxis& axis, const axis::OfRamp& params) {
  co_await must(axis.be_ready(), axis);
  const auto* model = axis.module().model();
  const auto units = co_await must(axis.module_units(), axis);
  if (model == nullptr || !units) {
    co_return param_error<&axis::OfRamp::axis>(
        "unknown_model", "the model of axis " + axis.name() +
                             " is not known, so what its parameters mean is not, either");
  }
  auto wish = co_await must(wish_of(axis, params));
  co_await must_not(jerk_refusal(axis, params, *model, wish.request));
  if (model->family == tmcl::Family::tmc457) {
    const auto bow = co_await must(axis.get(max_bow, {}), axis);
    wish.request.bow = bow;
  }
  auto choice = plan::choose_ramp(*model, wish.request, *units);
  if (!choice) co_return too_far(choice.error(), wish, *model, *units);
  auto warnings = foreseen(*choice, *model);
  co_return ChosenRamp{model, std::move(*choice), std::move(warnings)};
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
  std::vector<axis::RampSetting> views;
  for (const auto& setting : settings)
    views.push_back({std::string(row_of(setting, axis).name), setting.parameter, setting.value});
  return views;
}

awaitable<axis::Ramp> view_of(GatewayAxis& axis, ChosenRamp chosen) {
  const auto& choice = chosen.choice;
  const auto unit = co_await unit_per_microstep(axis);
  const auto in_unit = [&](double pulses) {
    return unit ? std::optional(pulses * *unit) : std::nullopt;
  };
  axis::Ramp ramp;
  ramp.axis = axis.name();
  ramp.model = chosen.model->name;
  if (unit) ramp.unit = axis.unit();
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
  const auto [seconds, microsteps] = ramp_up(choice);
  ramp.ramp_s = seconds;
  ramp.ramp_microsteps = microsteps;
  ramp.settings = view_of(choice.settings, axis);
  ramp.remarks = choice.remarks;
  ramp.warnings = std::move(chosen.warnings);
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

Error not_foreseeable(const GatewayAxis& axis, const std::string& why) {
  return param_error<&axis::GetRamp::axis>(
      "not_foreseeable", "how " + axis.name() + " will move cannot be foreseen: " + why);
}

}  // namespace

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
  if (motion.velocity.value != 0) co_return not_foreseeable(axis, "it moves already");
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
  auto settings = co_await must(in_safe_order(axis, chosen.choice.settings));
  chosen.choice.settings = std::move(settings);
  co_await must(write_all(axis, chosen.choice.settings, ready.moves));
  auto warnings = co_await axis.warnings();
  if (!warnings) warnings = std::vector{"no prediction: " + warnings.error().message};
  chosen.warnings.insert(chosen.warnings.end(), warnings->begin(), warnings->end());
  auto ramp = co_await view_of(axis, std::move(chosen));
  co_return ramp;
}

}  // namespace tmcld::handlers
