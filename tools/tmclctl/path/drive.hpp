/// Brings axes to where a path or a program wants them.
#pragma once

#include <string>
#include <vector>

#include "progress_line.hpp"
#include "verbs.hpp"

namespace tmclctl::path {

/// A line that shows how far a path has been passed.
void show(const PathProgress& now, ProgressLine& line);

/// Stops all of them, whatever becomes of each, and lets them come to rest. A signal that was
/// noticed does not keep it from that.
void stop_axes(const std::vector<std::string>& axes, Context& context);
/// Brings all to these positions, and waits until they stand there; otherwise all are stopped.
Attempt<void> go_to(const std::vector<std::string>& axes,
                    const std::vector<tmcl::Microsteps>& positions, const std::string& what,
                    Context& context);
/// Likewise, all started as nearly at once as their modules can.
Attempt<void> go_together(const std::vector<std::string>& axes,
                          const std::vector<tmcl::Microsteps>& positions, const std::string& what,
                          Context& context);

}  // namespace tmclctl::path
