// How much of a CAN bus is used when eight modules are read as fast as it carries:
//
//   can/utilisation   `utilisation`: of 1 Mbit/s in virtual time, from 0 to 1; `exchanges`: of
//                     them, in a second of virtual time. The time is what it takes to simulate it.

#include <benchmark/benchmark.h>

#include "async/spawn.hpp"
#include "tmcl/bus.hpp"
#include "tmcl/virtual_time.hpp"
#include "world/wire.hpp"

namespace {

using namespace tmcl;

constexpr std::uint16_t modules = 8;
// 2 is the identifier of all replies: a module of that address would take them for commands.
constexpr std::uint16_t first_address = 3;

// Of a request or a reply, with as many stuffed bits as there can be.
Duration time_on_the_wire() {
  CanFrame frame{};
  frame.length = can_datagram_size;
  return sim::Pace{.bits_per_second = 1'000'000}.of_frame(frame);
}

ModuleAddress address_of(std::uint16_t module) {
  return ModuleAddress{static_cast<std::uint16_t>(first_address + module)};
}

boost::asio::awaitable<void> read_on_and_on(Bus& bus, ModuleAddress module, std::size_t& done) {
  while (true) {
    const auto answer = co_await bus.execute({module, Command::GAP, 1, 0, 0});
    if (!answer) co_return;
    ++done;
  }
}

void utilisation(benchmark::State& state) {
  using namespace std::chrono_literals;
  constexpr auto slice = 100ms;
  boost::asio::io_context context{1};
  VirtualTime time(context);
  tmcld::test::Trace trace;
  // Modules answer after 0.2 ms.
  tmcld::test::Wire wire(context, "can", Framing::can, 1, {}, trace);
  for (std::uint16_t module = 0; module < modules; ++module)
    wire.bench().add(*find_model("TMCM-1110"), address_of(module));
  std::size_t done = 0;
  {
    Bus bus(context.get_executor(), std::move(*wire.open()));
    for (std::uint16_t module = 0; module < modules; ++module)
      tmcld::spawn(context.get_executor(), read_on_and_on(bus, address_of(module), done));
    time.run_for(slice);  // until all of them are under way
    done = 0;
    const auto began = time.now();
    for (auto _ : state) time.run_for(slice);
    const std::chrono::duration<double> lasted = time.now() - began;
    const std::chrono::duration<double> of_exchange = 2 * time_on_the_wire();
    const auto exchanges = static_cast<double>(done) / lasted.count();
    state.counters["exchanges"] = exchanges;
    state.counters["utilisation"] = exchanges * of_exchange.count();
    bus.close();
    time.run_for(slice);
  }
}

BENCHMARK(utilisation)->Name("can/utilisation")->Unit(benchmark::kMillisecond);

}  // namespace
