/// A line, carried out on the axes of modules: see Drive.
///
///     loading ──▶ starting ──▶ running ──all have arrived──▶ restoring ──▶ ended
///        │           │            │                              ▲
///        │           └────────────┴──▶ stopping ──▶ stopped ─────┤
///        └───────────────────────────────────────────────────────┘
///
/// First every axis gets its settings. Then those of one bus start one after the other, and those
/// of different buses side by side; nothing more starts when one could not. On the way each axis is
/// looked at, until it stands at its target.
#pragma once

#include "tmcl/plan/drive.hpp"
#include "tmcl/plan/line.hpp"

namespace tmcl::plan {

struct LineDriveAxis {
  Microsteps target;
  std::vector<Setting> before;  ///< The settings of its ramp.
  std::size_t bus = 0;
  std::uint8_t motor = 0;  ///< Of its module.
};

struct LineReport : DriveReport {
  TimePoint begin{};  ///< Of the first start.
  /// Between the first and the last start: the middle between a command and its answer counts.
  Duration skew{};
};

class LineDrive final : public Drive {
 public:
  enum class Phase : std::uint8_t {
    loading,
    starting,
    running,
    stopping,
    stopped,  ///< Or not: see the report. Comes to rest.
    restoring,
    ended,
  };

  /// One axis for each of the line's. `one_command`: they are all of one module, which one command
  /// starts.
  LineDrive(Line line, std::vector<LineDriveAxis> axes, bool one_command);
  ~LineDrive() override;

  Phase phase() const;
  const LineReport& report() const;

 private:
  class Runner;
  const Runner& line() const;
};

}  // namespace tmcl::plan
