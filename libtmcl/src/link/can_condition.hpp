/// What a CAN controller reports by error frames, in words.
#pragma once

#include <linux/can.h>

#include "tmcl/link.hpp"

namespace tmcl {

CanCondition describe_error_frame(const can_frame& frame);

}  // namespace tmcl
