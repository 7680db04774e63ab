/// What tmcld was called with.
#pragma once

#include <string>
#include <variant>

namespace tmcld {

struct CommandLine {
  /// Where the package has it.
  std::string config_file = "/etc/tmcl/tmcld.toml";
  bool only_check = false;
};

/// Nothing more to do: --help, --version, or a mistake that has been explained.
struct ExitCode {
  int value = 0;
};

namespace exit_code {
constexpr int ok = 0;
constexpr int runtime_failure = 1;
constexpr int bad_usage = 2;
}  // namespace exit_code

std::variant<CommandLine, ExitCode> parse_command_line(int argc, const char* const* argv);

}  // namespace tmcld
