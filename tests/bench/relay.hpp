/// The least program that could stand where tmcld stands: what comes from its client goes to the
/// port, what comes from there goes back. In a process of its own.
#pragma once

#include <array>
#include <csignal>
#include <cstdlib>

#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

namespace tmcl::bench {

class Relay {
 public:
  /// `port` is what it talks to; its client is at the socket().
  explicit Relay(int port) {
    if (socketpair(AF_UNIX, SOCK_STREAM, 0, ends_.data()) != 0) std::abort();
    process_ = fork();
    if (process_ == 0) serve(ends_[1], port);
  }
  Relay(const Relay&) = delete;
  Relay& operator=(const Relay&) = delete;
  ~Relay() {
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
    for (const int end : ends_) close(end);
  }

  int socket() const { return ends_[0]; }

 private:
  [[noreturn]] static void serve(int socket, int port) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    std::array<pollfd, 2> both{{{socket, POLLIN, 0}, {port, POLLIN, 0}}};
    while (true) {
      poll(both.data(), both.size(), -1);
      if ((both[0].revents & POLLIN) != 0) pass_on(socket, port);
      if ((both[1].revents & POLLIN) != 0) pass_on(port, socket);
    }
  }
  static void pass_on(int from, int to) {
    std::array<char, 4096> bytes;
    const auto count = read(from, bytes.data(), bytes.size());
    if (count > 0 && write(to, bytes.data(), static_cast<std::size_t>(count)) != count)
      std::abort();
  }

  std::array<int, 2> ends_{};
  pid_t process_ = 0;
};

}  // namespace tmcl::bench
