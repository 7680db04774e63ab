// One exchange with a module, three ways, against the same responder on a pty:
//
//   roundtrip/raw/pty      write, poll and read by hand: the limit
//   roundtrip/libtmcl/pty  the blocking bus
//   roundtrip/daemon/pty   a client of tmcld, on its unix socket
//
// The responder answers at once, so what differs is what the software adds.

#include <benchmark/benchmark.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include <fcntl.h>
#include <spawn.h>

#include "support/build_paths.hpp"
#include "support/pty.hpp"
#include "support/responder.hpp"
#include "tmcl/blocking.hpp"
#include "tmcl/client.hpp"

namespace {

using namespace tmcl;

const Request request{ModuleAddress{1}, Command::GAP, 1, 0, 0};

void raw(benchmark::State& state) {
  const test::Pty pty;
  const test::Responder responder(pty.master());
  // The link sets the port up; what is measured does without it.
  const auto link = Link::open("serial:" + pty.path() + "@115200");
  const auto bytes = encode_serial(request);
  SerialBytes reply{};
  for (auto _ : state) {
    if (write(link->descriptor(), bytes.data(), bytes.size()) != ssize_t{sizeof bytes}) break;
    pollfd waiting{link->descriptor(), POLLIN, 0};
    poll(&waiting, 1, 100);
    if (read(link->descriptor(), reply.data(), reply.size()) != ssize_t{sizeof reply}) break;
    benchmark::DoNotOptimize(reply);
  }
}

void libtmcl(benchmark::State& state) {
  const test::Pty pty;
  const test::Responder responder(pty.master());
  auto bus = blocking::Bus::open("serial:" + pty.path() + "@115200");
  for (auto _ : state) {
    const auto answer = bus->execute(request);
    if (!answer) state.SkipWithError(describe(answer.error()).c_str());
  }
}

/// A tmcld of its own, with one bus and one axis.
class Daemon {
 public:
  explicit Daemon(const std::string& port) {
    char name[] = "/tmp/tmcl_bench.XXXXXX";
    folder_ = mkdtemp(name);
    std::ofstream(folder_ / "tmcld.toml")
        << "[daemon]\nsocket = \"" << socket() << "\"\nlog_level = \"error\"\n"
        << "[[bus]]\nname = \"bench\"\nlink = \"serial:" << port << "@115200\"\n"
        << "[[axis]]\nname = \"x\"\nbus = \"bench\"\naddress = 1\nmotor = 0\n";
    const auto config = folder_ / "tmcld.toml";
    const char* arguments[] = {"tmcld", "--config", config.c_str(), nullptr};
    posix_spawn(&process_, TMCL_BIN_DIR "/tmcld", nullptr, nullptr, const_cast<char**>(arguments),
                environ);
  }
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;
  ~Daemon() {
    kill(process_, SIGTERM);
    waitpid(process_, nullptr, 0);
    std::filesystem::remove_all(folder_);
  }

  std::string socket() const { return folder_ / "tmcld.sock"; }

 private:
  std::filesystem::path folder_;
  pid_t process_ = 0;
};

client::CallResult<client::Connection> connect_soon(const std::string& socket) {
  for (int i = 0; i < 100; ++i) {
    auto connection = client::Connection::open(socket);
    if (connection && connection->call("axis.get_state", {{"axis", "x"}})) return connection;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return client::Connection::open(socket);
}

void daemon(benchmark::State& state) {
  const test::Pty pty;
  const test::Responder responder(pty.master());
  const Daemon daemon(pty.path());
  auto connection = connect_soon(daemon.socket());
  if (!connection) return state.SkipWithError(connection.error().message.c_str());
  for (auto _ : state) {
    const auto answer = connection->call("parameter.get", {{"axis", "x"}, {"parameter", 1}});
    if (!answer) state.SkipWithError(answer.error().message.c_str());
  }
}

BENCHMARK(raw)->Name("roundtrip/raw/pty")->UseRealTime()->Unit(benchmark::kMicrosecond);
BENCHMARK(libtmcl)->Name("roundtrip/libtmcl/pty")->UseRealTime()->Unit(benchmark::kMicrosecond);
BENCHMARK(daemon)->Name("roundtrip/daemon/pty")->UseRealTime()->Unit(benchmark::kMicrosecond);

}  // namespace

BENCHMARK_MAIN();
