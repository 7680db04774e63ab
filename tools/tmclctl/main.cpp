#include <iostream>
#include <string>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

#include "command_line/tmclctl.hpp"
#include "output/steady_stream.hpp"

namespace {

/// What is opened later must not take the number of a stream that the caller has closed: it would
/// get the output. Writing to what stands there instead fails.
void occupy_closed_streams() {
  for (int i = STDIN_FILENO; i <= STDERR_FILENO; ++i)
    if (::fcntl(i, F_GETFD) < 0) ::open("/dev/full", O_RDWR);
}

}  // namespace

int main(int argc, char** argv) {
  occupy_closed_streams();
  const tmclctl::SteadyStream steady_out(std::cout, STDOUT_FILENO);
  const tmclctl::SteadyStream steady_err(std::cerr, STDERR_FILENO);
  tmclctl::Output output{std::cout, std::cerr, tmclctl::screen_of(STDOUT_FILENO),
                         tmclctl::screen_of(STDERR_FILENO)};
  tmclctl::RealHost host;
  const auto exit =
      tmclctl::run(std::vector<std::string>(argv + (argc > 0 ? 1 : 0), argv + argc), output, host);
  return static_cast<int>(exit);
}
