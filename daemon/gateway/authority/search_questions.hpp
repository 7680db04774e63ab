/// What a module is asked about a reference search of one of its motors.
#pragma once

#include <vector>

#include "tmcl/script.hpp"

namespace tmcld {

/// Whether the motor searches (a module may refuse to say), its velocity and its position, in this
/// order. A late answer to such a question from before the search began is not taken for one.
std::vector<tmcl::step::Exchange> questions_about_search(tmcl::AxisAddress motor);

}  // namespace tmcld
