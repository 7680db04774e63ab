// Movements that are computed, of no axis.
#include "api/profile_handlers.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "api/lookup.hpp"
#include "api/mc1451a_profile.hpp"
#include "api/number_within.hpp"
#include "api/resonance_request.hpp"
#include "api/suggest.hpp"
#include "tmcl/plan/profile.hpp"
#include "tmcl/plan/ramp_comparison.hpp"
#include "tmcl/seconds.hpp"

namespace tmcld::handlers {
namespace {

namespace plan = tmcl::plan;
using api::profile::Solve;
using api::profile::Solved;
using plan::Quantity;

/// Where a quantity is said and told.
struct QuantityField {
  Quantity quantity;
  std::optional<double> Solve::*said;
  double Solved::*told;
};
constexpr auto fields = std::to_array<QuantityField>({
    {Quantity::distance, &Solve::distance, &Solved::distance},
    {Quantity::speed, &Solve::speed, &Solved::speed},
    {Quantity::acceleration, &Solve::acceleration, &Solved::acceleration},
    {Quantity::deceleration, &Solve::deceleration, &Solved::deceleration},
    {Quantity::acceleration_time, &Solve::acceleration_time, &Solved::acceleration_time},
    {Quantity::slew_time, &Solve::slew_time, &Solved::slew_time},
    {Quantity::deceleration_time, &Solve::deceleration_time, &Solved::deceleration_time},
    {Quantity::total_time, &Solve::total_time, &Solved::total_time},
    {Quantity::initial_speed, &Solve::initial_speed, &Solved::initial_speed},
    {Quantity::final_speed, &Solve::final_speed, &Solved::final_speed},
    {Quantity::acceleration_distance, &Solve::acceleration_distance,
     &Solved::acceleration_distance},
    {Quantity::slew_distance, &Solve::slew_distance, &Solved::slew_distance},
    {Quantity::deceleration_distance, &Solve::deceleration_distance,
     &Solved::deceleration_distance},
});
static_assert(fields.size() == plan::every_quantity_count);

std::string_view failure_name(plan::SolveError::Kind kind) {
  switch (kind) {
    case plan::SolveError::Kind::invalid: return "bad_value";
    case plan::SolveError::Kind::insufficient: return "insufficient";
    case plan::SolveError::Kind::contradiction: return "contradiction";
    case plan::SolveError::Kind::impossible: break;
  }
  return "impossible";
}

Error refusal_of(const plan::SolveError& error) {
  const bool too_little = error.kind == plan::SolveError::Kind::insufficient;
  const auto& about = too_little ? error.candidates : error.culprits;
  const auto param = about.empty() ? api::name_of<&Solve::distance>() : name_of(about.front());
  auto failure = param_error(failure_name(error.kind), param, describe(error, "", "s"));
  boost::json::array quantities;
  for (const auto quantity : about) quantities.emplace_back(name_of(quantity));
  failure.subject["quantities"] = std::move(quantities);
  return failure;
}

Result<plan::Assumption> assumption_of(const Solve& params) {
  if (!params.assumption) return plan::Assumption::none;
  const auto assumption = plan::assumption_named(*params.assumption);
  if (assumption) return *assumption;
  return tl::unexpected(param_error<&Solve::assumption>(
      "bad_argument", "'" + *params.assumption + "' is no assumption", "say symmetric or thirds"));
}

// ---- a move of a model

using api::profile::Curve;
using api::profile::Simulate;
using api::profile::Simulated;
using plan::Setting;

constexpr double least_s = 1e-6;
constexpr double greatest_s = 86'400;

Result<const tmcl::Model*> model_of(const Simulate& params) {
  const auto* model = tmcl::find_model(params.model);
  if (model != nullptr) return model;
  return tl::unexpected(param_error<&Simulate::model>(
      "unknown_model", "there is no model '" + params.model + "'", "such as TMCM-6212"));
}

Result<std::uint8_t> parameter_named(const std::string& name, const tmcl::Model& model) {
  if (const auto number = as_number(name)) return *number;
  const auto table = axis_parameters(model);
  if (const auto* row = find_parameter(table, name)) return row->number;
  std::vector<std::string_view> names;
  for (const auto& one : table) names.push_back(one.name);
  return tl::unexpected(param_error<&Simulate::parameters>(
      "unknown_parameter", "a " + std::string(model.name) + " has no parameter '" + name + "'",
      suggest(name, names, "use the number of the parameter, from the module's manual")));
}

Result<std::vector<Setting>> settings_of(const Simulate& params, const tmcl::Model& model) {
  std::vector<Setting> settings;
  const auto names = params.parameters.value_or(std::vector<std::string>());
  const auto values = params.values.value_or(std::vector<std::int32_t>());
  if (names.size() != values.size()) {
    return tl::unexpected(param_error<&Simulate::values>(
        "bad_argument", "there must be one of 'values' for each of 'parameters'"));
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto number = parameter_named(names[i], model);
    if (!number) return tl::unexpected(number.error());
    settings.push_back({*number, values[i]});
  }
  return settings;
}

/// The twin of a module that has just started, with these settings.
Result<plan::AxisTwin> twin_of(const tmcl::Model& model, const std::vector<Setting>& settings) {
  auto twin = plan::AxisTwin::of(model);
  if (!twin) {
    return tl::unexpected(param_error<&Simulate::model>(
        "not_foreseeable", "the ramps of a " + std::string(model.name) + " are not described"));
  }
  for (const auto& setting : settings) {
    if (twin->set(setting)) continue;
    return tl::unexpected(param_error<&Simulate::values>(
        "out_of_range", fmt::format("a {} does not take {} for parameter {}", model.name,
                                    setting.value, setting.parameter)));
  }
  return std::move(*twin);
}

Task<std::optional<plan::LoadWish>> load_of(const Simulate& params) {
  const auto resonance = co_await must(resonance_of(params.resonance_hz, params.damping));
  if (!resonance) co_return std::nullopt;
  plan::LoadWish load;
  load.resonance = *resonance;
  const double distance = std::abs(static_cast<double>(params.distance_microsteps));
  load.tolerance = params.tolerance_microsteps
                       ? std::abs(static_cast<double>(*params.tolerance_microsteps))
                       : plan::usual_load_tolerance * distance;
  co_return load;
}

Curve motor_curve(const plan::AxisTwin& twin, double until_s, int points) {
  Curve curve;
  const auto add = [&](double time, const plan::AxisMotion& motion) {
    curve.times_s.push_back(time);
    curve.positions_microsteps.push_back(motion.position.value);
    curve.velocities_pps.push_back(motion.velocity.value);
    curve.accelerations_pps2.push_back(motion.acceleration.value);
  };
  const double step_s = until_s / (points - 1);
  const auto step =
      std::chrono::duration_cast<tmcl::Duration>(std::chrono::duration<double>(step_s));
  add(0, twin.motion());
  const auto count = static_cast<std::size_t>(points - 1);
  const auto motions = plan::motions(twin, step, count);
  for (std::size_t i = 0; i < motions.size(); ++i)
    add(static_cast<double>(i + 1) * tmcl::seconds(step), motions[i]);
  return curve;
}

/// Nothing for a move that the module does not make.
std::optional<Simulated> simulated(plan::AxisTwin twin, const std::vector<Setting>& settings,
                                   const Simulate& params,
                                   const std::optional<plan::LoadWish>& load) {
  const tmcl::Microsteps distance{params.distance_microsteps};
  const auto move = plan::follow_move(twin.model(), settings, distance);
  if (!move) return std::nullopt;
  const auto verdict = plan::judge(*move, load);
  Simulated result{std::string(twin.model().name),
                   verdict.seconds,
                   verdict.longest_phase_s,
                   move->top_speed,
                   verdict.swing,
                   verdict.settled_s};
  twin.move_to(distance);
  result.warnings = twin.warnings(settings);
  const auto until = params.until_s ? params.until_s : verdict.seconds;
  if (params.points && until) result.curve = motor_curve(twin, *until, *params.points);
  return result;
}

}  // namespace

Answer<Simulate> simulate_profile(Call& call, const Simulate& params) {
  if (params.until_s) {
    co_await must(
        number_within(api::name_of<&Simulate::until_s>(), *params.until_s, least_s, greatest_s));
  }
  if (params.model == mc1451a_name) {
    auto follow_chip = [params] { return mc1451a_move(params); };
    auto move = co_await call.gateway->planner.plan(std::move(follow_chip));
    const auto made = co_await must(std::move(move));
    co_return made;
  }
  const auto* model = co_await must(model_of(params));
  const auto settings = co_await must(settings_of(params, *model));
  const auto twin = co_await must(twin_of(*model, settings));
  const auto load = co_await must(load_of(params));
  auto follow = [twin, settings, params, load] { return simulated(twin, settings, params, load); };
  auto result = co_await call.gateway->planner.plan(std::move(follow));
  if (!result) {
    co_return param_error<&Simulate::distance_microsteps>(
        "out_of_range", fmt::format("a {} makes no move by {} microsteps with these settings",
                                    model->name, params.distance_microsteps));
  }
  co_return *result;
}

// It takes some microseconds.
Answer<Solve> solve_profile(Call& /*call*/, const Solve& params) {
  plan::Given given;
  for (const auto& field : fields) given[field.quantity] = params.*field.said;
  const auto assumption = co_await must(assumption_of(params));
  const auto solved = plan::solve(given, assumption);
  if (!solved) co_return refusal_of(solved.error());
  Solved result;
  for (const auto& field : fields) result.*field.told = (*solved)[field.quantity];
  co_return result;
}

}  // namespace tmcld::handlers
