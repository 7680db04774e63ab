/// The programs that run on this computer, as /proc tells of them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace tmcl {

/// Their numbers.
std::vector<std::string> all_processes();

/// "tmcld (process 4711)"
std::string describe_process(const std::string& number);

/// The program whose controlling terminal the device is, named as above. Empty for what is no
/// pseudo terminal, for one that no program works at, and where that may not be seen.
std::string program_at_terminal(std::uint64_t device_number);
/// Of a path, which may be a link.
std::string program_at_terminal(const std::string& device);

}  // namespace tmcl
