// One exchange with a module, four ways, against the same responder on a pty:
//
//   roundtrip/raw/pty      look for surplus bytes, write, poll and read by hand: the limit
//   roundtrip/libtmcl/pty  the blocking bus
//   roundtrip/relay/pty    a client of a program that only passes bytes on, by a unix socket
//   roundtrip/daemon/pty   a client of tmcld, on its unix socket
//
// The responder answers at once, so what differs is what the software adds.

#include <benchmark/benchmark.h>

#include <poll.h>

#include "bench/daemon_process.hpp"
#include "bench/relay.hpp"
#include "support/pty.hpp"
#include "support/responder.hpp"
#include "tmcl/blocking.hpp"

namespace {

using namespace tmcl;

const Request position_request{ModuleAddress{1}, Command::GAP, 1, 0, 0};

bool is_readable(int descriptor, int wait_ms) {
  pollfd waiting{descriptor, POLLIN, 0};
  return poll(&waiting, 1, wait_ms) > 0;
}

void exchange_by_hand(benchmark::State& state, int descriptor) {
  const auto bytes = encode_serial(position_request);
  SerialBytes reply{};
  for (auto _ : state) {
    if (is_readable(descriptor, 0)) return state.SkipWithError("surplus bytes");
    if (write(descriptor, bytes.data(), bytes.size()) != ssize_t{sizeof bytes} ||
        !is_readable(descriptor, 1000) ||
        read(descriptor, reply.data(), reply.size()) != ssize_t{sizeof reply})
      return state.SkipWithError("no answer");
    benchmark::DoNotOptimize(reply);
  }
}

void raw(benchmark::State& state) {
  const test::Pty pty;
  const test::Responder responder(pty.master());
  // The link sets the port up; what is measured does without it.
  const auto link = Link::open("serial:" + pty.path() + "@115200");
  exchange_by_hand(state, link->descriptor());
}

void relay(benchmark::State& state) {
  const test::Pty pty;
  const test::Responder responder(pty.master());
  const auto link = Link::open("serial:" + pty.path() + "@115200");
  const bench::Relay relay(link->descriptor());
  exchange_by_hand(state, relay.socket());
}

void libtmcl(benchmark::State& state) {
  const test::Pty pty;
  const test::Responder responder(pty.master());
  auto bus = blocking::Bus::open("serial:" + pty.path() + "@115200");
  for (auto _ : state) {
    const auto answer = bus->execute(position_request);
    if (!answer) state.SkipWithError(describe(answer.error()).c_str());
  }
}

void through_daemon(benchmark::State& state) {
  const test::Pty pty;
  const test::Responder responder(pty.master());
  const bench::DaemonProcess daemon(pty.path());
  auto connection = daemon.connect();
  for (auto _ : state) {
    const auto answer = connection.call("parameter.get", {{"axis", "x"}, {"parameter", 1}});
    if (!answer) return state.SkipWithError(answer.error().message.c_str());
  }
}

void daemon(benchmark::State& state) { bench::attempt(state, through_daemon); }

BENCHMARK(raw)->Name("roundtrip/raw/pty")->UseRealTime()->Unit(benchmark::kMicrosecond);
BENCHMARK(libtmcl)->Name("roundtrip/libtmcl/pty")->UseRealTime()->Unit(benchmark::kMicrosecond);
BENCHMARK(relay)->Name("roundtrip/relay/pty")->UseRealTime()->Unit(benchmark::kMicrosecond);
BENCHMARK(daemon)->Name("roundtrip/daemon/pty")->UseRealTime()->Unit(benchmark::kMicrosecond);

}  // namespace
