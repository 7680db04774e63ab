/// What the code takes for granted, said where it does so, and looked at in every build.
#pragma once

#include <source_location>

namespace tmcl {

/// Throws std::logic_error, which names file and line, unless this holds. That is a mistake in the
/// code around it, and ends the call that came upon it; in a test it ends the process.
void broken(std::source_location here);
inline void ensure(bool holds, std::source_location here = std::source_location::current()) {
  if (!holds) [[unlikely]]
    broken(here);
}

/// Of tests: what is broken from now on ends the process. No exception handler hides it then.
void end_process_when_broken(bool ends = true);

}  // namespace tmcl
