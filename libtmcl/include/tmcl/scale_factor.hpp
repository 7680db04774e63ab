/// What a unit of a user is to the motor.
#pragma once

#include "tmcl/conversion.hpp"

namespace tmcl {

/// How many microsteps a unit is, in either direction; greater than 0. What it is to an encoder is
/// counts_per_unit() of tmcl/mechanics.hpp.
inline double microsteps_per_unit(const UserScale& scale) {
  return scale.steps.per_revolution() / scale.units_per_motor_revolution();
}

}  // namespace tmcl
