/// What was seen of a move beside what was planned.
#pragma once

#include "plot/picture.hpp"
#include "plot/recording.hpp"
#include "tmcl/plan/axis_twin.hpp"

namespace tmclctl::plot {

/// When the module took the command, in the times of the recording: between these two.
struct Start {
  double earliest = 0;
  double latest = 0;
};

struct Comparison {
  /// Where the plan has the axis at the time of each sample.
  std::vector<double> planned;
  /// Position less plan, in microsteps, as far as it cannot come from the time that reading took.
  std::vector<double> difference;
  double largest = 0;     ///< Without its sign.
  double largest_at = 0;  ///< In the times of the recording.
  /// When the plan begins, in the times of the recording: the instant within Start that brings the
  /// two nearest to each other.
  double start = 0;
};

/// `twin` has its target, and is as the axis was when the command came. The recording is not empty.
Comparison compare(const Recording& recording, const tmcl::plan::AxisTwin& twin, Start start);

/// "the axis was at most 12 microsteps off its plan, at 0.43 s"; in the unit that is drawn in.
std::string summary(const Comparison& comparison, const Recording& recording);
/// The recording's picture with the plan drawn into it, and the difference below.
Picture picture_of(const Recording& recording, const Comparison& comparison,
                   const Shown& shown = {});

}  // namespace tmclctl::plot
