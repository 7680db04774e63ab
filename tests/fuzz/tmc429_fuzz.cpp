#include "tmcl/ramp/tmc429.hpp"

#include "ramp_script.hpp"

TMCL_FUZZ_RAMP(Tmc429)
