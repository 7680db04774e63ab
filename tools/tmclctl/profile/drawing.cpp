#include "profile/drawing.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "tmcl/plain_number.hpp"

namespace tmclctl::profile {
namespace {

// So many points make a curve that looks smooth, and a phase that shows how it goes.
constexpr Tick curve_points = 1000;
constexpr Tick phase_points = 32;

/// The phases that are drawn.
std::span<const PhaseStart> drawn_phases(const Outcome& outcome, bool all) {
  const std::span<const PhaseStart> phases(outcome.phases);
  return all ? phases : phases.first(std::min(phases.size(), most_drawn_phases));
}

Tick drawn_end(const Outcome& outcome, bool all) {
  const auto drawn = drawn_phases(outcome, all).size();
  return drawn < outcome.phases.size() ? outcome.phases[drawn].tick : outcome.end;
}

void add_points(Tick begin, Tick end, Tick count, std::vector<Tick>& ticks) {
  const auto length = end - begin;
  for (Tick i = 0; i <= count; ++i)
    ticks.push_back(begin + length / count * i + length % count * i / count);
}

/// Evenly spread, and more where a phase begins, so that corners are corners.
std::vector<Tick> curve_ticks(const Outcome& outcome, bool all) {
  const auto end = drawn_end(outcome, all);
  const auto phases = drawn_phases(outcome, all);
  std::vector<Tick> ticks;
  add_points(0, end, curve_points, ticks);
  for (std::size_t i = 0; i < phases.size(); ++i) {
    const auto next = i + 1 < phases.size() ? phases[i + 1].tick : end;
    const auto count = phases.size() > most_drawn_phases ? 1 : phase_points;
    add_points(phases[i].tick, std::max(phases[i].tick, next), count, ticks);
  }
  std::ranges::sort(ticks);
  const auto [first, last] = std::ranges::unique(ticks);
  ticks.erase(first, last);
  return ticks;
}

plot::Curve& named(const std::string& name, plot::Picture& picture) {
  return *std::ranges::find(picture.curves, name, &plot::Curve::name);
}

void add_load(const LoadRun& load, plot::Picture& picture) {
  for (auto& curve : picture.curves) {
    if (curve.name == "position")
      curve.overlays.push_back({"load", load.times, load.positions, true});
    if (curve.name == "velocity")
      curve.overlays.push_back({"load", load.times, load.velocities, true});
  }
}

}  // namespace

Result<plot::Recording> record(const Profile& profile, bool all) {
  const auto& setup = profile.setup;
  const auto ticks = curve_ticks(profile.outcome, all);
  const auto motions = profile.simulation->motions_at(ticks);
  if (!motions) return tl::unexpected(motions.error());
  plot::Recording recording{std::string(setup.generator.name),
                            {},
                            std::string(setup.generator.time_unit),
                            std::string(setup.generator.length_unit)};
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    const auto& motion = (*motions)[i];
    recording.samples.push_back(
        {setup.time_of(ticks[i]), motion.position, motion.velocity, 0, motion.acceleration});
  }
  for (const auto& phase : drawn_phases(profile.outcome, all))
    recording.phases.push_back({setup.time_of(phase.tick), phase.name});
  if (setup.user) plot::use(*setup.user, recording);
  return recording;
}

bool goes_on(const Profile& profile) {
  return profile.outcome.cut_off ||
         profile.recording.samples.back().time < profile.setup.time_of(profile.outcome.end);
}

plot::Picture picture_of(const std::vector<Profile>& profiles, const plot::Shown& shown) {
  const auto& first = profiles.front();
  auto picture = plot::picture_of(first.recording, shown);
  if (first.recording.phases.size() == most_drawn_phases && goes_on(first)) {
    picture.title += fmt::format(
        "; it swings on: only the first {} phases, {} {}", most_drawn_phases,
        tmcl::plain_number(first.recording.samples.back().time, 4), first.recording.time_unit);
  }
  if (profiles.size() == 1) {
    if (first.load) add_load(*first.load, picture);
    return picture;
  }
  picture.marks.clear();
  const auto others = std::span(profiles).subspan(1);
  for (const auto& profile : others.first(std::min(others.size(), plot::most_overlays))) {
    for (auto& curve : plot::picture_of(profile.recording, shown).curves)
      named(curve.name, picture)
          .overlays.push_back(
              {profile.label, std::move(curve.times), std::move(curve.values), false});
  }
  return picture;
}

}  // namespace tmclctl::profile
