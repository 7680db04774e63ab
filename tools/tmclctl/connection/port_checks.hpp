/// What keeps programs from a serial port. Asked of the kernel: nothing is opened.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tmcl/doctor.hpp"

namespace tmclctl {

/// Of the device behind this name. `holder`: the program that may have it; any other is wrong.
/// `root` has the folders dev, sys, proc and run.
std::vector<tmcl::Finding> look_at_port(const std::string& device, std::string_view holder,
                                        const std::filesystem::path& root = "/");

}  // namespace tmclctl
