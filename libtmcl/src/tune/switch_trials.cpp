// Trials of an axis without an encoder: what was lost is seen when it goes to its switch.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "engine/verb_steps.hpp"
#include "tune/tuner.hpp"

namespace tmcl::verbs {
namespace {

/// The trials keep this much of the travel from the switch.
constexpr double clear_full_steps = 16;
constexpr double least_room_full_steps = 48;

}  // namespace

Script<Result<void>> Tuner::calibrate_switch() {
  tell("approaches its switch slowly, some times");
  const auto all = options_.travel.greatest - options_.travel.least;
  co_await must(switched_->calibrate(options_.travel, limit_of(slow_, all)));
  away_ = switched_->away();
  const auto clear = static_cast<std::int32_t>(clear_full_steps * ramps_.full_step);
  (away_ > 0 ? range_.least : range_.greatest) = switched_->reference() + away_ * clear;
  if (room() < least_room_full_steps * ramps_.full_step)
    co_return tl::unexpected(bad_argument(
        fmt::format("{} microsteps beside the switch are too short to tune by", room()),
        fmt::format("it takes {:.0f} at least", least_room_full_steps * ramps_.full_step)));
  co_await must(go_slowly_to(base()));
  co_return Result<void>{};
}

/// With all the current, and back to where trials begin. Gives back how far its position was off.
Script<Result<double>> Tuner::find_switch(std::int32_t way) {
  co_await must(watched_.set(plan::Setting{tuned::max_current, options_.max_current}));
  co_await must(set_ramp(slow_));
  // All the way may have been lost.
  const auto reach = way + std::abs(base() - switched_->reference());
  const auto off = co_await must(switched_->find_switch(reach, limit_of(slow_, 2 * reach)));
  co_await must(go_slowly_to(base()));
  co_return off;
}

/// What brings an axis back for certain.
Script<Result<void>> Tuner::set_gentle() {
  co_await must(watched_.set(plan::Setting{tuned::max_current, options_.max_current}));
  co_await must(set_ramp(back_));
  co_return Result<void>{};
}

/// First back with what has held: what was lost on the way out would take the axis into its switch
/// fast, and a motor that turned neither out nor back would seem to have lost nothing.
Script<Result<void>> Tuner::out_and_back(TuneTrial& trial, const plan::PlannedRamp& ramp,
                                         std::int32_t way) {
  const auto lookout = lookout_of(trial, ramp, way);
  for (int round = 0; round < 2 && trial.trouble.empty(); ++round) {
    const bool is_fast = round > 0;
    co_await must(watched_.set(plan::Setting{tuned::max_current, trial.current}));
    co_await must(set_ramp(ramp));
    const auto out = co_await must(switched_->pass_to(at(way), lookout));
    if (!is_fast) co_await must(set_gentle());
    Lookout on_way_back = lookout;
    if (!is_fast) on_way_back = Lookout{limit_of(back_, way), std::nullopt};
    const auto back = co_await must(switched_->pass_to(base(), on_way_back));
    for (const auto* passage : {&out, &back}) {
      if (passage->load_value)
        trial.load_value =
            std::min(trial.load_value.value_or(*passage->load_value), *passage->load_value);
      if (trial.trouble.empty()) trial.trouble = passage->trouble;
    }
    co_await must(watched_.stop());
    const auto off = co_await must(find_switch(way));
    trial.deviation = std::max(trial.deviation, off);
    if (off > switched_->tolerance())
      trial.trouble = fmt::format("the switch closed {:.1f} full steps from where it should have",
                                  off / ramps_.full_step);
  }
  trial.held = trial.trouble.empty();
  found_.lost_steps = found_.lost_steps || !trial.held;
  co_return Result<void>{};
}

/// One that began on its switch ends there.
Script<Result<void>> Tuner::go_home() {
  const auto home = watched_.home().value;
  const bool is_on_switch = switched_ && away_ * (std::int64_t{home} - switched_->reference()) <= 0;
  if (!is_on_switch) {
    co_await must(go_slowly_to(home));
    co_return Result<void>{};
  }
  co_await must(set_ramp(slow_));
  const auto reach = std::abs(base() - switched_->reference());
  co_await must(switched_->find_switch(reach, limit_of(slow_, 2 * reach)));
  co_return Result<void>{};
}

}  // namespace tmcl::verbs
