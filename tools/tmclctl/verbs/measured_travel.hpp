/// What verbs ask for that move an axis to measure it: how far, and whether it may.
#pragma once

#include <string>

#include "command_line/form.hpp"
#include "command_line/options.hpp"

namespace tmclctl {

/// "-2mm..2mm"
Reading read_travel(const std::string& said, MeasuredTravel& travel);

/// Asks, unless `yes` says so. Without a person to ask: that is an error.
Result<bool> may_be_measured(const std::string& axis, const MeasuredTravel& travel, bool yes,
                             Context& context);

}  // namespace tmclctl
