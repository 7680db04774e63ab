/// How often a random test does what it does: as often as TMCL_ROUNDS says, which is how the
/// nightly run has it done many more times, otherwise as often as is fit for every day.
#pragma once

#include <cstdlib>
#include <string>

namespace tmcl::test {

inline int rounds(int usual) {
  const char* given = std::getenv("TMCL_ROUNDS");
  return given != nullptr ? std::stoi(given) : usual;
}

}  // namespace tmcl::test
