/// Durations as numbers of seconds.
#pragma once

#include "tmcl/clock.hpp"

namespace tmcl {

constexpr double seconds(Duration time) { return std::chrono::duration<double>(time).count(); }

}  // namespace tmcl
