/// Things in the simulator say when they next need attention, so that nothing ever polls.
#pragma once

#include "tmcl/clock.hpp"

namespace tmcl::sim {

constexpr TimePoint never = TimePoint::max();

}  // namespace tmcl::sim
