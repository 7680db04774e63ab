/// A program that a test runs: its output, its end, its exit status.
#pragma once

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support/build_paths.hpp"

namespace tmcl::test {

/// Ends its program, at the latest when it goes out of scope.
class Program {
 public:
  enum class Input { inherited, piped };

  /// `words`: the program, by name in the build's folder of programs or by path, and its arguments.
  explicit Program(std::vector<std::string> words, Input input = Input::inherited) {
    if (words.at(0).find('/') == std::string::npos)
      words[0] = std::string(TMCL_BIN_DIR "/") + words[0];
    int output[2];
    int talk[2] = {-1, -1};
    if (pipe2(output, O_CLOEXEC) != 0) throw std::runtime_error("no pipe to be had");
    if (input == Input::piped && pipe2(talk, O_CLOEXEC) != 0)
      throw std::runtime_error("no pipe to be had");
    process_ = fork();
    if (process_ == 0) execute(words, talk[0], output[1]);
    close(output[1]);
    if (input == Input::piped) close(talk[0]);
    output_end_ = output[0];
    input_end_ = talk[1];
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  ~Program() {
    if (process_ > 0) kill(process_, SIGKILL);
    wait();
    close(output_end_);
    if (input_end_ >= 0) close(input_end_);
  }

  pid_t process() const { return process_; }
  /// What it has written to its standard output and error so far, as far as it was waited for.
  const std::string& output() const { return output_; }

  /// Reads until the text has appeared; false if the program ends, or stays silent for ten seconds,
  /// before.
  bool wait_for(std::string_view text) {
    while (output_.find(text) == std::string::npos) {
      if (!read_more(std::chrono::seconds(10))) return false;
    }
    return true;
  }
  /// Likewise, until the text has appeared so often.
  bool wait_for_count(std::string_view text, std::size_t times) {
    while (count(text) < times) {
      if (!read_more(std::chrono::seconds(10))) return false;
    }
    return true;
  }
  /// Writes to its standard input, which must be piped.
  void say(std::string_view text) const {
    if (write(input_end_, text.data(), text.size()) < 0) throw std::runtime_error("it has ended");
  }
  void signal(int number) const { kill(process_, number); }
  /// Reads all that it writes and waits for its end; its exit status, or 128 and the signal that
  /// ended it.
  int wait() {
    if (process_ <= 0) return status_;
    while (read_more(std::chrono::seconds(30))) {
    }
    int status = 0;
    waitpid(process_, &status, 0);
    process_ = -1;
    status_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return status_;
  }

 private:
  [[noreturn]] static void execute(const std::vector<std::string>& words, int input, int output) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (input >= 0) dup2(input, STDIN_FILENO);
    dup2(output, STDOUT_FILENO);
    dup2(output, STDERR_FILENO);
    std::vector<char*> arguments;
    for (const auto& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    execv(arguments[0], arguments.data());
    _exit(127);
  }

  std::size_t count(std::string_view text) const {
    std::size_t times = 0;
    for (auto at = output_.find(text); at != std::string::npos; at = output_.find(text, at + 1))
      ++times;
    return times;
  }

  bool read_more(std::chrono::milliseconds patience) {
    pollfd waiting{output_end_, POLLIN, 0};
    if (poll(&waiting, 1, static_cast<int>(patience.count())) <= 0) return false;
    char buffer[4096];
    const auto count = read(output_end_, buffer, sizeof buffer);
    if (count <= 0) return false;
    output_.append(buffer, static_cast<std::size_t>(count));
    return true;
  }

  pid_t process_ = -1;
  int output_end_ = -1;
  int input_end_ = -1;
  int status_ = -1;
  std::string output_;
};

struct Finished {
  int status;
  std::string output;
};

/// Runs a program to its end.
inline Finished run_program(std::vector<std::string> words) {
  Program program(std::move(words));
  const int status = program.wait();
  return {status, program.output()};
}

}  // namespace tmcl::test
