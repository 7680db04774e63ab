#include "tmcl/tuning.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "engine/verb_steps.hpp"
#include "motion/twin/divisors.hpp"
#include "tmcl/plan/ramp_limits.hpp"
#include "tmcl/verbs.hpp"
#include "tune/tuner.hpp"

namespace tmcl {
namespace verbs {
namespace {

namespace ap = axis_parameter;
using plan::LimitSearch;

/// With this an axis is measured, and brought back after a trial that failed.
constexpr double slow_full_steps = 100;  ///< A second.
constexpr double slow_part = 0.25;       ///< Of the velocity that it has, at most.
/// An encoder is measured on so much of the travel at most.
constexpr double measured_full_steps = 400;
constexpr double least_travel_full_steps = 64;
/// The trials keep this much of the travel to either end: steps may be lost.
constexpr double kept_full_steps = 16;

constexpr double least_part = 1.0 / 64;  ///< Of the first velocity and acceleration.
/// Beyond this no motor gets, in full steps and their squares.
constexpr double greatest_full_steps = 20'000;
constexpr double greatest_acceleration_full_steps = 20'000'000;

/// Below this part of the current nothing is tried: coolStep goes no lower.
constexpr double least_current_part = 0.25;
/// A load value keeps off 0 by this part of its range.
constexpr double least_load_part = 0.1;
constexpr std::int32_t old_load_values = 7;  ///< The greatest of drivers before stallGuard2.
constexpr int confirmations = 2;
/// How much less is proposed if what was found does not hold in the end, and how often.
constexpr double less = 0.9;
constexpr int most_retreats = 3;

std::string_view unit_of(Sought sought) {
  return sought == Sought::velocity ? "microsteps/s" : "microsteps/s^2";
}

tl::unexpected<Error> nothing_held(Sought sought, double first) {
  Error error;
  error.code = Errc::move_interrupted;
  error.outcome = Outcome::unknown;
  error.message =
      fmt::format("no {} from {:.0f} {} down has held", name_of(sought), first, unit_of(sought));
  error.hint = "a lower acceleration to begin with, more current, or a longer travel";
  return tl::unexpected(std::move(error));
}

}  // namespace

// ---- the course -------------------------------------------------------------------------------

Script<Result<void>> Tuner::begin() {
  const auto resolution = co_await must(watched_.get(ap::microstep_resolution));
  ramps_.full_step = 1 << std::clamp(resolution, 0, max_microstep_resolution);
  const auto& travel = options_.travel;
  const auto length = std::int64_t{travel.greatest} - travel.least;
  if (static_cast<double>(length) < least_travel_full_steps * ramps_.full_step)
    co_return tl::unexpected(bad_argument(
        fmt::format("a travel of {} microsteps is too short to tune by", length),
        fmt::format("it takes {:.0f} at least", least_travel_full_steps * ramps_.full_step)));
  co_await must(watched_.begin());
  const auto kept = static_cast<std::int32_t>(
      std::min(kept_full_steps * ramps_.full_step, static_cast<double>(length) / 16));
  range_ = {travel.least + kept, travel.greatest - kept};
  const auto& units = *options_.units.module;
  const double velocity = to_pps(InternalVelocity{present(ap::max_velocity)}, units).value;
  const auto acceleration = present(plan::acceleration_parameter(model()));
  ramps_.base_acceleration =
      std::min(to_pps2(InternalAcceleration{acceleration}, units).value, greatest_acceleration());
  const auto slow = ramps_.ramp_of(
      std::min(slow_part * velocity, slow_full_steps * ramps_.full_step), ramps_.base_acceleration);
  if (!slow)
    co_return tl::unexpected(
        bad_argument("the velocity and the acceleration that the axis has make no ramp",
                     "set some with which it moves slowly: 'tmclctl ramp'"));
  slow_ = *slow;
  back_ = slow_;
  if (options_.by_switch)
    switched_.emplace(axis_, watched_, *options_.by_switch, ramps_.full_step);
  else
    encoded_.emplace(axis_, watched_, *tune_encoder(model()), ramps_.full_step);
  co_return Result<void>{};
}

Script<Result<void>> Tuner::find_velocity() {
  LimitSearch::Terms terms;
  terms.first = 2 * slow_.choice.velocity.value;
  terms.most = greatest_full_steps * ramps_.full_step;
  if (options_.greatest_velocity) terms.most = options_.greatest_velocity->value;
  terms.first = std::min(terms.first, terms.most);
  terms.least = least_part * terms.first;
  LimitSearch velocities(terms);
  co_await must(search(Sought::velocity, velocities));
  const auto limit = velocities.greatest_held();
  if (!limit) co_return nothing_held(Sought::velocity, terms.first);
  auto& found = found_.velocity;
  found.limit = *limit;
  const auto& last = found_.trials;
  const bool has_lost = std::ranges::any_of(last, [](const auto& one) { return !one.held; });
  if (!has_lost) found.limited_by = beyond_travel_ ? LimitedBy::travel : LimitedBy::bounds;
  found.proposed = *limit / (1 + options_.margin);
  co_return Result<void>{};
}

double Tuner::greatest_acceleration() const {
  if (!options_.greatest_acceleration) return greatest_acceleration_full_steps * ramps_.full_step;
  // The deceleration of a ramp with a bow is set to 16/15 of what it is.
  const double part = row_of("max_bow") != nullptr ? 15.0 / 16 : 1;
  return part * options_.greatest_acceleration->value;
}

Script<Result<void>> Tuner::find_acceleration() {
  LimitSearch::Terms terms;
  terms.first = ramps_.base_acceleration;
  terms.most = greatest_acceleration();
  terms.first = std::min(terms.first, terms.most);
  terms.least = least_part * terms.first;
  const auto before = found_.trials.size();
  LimitSearch accelerations(terms);
  co_await must(search(Sought::acceleration, accelerations));
  const auto limit = accelerations.greatest_held();
  if (!limit) co_return nothing_held(Sought::acceleration, terms.first);
  auto& found = found_.acceleration;
  found.limit = *limit;
  const auto begin = found_.trials.begin() + static_cast<std::ptrdiff_t>(before);
  const bool has_lost =
      std::any_of(begin, found_.trials.end(), [](const auto& one) { return !one.held; });
  if (!has_lost) found.limited_by = LimitedBy::bounds;
  found.proposed = *limit / (1 + options_.margin);
  co_return Result<void>{};
}

/// By how many times less current.
Script<Result<void>> Tuner::find_current() {
  LimitSearch::Terms terms;
  terms.first = 1;
  terms.least = 1;
  terms.most = 1 / least_current_part;
  terms.growth = 1.2;
  terms.precision = 0.04;
  LimitSearch parts(terms);
  co_await must(search(Sought::current, parts));
  auto& found = found_.current;
  found.limit = current_for(Sought::current, parts.greatest_held().value_or(1));
  if (!parts.least_lost()) found.limited_by = LimitedBy::bounds;
  found.proposed =
      std::min<double>(std::ceil(found.limit * (1 + options_.margin)), options_.max_current);
  co_return Result<void>{};
}

Script<Result<bool>> Tuner::load_stays_up(std::int32_t threshold) {
  const auto* row = find_parameter(axis_parameters(model()), tuned::load_value);
  const auto ramp = *ramps_.ramp_for(Sought::threshold, 0);
  found_.threshold = threshold;
  co_await must(watched_.set(plan::Setting{tuned::threshold, threshold}));
  const auto current = static_cast<std::int32_t>(found_.current.proposed);
  const auto held = co_await must(trial(Sought::threshold, ramp, current, ramps_.way_of(ramp)));
  const auto& seen = found_.trials.back().load_value;
  co_return held&& seen&&* seen >= least_load_part*(row->maximum + 1);
}

/// The least with which the load value keeps off 0 at full speed.
Script<Result<void>> Tuner::find_threshold() {
  const auto* row = find_parameter(axis_parameters(model()), tuned::load_value);
  if (!has(tuned::threshold) || row == nullptr || row->maximum <= old_load_values)
    co_return Result<void>{};
  const auto* range = find_parameter(axis_parameters(model()), tuned::threshold);
  auto low = static_cast<std::int32_t>(range->minimum) - 1;
  auto high = static_cast<std::int32_t>(range->maximum);
  bool is_up = co_await must(load_stays_up(high));
  while (is_up && high - low > 1) {
    const auto middle = low + (high - low) / 2;
    const bool stays = co_await must(load_stays_up(middle));
    (stays ? high : low) = middle;
  }
  // It is not the same at each reading.
  for (int left = confirmations; is_up && left > 0; --left) {
    const bool stays = co_await must(load_stays_up(high));
    if (stays) continue;
    is_up = ++high <= range->maximum;
    left = confirmations + 1;
  }
  found_.threshold.reset();
  if (is_up) found_.threshold = high;
  if (!is_up)
    found_.warnings.emplace_back(
        "with no stallGuard2 threshold the load value keeps off 0 at the proposed velocity");
  co_await must(watched_.set(plan::Setting{tuned::threshold, present(tuned::threshold)}));
  co_return Result<void>{};
}

/// All of it on all of the travel.
Script<Result<void>> Tuner::confirm() {
  for (int retreats = 0;; ++retreats) {
    const auto ramp = ramps_.ramp_for(Sought::confirmation, 0);
    if (!ramp) co_return nothing_held(Sought::confirmation, found_.velocity.proposed);
    const auto current = static_cast<std::int32_t>(found_.current.proposed);
    bool held = true;
    for (int left = confirmations; held && left > 0; --left)
      held = co_await must(trial(Sought::confirmation, *ramp, current, room()));
    if (held) co_return Result<void>{};
    if (retreats >= most_retreats)
      co_return nothing_held(Sought::confirmation, found_.velocity.proposed);
    found_.velocity.proposed *= less;
    found_.acceleration.proposed *= less;
    found_.warnings.emplace_back(
        "what was found did not hold on all of the travel: less is proposed");
  }
}

void Tuner::propose() {
  const auto ramp = ramps_.ramp_for(Sought::confirmation, 0);
  found_.settings = plan::in_safe_order(ramp->choice.settings, present(plan::pulse_divisor));
  found_.settings.push_back(
      {tuned::max_current, static_cast<std::int32_t>(found_.current.proposed)});
  const auto& hold = found_.hold_current;
  if (hold && hold->limited_by == LimitedBy::motor)
    found_.settings.push_back({tuned::standby_current, static_cast<std::int32_t>(hold->proposed)});
  if (found_.threshold) found_.settings.push_back({tuned::threshold, *found_.threshold});
  if (encoded_) {
    found_.backlash = encoded_->backlash();
    found_.counts_per_microstep = encoded_->counts_per_microstep();
  }
  if (found_.velocity.limited_by == LimitedBy::travel)
    found_.warnings.emplace_back(
        "the travel is too short for a higher velocity with the acceleration that the axis has");
  if (found_.lost_steps)
    found_.warnings.emplace_back(
        "the axis has lost steps, and its position was set again by its encoder or switch: search "
        "the reference again");
}

Script<Result<void>> Tuner::calibrate() {
  if (switched_) return calibrate_switch();
  return calibrate_encoder();
}

Script<Result<void>> Tuner::calibrate_encoder() {
  tell("measures its encoder by slow moves");
  auto measured = range_;
  measured.greatest = static_cast<std::int32_t>(
      std::min<double>(measured.greatest, measured.least + measured_full_steps * ramps_.full_step));
  const auto all = options_.travel.greatest - options_.travel.least;
  co_await must(encoded_->calibrate(measured, limit_of(slow_, all)));
  co_return Result<void>{};
}

Script<Result<void>> Tuner::course() {
  co_await must(begin());
  for (const auto parameter : {tuned::stop_on_stall, tuned::cool_step})
    if (has(parameter)) co_await must(watched_.set(plan::Setting{parameter, 0}));
  co_await must(watched_.set(plan::Setting{tuned::max_current, options_.max_current}));
  co_await must(set_ramp(slow_));
  co_await must(calibrate());
  co_await must(find_velocity());
  co_await must(find_acceleration());
  co_await must(find_current());
  co_await must(find_threshold());
  if (encoded_) {
    co_await must(find_hold_current());
    co_await must(find_bow());
  }
  co_await must(confirm());
  co_await must(go_home());
  propose();
  co_return Result<void>{};
}

Script<Result<Tuning>> Tuner::run() {
  if (!options_.by_switch && !tune_encoder(model()))
    co_return tl::unexpected(
        bad_argument(fmt::format("a {} has no encoder that would tell lost steps", model().name),
                     "say which limit switch tells them: '--switch left'"));
  auto done = co_await course();
  co_await must(watched_.end(std::move(done)));
  co_return std::move(found_);
}

Script<Result<Tuning>> tune(AxisAddress axis, TuneOptions options) {
  Tuner tuner(axis, std::move(options));
  auto result = co_await tuner.run();
  co_return result;
}

}  // namespace verbs

std::string_view name_of(Sought sought) {
  switch (sought) {
    case Sought::velocity: return "velocity";
    case Sought::acceleration: return "acceleration";
    case Sought::current: return "current";
    case Sought::threshold: return "threshold";
    case Sought::confirmation: return "confirmation";
    case Sought::hold: return "hold";
    case Sought::bow: return "bow";
  }
  return {};
}

std::string_view name_of(LimitedBy limit) {
  switch (limit) {
    case LimitedBy::motor: return "motor";
    case LimitedBy::travel: return "travel";
    case LimitedBy::bounds: return "bounds";
  }
  return {};
}

std::optional<std::uint8_t> tune_encoder(const Model& model) {
  for (const auto* name : {"encoder_position", "external_encoder_position"}) {
    if (const auto* row = find_parameter(axis_parameters(model), name)) return row->number;
  }
  return std::nullopt;
}

std::vector<std::uint8_t> tune_parameters(const Model& model) {
  const AxisUnits units{"", &model, initial_units(model)};
  const plan::RampWish wish{{1000, "pps"}, {1000, "pps/s"}};
  std::vector<std::uint8_t> parameters;
  const auto add = [&](std::uint8_t parameter) {
    const auto* row = find_parameter(axis_parameters(model), parameter);
    if (row != nullptr && std::ranges::count(parameters, parameter) == 0)
      parameters.push_back(parameter);
  };
  if (const auto ramp = plan::plan_ramp(wish, units, 0)) {
    for (const auto& setting : ramp->choice.settings) add(setting.parameter);
  }
  add(axis_parameter::max_velocity);
  add(plan::acceleration_parameter(model));
  for (const auto* name : {"max_current", "max_bow", "stallguard2_threshold",
                           "smart_energy_stall_velocity", "smart_energy_hysteresis_start",
                           "standby_current", "power_down_delay", "power_down_ramp"}) {
    if (const auto* row = find_parameter(axis_parameters(model), name)) add(row->number);
  }
  return parameters;
}

}  // namespace tmcl
