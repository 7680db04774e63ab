/// The simulation of one kind of generator.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <utility>

#include <fmt/format.h>

#include "profile/simulation.hpp"

namespace tmclctl::profile {

/// Lets a generator run, and writes its registers when it is time to.
template <tmcl::ramp::Generator G>
class Player {
 public:
  Player(const Script& script, std::size_t most_changes)
      : script_(script), changes_left_(most_changes) {}

  Result<void> start() {
    for (const auto& write : script_.start) {
      if (auto written = apply(write); !written) return written;
    }
    if (auto written = apply_changes_due(); !written) return written;
    judge();
    return {};
  }

  const G& generator() const { return generator_; }
  const std::vector<std::string>& warnings() const { return warnings_; }
  bool all_written() const { return next_change_ == script_.changes.size(); }
  /// It went from event to event as often as it may, and does not move any more.
  bool exhausted() const { return changes_left_ == 0; }

  /// To the last tick before the next event, or before `limit` if that comes first.
  void approach(Tick limit) {
    const auto next = std::min(limit, next_event());
    if (next > generator_.tick()) generator_.advance_to(next - 1);
  }
  /// To the next event, or to `limit` if that comes first.
  void advance(Tick limit) {
    if (exhausted()) return;
    --changes_left_;
    generator_.advance_to(std::min(limit, next_event()));
  }
  /// What is to be written at this tick.
  Result<void> write() {
    const auto first = next_change_;
    if (auto written = apply_changes_due(); !written) return written;
    if (next_change_ != first) judge();
    return {};
  }

 private:
  Tick next_event() {
    const auto by_itself = generator_.next_change();
    return all_written() ? by_itself : std::min(by_itself, script_.changes[next_change_].tick);
  }

  Result<void> apply(const Write& write) {
    const auto written =
        generator_.write(static_cast<typename G::Register>(write.index), write.value);
    if (written) return {};
    return tl::unexpected(
        usage_error("bad_register", fmt::format("{}: {}", write.words, describe(written.error()))));
  }

  Result<void> apply_changes_due() {
    for (; !all_written() && script_.changes[next_change_].tick <= generator_.tick();
         ++next_change_) {
      const auto written = apply(script_.changes[next_change_].write);
      if (!written) return written;
    }
    return {};
  }

  // What is written at one instant is judged together.
  void judge() {
    for (const auto& finding : generator_.findings()) {
      auto warning =
          script_.said ? describe(finding, script_.said) : describe(finding, G::registers());
      if (std::ranges::find(warnings_, warning) == warnings_.end())
        warnings_.push_back(std::move(warning));
    }
  }

  const Script& script_;
  std::size_t next_change_ = 0;
  std::size_t changes_left_;
  G generator_;
  std::vector<std::string> warnings_;
};

/// Gathers what there is to tell of a run.
template <tmcl::ramp::Generator G>
class Observer {
 public:
  void look_at_velocity(const G& generator) {
    const auto motion = generator.motion();
    const auto speed = std::abs(motion.velocity);
    const Place here{generator.tick(), motion.position};
    if (generator.tick() == 0) outcome_.start = here;
    if (speed > outcome_.peak_velocity) outcome_.first_peak = here;
    if (speed >= outcome_.peak_velocity) outcome_.last_peak = here;
    outcome_.peak_velocity = std::max(outcome_.peak_velocity, speed);
  }

  /// When everything has happened at this tick.
  void look(const G& generator) {
    look_at_velocity(generator);
    if (!generator.arrived()) {
      outcome_.arrival.reset();
    } else if (!outcome_.arrival) {
      outcome_.arrival = generator.tick();
    }
    look_at_phase(generator);
  }

  Outcome finish(const Player<G>& player) {
    outcome_.end = player.generator().tick();
    outcome_.cut_off = player.exhausted();
    outcome_.at_end = player.generator().motion();
    outcome_.warnings = player.warnings();
    if (!outcome_.phases.empty() && phase_ == "rest" && !outcome_.more_phases)
      outcome_.phases.pop_back();
    return std::move(outcome_);
  }

 private:
  void look_at_phase(const G& generator) {
    if (generator.phase() == phase_) return;
    // Where the phase is that of the tick that has passed, one tick of rest goes before the start.
    const bool was_starting = phase_ == "rest" && generator.tick() == 1;
    phase_ = generator.phase();
    if (was_starting) {
      outcome_.phases.back().name = phase_;
    } else if (outcome_.phases.size() < most_phases) {
      outcome_.phases.push_back({std::string(phase_), generator.tick()});
    } else {
      outcome_.more_phases = true;
    }
  }

  Outcome outcome_;
  std::string_view phase_;
};

template <tmcl::ramp::Generator G>
class SimulationOf final : public Simulation {
 public:
  explicit SimulationOf(Script script, std::size_t most_changes = tmcl::ramp::most_changes_ahead)
      : script_(std::move(script)), most_changes_(most_changes) {}

  Result<Outcome> follow(std::optional<Tick> until) const override {
    const auto limit = until.value_or(tmcl::ramp::forever);
    Player<G> player(script_, most_changes_);
    Observer<G> observer;
    auto written = player.start();
    observer.look(player.generator());
    while (written && !is_over(player, until)) {
      player.approach(limit);
      observer.look_at_velocity(player.generator());
      player.advance(limit);
      observer.look_at_velocity(player.generator());
      written = player.write();
      observer.look(player.generator());
    }
    if (!written) return tl::unexpected(written.error());
    return observer.finish(player);
  }

  Result<std::vector<Motion>> motions_at(std::span<const Tick> ticks) const override {
    // It stops at more places than follow(), and goes at least as far.
    Player<G> player(script_, 2 * most_changes_ + ticks.size());
    auto written = player.start();
    std::vector<Motion> motions;
    motions.reserve(ticks.size());
    for (const auto tick : ticks) {
      while (written && player.generator().tick() < tick) {
        if (player.exhausted()) return tl::unexpected(endless());
        player.advance(tick);
        written = player.write();
      }
      if (!written) return tl::unexpected(written.error());
      motions.push_back(player.generator().motion());
    }
    return motions;
  }

 private:
  static bool is_over(const Player<G>& player, std::optional<Tick> until) {
    const auto& generator = player.generator();
    if (player.exhausted()) return true;
    if (until) return generator.tick() >= *until;
    return player.all_written() && (generator.arrived() || generator.settled());
  }

  Error endless() const {
    return usage_error(
        "endless",
        fmt::format("it changes more than {} times before the last of the times asked for",
                    most_changes_));
  }

  Script script_;
  std::size_t most_changes_;
};

}  // namespace tmclctl::profile
