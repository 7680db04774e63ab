// Of one trial, and of a search by trials.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "engine/verb_steps.hpp"
#include "motion/twin/divisors.hpp"
#include "tune/tuner.hpp"

namespace tmcl::verbs {
namespace {

namespace ap = axis_parameter;

constexpr double full_speed_part = 0.98;
/// A trial that failed is gone back from with this part of what has held.
constexpr double back_part = 0.5;

}  // namespace

std::int32_t Tuner::current_for(Sought sought, double value) const {
  if (sought != Sought::current) return options_.max_current;
  return static_cast<std::int32_t>(std::ceil(options_.max_current / std::max(value, 1.0)));
}

// A ramp that says nothing of a bow has the one that the axis has had.
Script<Result<void>> Tuner::set_ramp(const plan::PlannedRamp& ramp) {
  auto settings = plan::in_safe_order(ramp.choice.settings, present(plan::pulse_divisor));
  const bool has_bow = std::ranges::count(settings, tuned::max_bow, &plan::Setting::parameter) != 0;
  if (row_of("max_bow") != nullptr && !has_bow)
    settings.push_back({tuned::max_bow, present(tuned::max_bow)});
  for (const auto& setting : settings) co_await must(watched_.set(setting));
  co_return Result<void>{};
}

// ---- trials -----------------------------------------------------------------------------------

Script<Result<void>> Tuner::go_slowly_to(std::int32_t target) {
  co_await must(set_ramp(back_));
  const auto way = options_.travel.greatest - options_.travel.least;
  const Lookout lookout{limit_of(back_, way), std::nullopt};
  auto move = switched_ ? switched_->pass_to(target, lookout) : encoded_->pass_to(target, lookout);
  const auto passage = co_await must(std::move(move));
  if (passage.held()) co_return Result<void>{};
  Error error;
  error.code = Errc::move_interrupted;
  error.outcome = Outcome::unknown;
  error.message = "the axis does not follow a slow move any more: " + passage.trouble;
  error.hint = "its position is not to be trusted; search the reference again";
  co_return tl::unexpected(std::move(error));
}

// Its backlash is on the one side after a move up and on the other one after a move down: where
// the motor did not move at all, nothing tells on which.
Script<Result<void>> Tuner::recover(bool up, Duration limit) {
  found_.lost_steps = true;
  co_await must(encoded_->correct(up, limit));
  co_await must(watched_.set(plan::Setting{tuned::max_current, options_.max_current}));
  co_await must(set_ramp(back_));
  const auto reserve =
      static_cast<std::int32_t>(encoded_->backlash() + full_steps_beyond * ramps_.full_step);
  const auto target = std::min(range_.least + reserve, range_.greatest);
  const Lookout lookout{limit_of(back_, room() + 2 * reserve), std::nullopt};
  co_await must(encoded_->pass_to(target, lookout));
  co_await must(encoded_->pass_to(range_.least, lookout));
  co_await must(encoded_->correct(false, limit));
  co_await must(go_slowly_to(range_.least));
  co_return Result<void>{};
}

Lookout Tuner::lookout_of(const TuneTrial& trial, const plan::PlannedRamp& ramp,
                          std::int32_t way) const {
  Lookout lookout{limit_of(ramp, way), std::nullopt, trial.sought == Sought::bow};
  if (!trial.threshold) return lookout;
  const auto& settings = ramp.choice.settings;
  const auto top = std::ranges::find(settings, ap::max_velocity, &plan::Setting::parameter);
  lookout.load_value_from = static_cast<std::int32_t>(full_speed_part * top->value);
  return lookout;
}

Script<Result<void>> Tuner::there_and_back(TuneTrial& trial, const plan::PlannedRamp& ramp,
                                           std::int32_t way) {
  const auto lookout = lookout_of(trial, ramp, way);
  const std::int32_t targets[] = {range_.least + way, range_.least};
  for (const auto target : targets) {
    auto passage = co_await must(encoded_->pass_to(target, lookout));
    trial.deviation = std::max(trial.deviation, passage.deviation);
    if (passage.load_value)
      trial.load_value =
          std::min(trial.load_value.value_or(*passage.load_value), *passage.load_value);
    if (lookout.listens)
      trial.swing = std::max(trial.swing.value_or(0), encoded_->swing_of(passage.at_rest));
    at_rest_ = std::move(passage.at_rest);
    trial.trouble = passage.trouble;
    const bool is_back = target == range_.least;
    if (passage.held() && passage.drifted && is_back) {
      found_.lost_steps = true;
      co_await must(encoded_->correct(false, lookout.limit));
    }
    if (passage.held()) continue;
    co_await must(recover(!is_back, lookout.limit));
    break;
  }
  trial.held = trial.trouble.empty();
  co_return Result<void>{};
}

Script<Result<bool>> Tuner::trial(Sought sought, const plan::PlannedRamp& ramp,
                                  std::int32_t current, std::int32_t way) {
  TuneTrial trial;
  trial.sought = sought;
  trial.velocity = ramp.choice.velocity;
  trial.acceleration = ramp.choice.acceleration;
  trial.current = current;
  if (sought == Sought::threshold) trial.threshold = found_.threshold;
  co_await must(watched_.set(plan::Setting{tuned::max_current, current}));
  co_await must(set_ramp(ramp));
  auto moves = switched_ ? out_and_back(trial, ramp, way) : there_and_back(trial, ramp, way);
  co_await must(std::move(moves));
  tell(fmt::format("{}: {:.0f} microsteps/s, {:.0f} microsteps/s^2, current {}: {}",
                   name_of(sought), trial.velocity.value, trial.acceleration.value, current,
                   trial.held ? "held" : trial.trouble));
  found_.trials.push_back(trial);
  co_return trial.held;
}

/// What does not fit counts as if it had not held, and is not tried.
Script<Result<void>> Tuner::search(Sought sought, plan::LimitSearch& search) {
  beyond_bounds_ = false;
  beyond_travel_ = false;
  while (const auto value = search.next()) {
    const auto ramp = ramps_.ramp_for(sought, *value);
    const bool is_too_long = ramp && ramps_.way_of(*ramp) > room();
    if (!ramp || is_too_long) {
      beyond_bounds_ = beyond_bounds_ || !ramp;
      beyond_travel_ = beyond_travel_ || is_too_long;
      search.tried(*value, false);
      continue;
    }
    const auto held =
        co_await must(trial(sought, *ramp, current_for(sought, *value), ramps_.way_of(*ramp)));
    search.tried(*value, held);
    if (!held || sought != Sought::velocity) continue;
    auto back = ramps_.ramp_of(back_part * *value, ramps_.base_acceleration);
    if (back && back->choice.velocity > slow_.choice.velocity) back_ = std::move(*back);
  }
  co_return Result<void>{};
}

}  // namespace tmcl::verbs
