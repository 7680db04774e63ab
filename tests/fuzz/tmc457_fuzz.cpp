#include "tmcl/ramp/tmc457.hpp"

#include "ramp_script.hpp"

TMCL_FUZZ_RAMP(Tmc457)
