/// A Mint program, carried out on the axes of modules: see Drive.
///
///     ┌─▶ loading ──▶ starting ──▶ running ──all stand──▶ more groups? ──no──▶ restoring ──▶ ended
///     │      │           │            │                        │                   ▲
///     │      │           └────────────┴──▶ stopping ───────────┼───────────────────┤
///     │      └─────────────────────────────────────────────────┼───────────────────┘
///     └───────────────────────────yes──────────────────────────┘
///
/// For each GO its axes get their ramps, in an order in which none is ever faster than before and
/// after. Targets of several motors of one module are loaded, and one command starts them; a module
/// that has no coordinates is told each target when it is to start.
#pragma once

#include "tmcl/plan/drive.hpp"

namespace tmcl::plan {

struct MintDriveMove {
  std::size_t axis = 0;
  Microsteps target;
  std::vector<Setting> ramp;  ///< In any order.
};
/// What one GO starts together.
struct MintDriveGroup {
  std::size_t line = 0;  ///< Of GO, in the program.
  double duration = 0;   ///< As planned, in seconds.
  std::vector<MintDriveMove> moves;
};
struct MintDriveAxis {
  std::size_t module = 0;  ///< Those of one module have the same; the least starts first.
  std::uint8_t motor = 0;  ///< Of its module.
};

struct MintReport : DriveReport {
  /// Of each group that has come to its end, from its first setting until all stood.
  std::vector<Duration> took;
};

class MintDrive final : public Drive {
 public:
  MintDrive(std::vector<MintDriveGroup> groups, std::vector<MintDriveAxis> axes);
  ~MintDrive() override;

  const MintReport& report() const;
  const std::vector<MintDriveGroup>& groups() const;
  /// When the group that is under way began; in the far future before the first.
  TimePoint group_begin() const;

 private:
  class Runner;
  const Runner& program() const;
};

}  // namespace tmcl::plan
