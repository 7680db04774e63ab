/// A move of the MC1451A, which is in no module, for profile.simulate.
#pragma once

#include <string_view>

#include "api/error.hpp"
#include "tmcl/api/profile.hpp"

namespace tmcld {

/// What it is called as a model. Its parameters are the registers of its data sheet, as that counts
/// them, and cycle_us: how long a cycle is, 1 to 1,000,000; 1000 if it is not set.
constexpr std::string_view mc1451a_name = "MC1451A";

/// A microstep is a step here. Computes for as long as the curve has points.
/// Errors: unknown_parameter; out_of_range; bad_argument for a load, which is not followed.
Result<tmcl::api::profile::Simulated> mc1451a_move(const tmcl::api::profile::Simulate& params);

}  // namespace tmcld
