/// What the method does that looks for faults.
#pragma once

#include "api/handlers.hpp"
#include "tmcl/api/doctor.hpp"

namespace tmcld::handlers {

Answer<doctor::Examine> examine(Call& call, const doctor::Examine& params);

}  // namespace tmcld::handlers
