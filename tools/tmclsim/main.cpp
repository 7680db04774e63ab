// tmclsim: simulated TMCL modules on ptys, CAN and TCP.
#include <csignal>
#include <cstdio>
#include <exception>
#include <iostream>
#include <memory>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>

#include "console_input.hpp"
#include "options.hpp"
#include "sim/bench.hpp"
#include "sim/ports/can_port.hpp"
#include "sim/ports/pty_port.hpp"
#include "sim/ports/scheduler.hpp"
#include "sim/ports/tcp_port.hpp"

namespace {

namespace sim = tmcl::sim;
using Ports = std::vector<std::unique_ptr<sim::Port>>;

constexpr int exit_failed = 1;

void add_modules(sim::Bench& bench, const std::vector<tmclsim::ModuleSpec>& specs) {
  for (const auto& sentence : tmclsim::shared_addresses(specs)) {
    std::cerr << "tmclsim: warning: " << sentence << '\n';
  }
  for (const auto& spec : specs) {
    auto& module = bench.add(*spec.model, spec.address);
    for (std::size_t motor = 0; motor < spec.stages.size(); ++motor) {
      module.mount(motor, spec.stages[motor]);
    }
    std::cout << "module " << number(spec.address) << " " << spec.model->name << ", "
              << int{spec.model->axes} << (spec.model->axes == 1 ? " motor" : " motors")
              << ", firmware " << to_string(module.version()) << '\n';
  }
}

bool keep(Ports& ports, sim::OpenedPort opened) {
  if (!opened) {
    std::cerr << "tmclsim: " << opened.error() << '\n';
    return false;
  }
  std::cout << (*opened)->description() << '\n';
  ports.push_back(std::move(*opened));
  return true;
}

bool open_ports(boost::asio::io_context& io, sim::Scheduler& scheduler,
                const tmclsim::Options& options, Ports& ports) {
  for (const auto& path : options.ptys) {
    if (!keep(ports, sim::open_pty_port(io, scheduler, path))) return false;
  }
  for (const auto& interface : options.can_interfaces) {
    if (!keep(ports, sim::open_can_port(io, scheduler, interface))) return false;
  }
  for (const auto& endpoint : options.tcp_endpoints) {
    if (!keep(ports, sim::open_tcp_port(io, scheduler, endpoint))) return false;
  }
  return true;
}

int run(const tmclsim::Options& options) {
  boost::asio::io_context io(1);
  boost::asio::signal_set signals(io, SIGINT, SIGTERM);
  signals.async_wait([&](const auto& error, int) {
    if (!error) io.stop();
  });
  const tmcl::RealClock clock;
  sim::Bench bench(clock);
  sim::Scheduler scheduler(io, bench);
  Ports ports;
  add_modules(bench, options.modules);
  if (!open_ports(io, scheduler, options, ports)) return exit_failed;
  tmclsim::ConsoleInput console(io, scheduler);
  if (options.console) console.listen();
  std::cout << "ready" << std::endl;
  io.run();
  return 0;
}

}  // namespace

int main(int argc, char** argv) try {
  const auto options = tmclsim::parse_options(argc, argv);
  if (!options) {
    const auto& exit = options.error();
    (exit.status == 0 ? std::cout : std::cerr) << exit.message;
    return exit.status;
  }
  return run(*options);
} catch (const std::exception& error) {
  std::fprintf(stderr, "tmclsim: %s\n", error.what());
  return exit_failed;
}
