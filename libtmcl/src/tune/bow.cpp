// The bow with which a load that swings stands first: the swing is measured, each bow is worked
// out, and the best is tried.
#include <optional>
#include <utility>
#include <vector>

#include "engine/verb_steps.hpp"
#include "tmcl/plan/ring_down.hpp"
#include "tmcl/seconds.hpp"
#include "tune/tuner.hpp"

namespace tmcl::verbs {

/// There and back with it; nothing if that did not hold.
Script<Result<std::optional<double>>> Tuner::swing_with(std::int32_t bow) {
  const auto ramp = *ramps_.bowed_ramp(bow, options_.units);
  const auto current = static_cast<std::int32_t>(found_.current.proposed);
  std::optional<double> swing;
  const auto held = co_await must(trial(Sought::bow, ramp, current, ramps_.way_of(ramp)));
  if (held) swing = found_.trials.back().swing;
  co_return swing;
}

plan::RingDown Tuner::ring_down_seen() const {
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
  if (seen.verdict == plan::RingDown::Verdict::unclear)
    found_.warnings.emplace_back(
        "how the load swings is not clear, so no bow is proposed: see 'tmclctl resonance'");
  if (seen.verdict != plan::RingDown::Verdict::rings) co_return Result<void>{};
  found_.bow->resonance = seen.resonance;
  const auto bow = co_await ramps_.first_settled_bow(seen.resonance, room());
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
