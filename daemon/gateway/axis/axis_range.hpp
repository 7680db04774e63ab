/// Where an axis may go.
#pragma once

#include "gateway/axis/axis.hpp"
#include "tmcl/mechanics.hpp"

namespace tmcld {

/// In microsteps: within its soft limits, if it has any, and what its module can hold.
tmcl::ValueRange range_of(const GatewayAxis& axis, const tmcl::UserScale& scale);

}  // namespace tmcld
