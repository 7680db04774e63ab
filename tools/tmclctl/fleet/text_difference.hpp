/// In which lines two texts differ.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tmclctl {

/// "-line" for what only `before` has, "+line" for what only `after` has, in their order; empty if
/// they are the same.
std::vector<std::string> difference_of(std::string_view before, std::string_view after);

}  // namespace tmclctl
