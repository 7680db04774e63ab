#include "tmcl/ramp/mc1451a.hpp"

#include "ramp_script.hpp"

TMCL_FUZZ_RAMP(Mc1451a)
