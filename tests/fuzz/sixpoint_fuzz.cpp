#include "tmcl/ramp/sixpoint.hpp"

#include "ramp_script.hpp"

TMCL_FUZZ_RAMP(SixPoint)
