/// A debugger on a simulated module: lines on standard input, in virtual time.
#pragma once

#include <functional>
#include <iosfwd>
#include <string>

#include "program_bench.hpp"

namespace tmclsim {

/// Of `path`, for the module that is built: 0, or 1 if there is something wrong with it.
/// `prompts`: a person types.
int debug_program(const std::string& path, const tmcl::Model& model, ProgramBench::Build build,
                  std::istream& in, std::ostream& out, std::ostream& errors, bool prompts);

}  // namespace tmclsim
