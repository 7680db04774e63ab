/// Which program has a device open.
#pragma once

#include <string>

namespace tmcl {

/// "tmcld (process 4711)"; empty if it cannot be found, for instance because it belongs to another
/// user.
std::string holder_of(const std::string& device);

/// The same of the program that asks.
std::string this_process();

}  // namespace tmcl
