/// How far an axis may go from where it stands, as calls that move it to measure it say that.
#pragma once

#include <optional>

#include "api/quantity.hpp"
#include "tmcl/mechanics.hpp"

namespace tmcld {

using Travel = std::optional<tmcl::ValueRange>;

/// Both ends, or none: then nothing. Errors: one alone; the axis is not within.
Task<Travel> travel_between(GatewayAxis& axis, RawOrQuantity from, RawOrQuantity to);

template <class Params>
Task<Travel> travel_of(GatewayAxis& axis, const Params& params) {
  return travel_between(axis, raw_or_quantity<&Params::from_microsteps, &Params::from>(params),
                        raw_or_quantity<&Params::to_microsteps, &Params::to>(params));
}

}  // namespace tmcld
