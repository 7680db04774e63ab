#include "program_debug.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iostream>
#include <sstream>
#include <utility>

namespace tmclsim {
namespace {

namespace program = tmcl::program;
using program::Debugger;
using program::DebugOrder;
using program::Standing;
using Kind = DebugOrder::Kind;

constexpr std::uint32_t most_steps_to_a_breakpoint = 1'000'000;

tl::expected<std::string, std::string> read_source(const std::string& path) {
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::string text(program::most_source_bytes + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!file.is_open() || file.bad()) return tl::unexpected(std::string(std::strerror(errno)));
  text.resize(static_cast<std::size_t>(file.gcount()));
  return text;
}

Standing carry_out(const DebugOrder& order, const Debugger& debugger, ProgramBench& bench) {
  switch (order.kind) {
    case Kind::step: return bench.step(order.steps, debugger.breakpoints());
    case Kind::back: return bench.back(order.steps);
    case Kind::restart: return bench.restart();
    case Kind::stop: return bench.stop();
    default: return bench.look();
  }
}

std::string outcome_text(const DebugOrder& order, Debugger& debugger, ProgramBench& bench) {
  const auto now = carry_out(order, debugger, bench);
  std::vector<program::Reading> readings;
  for (const auto& watched : debugger.to_read(order.kind))
    readings.push_back({watched, bench.read(watched)});
  return debugger.stands(order.kind, now, readings);
}

}  // namespace

int debug_program(const std::string& path, const tmcl::Model& model, ProgramBench::Build build,
                  std::istream& in, std::ostream& out, std::ostream& errors, bool prompts) {
  auto assembly = program::assemble(path, read_source, &model);
  if (!assembly) {
    for (const auto& problem : assembly.error()) errors << describe(problem, path) << '\n';
    return 1;
  }
  ProgramBench bench(std::move(build), assembly->program);
  program::DebuggerOptions options;
  options.is_simulated = true;
  options.most_steps = most_steps_to_a_breakpoint;
  options.motors = model.axes;
  Debugger debugger(std::move(*assembly), options);
  out << outcome_text({Kind::look, 0, {}, false}, debugger, bench) << std::flush;
  std::string line;
  while (true) {
    if (prompts) out << "(debug) " << std::flush;
    if (!std::getline(in, line)) return 0;
    const auto order = debugger.say(line);
    out << order.text;
    if (order.kind == Kind::quit) return 0;
    if (order.kind != Kind::none) out << outcome_text(order, debugger, bench);
    out << std::flush;
  }
}

}  // namespace tmclsim
