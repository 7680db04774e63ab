// A mistake that ensure() finds ends every program of tests.
#include "tmcl/ensure.hpp"

namespace {

[[maybe_unused]] const bool ends = (tmcl::end_process_when_broken(), true);

}  // namespace
