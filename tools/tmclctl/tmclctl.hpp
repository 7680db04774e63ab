/// The program, without the process around it.
#pragma once

#include <string>
#include <vector>

#include "exit_code.hpp"
#include "patience.hpp"
#include "screen.hpp"

namespace tmclctl {

/// `arguments` without the program's name.
ExitCode run(const std::vector<std::string>& arguments, Output& output, Patience& patience);

}  // namespace tmclctl
