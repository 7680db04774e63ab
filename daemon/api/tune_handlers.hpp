/// The method that finds what an axis bears.
#pragma once

#include "api/handlers.hpp"
#include "tmcl/api/tune.hpp"

namespace tmcld::handlers {

Answer<axis::Tune> tune(Call& call, const axis::Tune& params);

}  // namespace tmcld::handlers
