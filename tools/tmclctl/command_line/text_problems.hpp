/// What is wrong with a file that the user wrote, as it is shown.
#pragma once

#include <cstddef>
#include <string>

#include "output/errors.hpp"
#include "output/screen.hpp"
#include "tmcl/text_problem.hpp"

namespace tmclctl {

/// Prints each problem as FILE:LINE:COLUMN: MESSAGE, and says how many there are. `most`: no more
/// than so many are ever told. `name`: of the error.
Error error_from(const std::string& file, const tmcl::TextProblems& problems, std::size_t most,
                 Output& output, const char* name = "bad_program");

}  // namespace tmclctl
