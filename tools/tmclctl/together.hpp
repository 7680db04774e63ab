/// Starts several axes as nearly at once as their modules can.
#pragma once

#include <string>
#include <vector>

#include "target.hpp"

namespace tmclctl {

/// Everything that can be loaded before is: the targets go to coordinate 0 of each motor, which no
/// EEPROM keeps. Then one command for each module starts its motors, one module after the other. A
/// module that has no coordinates is told each target when it is to start.
Attempt<void> start_together(const std::vector<std::string>& axes,
                             const std::vector<tmcl::Microsteps>& positions, Target& target);

}  // namespace tmclctl
