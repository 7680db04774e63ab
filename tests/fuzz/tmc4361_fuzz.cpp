#include "tmcl/ramp/tmc4361.hpp"

#include "ramp_script.hpp"

TMCL_FUZZ_RAMP(Tmc4361)
