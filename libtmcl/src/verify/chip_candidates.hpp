/// Which of the known variants of a TMC429 a chip is, found out by watching it move.
///
/// A movement is watched through a line: of each reading it is known when it was asked for and when
/// it came, so the chip had it in between. A variant fits if there is a moment within the exchange
/// that set the motor out, and a phase of the chip's ramp tick, with which it makes every microstep
/// when the readings say so. Nothing is estimated: a busy line tells less, but nothing wrong.
///
/// All variants do the same as long as nothing of a microstep is left over from before; so the
/// motor first makes one microstep at the least speed that there is, after which nothing is.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "tmcl/clock.hpp"
#include "tmcl/module_traits.hpp"
#include "tmcl/ramp/tmc429.hpp"
#include "tmcl/units.hpp"

namespace tmcl::plan {

/// What a TMC429 is set to, in its own units, and how far it goes: there, and back again.
struct Experiment {
  std::int32_t velocity;
  std::int32_t acceleration;
  std::int32_t minimum_velocity;
  Tmc429Dividers dividers;
  std::int32_t distance;

  PulsesPerSecond pps() const { return to_pps(InternalVelocity{velocity}, dividers); }
  PulsesPerSecond2 pps2() const { return to_pps2(InternalAcceleration{acceleration}, dividers); }
};
/// Those which tell variants apart.
std::span<const Experiment> experiments();
/// After it nothing of a microstep is left over.
const Experiment& levelling();

/// When something happened in the module: after the one and before the other.
struct Window {
  TimePoint sent;
  TimePoint received;
};
struct Sighting {
  Window when;
  std::int32_t steps;  ///< From where the motor was, in the direction of its movement.
};
/// A movement from rest to rest.
struct WatchedMove {
  std::int32_t distance;  ///< Not 0; the sign is the direction.
  Window told;
  std::vector<Sighting> sightings{};  ///< The last is of the target.
};

class ChipCandidates {
 public:
  /// All variants; `expected`: which of them the twin is. At rest, and levelled.
  explicit ChipCandidates(const ModuleTraits& expected);

  /// How many fit.
  std::size_t size() const { return candidates_.size(); }
  /// Those of a trait of the chip that fit; ascending.
  std::vector<std::uint8_t> variants(Trait trait) const;

  enum class Pairs : std::uint8_t {
    any,            ///< But for those of the other kind.
    only_by_order,  ///< Nothing else is different. Mostly a phase of the tick can be taken for it.
  };
  /// How many pairs of those that fit would be told apart by readings that are known to within
  /// this time; `experiment` counts in experiments().
  std::size_t pairs_apart(std::size_t experiment, Duration resolution, Pairs pairs) const;
  /// How long one way takes at most, by what fits.
  Duration longest(std::size_t experiment) const;

  /// The motor has made a levelling move.
  void level(std::int32_t distance);
  /// Those that cannot have moved like this fit no more. Gives how long the twin takes.
  Duration judge(const Experiment& experiment, const WatchedMove& move);

 private:
  using Chip = ramp::Tmc429;
  using Variant = std::array<std::uint8_t, 4>;
  struct Candidate {
    Variant variant;
    std::vector<Chip> chips;  ///< It is one of these: what is left of a microstep is not known.
  };
  static Chip chip_of(const Variant& variant);
  using Times = std::vector<Duration>;
  /// When a levelled one makes each microstep, there and back; computed once.
  const Times& times(const Variant& variant, std::size_t experiment) const;

  std::vector<Candidate> candidates_;
  mutable std::map<std::pair<Variant, std::size_t>, Times> times_;
  Chip twin_;
};

}  // namespace tmcl::plan
