/// The least server that could answer many clients: a line as long as the state of an axis for each
/// line that comes, whatever that says. In a process of its own.
#pragma once

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <string>

#include <sys/epoll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

namespace tmcl::bench {

class LineServer {
 public:
  LineServer() {
    const int listener = ::socket(AF_UNIX, SOCK_STREAM, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path_.copy(address.sun_path, sizeof address.sun_path - 1);
    if (bind(listener, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0 ||
        listen(listener, SOMAXCONN) != 0)
      std::abort();
    process_ = fork();
    if (process_ == 0) serve(listener);
    close(listener);
  }
  LineServer(const LineServer&) = delete;
  LineServer& operator=(const LineServer&) = delete;
  ~LineServer() {
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
    std::filesystem::remove(path_);
  }

  const std::string& socket() const { return path_; }
  pid_t process() const { return process_; }

 private:
  static constexpr std::size_t line_bytes = 400;

  [[noreturn]] static void serve(int listener) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    const int poller = epoll_create1(0);
    watch(poller, listener);
    while (true) {
      std::array<epoll_event, 128> events;
      const int count = epoll_wait(poller, events.data(), events.size(), -1);
      for (int i = 0; i < count; ++i) {
        const int ready = events[static_cast<std::size_t>(i)].data.fd;
        ready == listener ? greet(poller, accept(listener, nullptr, nullptr)) : answer(ready);
      }
    }
  }
  static void watch(int poller, int descriptor) {
    epoll_event event{EPOLLIN, {.fd = descriptor}};
    epoll_ctl(poller, EPOLL_CTL_ADD, descriptor, &event);
  }
  static void greet(int poller, int client) {
    watch(poller, client);
    send_lines(client, 1);
  }
  static void answer(int client) {
    std::array<char, 16384> bytes;
    const auto count = read(client, bytes.data(), bytes.size());
    if (count <= 0) {
      close(client);
      return;
    }
    send_lines(client, std::count(bytes.begin(), bytes.begin() + count, '\n'));
  }
  static void send_lines(int client, std::ptrdiff_t count) {
    std::string lines;
    while (count-- > 0) lines.append(line_bytes - 1, 'x') += '\n';
    if (write(client, lines.data(), lines.size()) != static_cast<ssize_t>(lines.size()))
      std::abort();
  }

  std::string path_ =
      std::filesystem::temp_directory_path() / ("tmcl_bench." + std::to_string(getpid()));
  pid_t process_ = 0;
};

}  // namespace tmcl::bench
