#include "program_bench.hpp"

#include <algorithm>
#include <charconv>
#include <string_view>
#include <utility>

#include "sim/module/due.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/seconds.hpp"

namespace tmclsim {
namespace {

namespace sim = tmcl::sim;
using tmcl::Command;
using tmcl::Request;
using tmcl::program::Registers;
using tmcl::program::Standing;

constexpr std::uint8_t user_variable_bank = 2;
constexpr auto error_flags = std::to_array<std::string_view>({"ETO", "EAL", "EDV", "EPO", "ESD"});
constexpr auto state_names =
    std::to_array<std::string_view>({"stopped", "running", "stepping", "reset"});

/// The debugger takes no events.
struct NoEvents final : sim::EventSink {
  void target_reached(const sim::Module& /*module*/, std::int32_t /*motors*/) override {}
};

Registers registers_of(const sim::Processor::Inside& inside) {
  Registers told;
  const auto& registers = inside.registers;
  told.accumulator = registers.accumulator;
  told.x = registers.x;
  told.zero = registers.zero;
  told.compared = registers.compared < 0 ? -1 : registers.compared > 0 ? 1 : 0;
  for (std::size_t flag = 0; flag < error_flags.size(); ++flag)
    if ((inside.errors >> flag & 1U) != 0) told.errors.emplace_back(error_flags[flag]);
  told.returns = inside.calls;
  told.resumes = inside.resumes;
  return told;
}

std::optional<std::uint8_t> parameter_number(const tmcl::Model& model, const std::string& name) {
  if (const auto* row = tmcl::find_parameter(tmcl::axis_parameters(model), name))
    return row->number;
  std::uint8_t number = 0;
  const auto* end = name.data() + name.size();
  const auto read = std::from_chars(name.data(), end, number);
  if (read.ec != std::errc() || read.ptr != end) return std::nullopt;
  return number;
}

}  // namespace

struct ProgramBench::World {
  tmcl::VirtualClock clock;
  sim::Bench bench{clock};
  NoEvents events;

  sim::Module& module() const { return *bench.modules().front(); }
  /// Everything that is due until then happens at its own time.
  void advance_to(tmcl::TimePoint time) {
    for (auto due = bench.next_due(); due <= time; due = bench.next_due()) {
      clock.advance_to(std::max(due, clock.now()));
      bench.run_due();
    }
    clock.advance_to(std::max(time, clock.now()));
  }
};

ProgramBench::ProgramBench(Build build, tmcl::program::Program program)
    : build_(std::move(build)), program_(std::move(program)) {
  begin();
}
ProgramBench::~ProgramBench() = default;

void ProgramBench::begin() {
  world_ = std::make_unique<World>();
  build_(world_->bench);
  done_ = 0;
  const tmcl::ModuleAddress address{1};
  ask({address, Command::START_DOWNLOAD, 0, 0, 0});
  for (const auto& line : program_) ask({address, line.command, line.type, line.motor, line.value});
  ask({address, Command::END_DOWNLOAD, 0, 0, 0});
  ask({address, Command::RESET_APPLICATION, 0, 0, 0});
}

sim::Answer ProgramBench::ask(const Request& request) {
  return world_->module().execute(request, sim::Medium::serial, world_->events);
}

Standing ProgramBench::look() const {
  const auto& module = world_->module();
  const auto inside = module.program_inside();
  Standing now;
  now.state = state_names[static_cast<std::size_t>(inside.state)];
  now.address = inside.counter;
  now.last_error = inside.last_error ? static_cast<std::int32_t>(*inside.last_error) : 0;
  now.registers = registers_of(inside);
  now.time_s = tmcl::seconds(world_->clock.now() - tmcl::TimePoint{});
  return now;
}

bool ProgramBench::step_once() {
  auto& world = *world_;
  const auto& module = world.module();
  const auto limit = world.clock.now() + longest_wait;
  ask({tmcl::ModuleAddress{1}, Command::STEP_APPLICATION, 0, 0, 0});
  ++done_;
  while (module.program_inside().is_busy) {
    const auto due = world.bench.next_due();
    world.advance_to(std::min(due, limit));
    if (world.clock.now() >= limit && module.program_inside().is_busy) return false;
  }
  // As late as the next command would begin if it ran.
  world.advance_to(std::max(world.clock.now(), module.program_inside().ready));
  return true;
}

Standing ProgramBench::step(std::uint32_t steps, std::span<const std::uint16_t> breakpoints) {
  std::string reason = "steps";
  std::uint32_t executed = 0;
  while (executed < steps) {
    const bool is_over = step_once();
    ++executed;
    const auto inside = world_->module().program_inside();
    if (!is_over) {
      reason = "waits";
    } else if (inside.state == sim::Processor::State::stopped) {
      reason = "ended";
    } else if (std::ranges::find(breakpoints, inside.counter) != breakpoints.end()) {
      reason = "breakpoint";
    } else {
      continue;
    }
    break;
  }
  auto now = look();
  now.reason = reason;
  now.steps = executed;
  return now;
}

Standing ProgramBench::back(std::uint32_t steps) {
  const auto wanted = done_ - std::min<std::uint64_t>(done_, steps);
  begin();
  while (done_ < wanted) step_once();
  return look();
}

Standing ProgramBench::restart() {
  begin();
  return look();
}

Standing ProgramBench::stop() {
  const tmcl::ModuleAddress address{1};
  ask({address, Command::STOP_APPLICATION, 0, 0, 0});
  for (int motor = 0; motor < world_->module().model().axes; ++motor)
    ask({address, Command::MST, 0, static_cast<std::uint8_t>(motor), 0});
  return look();
}

tl::expected<std::int32_t, std::string> ProgramBench::read(const tmcl::program::Watched& watched) {
  const tmcl::ModuleAddress address{1};
  const auto& model = world_->module().model();
  Request request{address, Command::GGP, 0, user_variable_bank, 0};
  if (watched.motor) {
    const auto number = parameter_number(model, watched.name);
    if (!number)
      return tl::unexpected("there is no parameter '" + watched.name + "' of a " +
                            std::string(model.name));
    request = {address, Command::GAP, *number, *watched.motor, 0};
  } else {
    request.type = static_cast<std::uint8_t>(std::stoi(watched.name));
  }
  const auto answer = ask(request);
  if (!tmcl::is_success(answer.status))
    return tl::unexpected("the module refuses to tell it: " +
                          std::string(tmcl::name_of(answer.status)));
  return answer.value;
}

}  // namespace tmclsim
