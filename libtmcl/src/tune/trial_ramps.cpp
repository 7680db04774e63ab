#include "tune/trial_ramps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "engine/verb_steps.hpp"
#include "tmcl/plan/ramp_comparison.hpp"
#include "tmcl/seconds.hpp"
#include "tune/tuned_parameters.hpp"

namespace tmcl::verbs {
namespace {

using namespace std::chrono_literals;

/// How long a trial goes at full speed at least, in seconds.
constexpr double cruise_s = 0.3;
constexpr Duration trial_grace = 2s;
/// Within this the load is to stand.
constexpr double full_steps_of_swing = 0.1;
/// Moves that differ by so many parts of a swing: what the beginning leaves may add to what the end
/// does, or take from it.
constexpr std::array parts_of_swing{0.0, 0.25, 0.5, 0.75};

Duration duration_of(double seconds) {
  return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds));
}

}  // namespace

std::int32_t TrialRamps::present(std::uint8_t parameter) const {
  const auto set = std::ranges::find(options.settings, parameter, &plan::Setting::parameter);
  return set == options.settings.end() ? 0 : set->value;
}

std::optional<plan::PlannedRamp> TrialRamps::ramp_of(double velocity, double acceleration) const {
  const plan::RampWish wish{{velocity, "pps"}, {acceleration, "pps/s"}};
  auto planned = plan::plan_ramp(wish, options.units, present(tuned::max_bow));
  if (!planned) return std::nullopt;
  return std::move(*planned);
}

std::optional<plan::PlannedRamp> TrialRamps::ramp_for(Sought sought, double value) const {
  switch (sought) {
    case Sought::velocity: return ramp_of(value, base_acceleration);
    case Sought::acceleration: return ramp_of(found.velocity.proposed, value);
    case Sought::confirmation:
      if (found.bow) return bowed_ramp(found.bow->value, options.units);
      [[fallthrough]];
    default: return ramp_of(found.velocity.proposed, found.acceleration.proposed);
  }
}

std::int32_t TrialRamps::way_of(const plan::PlannedRamp& ramp) const {
  const double way = 2 * ramp.ramp_up().microsteps + cruise_s * ramp.choice.velocity.value +
                     full_steps_beyond * full_step;
  return static_cast<std::int32_t>(std::min<double>(std::ceil(way), INT32_MAX / 2));
}

Duration limit_of(const plan::PlannedRamp& ramp, std::int32_t way) {
  return trial_grace + duration_of(2 * ramp.ramp_up().seconds + way / ramp.choice.velocity.value);
}

std::optional<plan::PlannedRamp> TrialRamps::bowed_ramp(std::int32_t bow,
                                                        const AxisUnits& units) const {
  plan::RampWish wish{{found.velocity.proposed, "pps"}, {found.acceleration.proposed, "pps/s"}};
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
std::vector<std::int32_t> TrialRamps::gentler_bows(std::int32_t room) const {
  const auto before = present(tuned::max_bow);
  const auto most = before == 0 ? greatest_bow : before - 1;
  std::vector<std::int32_t> bows{before};
  for (auto bow = most; bow >= 1; --bow) {
    const auto ramp = bowed_ramp(bow, options.units);
    if (!ramp || way_of(*ramp) > room) continue;
    const auto& settings = ramp->choice.settings;
    const auto set = std::ranges::find(settings, tuned::max_bow, &plan::Setting::parameter);
    if (set != settings.end() && set->value == bow) bows.push_back(bow);
  }
  return bows;
}

/// The longest of moves of about this way; nothing if one does not come to an end.
std::optional<double> TrialRamps::settled_s(std::int32_t bow, double way,
                                            const ramp::Resonance& resonance) const {
  const AxisUnits units{"", &model(), initial_units(model())};
  const auto ramp = bowed_ramp(bow, units);
  if (!ramp) return std::nullopt;
  const plan::LoadWish load{resonance, full_steps_of_swing * full_step};
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
Script<std::int32_t> TrialRamps::first_settled_bow(ramp::Resonance resonance,
                                                   std::int32_t room) const {
  const auto bows = gentler_bows(room);
  double way = 0;
  for (const auto bow : bows) way = std::max<double>(way, way_of(*bowed_ramp(bow, options.units)));
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

}  // namespace tmcl::verbs
