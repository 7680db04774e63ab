/// What the methods do that choose among ramps.
#pragma once

#include "api/handlers.hpp"
#include "tmcl/api/ramp.hpp"

namespace tmcld::handlers {

Answer<api::ramp::Compare> compare_ramps(Call& call, const api::ramp::Compare& params);
Answer<api::ramp::Find> find_ramp(Call& call, const api::ramp::Find& params);

}  // namespace tmcld::handlers
