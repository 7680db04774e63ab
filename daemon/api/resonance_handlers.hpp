/// The method that measures how the load of an axis swings.
#pragma once

#include "api/handlers.hpp"
#include "tmcl/api/resonance.hpp"

namespace tmcld::handlers {

Answer<axis::Resonance> measure_resonance(Call& call, const axis::Resonance& params);

}  // namespace tmcld::handlers
