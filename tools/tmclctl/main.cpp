#include <unistd.h>

#include <iostream>
#include <string>
#include <vector>

#include "tmclctl.hpp"

int main(int argc, char** argv) {
  tmclctl::Output output{std::cout, std::cerr, tmclctl::screen_of(STDOUT_FILENO),
                         tmclctl::screen_of(STDERR_FILENO)};
  tmclctl::RealHost host;
  const auto exit =
      tmclctl::run(std::vector<std::string>(argv + (argc > 0 ? 1 : 0), argv + argc), output, host);
  return static_cast<int>(exit);
}
