/// The resonance of a load, as the parameters resonance_hz and damping of some methods say it.
#pragma once

#include <optional>

#include "api/task.hpp"
#include "tmcl/ramp/resonant_load.hpp"

namespace tmcld {

/// Nothing without a frequency. Errors: out_of_range, with the parameter.
Task<std::optional<tmcl::ramp::Resonance>> resonance_of(std::optional<double> frequency_hz,
                                                        std::optional<double> damping);

}  // namespace tmcld
