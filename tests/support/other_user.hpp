/// Something done by a user who has no rights of its own.
#pragma once

#include <stdexcept>
#include <string>

#include <sys/wait.h>
#include <unistd.h>

namespace tmcl::test {

/// What `work` gives, done in a process of its own: by nobody if it is root that asks, otherwise by
/// who asks.
template <class Work>
std::string told_by_other_user(Work work) {
  constexpr uid_t nobody = 65534;
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("no pipe to be had");
  const pid_t process = fork();
  if (process == 0) {
    const bool changed = getuid() != 0 || setresuid(nobody, nobody, nobody) == 0;
    const std::string text = changed ? work() : "cannot become another user";
    _exit(write(ends[1], text.data(), text.size()) == static_cast<ssize_t>(text.size()) ? 0 : 1);
  }
  close(ends[1]);
  std::string text;
  char buffer[512];
  for (ssize_t count = 0; (count = read(ends[0], buffer, sizeof buffer)) > 0;)
    text.append(buffer, static_cast<std::size_t>(count));
  close(ends[0]);
  waitpid(process, nullptr, 0);
  return text;
}

}  // namespace tmcl::test
