// Moves two motors of one module at the same time, with coroutines on Boost.Asio.
//
//     03_two_axes_with_asio serial:/dev/ttyACM0@115200

#include <iostream>

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/experimental/awaitable_operators.hpp>
#include <boost/asio/io_context.hpp>

#include "tmcl/bus.hpp"

namespace asio = boost::asio;

namespace {

/// There and back again; what went wrong, if something did.
asio::awaitable<std::optional<tmcl::Error>> round_trip(tmcl::Axis axis, tmcl::Microsteps distance) {
  for (const auto leg : {distance, tmcl::Microsteps{-distance.value}}) {
    const auto target = co_await axis.move_by(leg);
    if (!target) co_return target.error();
    const auto arrived = co_await axis.wait_until_reached();
    if (!arrived) co_return arrived.error();
    std::cout << "motor " << axis.address().motor + 0 << " stands at " << arrived->value << '\n';
  }
  co_return std::nullopt;
}

asio::awaitable<void> run(tmcl::Bus& bus, int& exit_code) {
  using namespace asio::experimental::awaitable_operators;
  auto module = bus.module(tmcl::ModuleAddress{1});
  const auto [first, second] = co_await (round_trip(module.axis(0), tmcl::Microsteps{20'000}) &&
                                         round_trip(module.axis(1), tmcl::Microsteps{-5'000}));
  for (const auto& error : {first, second}) {
    if (!error) continue;
    std::cerr << describe(*error) << '\n';
    exit_code = 1;
  }
  bus.close();
}

}  // namespace

int main(int argc, char** argv) {
  auto link = tmcl::Link::open(argc > 1 ? argv[1] : "serial:/dev/ttyACM0@115200");
  if (!link) {
    std::cerr << describe(link.error()) << '\n';
    return 1;
  }
  asio::io_context context;
  tmcl::Bus bus(context.get_executor(), std::move(*link));
  int exit_code = 0;
  asio::co_spawn(context, run(bus, exit_code), asio::detached);
  context.run();
  return exit_code;
}
