/// What is known of a profile, as it is typed: distance=20mm total_time=600ms thirds.
#pragma once

#include <string>
#include <vector>

#include "output/errors.hpp"
#include "tmcl/plan/profile.hpp"

namespace tmclctl::profile {

struct KnownValues {
  tmcl::plan::Given given;  ///< In `unit` and seconds.
  tmcl::plan::Assumption assumption = tmcl::plan::Assumption::none;
  std::string unit;  ///< The first unit of length; empty if none was typed.
};

Result<KnownValues> read_known_values(const std::vector<std::string>& words);

}  // namespace tmclctl::profile
