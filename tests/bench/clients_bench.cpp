// What tmcld does for many clients that read young states, one or sixteen requests of each
// outstanding:
//
//   clients/CLIENTS/OUTSTANDING   `items_per_second`: requests; `cpu`: seconds of processor time of
//                                 tmcld in a second; `us_cpu_a_request`: of it, for a request
//   answered/CLIENTS/OUTSTANDING  the same of the least server, see line_server.hpp

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <sys/epoll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/un.h>

#include "bench/daemon_process.hpp"
#include "bench/line_server.hpp"
#include "support/pty.hpp"
#include "support/responder.hpp"
#include "tmcl/clock.hpp"

namespace {

using namespace tmcl;

constexpr std::string_view request =
    R"({"jsonrpc":"2.0","id":1,"method":"axis.get_state","params":{"axis":"x","max_age_ms":1000}})"
    "\n";

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {
    if (number < 0) throw std::runtime_error("no descriptor");
  }
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&&) = delete;
  ~Descriptor() {
    if (number_ >= 0) close(number_);
  }
  int number() const { return number_; }

 private:
  int number_;
};

/// Each writes as many requests as it gets answers.
class Clients {
 public:
  Clients(const std::string& socket, std::size_t count) : poller_(epoll_create1(EPOLL_CLOEXEC)) {
    for (std::size_t i = 0; i < count; ++i) {
      const auto& client = clients_.emplace_back(connect_to(socket));
      epoll_event event{EPOLLIN, {.fd = client.number()}};
      epoll_ctl(poller_.number(), EPOLL_CTL_ADD, client.number(), &event);
      take_lines(client.number());  // the greeting
    }
  }

  void ask(std::size_t outstanding) {
    for (const auto& client : clients_) write_requests(client.number(), outstanding);
  }
  /// Takes answers as they come, and asks again for each; how many there were.
  std::size_t work() {
    constexpr int patience_ms = 10'000;
    std::array<epoll_event, 64> events{};
    const auto count = epoll_wait(poller_.number(), events.data(), events.size(), patience_ms);
    if (count <= 0) throw std::runtime_error("tmcld is silent");
    std::size_t answers = 0;
    for (int i = 0; i < count; ++i) {
      const int client = events[static_cast<std::size_t>(i)].data.fd;
      const auto lines = take_lines(client);
      write_requests(client, lines);
      answers += lines;
    }
    return answers;
  }

 private:
  static int connect_to(const std::string& path) {
    const int descriptor = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    if (connect(descriptor, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0)
      throw std::runtime_error("cannot connect to " + path);
    return descriptor;
  }
  std::size_t take_lines(int client) {
    const auto count = read(client, buffer_.data(), buffer_.size());
    if (count <= 0) throw std::runtime_error("tmcld has hung up");
    const std::string_view text(buffer_.data(), static_cast<std::size_t>(count));
    if (text.find("\"error\"") != text.npos) throw std::runtime_error(std::string(text));
    return static_cast<std::size_t>(std::ranges::count(text, '\n'));
  }
  void write_requests(int client, std::size_t count) {
    output_.clear();
    while (count-- > 0) output_ += request;
    if (write(client, output_.data(), output_.size()) != static_cast<ssize_t>(output_.size()))
      throw std::runtime_error("tmcld does not read");
  }

  Descriptor poller_;
  std::vector<Descriptor> clients_;
  std::array<char, 65536> buffer_{};
  std::string output_;
};

void allow_enough_descriptors() {
  rlimit limit{};
  getrlimit(RLIMIT_NOFILE, &limit);
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
}

void ask(benchmark::State& state, const std::string& socket,
         const std::function<double()>& cpu_seconds) {
  Clients clients(socket, static_cast<std::size_t>(state.range(0)));
  const auto outstanding = static_cast<std::size_t>(state.range(1));
  const RealClock clock;
  clients.ask(outstanding);
  std::size_t answers = 0;
  const auto cpu_before = cpu_seconds();
  const auto began = clock.now();
  for (auto _ : state) answers += clients.work();
  const std::chrono::duration<double> took = clock.now() - began;
  const auto cpu = cpu_seconds() - cpu_before;
  state.SetItemsProcessed(static_cast<std::int64_t>(answers));
  state.counters["cpu"] = cpu / took.count();
  state.counters["us_cpu_a_request"] = 1e6 * cpu / static_cast<double>(answers);
}

void ask_tmcld(benchmark::State& state) {
  allow_enough_descriptors();
  const test::Pty pty;
  const test::Responder responder(pty.master());
  const bench::DaemonProcess daemon(pty.path());
  ask(state, daemon.socket(), [&] { return daemon.cpu_seconds(); });
}

void ask_line_server(benchmark::State& state) {
  allow_enough_descriptors();
  const bench::LineServer server;
  ask(state, server.socket(), [&] { return bench::cpu_seconds_of(server.process()); });
}

void clients(benchmark::State& state) { bench::attempt(state, ask_tmcld); }
void answered(benchmark::State& state) { bench::attempt(state, ask_line_server); }

void sizes(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgsProduct({{1, 100, 1000}, {1, 16}})->UseRealTime()->Unit(benchmark::kMicrosecond);
}

BENCHMARK(clients)->Apply(sizes);
BENCHMARK(answered)->Apply(sizes);

}  // namespace
