// The bow with which a load that swings stands first: the swing is measured, each bow is worked
// out, and the best is tried.
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/verb_steps.hpp"
#include "tmcl/plan/ramp_comparison.hpp"
#include "tmcl/plan/ring_down.hpp"
#include "tmcl/seconds.hpp"
#include "tune/tuner.hpp"

namespace tmcl::verbs {
namespace {

using plan::RingDown;

/// Within this the load is to stand.
constexpr double full_steps_of_swing = 0.1;
/// Moves that differ by so many parts of a swing: what the beginning leaves may add to what the end
/// does, or take from it.
constexpr std::array parts_of_swing{0.0, 0.25, 0.5, 0.75};

}  // namespace

std::optional<plan::PlannedRamp> Tuner::bowed_ramp(std::int32_t bow, const AxisUnits& units) const {
  plan::RampWish wish{{found_.velocity.proposed, "pps"}, {found_.acceleration.proposed, "pps/s"}};
  // What it has may be none, for which there is no jerk.
  const auto before = present(tuned::max_bow);
  if (bow != before) wish.jerk = plan::JerkWish{.quantity = {}, .bow = bow, .highest = false};
  auto planned = plan::plan_ramp(wish, units, before);
  if (!planned) return std::nullopt;
  return std::move(*planned);
}

/// No steeper than the one with which the axis has been tried: a gentler one asks for no more
/// torque at any speed. None with which the module swings by itself, or for which the travel is too
/// short.
std::vector<std::int32_t> Tuner::gentler_bows() const {
  const auto before = present(tuned::max_bow);
  const auto most = before == 0 ? greatest_bow : before - 1;
  std::vector<std::int32_t> bows{before};
  for (auto bow = most; bow >= 1; --bow) {
    const auto ramp = bowed_ramp(bow, options_.units);
    if (!ramp || way_of(*ramp) > room()) continue;
    const auto& settings = ramp->choice.settings;
    const auto set = std::ranges::find(settings, tuned::max_bow, &plan::Setting::parameter);
    if (set != settings.end() && set->value == bow) bows.push_back(bow);
  }
  return bows;
}

/// The longest of moves of about this way; nothing if one does not come to an end.
std::optional<double> Tuner::settled_s(std::int32_t bow, double way,
                                       const ramp::Resonance& resonance) const {
  const AxisUnits units{"", &model(), initial_units(model())};
  const auto ramp = bowed_ramp(bow, units);
  if (!ramp) return std::nullopt;
  const plan::LoadWish load{resonance, full_steps_of_swing * full_step_};
  double longest = 0;
  for (const double part : parts_of_swing) {
    const double distance = way + part * ramp->choice.velocity.value / resonance.frequency_hz;
    const auto verdict = plan::judge_variant(model(), ramp->choice.settings, {},
                                             Microsteps{static_cast<std::int32_t>(distance)}, load);
    if (!verdict || !verdict->settled_s) return std::nullopt;
    const double later = (distance - way) / ramp->choice.velocity.value;
    longest = std::max(longest, *verdict->settled_s - later);
  }
  return longest;
}

/// Of equal ones the steepest. Others get their turn between two: each takes some milliseconds.
Script<std::int32_t> Tuner::first_settled_bow(ramp::Resonance resonance) const {
  const auto bows = gentler_bows();
  double way = 0;
  for (const auto bow : bows) way = std::max<double>(way, way_of(*bowed_ramp(bow, options_.units)));
  auto best = bows.front();
  auto least = settled_s(best, way, resonance);
  for (const auto bow : bows) {
    co_await pause({});
    const auto settled = settled_s(bow, way, resonance);
    if (!settled || (least && *settled >= *least)) continue;
    least = settled;
    best = bow;
  }
  co_return best;
}

/// There and back with it; nothing if that did not hold.
Script<Result<std::optional<double>>> Tuner::swing_with(std::int32_t bow) {
  const auto ramp = *bowed_ramp(bow, options_.units);
  const auto current = static_cast<std::int32_t>(found_.current.proposed);
  std::optional<double> swing;
  const auto held = co_await must(trial(Sought::bow, ramp, current, way_of(ramp)));
  if (held) swing = found_.trials.back().swing;
  co_return swing;
}

RingDown Tuner::ring_down_seen() const {
  std::vector<plan::PositionAt> positions;
  for (const auto& [at, value] : at_rest_)
    positions.push_back({seconds(at - at_rest_.front().at), static_cast<double>(value)});
  return plan::ring_down(positions);
}

Script<Result<void>> Tuner::find_bow() {
  if (row_of("max_bow") == nullptr) co_return Result<void>{};
  const auto before = present(tuned::max_bow);
  const auto swing = co_await must(swing_with(before));
  if (!swing) co_return Result<void>{};
  const auto seen = ring_down_seen();
  found_.bow = TunedBow{before, std::nullopt, *swing, *swing};
  if (seen.verdict == RingDown::Verdict::unclear)
    found_.warnings.emplace_back(
        "how the load swings is not clear, so no bow is proposed: see 'tmclctl resonance'");
  if (seen.verdict != RingDown::Verdict::rings) co_return Result<void>{};
  found_.bow->resonance = seen.resonance;
  const auto bow = co_await first_settled_bow(seen.resonance);
  if (bow == before) co_return Result<void>{};
  const auto less = co_await must(swing_with(bow));
  if (less && *less < *swing) {
    found_.bow->value = bow;
    found_.bow->swing = *less;
  } else {
    found_.warnings.emplace_back(
        "the bow that should leave the least swing left no less, and is not proposed");
  }
  co_return Result<void>{};
}

}  // namespace tmcl::verbs
