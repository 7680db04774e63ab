/// The methods that compute movements of no axis.
#pragma once

#include "api/handlers.hpp"
#include "tmcl/api/profile.hpp"

namespace tmcld::handlers {

Answer<api::profile::Simulate> simulate_profile(Call& call, const api::profile::Simulate& params);
Answer<api::profile::Solve> solve_profile(Call& call, const api::profile::Solve& params);

}  // namespace tmcld::handlers
