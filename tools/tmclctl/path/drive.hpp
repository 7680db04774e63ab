/// Carries out on a target what a stream says.
#pragma once

#include <string>
#include <vector>

#include "progress_line.hpp"
#include "tmcl/plan/path_run.hpp"
#include "verbs.hpp"

namespace tmclctl::path {

/// Until the stream ends, with a line that shows how far it is. Ctrl-C stops all axes, Ctrl-Z
/// pauses and goes on. Returns the signal that ended it; 0 if none did.
int drive(tmcl::plan::PathStream& stream, const std::vector<std::string>& axes, double duration,
          Room& room);
void show(const PathProgress& now, ProgressLine& line);

/// Why a stream that has a fault did not pass the path, in a sentence with the names of the axes.
Failure failure_from(const tmcl::plan::StreamReport& report, const std::vector<std::string>& axes);

/// Stops all of them, whatever becomes of each, and lets them come to rest. A signal that was
/// noticed does not keep it from that.
void stop_axes(const std::vector<std::string>& axes, Room& room);
/// Brings all to these positions, and waits until they stand there; otherwise all are stopped.
Attempt<void> go_to(const std::vector<std::string>& axes,
                    const std::vector<tmcl::Microsteps>& positions, const std::string& what,
                    Room& room);
/// Likewise, all started as nearly at once as their modules can.
Attempt<void> go_together(const std::vector<std::string>& axes,
                          const std::vector<tmcl::Microsteps>& positions, const std::string& what,
                          Room& room);

}  // namespace tmclctl::path
