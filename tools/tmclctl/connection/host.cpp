#include "host.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <iostream>

#include <poll.h>
#include <unistd.h>

namespace tmclctl {
namespace {

volatile std::sig_atomic_t caught_signal = 0;
volatile std::sig_atomic_t pause_wanted = 0;

void note_signal(int number) { caught_signal = number; }
void note_pause(int number) { pause_wanted = number == SIGTSTP && pause_wanted == 0 ? 1 : 0; }

// A signal that comes just before the sleep begins is noticed after so long at the latest.
constexpr auto longest_sleep = std::chrono::milliseconds(100);
/// A longer one is handed out in parts.
constexpr std::size_t longest_line = 4096;

}  // namespace

void RealHost::catch_signals() {
  struct sigaction action {};
  action.sa_handler = note_signal;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigemptyset(&action.sa_mask);
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
  // Whom nohup started ignores it.
  struct sigaction before {};
  ::sigaction(SIGHUP, nullptr, &before);
  if (before.sa_handler != SIG_IGN) ::sigaction(SIGHUP, &action, nullptr);
}

std::optional<bool> RealHost::confirm(const std::string& question) {
  if (::isatty(STDIN_FILENO) == 0 || ::isatty(STDERR_FILENO) == 0) return std::nullopt;
  std::cerr << question << std::flush;
  std::string said;
  std::getline(std::cin, said);
  return said == "y" || said == "Y" || said == "yes";
}

void RealHost::read_input() {
  while (!input_ended_ && input_.find('\n') == std::string::npos && input_.size() < longest_line) {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    if (::poll(&input, 1, 0) <= 0) return;
    char part[longest_line];
    const auto count = ::read(STDIN_FILENO, part, longest_line - input_.size());
    if (count < 0 && errno == EINTR) return;
    if (count <= 0) input_ended_ = true;
    if (count > 0) input_.append(part, static_cast<std::size_t>(count));
  }
}

std::optional<std::string> RealHost::take_line() {
  read_input();
  const auto end = input_.find('\n');
  const bool is_last = input_ended_ && !input_.empty();
  if (end == std::string::npos && !is_last && input_.size() < longest_line) return std::nullopt;
  auto line = input_.substr(0, end);
  input_.erase(0, end == std::string::npos ? end : end + 1);
  return line;
}

void RealHost::sleep(tmcl::Duration duration) {
  const auto until = now() + duration;
  while (signal() == 0) {
    const auto left = until - now();
    if (left <= tmcl::Duration::zero()) return;
    const auto slice = std::min<tmcl::Duration>(left, longest_sleep);
    const timespec time{0, static_cast<long>(slice.count())};
    ::ppoll(nullptr, 0, &time, nullptr);
  }
}

int RealHost::signal() const { return caught_signal; }

int RealHost::take_signal() {
  const int number = caught_signal;
  caught_signal = 0;
  return number;
}

void RealHost::catch_pauses() {
  struct sigaction action {};
  action.sa_handler = note_pause;
  sigemptyset(&action.sa_mask);
  ::sigaction(SIGTSTP, &action, nullptr);
  ::sigaction(SIGCONT, &action, nullptr);
}

bool RealHost::pause_asked() const { return pause_wanted != 0; }

}  // namespace tmclctl
