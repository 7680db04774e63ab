/// A move that comes to its target from one side only, so that the play of a screw or a gear does
/// not show: see Drive.
///
///     waiting ◀──▶ on the way round ──stands there──▶ on the way to the target ──▶ ended
///        │                │                                     │                    ▲
///        └────────────────┴─────────────────────────────────────┴──▶ stopping ───────┘
///
/// The module itself ends each of the two moves, whatever has become of the host.
#pragma once

#include <cstdint>
#include <optional>

#include "tmcl/conversion.hpp"
#include "tmcl/plan/drive.hpp"

namespace tmcl::plan {

/// How an axis comes to its targets, in its microsteps.
struct Approach {
  bool upwards = true;        ///< From positions below.
  std::int32_t distance = 0;  ///< So far beyond a target it goes first; greater than 0.
  ValueRange range{};         ///< Where it may go: it goes less far beyond a target near its end.
};

/// Where it is sent first: beyond the target, if it is there or comes from there, or moves;
/// otherwise to the target itself.
Microsteps first_stop(const Approach& approach, Microsteps position, InternalVelocity velocity,
                      Microsteps target);

class ApproachDrive final : public Drive {
 public:
  explicit ApproachDrive(Approach approach);
  ~ApproachDrive() override;

  /// Gives the number of the wish, from 1; nothing if the drive has ended or is ending. The last
  /// one counts.
  std::optional<std::uint64_t> wish(Microsteps target);
  /// The number of the last wish for which the axis was sent off.
  std::uint64_t done() const;
  const DriveReport& report() const;

 private:
  class Runner;
  Runner& approach();
  const Runner& approach() const;
};

}  // namespace tmcl::plan
