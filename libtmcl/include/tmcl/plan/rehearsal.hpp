/// How well axes will keep to a course, before they move: a stream passes it on their twins.
///
/// Twins are exact to the tick of a ramp generator, so what is left unknown is time: each command
/// takes as long as any other here, and never longer.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "tmcl/clock.hpp"
#include "tmcl/plan/axis_twin.hpp"
#include "tmcl/plan/course.hpp"
#include "tmcl/plan/stream.hpp"

namespace tmcl::plan {

/// A rehearsal ends after so many commands; what comes after them is not foreseen.
constexpr std::size_t most_rehearsed_commands = 50'000;

struct RehearsedAxis {
  StreamAxis axis;
  AxisTwin twin;
  std::vector<Setting> settings;  ///< Of its ramp: AxisTwin::parameters().
};

struct Rehearsal {
  double farthest = 0;    ///< From the path, in units: every millisecond, or 20,000 looks in all.
  double at_s = 0;        ///< When, in seconds of the course.
  AxisValues position{};  ///< Where the axes were then.
  double lag_s = 0;       ///< How late they were on the path at most.
  double passed_s = 0;    ///< How much of the course was passed.
  std::optional<DriveFault> fault{};  ///< Why it cannot be run, or would be ended.
};

/// `command`: how long one takes. The axes stand at the start of the course.
Rehearsal rehearse(const Course& course, std::vector<RehearsedAxis> axes,
                   const StreamOptions& options, Duration command);

}  // namespace tmcl::plan
