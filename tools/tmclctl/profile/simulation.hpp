/// One axis whose registers are written at times known beforehand, whatever its generator.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "output/errors.hpp"
#include "tmcl/ramp/generator.hpp"

namespace tmclctl::profile {

using tmcl::ramp::Motion;
using tmcl::ramp::Tick;

struct Write {
  std::size_t index;  ///< Of the generator's registers.
  std::int64_t value;
  std::string words;  ///< As it was typed, for what goes wrong with it.
};

struct Change {
  Tick tick;  ///< It acts after everything up to this tick.
  Write write;
};

struct Script {
  std::vector<Write> start;     ///< At tick 0.
  std::vector<Change> changes;  ///< Ascending by tick.
  /// How warnings call a register and its value; empty: as the chip does.
  std::function<std::string(const tmcl::ramp::Finding::Mention&)> said{};
};

struct PhaseStart {
  std::string name;
  Tick tick;
};

/// Where it is, and when.
struct Place {
  Tick tick = 0;
  std::int64_t position = 0;
};

struct Outcome {
  Tick end = 0;                 ///< As far as it was followed.
  bool cut_off = false;         ///< It changes so often that it was not followed to its end.
  std::optional<Tick> arrival;  ///< When it last came to rest on its target, if it stays there.
  Motion at_end;
  std::int64_t peak_velocity = 0;  ///< The greatest |velocity|.
  Place start;
  Place first_peak;                ///< As fast as it gets, for the first time,
  Place last_peak;                 ///< and for the last time.
  std::vector<PhaseStart> phases;  ///< Without the rest at the end; at most most_phases.
  bool more_phases = false;
  std::vector<std::string> warnings;
};

/// A generator that oscillates has phases without end.
constexpr std::size_t most_phases = 10'000;

class Simulation {
 public:
  virtual ~Simulation() = default;
  /// Until this tick; without one until it stands on its target, or cannot get there any more.
  virtual Result<Outcome> follow(std::optional<Tick> until) const = 0;
  /// Its motion at these ticks, which ascend.
  virtual Result<std::vector<Motion>> motions_at(std::span<const Tick> ticks) const = 0;
};

}  // namespace tmclctl::profile
