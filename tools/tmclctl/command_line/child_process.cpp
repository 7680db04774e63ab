#include "child_process.hpp"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <system_error>

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace tmclctl {
namespace {

constexpr int signal_exit_base = 128;

}  // namespace

Result<ChildProcess> ChildProcess::start(const std::vector<std::string>& command, Prints prints) {
  std::vector<char*> words;
  for (const auto& word : command) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  if (prints == Prints::to_standard_error)
    ::posix_spawn_file_actions_adddup2(&actions, STDERR_FILENO, STDOUT_FILENO);
  pid_t id = 0;
  const int failed = ::posix_spawnp(&id, words.front(), &actions, nullptr, words.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (failed == 0) return ChildProcess(id);
  return tl::unexpected(usage_error("cannot_run", command.front() + " cannot be run: " +
                                                      std::generic_category().message(failed)));
}

std::optional<int> ChildProcess::exit_code() {
  int status = 0;
  if (!exit_code_ && ::waitpid(id_, &status, WNOHANG) == id_)
    exit_code_ = WIFSIGNALED(status) ? signal_exit_base + WTERMSIG(status) : WEXITSTATUS(status);
  return exit_code_;
}

void ChildProcess::send(int signal) const {
  if (!exit_code_) ::kill(id_, signal);
}

}  // namespace tmclctl
