/// The axis parameters of a TMC429 that say what its velocities and accelerations are.
#pragma once

#include "tmcl/parameter_number.hpp"

namespace tmcl::plan {

inline constexpr auto pulse_divisor = number_of("pulse_divisor");
inline constexpr auto ramp_divisor = number_of("ramp_divisor");

}  // namespace tmcl::plan
