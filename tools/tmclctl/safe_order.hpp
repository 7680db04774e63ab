/// Settings of a ramp in the order in which to write them to an axis that stands.
#pragma once

#include <string>
#include <vector>

#include "target.hpp"
#include "tmcl/plan/axis_twin.hpp"

namespace tmclctl {

/// tmcl::plan::in_safe_order(), with what the module has now.
Attempt<std::vector<tmcl::plan::Setting>> in_safe_order(std::vector<tmcl::plan::Setting> settings,
                                                        const std::string& axis, Target& target);

}  // namespace tmclctl
