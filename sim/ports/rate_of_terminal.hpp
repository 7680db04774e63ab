/// The rate at which the program that has opened a terminal speaks.
#pragma once

#include <cstdint>

namespace tmcl::sim {

/// In bits per second, whatever number it is; of a pseudo terminal, either end tells what the other
/// one has set. 1 if it cannot be learnt, which is no real rate.
std::uint32_t rate_of_terminal(int descriptor);

}  // namespace tmcl::sim
