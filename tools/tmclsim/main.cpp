// tmclsim: simulated TMCL modules on ptys, USB, CAN and TCP.
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <unistd.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>

#include "console.hpp"
#include "console_input.hpp"
#include "log/log.hpp"
#include "options.hpp"
#include "own_gateway.hpp"
#include "program_debug.hpp"
#include "replay.hpp"
#include "sim/bench.hpp"
#include "sim/ports/can_port.hpp"
#include "sim/ports/eeprom_file.hpp"
#include "sim/ports/pty_port.hpp"
#include "sim/ports/scheduler.hpp"
#include "sim/ports/tcp_port.hpp"
#include "sim/ports/usb_port.hpp"
#include "sim/wire/rates.hpp"

namespace {

namespace sim = tmcl::sim;
using Ports = std::vector<std::unique_ptr<sim::Port>>;

constexpr int exit_failed = 1;
constexpr int exit_wrong = 2;

struct Memory {
  sim::Module* module;
  std::unique_ptr<sim::EepromFile> file;  ///< Null if it forgets everything.
  std::uint64_t writes_before;
};
using Memories = std::vector<Memory>;

/// Modules that share model and address have a file each.
std::filesystem::path eeprom_path(const std::string& folder, const tmclsim::ModuleSpec& spec,
                                  std::set<std::string>& taken) {
  const auto name = std::string(spec.model->name) + "@" + std::to_string(number(spec.address));
  auto unique = name;
  for (int twin = 2; !taken.insert(unique).second; ++twin)
    unique = name + "-" + std::to_string(twin);
  return std::filesystem::path(folder) / (unique + ".eeprom");
}

tl::expected<sim::Module*, std::string> add_module(sim::Bench& bench,
                                                   const tmclsim::ModuleSpec& spec,
                                                   const std::filesystem::path& file) {
  if (file.empty()) return &bench.add(*spec.model, spec.address, spec.settings);
  auto eeprom = sim::read_eeprom_file(file, *spec.model);
  if (!eeprom) return tl::unexpected(eeprom.error());
  if (!*eeprom) return &bench.add(*spec.model, spec.address, spec.settings);
  return &bench.add(*spec.model, std::move(**eeprom), spec.settings);
}

std::string name_of(const sim::Module& module) {
  const auto address = module.globals().value(tmcl::global_parameter::serial_address);
  return "module " + std::to_string(address) + " " + std::string(module.model().name);
}

void introduce(const sim::Module& module) {
  const int axes = module.model().axes;
  std::cout << name_of(module) << ", " << axes << (axes == 1 ? " motor" : " motors")
            << ", firmware " << to_string(module.version()) << '\n';
}

void surround(sim::Module& module, const tmclsim::Surroundings& by) {
  if (by.supply_tenths) module.set_supply(*by.supply_tenths);
  if (by.temperature) module.set_analog(sim::Io::temperature_port, *by.temperature);
}

bool add_modules(boost::asio::io_context& io, sim::Bench& bench, const tmclsim::Options& options,
                 Memories& memories) {
  for (const auto& sentence : tmclsim::shared_addresses(options.modules)) {
    std::cerr << "tmclsim: warning: " << sentence << '\n';
  }
  std::set<std::string> taken;
  const auto& folder = options.eeprom_folder;
  for (const auto& spec : options.modules) {
    const auto path = folder.empty() ? "" : eeprom_path(folder, spec, taken);
    const auto module = add_module(bench, spec, path);
    if (!module) {
      std::cerr << "tmclsim: " << module.error() << '\n';
      return false;
    }
    for (std::size_t motor = 0; motor < spec.stages.size(); ++motor) {
      (*module)->mount(motor, spec.stages[motor]);
    }
    surround(**module, spec.surroundings);
    introduce(**module);
    auto file = folder.empty() ? nullptr : std::make_unique<sim::EepromFile>(io, **module, path);
    memories.push_back({*module, std::move(file), (*module)->eeprom().writes()});
  }
  return true;
}

void tell_of_wear(const Memories& memories) {
  for (const auto& memory : memories) {
    const auto writes = memory.module->eeprom().writes();
    if (writes == memory.writes_before) continue;
    std::cout << name_of(*memory.module)
              << ", writes to its EEPROM: " << writes - memory.writes_before;
    if (memory.file) std::cout << ", in its life: " << writes;
    std::cout << '\n';
  }
}

/// As on a real bus, and seldom what is wanted.
void warn_of_replies_taken_for_commands(const sim::Bench& bench) {
  using namespace tmcl::global_parameter;
  for (const auto& module : bench.modules()) {
    const auto own = module->globals().value(can_id);
    const bool hears_replies = std::ranges::any_of(bench.modules(), [&](const auto& other) {
      return other != module && other->globals().value(can_reply_id) == own;
    });
    if (!hears_replies) continue;
    std::cerr << "tmclsim: warning: " << own << " is the address of " << name_of(*module)
              << " and, on CAN, the identifier of replies: it takes those of the other modules for "
                 "commands. Give it another address.\n";
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

/// Those of the first module; they are delivered with the same ones.
sim::SerialWire serial_wire(const tmclsim::Options& options, const sim::Bench& bench) {
  const auto& wires = options.wires;
  sim::SerialWire wire;
  wire.echoes = wires.echo;
  wire.noise = wires.noise;
  wire.seed = wires.seed;
  if (!wires.has_pace) return wire;
  using tmcl::global_parameter::serial_baud_rate;
  const auto code = bench.modules().front()->globals().value(serial_baud_rate);
  wire.pace = {wires.baud != 0 ? wires.baud : sim::serial_rate(code), sim::usual_time_to_answer};
  wire.has_rates_of_modules = wires.baud == 0;
  return wire;
}

sim::Pace can_pace(const tmclsim::Options& options, const sim::Bench& bench) {
  if (!options.wires.has_pace) return {};
  const auto code = bench.modules().front()->globals().value(tmcl::global_parameter::can_bit_rate);
  return {sim::can_rate(code), sim::usual_time_to_answer};
}

bool open_ports(boost::asio::io_context& io, sim::Scheduler& scheduler,
                const tmclsim::Options& options, Ports& ports) {
  const auto wire = serial_wire(options, scheduler.bench());
  const auto pace = can_pace(options, scheduler.bench());
  for (const auto& path : options.ptys) {
    if (!keep(ports, sim::open_pty_port(io, scheduler, path, wire))) return false;
  }
  for (const auto& [module, path] : options.usb_ptys) {
    auto& owner = *scheduler.bench().modules().at(module);
    if (!keep(ports,
              sim::open_usb_pty_port(io, scheduler, owner, path, options.wires.seed + module)))
      return false;
  }
  for (const auto& [module, layout] : options.usb_devices) {
    auto& owner = *scheduler.bench().modules().at(module);
    if (!keep(ports, sim::open_usb_port(io, scheduler, owner, layout, options.wires.seed + module)))
      return false;
  }
  if (!options.can_interfaces.empty()) warn_of_replies_taken_for_commands(scheduler.bench());
  for (const auto& interface : options.can_interfaces) {
    if (!keep(ports, sim::open_can_port(io, scheduler, interface, pace))) return false;
  }
  for (const auto& endpoint : options.tcp_endpoints) {
    if (!keep(ports, sim::open_tcp_port(io, scheduler, endpoint, wire))) return false;
  }
  return true;
}

int run_replay(const tmclsim::Options& options) {
  const auto trace = tmcl::read_trace_file(options.replay);
  if (!trace) {
    std::cerr << "tmclsim: " << trace.error() << '\n';
    return exit_failed;
  }
  boost::asio::io_context io(1);
  tmcl::VirtualClock clock;
  sim::Bench bench(clock);
  Memories memories;
  if (!add_modules(io, bench, options, memories)) return exit_failed;
  const auto tell = [](const std::string& line) { std::cout << line << '\n'; };
  const auto report = tmclsim::replay(*trace, bench, clock, tell);
  std::cout << describe(report) << '\n';
  return report.all_equal() ? 0 : exit_failed;
}

int run_debug(const tmclsim::Options& options) {
  const auto& spec = options.modules.front();
  const auto build = [&](sim::Bench& bench) {
    auto& module = bench.add(*spec.model, spec.address, spec.settings);
    for (std::size_t motor = 0; motor < spec.stages.size(); ++motor)
      module.mount(motor, spec.stages[motor]);
    surround(module, spec.surroundings);
  };
  const bool is_typed = ::isatty(STDIN_FILENO) != 0 && ::isatty(STDOUT_FILENO) != 0;
  return tmclsim::debug_program(options.debug, *spec.model, build, std::cin, std::cout, std::cerr,
                                is_typed);
}

int run(const tmclsim::Options& options) {
  boost::asio::io_context io(1);
  boost::asio::signal_set signals(io, SIGINT, SIGTERM);
  signals.async_wait([&](const auto& error, int) {
    if (!error) io.stop();
  });
  const tmcl::ContextClock clock(io);
  sim::Bench bench(clock);
  sim::Scheduler scheduler(io, bench);
  Ports ports;
  Memories memories;
  if (!add_modules(io, bench, options, memories)) return exit_failed;
  if (!open_ports(io, scheduler, options, ports)) return exit_failed;
  tmclsim::ConsoleInput console(io, [&](std::string_view line) {
    auto answer = tmclsim::run_console_line(bench, line);
    scheduler.touch();
    return answer;
  });
  if (options.console) console.listen();
  std::cout << "ready" << std::endl;
  io.run();
  tell_of_wear(memories);
  return 0;
}

int run_gateway(const tmclsim::Options& options, const tmcld::Config& config) {
  boost::asio::io_context io(1);
  tmcl::VirtualTime time(io);
  const tmcl::ContextClock clock(io);
  sim::Bench bench(clock);
  sim::Scheduler scheduler(io, bench);
  Memories memories;
  if (!add_modules(io, bench, options, memories)) return exit_failed;
  const auto gateway = tmclsim::OwnGateway::create(io, time, scheduler, config, options.wires);
  if (!gateway) {
    std::cerr << "tmclsim: " << gateway.error() << '\n';
    return exit_failed;
  }
  tmclsim::ConsoleInput console(io, [&](auto line) { return (*gateway)->answer(line); });
  if (options.console) console.listen();
  std::cout << "ready" << std::endl;
  (*gateway)->run();
  tell_of_wear(memories);
  return 0;
}

int run_with_gateway(const tmclsim::Options& options) {
  const auto config = tmclsim::load_gateway_config(options.gateway);
  if (!config) {
    for (const auto& line : config.error()) std::cerr << line << '\n';
    return exit_wrong;
  }
  // As in tmcld: a peer that has gone is an error value of the write.
  std::signal(SIGPIPE, SIG_IGN);
  tmcld::start_log(config->daemon.log_level);
  const int status = run_gateway(options, *config);
  if (!tmcld::end_log()) std::_Exit(status);
  return status;
}

}  // namespace

int main(int argc, char** argv) try {
  const auto parsed = tmclsim::parse_options(argc, argv);
  if (!parsed) {
    std::cerr << "tmclsim: " << parsed.error() << "\nSee tmclsim --help.\n";
    return exit_wrong;
  }
  if (const auto* information = std::get_if<tmclsim::Information>(&*parsed)) {
    std::cout << information->text;
    return EXIT_SUCCESS;
  }
  const auto* options = std::get_if<tmclsim::Options>(&*parsed);
  if (!options->debug.empty()) return run_debug(*options);
  if (!options->replay.empty()) return run_replay(*options);
  return options->gateway.empty() ? run(*options) : run_with_gateway(*options);
} catch (const std::exception& error) {
  std::fprintf(stderr, "tmclsim: %s\n", error.what());
  return exit_failed;
}
