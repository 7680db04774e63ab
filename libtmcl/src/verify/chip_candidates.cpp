#include "verify/chip_candidates.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace tmcl::plan {
namespace {

using Chip = ramp::Tmc429;
using R = Chip::Register;
using ramp::Tick;

constexpr std::array<Trait, 4> chip_traits{Trait::last_step, Trait::factor_rule, Trait::order,
                                           Trait::accumulator};
constexpr std::array<R, 4> chip_registers{R::last_step, R::factor_rule, R::order, R::accumulator};
constexpr std::size_t order_index = 2;
/// No longer wait for a movement that some variants never end.
constexpr Duration longest_move = std::chrono::seconds(8);
constexpr Tick longest_ticks = longest_move / Chip::base_tick;
/// By so much firmware may be late with what it does and tells.
constexpr Duration firmware_lag = std::chrono::microseconds(500);
/// The clock of a module is off by less than one part of so many.
constexpr int clock_tolerance = 1000;
/// So much later a motor that is on its target has stopped.
constexpr int settling_bits = 14;

// From a search by chance for a few that tell apart all variants, the early ones also on a slow
// line: by what they tell apart in the time that they take. All variants arrive in each.
constexpr auto all_experiments = std::to_array<Experiment>({
    {8, 223, 1, {4, 6}, 2},     {404, 64, 2, {10, 8}, 2},   {110, 144, 14, {10, 8}, 2},
    {128, 264, 1, {6, 8}, 7},   {887, 36, 2, {11, 9}, 5},   {29, 16, 9, {7, 5}, 2},
    {61, 4, 5, {9, 10}, 4},     {139, 94, 1, {9, 7}, 24},   {642, 14, 11, {11, 11}, 4},
    {46, 274, 3, {6, 11}, 32},  {82, 389, 6, {11, 10}, 5},  {50, 2, 6, {6, 6}, 76},
    {15, 9, 2, {9, 11}, 2},     {136, 57, 7, {8, 10}, 76},  {533, 14, 1, {9, 6}, 2},
    {263, 151, 3, {9, 8}, 3},   {202, 22, 10, {11, 8}, 5},  {27, 405, 14, {4, 11}, 15},
    {180, 119, 3, {10, 8}, 2},  {173, 32, 18, {11, 10}, 5}, {193, 46, 8, {11, 9}, 9},
    {1000, 250, 1, {10, 5}, 2},
});
// Each pulse adds 1 to what is left of a microstep, and the ramp stage looks between two pulses:
// the motor stops when nothing is left.
constexpr Experiment levelling_move{1, 2047, 1, {4, 3}, 1};

// ---- how a chip moves -------------------------------------------------------------------------

struct Step {
  Duration at;  ///< Since the ramp tick before which the movement was asked for.
  std::int32_t steps;
};
struct Course {
  std::vector<Step> steps;
  Chip chip;  ///< At rest again, if it arrives.
  bool arrives = false;
};

Duration time_of(Tick ticks) { return ticks * Chip::base_tick; }

void set(Chip& chip, const Experiment& experiment) {
  chip.write(R::pulse_div, experiment.dividers.pulse);
  chip.write(R::ramp_div, experiment.dividers.ramp);
  chip.write(R::a_max, experiment.acceleration);
  chip.write(R::v_min, experiment.minimum_velocity);
  chip.write(R::v_max, experiment.velocity);
}

/// Brings a chip at rest to a ramp tick; where pulses are rarer than those, to this one of them.
void wait_for_phase(Chip& chip, Tmc429Dividers dividers, Tick phase) {
  const auto bits = std::max(dividers.pulse, dividers.ramp);
  chip.advance_to((((chip.tick() >> bits) + 1) << bits) + (phase << dividers.ramp));
}
Tick phases_of(Tmc429Dividers dividers) {
  return dividers.pulse > dividers.ramp ? Tick{1} << (dividers.pulse - dividers.ramp) : 1;
}

/// The tick at which it is somewhere else than at its present one: not after `until`, where it is.
Tick tick_of_step(const Chip& chip, Tick until) {
  auto before = chip.tick();
  auto after = until;
  while (after - before > 1) {
    const auto middle = before + (after - before) / 2;
    auto copy = chip;
    copy.advance_to(middle);
    (copy.x_actual() != chip.x_actual() ? after : before) = middle;
  }
  return after;
}

Course course_of(Chip chip, const Experiment& experiment, std::int32_t distance, Tick phase = 0) {
  set(chip, experiment);
  wait_for_phase(chip, experiment.dividers, phase);
  const auto begin = chip.tick();
  const auto from = chip.x_actual();
  const auto sign = distance < 0 ? -1 : 1;
  chip.write(R::x_target, from + distance);
  chip.write(Chip::Mode::ramp);
  Course course{{{Duration{}, 0}}, chip};
  while (!(chip.at_target() && chip.settled()) && chip.tick() < begin + longest_ticks) {
    auto next = chip;
    next.advance_to(std::min(chip.next_change(), begin + longest_ticks));
    if (next.x_actual() != chip.x_actual()) {
      next = chip;
      next.advance_to(tick_of_step(chip, chip.next_change()));
      course.steps.push_back({time_of(next.tick() - begin), sign * (next.x_actual() - from)});
    }
    chip = next;
  }
  course.arrives = chip.at_target() && chip.settled();
  chip.advance_to(((chip.tick() >> settling_bits) + 2) << settling_bits);
  course.chip = chip;
  return course;
}

/// Only where it stops matters: what was left over before is not known.
void make_level(Chip& chip, std::int32_t distance) {
  chip = course_of(chip, levelling_move, distance).chip;
}

// ---- whether that is what was seen ------------------------------------------------------------

/// Moments at which the movement may have begun.
struct Span {
  TimePoint first;
  TimePoint last;
};
using Spans = std::vector<Span>;

/// With which beginnings the motor is there when it was seen.
Spans beginnings(const Course& course, const Sighting& sighting) {
  Spans spans;
  for (auto step = course.steps.begin(); step != course.steps.end(); ++step) {
    if (step->steps != sighting.steps) continue;
    const auto next = step + 1;
    const auto enters = step->at - step->at / clock_tolerance;
    const auto leaves =
        next == course.steps.end() ? 2 * longest_move : next->at + next->at / clock_tolerance;
    spans.push_back({sighting.when.sent - firmware_lag - leaves, sighting.when.received - enters});
  }
  return spans;
}

Spans common(const Spans& some, const Spans& others) {
  Spans spans;
  for (const auto& one : some) {
    for (const auto& other : others) {
      const Span both{std::max(one.first, other.first), std::min(one.last, other.last)};
      if (both.first <= both.last) spans.push_back(both);
    }
  }
  return spans;
}

bool fits(const Course& course, const Experiment& experiment, const WatchedMove& move) {
  // The movement begins at the first ramp tick after it was asked for.
  const auto period = time_of(Tick{1} << experiment.dividers.ramp);
  Spans spans{{move.told.sent - period, move.told.received + firmware_lag}};
  for (const auto& sighting : move.sightings) {
    spans = common(spans, beginnings(course, sighting));
    if (spans.empty()) return false;
  }
  return true;
}

// ---- whether two of them could be told apart --------------------------------------------------

std::vector<Duration> times_of(const Chip& levelled, const Experiment& experiment) {
  std::vector<Duration> times;
  auto at = levelled;
  for (const auto distance : {experiment.distance, -experiment.distance}) {
    const auto course = course_of(at, experiment, distance);
    for (std::int32_t i = 1; i <= experiment.distance; ++i) {
      const auto index = static_cast<std::size_t>(i);
      times.push_back(index < course.steps.size() ? course.steps[index].at : longest_move);
    }
    at = course.chip;
  }
  return times;
}

/// When the movement began is not known exactly: what one microstep is late by, and another early.
Duration difference(std::span<const Duration> one, std::span<const Duration> other) {
  Duration least{};
  Duration greatest{};
  for (std::size_t i = 0; i < one.size(); ++i) {
    least = std::min(least, one[i] - other[i]);
    greatest = std::max(greatest, one[i] - other[i]);
  }
  return greatest - least;
}

bool are_apart(std::span<const Duration> one, std::span<const Duration> other,
               Duration resolution) {
  const auto half = one.size() / 2;
  return difference(one.first(half), other.first(half)) > resolution ||
         difference(one.subspan(half), other.subspan(half)) > resolution;
}

}  // namespace

std::span<const Experiment> experiments() { return all_experiments; }
const Experiment& levelling() { return levelling_move; }

ramp::Tmc429 ChipCandidates::chip_of(const Variant& variant) {
  Chip chip;
  for (std::size_t i = 0; i < variant.size(); ++i) chip.write(chip_registers[i], variant[i]);
  return chip;
}

ChipCandidates::ChipCandidates(const ModuleTraits& expected) {
  take_traits(twin_, expected);
  std::vector<Variant> all{Variant{}};
  for (std::size_t i = 0; i < chip_traits.size(); ++i) {
    const auto& info = trait_table()[static_cast<std::size_t>(chip_traits[i])];
    std::vector<Variant> more;
    for (auto variant : all) {
      for (std::uint8_t word = 0; word < info.variants.size(); ++word) {
        variant[i] = word;
        more.push_back(variant);
      }
    }
    all = std::move(more);
  }
  for (const auto& variant : all) candidates_.push_back({variant, {chip_of(variant)}});
}

std::vector<std::uint8_t> ChipCandidates::variants(Trait trait) const {
  const auto index =
      static_cast<std::size_t>(std::ranges::find(chip_traits, trait) - chip_traits.begin());
  std::vector<std::uint8_t> found;
  for (const auto& candidate : candidates_) found.push_back(candidate.variant.at(index));
  std::ranges::sort(found);
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

const ChipCandidates::Times& ChipCandidates::times(const Variant& variant,
                                                   std::size_t experiment) const {
  const auto [known, is_new] = times_.try_emplace({variant, experiment});
  if (is_new) {
    auto chip = chip_of(variant);
    make_level(chip, 1);
    known->second = times_of(chip, all_experiments.at(experiment));
  }
  return known->second;
}

std::size_t ChipCandidates::pairs_apart(std::size_t experiment, Duration resolution,
                                        Pairs pairs) const {
  const auto& dividers = all_experiments.at(experiment).dividers;
  resolution += time_of(Tick{1} << std::max(dividers.pulse, dividers.ramp));
  std::vector<std::span<const Duration>> all;
  for (const auto& candidate : candidates_) all.push_back(times(candidate.variant, experiment));
  const auto is_wanted = [&](std::size_t i, std::size_t j) {
    auto other = candidates_[j].variant;
    other[order_index] = candidates_[i].variant[order_index];
    return (other == candidates_[i].variant) == (pairs == Pairs::only_by_order);
  };
  std::size_t apart = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (is_wanted(i, j) && are_apart(all[i], all[j], resolution)) ++apart;
    }
  }
  return apart;
}

Duration ChipCandidates::longest(std::size_t experiment) const {
  Duration longest{};
  for (const auto& candidate : candidates_)
    longest = std::max(longest, std::ranges::max(times(candidate.variant, experiment)));
  return longest;
}

void ChipCandidates::level(std::int32_t distance) {
  for (auto& candidate : candidates_) {
    candidate.chips.resize(1, candidate.chips.front());
    make_level(candidate.chips.front(), distance);
  }
  make_level(twin_, distance);
}

Duration ChipCandidates::judge(const Experiment& experiment, const WatchedMove& move) {
  for (auto& candidate : candidates_) {
    std::vector<Chip> chips;
    for (const auto& chip : candidate.chips) {
      for (Tick phase = 0; phase < phases_of(experiment.dividers); ++phase) {
        const auto course = course_of(chip, experiment, move.distance, phase);
        if (!course.arrives || !fits(course, experiment, move)) continue;
        const auto is_known = [&](const Chip& other) {
          return other.exact().accumulator == course.chip.exact().accumulator;
        };
        if (std::ranges::none_of(chips, is_known)) chips.push_back(course.chip);
      }
    }
    candidate.chips = std::move(chips);
  }
  std::erase_if(candidates_, [](const Candidate& candidate) { return candidate.chips.empty(); });
  const auto course = course_of(twin_, experiment, move.distance);
  twin_ = course.chip;
  return course.steps.back().at;
}

}  // namespace tmcl::plan
