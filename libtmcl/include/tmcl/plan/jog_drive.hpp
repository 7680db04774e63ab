/// A jog, carried out on the axis of a module: see Drive.
///
///     waiting ◀──▶ going ──stands at its target, or velocity 0──▶ restoring ──▶ ended
///        │           │                                               ▲
///        └───────────┴──▶ stopping ──────────────────────────────────┘
///
/// Each wish sends the axis as far as it can go while the wish holds, and over its braking distance
/// then, within its range: without a further wish the module itself brings it to rest there,
/// whatever has become of the host. The first wish that needs it sets max_velocity, which is set
/// back in the end.
#pragma once

#include "tmcl/conversion.hpp"
#include "tmcl/plan/drive.hpp"

namespace tmcl::plan {

/// What a jog has to know of its axis.
struct JogAxis {
  const Model* model = nullptr;
  ModuleUnits units{};
  std::vector<Setting> ramp;       ///< The settings of its ramp, max_velocity among them.
  std::optional<AxisTwin> twin{};  ///< Nothing where its ramps are not described.
  ValueRange range{};              ///< Of its targets, in microsteps.
};

struct JogWish {
  InternalVelocity velocity;  ///< The sign is the direction; 0 ends the jog.
  Duration hold{};            ///< For how long it goes on without a further wish.
};

struct JogGoal {
  Microsteps target;
  TimePoint until{};  ///< From then on it brakes.
};

/// Where an axis is sent that is at `position` and so fast. Where its ramps are not described, it
/// may not get there in that time.
Microsteps jog_target(const JogAxis& axis, Microsteps position, InternalVelocity velocity,
                      const JogWish& wish);

class JogDrive final : public Drive {
 public:
  JogDrive();
  ~JogDrive() override;

  /// Before the first step.
  void know(JogAxis axis);
  /// Gives its number, from 1; nothing if the jog is ending and takes none any more. The last one
  /// counts. Errors: Errc::bad_argument if it is faster than the max_velocity of the axis.
  Result<std::optional<std::uint64_t>> wish(JogWish wish);
  /// The number of the last wish that has been carried out.
  std::uint64_t done() const;
  /// Of that one.
  const JogGoal& goal() const;
  const DriveReport& report() const;

 private:
  class Runner;
  Runner& jog();
  const Runner& jog() const;
};

}  // namespace tmcl::plan
