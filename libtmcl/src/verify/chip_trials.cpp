#include "verify/chip_trials.hpp"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "engine/verb_steps.hpp"

namespace tmcl::verbs {
namespace {

using namespace std::chrono_literals;
using plan::Experiment;
using Pairs = plan::ChipCandidates::Pairs;

constexpr auto chip_traits =
    std::to_array<Trait>({Trait::last_step, Trait::factor_rule, Trait::order, Trait::accumulator});

/// Each that helps is made twice, if need be: readings come at other moments then.
constexpr unsigned most_repetitions = 2;
/// What only the order of the stages is seen by, seldom tells.
constexpr unsigned most_of_order = 3;
constexpr Duration grace = 2s;

std::string count(std::size_t number, std::string_view what) {
  return fmt::format("{} {}{}", number, what, number == 1 ? "" : "s");
}

std::string text_of(const Experiment& experiment) {
  return fmt::format("v_max={} a_max={} v_min={} pulse_div={} ramp_div={}", experiment.velocity,
                     experiment.acceleration, experiment.minimum_velocity,
                     experiment.dividers.pulse, experiment.dividers.ramp);
}

}  // namespace

bool ChipTrials::is_within(const Experiment& experiment) const {
  const auto& greatest = inquiry_.options().greatest_acceleration;
  return experiment.distance < room_.distance && inquiry_.allows(experiment.pps()) &&
         (!greatest || experiment.pps2() <= *greatest);
}

/// What tells most apart in the time that it takes; nothing where nothing does. Others may want
/// the computer meanwhile.
Script<std::optional<std::size_t>> ChipTrials::choose(Pairs pairs_of) const {
  std::optional<std::size_t> best;
  double best_score = 0;
  const auto all = plan::experiments();
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (made_.at(i) >= most_repetitions || !is_within(all[i])) continue;
    const auto pairs = candidates_.pairs_apart(i, 2 * watched_.usual_exchange(), pairs_of);
    co_await pause({});
    if (pairs == 0) continue;
    const std::chrono::duration<double> time = 1s + 2 * candidates_.longest(i);
    const auto score = static_cast<double>(pairs) / time.count();
    if (score > best_score) best = i;
    best_score = std::max(score, best_score);
  }
  co_return best;
}

Script<Result<void>> ChipTrials::way(std::size_t number, std::int32_t target) {
  const auto& experiment = plan::experiments()[number];
  const auto limit = candidates_.longest(number) + grace;
  const auto move = co_await must(watched_.move_to(target, limit));
  const auto foreseen = candidates_.judge(experiment, move);
  const auto& arrival = move.sightings.back().when;
  auto last_before = move.told.received;
  for (const auto& sighting : move.sightings) {
    if (sighting.steps != std::abs(move.distance)) last_before = sighting.when.sent;
  }
  inquiry_.found().moves.push_back({move.distance, text_of(experiment), foreseen,
                                    std::max(last_before - move.told.received, Duration{}),
                                    arrival.received - move.told.sent});
  co_return Result<void>{};
}

Script<Result<void>> ChipTrials::level() {
  co_await must(watched_.set(plan::levelling()));
  const auto next = 1 - offset_;
  const auto target = watched_.home().value + room_.sign * next;
  co_await must(watched_.move_to(target, grace));
  candidates_.level(room_.sign * (next - offset_));
  offset_ = next;
  co_return Result<void>{};
}

Script<Result<void>> ChipTrials::make(std::size_t number) {
  const auto& experiment = plan::experiments()[number];
  co_await must(level());
  co_await must(watched_.set(experiment));
  const auto here = watched_.home().value + room_.sign * offset_;
  co_await must(way(number, here + room_.sign * experiment.distance));
  co_await must(way(number, here));
  co_return Result<void>{};
}

Script<Result<void>> ChipTrials::run() {
  unsigned of_order = 0;
  while (candidates_.size() > 1) {
    auto best = co_await choose(Pairs::any);
    if (!best && of_order++ < most_of_order) best = co_await choose(Pairs::only_by_order);
    if (!best) break;
    ++made_.at(*best);
    const auto& next = plan::experiments()[*best];
    inquiry_.tell(fmt::format("moves by {} there and back: {} of the chip left",
                              count(static_cast<std::size_t>(next.distance), "microstep"),
                              count(candidates_.size(), "variant")));
    co_await must(make(*best));
  }
  conclude();
  co_await must(watched_.go_home());
  co_return Result<void>{};
}

void ChipTrials::conclude() {
  const auto moves = count(inquiry_.found().moves.size(), "move");
  const auto left_out = std::ranges::count_if(
      plan::experiments(), [&](const auto& experiment) { return !is_within(experiment); });
  for (const auto trait : chip_traits) {
    auto fits = candidates_.variants(trait);
    if (inquiry_.found().moves.empty()) {
      inquiry_.not_measured(trait, left_out > 0
                                       ? "no experiment fits into the travel and the limits"
                                       : "the line is too slow to tell variants apart");
      continue;
    }
    auto text = "as " + moves + " say";
    if (fits.empty()) text = "no known variant moves like this";
    if (fits.size() > 1) text = "these move alike, as far as this line shows";
    if (fits.size() > 1 && left_out > 0)
      text += fmt::format("; {} did not fit into the travel and the limits",
                          count(static_cast<std::size_t>(left_out), "experiment"));
    inquiry_.finding(trait, std::move(fits), std::move(text));
  }
}

}  // namespace tmcl::verbs
