/// The program, without the process around it.
#pragma once

#include <string>
#include <vector>

#include "connection/gateway.hpp"
#include "connection/host.hpp"
#include "exit_code.hpp"
#include "output/screen.hpp"

namespace tmclctl {

/// `arguments` without the program's name.
ExitCode run(const std::vector<std::string>& arguments, Output& output, Host& host);

/// The same with a target that is there already, whatever the command line says about it.
ExitCode run(const std::vector<std::string>& arguments, Output& output, Host& host,
             Gateway& gateway);

}  // namespace tmclctl
