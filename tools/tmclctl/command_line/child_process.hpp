/// Another program that runs beside this one.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

#include "output/errors.hpp"

namespace tmclctl {

class ChildProcess {
 public:
  enum class Prints : std::uint8_t { as_this_one, to_standard_error };

  /// Looks in $PATH. Errors: it cannot be run.
  static Result<ChildProcess> start(const std::vector<std::string>& command,
                                    Prints prints = Prints::as_this_one);

  /// Its exit code once it has ended, 128 and its number if a signal ended it.
  std::optional<int> exit_code();
  void send(int signal) const;

 private:
  explicit ChildProcess(pid_t id) : id_(id) {}

  pid_t id_;
  std::optional<int> exit_code_;
};

}  // namespace tmclctl
