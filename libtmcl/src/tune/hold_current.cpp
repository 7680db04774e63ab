// The standby current: what an axis needs so that nothing moves it while it stands.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "engine/verb_steps.hpp"
#include "tune/tuner.hpp"

namespace tmcl::verbs {
namespace {

using namespace std::chrono_literals;

/// A driver scales its current in so many steps.
constexpr std::int32_t driver_steps = 32;
/// For so long an axis is looked at.
constexpr Duration at_rest = 1s;
/// A move before that makes up for the backlash, and goes so much farther.
constexpr double full_steps_moved = 8;

std::int32_t driver_step(const ParameterInfo& row) {
  return (row.maximum + driver_steps) / driver_steps;
}

}  // namespace

const ParameterInfo* Tuner::row_of(std::string_view name) const {
  return find_parameter(axis_parameters(model()), name);
}

/// It takes over as soon as the axis stands.
Script<Result<void>> Tuner::hold_at_once() {
  for (const auto* name : {"power_down_delay", "power_down_ramp"}) {
    const auto* row = row_of(name);
    if (row != nullptr) co_await must(watched_.set(plan::Setting{row->number, row->minimum}));
  }
  co_return Result<void>{};
}

/// After a move up and after one down. The current is less only while the axis is looked at.
Script<Result<bool>> Tuner::stands_with(std::int32_t current) {
  TuneTrial trial;
  trial.sought = Sought::hold;
  trial.velocity = back_.choice.velocity;
  trial.acceleration = back_.choice.acceleration;
  trial.current = current;
  const auto way = encoded_->backlash() + full_steps_moved * ramps_.full_step;
  const auto low = range_.least + room() / 2;
  const auto high = low + static_cast<std::int32_t>(std::min(way, room() / 4.0));
  const std::int32_t targets[] = {high, low};
  for (const auto target : targets) {
    co_await must(go_slowly_to(target));
    const plan::Setting less{tuned::standby_current, current};
    const auto slid = co_await must(encoded_->slides_with(less, at_rest));
    co_await must(watched_.set(plan::Setting{tuned::standby_current, options_.max_current}));
    trial.deviation = std::max(trial.deviation, slid);
    if (slid <= encoded_->tolerance_at_rest()) continue;
    trial.trouble =
        fmt::format("it slid {:.1f} full steps while it stood", slid / ramps_.full_step);
    co_await must(recover(target == high, limit_of(back_, room())));
    break;
  }
  trial.held = trial.trouble.empty();
  tell(fmt::format("hold: current {}: {}", current, trial.held ? "held" : trial.trouble));
  found_.trials.push_back(trial);
  co_return trial.held;
}

/// From what it has down by one step of the driver each, until it moves: a load that hangs slides
/// once. If it moves with what it has, up.
Script<Result<std::optional<std::int32_t>>> Tuner::least_hold_current() {
  const auto& row = *row_of("standby_current");
  const auto step = driver_step(row);
  auto current = std::min(present(tuned::standby_current), options_.max_current);
  bool stands = co_await must(stands_with(current));
  const bool goes_down = stands;
  while (!stands && current < options_.max_current) {
    current = std::min(current + step, options_.max_current);
    stands = co_await must(stands_with(current));
  }
  while (goes_down && stands && current > row.minimum) {
    const auto less = std::max(current - step, row.minimum);
    stands = co_await must(stands_with(less));
    if (stands) current = less;
  }
  std::optional<std::int32_t> least;
  if (goes_down || stands) least = current;
  co_return least;
}

Script<Result<void>> Tuner::find_hold_current() {
  const auto* row = row_of("standby_current");
  if (row == nullptr) co_return Result<void>{};
  co_await must(watched_.set(plan::Setting{tuned::max_current, options_.max_current}));
  co_await must(watched_.set(plan::Setting{tuned::standby_current, options_.max_current}));
  co_await must(hold_at_once());
  const auto least = co_await must(least_hold_current());
  for (const auto* name : {"standby_current", "power_down_delay", "power_down_ramp"}) {
    const auto* held = row_of(name);
    if (held != nullptr)
      co_await must(watched_.set(plan::Setting{held->number, present(held->number)}));
  }
  if (!least) {
    found_.warnings.emplace_back(
        "with no standby current up to the greatest that may flow the axis stood");
    co_return Result<void>{};
  }
  const auto is_lost = [](const auto& one) { return one.sought == Sought::hold && !one.held; };
  TunedValue found;
  found.limit = *least;
  if (std::ranges::any_of(found_.trials, is_lost)) {
    const auto more =
        std::max(std::ceil(found.limit * (1 + options_.margin)), found.limit + driver_step(*row));
    found.proposed = std::min<double>(more, options_.max_current);
  } else {
    found.limited_by = LimitedBy::bounds;
    found.proposed = present(tuned::standby_current);
  }
  found_.hold_current = found;
  co_return Result<void>{};
}

}  // namespace tmcl::verbs
