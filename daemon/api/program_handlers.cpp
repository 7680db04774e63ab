// Stand-alone programs.
#include "api/handlers.hpp"
#include "api/journey.hpp"
#include "api/module_choice.hpp"
#include "gateway/authority/reach.hpp"
#include "gateway/program_end.hpp"
#include "tmcl/assembler.hpp"

namespace tmcld::handlers {
namespace {

using tmcl::program::Program;

constexpr std::uint32_t usual_most_steps = 1000;

Result<Program> program_of(const std::string& text) {
  return tmcl::program::from_hex(text).map_error([](const std::string& problem) {
    return param_error<&program::Load::program>("bad_argument", "'program': " + problem);
  });
}

Result<const tmcl::Model*> model_of(const program::Assemble& params) {
  if (!params.model) return nullptr;
  const auto* model = tmcl::find_model(*params.model);
  if (model != nullptr) return model;
  return tl::unexpected(param_error<&program::Assemble::model>(
      "unknown_model", "there is no model '" + *params.model + "'", "such as TMCM-1110"));
}

/// The text has no file beside it, and none of this computer is shown to a client.
tl::expected<tmcl::program::Assembly, tmcl::TextProblems> assembly_of(const std::string& text,
                                                                      const tmcl::Model* model) {
  bool is_read = false;
  const auto read = [&](const std::string&) -> tl::expected<std::string, std::string> {
    if (!std::exchange(is_read, true)) return text;
    return tl::unexpected(std::string("tmcld reads no files"));
  };
  return tmcl::program::assemble("program", read, model);
}

Error refusal_of_text(const tmcl::TextProblems& problems) {
  const auto& first = problems.front();
  auto error = param_error<&program::Assemble::text>(
      "bad_program", "line " + std::to_string(first.line) + ": " + first.message);
  add_problems(error, problems);
  return error;
}

program::Assembled view_of(const tmcl::program::Assembly& assembly) {
  program::Assembled view{tmcl::program::to_hex(assembly.program),
                          static_cast<std::uint32_t>(assembly.program.size())};
  for (const auto& line : assembly.lines)
    if (line.address) view.lines.push_back(static_cast<std::uint32_t>(line.line));
  for (const auto& label : assembly.labels)
    view.labels.push_back({label.name, static_cast<std::uint32_t>(label.address)});
  return view;
}

/// Tells the client how far it is; ends the verb when its client has gone.
tmcl::OnLoadProgress progress_for(const Call& call, const ModuleChoice& module) {
  return [gateway = call.gateway, peer = call.peer, tell = call.progress_reporter(),
          bus = module.bus->name(),
          address = number(module.address)](const tmcl::LoadProgress& progress) {
    const bool writing = progress.phase == tmcl::LoadProgress::Phase::writing;
    tell(LoadProgress{bus, address, writing ? "writing" : "comparing", progress.done, progress.of});
    return !peer->is_gone() && !gateway->is_closing();
  };
}

std::string_view name_of(tmcl::ProgramStatus::State state) {
  using enum tmcl::ProgramStatus::State;
  switch (state) {
    case stopped: return "stopped";
    case running: return "running";
    case stepping: return "stepping";
    case reset: return "reset";
  }
  return {};
}

using LoadVerb = tmcl::Script<tmcl::Result<void>> (*)(tmcl::ModuleAddress, Program,
                                                      tmcl::LoadOptions);

Task<program::Commands> load_or_compare(const Call& call, program::Load params, LoadVerb verb) {
  const auto module = co_await must(module_of(call, params));
  const auto program = co_await must(program_of(params.program));
  tmcl::LoadOptions options;
  options.first_address = params.first_address.value_or(0);
  if (verb == tmcl::verbs::load_program) {
    co_await must_not(loss_by_program(*module.bus, module.address, program, options.first_address));
  }
  options.compare = params.compare.value_or(true);
  options.progress = progress_for(call, module);
  co_await must(act_on(call, module, verb(module.address, program, std::move(options))));
  co_return program::Commands{static_cast<std::uint32_t>(program.size())};
}

/// No client owns what a program moves.
Task<program::Started> start(Call& call, Result<ModuleChoice> module,
                             tmcl::Script<tmcl::Result<void>> script) {
  co_await must(act_on(call, std::move(module), std::move(script)));
  call.unattended = true;
  co_return program::Started{true};
}

std::string_view name_of(tmcl::SteppedProgram::Reason reason) {
  using enum tmcl::SteppedProgram::Reason;
  switch (reason) {
    case at_address: return "address";
    case ended:
    case cancelled: return "ended";
    case steps: return "steps";
    case waits: return "waits";
  }
  return {};
}

/// Told with each command, and each time that one waits; ends the verb when its client has gone.
std::function<bool(std::uint32_t)> progress_of_steps(const Call& call, const ModuleChoice& module,
                                                     std::uint32_t most_steps) {
  return [gateway = call.gateway, peer = call.peer, tell = call.progress_reporter(),
          bus = module.bus->name(), address = number(module.address),
          most_steps](std::uint32_t steps) {
    tell(LoadProgress{bus, address, "stepping", steps, most_steps});
    return !peer->is_gone() && !gateway->is_closing();
  };
}

/// All that the module has, whether an axis is configured for them or not.
std::vector<tmcl::AxisAddress> motors_of(const ModuleChoice& module) {
  const auto* known = module.bus->find_module(module.address);
  const auto* model = known == nullptr ? nullptr : known->model();
  const int count = model == nullptr ? 1 : model->axes;
  std::vector<tmcl::AxisAddress> motors;
  for (int motor = 0; motor < count; ++motor)
    motors.push_back({module.address, static_cast<std::uint8_t>(motor)});
  return motors;
}

/// A client that has gone sees nothing any more of what it has let move.
Task<Nothing> end_for_gone_client(const Call& call, const ModuleChoice& module) {
  const StopInProgress in_progress(call.gateway);
  const auto client = call.permit.client;
  const auto motors = motors_of(module);
  StoppedModule stepped{module.bus, module.address, motors, true};
  co_await end_program(std::move(stepped), client);
  for (const auto motor : motors) {
    if (const auto axis = call.gateway->find_axis(*module.bus, motor)) {
      co_await axis->stop();
    } else {
      co_await module.bus->run(tmcl::verbs::stop(motor), asked_by(client));
    }
  }
  co_return Nothing{};
}

}  // namespace

Answer<program::Assemble> assemble_program(Call& call, const program::Assemble& params) {
  const auto* model = co_await must(model_of(params));
  auto work = [text = params.text, model] { return assembly_of(text, model); };
  const auto assembly = co_await call.gateway->planner.plan(std::move(work));
  if (!assembly) co_return refusal_of_text(assembly.error());
  co_return view_of(*assembly);
}

Answer<program::Load> load_program(Call& call, const program::Load& params) {
  // The end of the daemon waits a little: a module must not be left in download mode.
  const StopInProgress in_progress(call.gateway);
  auto loaded = co_await load_or_compare(call, params, tmcl::verbs::load_program);
  co_return loaded;
}

Answer<program::Compare> compare_program(Call& call, const program::Compare& params) {
  return load_or_compare(call, {{params}, params.program, params.first_address},
                         tmcl::verbs::compare_program);
}

Answer<program::Read> read_program(Call& call, const program::Read& params) {
  const auto module = co_await must(module_of(call, params));
  tmcl::ReadOptions options;
  options.first_address = params.first_address.value_or(0);
  if (params.length) options.length = *params.length;
  options.progress = progress_for(call, module);
  auto script = tmcl::verbs::read_program(module.address, std::move(options));
  const auto program = co_await must(run_on(module, call, std::move(script)));
  co_return program::ReadProgram{static_cast<std::uint32_t>(program.size()),
                                 tmcl::program::to_hex(program)};
}

Answer<program::Run> run_program(Call& call, const program::Run& params) {
  return start(call, module_of(call, params),
               tmcl::verbs::run_program(address_of(params), params.first_address));
}
Answer<program::Stop> stop_program(Call& call, const program::Stop& params) {
  return act_on(call, params, tmcl::verbs::stop_program(address_of(params)));
}
Answer<program::Step> step_program(Call& call, const program::Step& params) {
  return start(call, module_of(call, params), tmcl::verbs::step_program(address_of(params)));
}
Answer<program::StepTo> step_program_to(Call& call, const program::StepTo& params) {
  const auto module = co_await must(module_of(call, params, {}));
  tmcl::StepOptions options;
  options.until = params.until.value_or(std::vector<std::uint16_t>{});
  options.most_steps = params.most_steps.value_or(params.until ? usual_most_steps : 1);
  options.longest_wait = std::chrono::milliseconds(params.wait_ms.value_or(program::usual_wait_ms));
  options.progress = progress_of_steps(call, module, options.most_steps);
  RunOptions how;
  how.permit = call.permit;
  auto script = tmcl::verbs::step_program_to(module.address, std::move(options));
  auto stepped = co_await module.bus->run(std::move(script), std::move(how));
  if (call.peer->is_gone()) co_await end_for_gone_client(call, module);
  if (!stepped && stepped.error().bus.empty()) stepped.error().bus = module.bus->name();
  const auto& done = co_await must(std::move(stepped));
  call.unattended = true;
  co_return program::Stepped{std::string(name_of(done.reason)),
                             done.steps,
                             std::string(name_of(done.status.state)),
                             done.status.next_address,
                             done.status.last_error,
                             true};
}

Answer<program::Reset> reset_program(Call& call, const program::Reset& params) {
  return act_on(call, params, tmcl::verbs::reset_program(address_of(params)));
}

Answer<program::Status> program_status(Call& call, const program::Status& params) {
  const auto module = co_await must(module_of(call, params));
  auto status = co_await must(run_on(module, call, tmcl::verbs::program_status(module.address)));
  co_return program::ProgramState{std::string(name_of(status.state)), status.next_address,
                                  status.last_error};
}

Answer<program::SetBreakpoint> set_breakpoint(Call& call, const program::SetBreakpoint& params) {
  return act_on(call, params, tmcl::verbs::add_breakpoint(address_of(params), params.at));
}
Answer<program::ClearBreakpoint> clear_breakpoint(Call& call,
                                                  const program::ClearBreakpoint& params) {
  return act_on(call, params, tmcl::verbs::delete_breakpoint(address_of(params), params.at));
}
Answer<program::ClearBreakpoints> clear_breakpoints(Call& call,
                                                    const program::ClearBreakpoints& params) {
  return act_on(call, params, tmcl::verbs::delete_all_breakpoints(address_of(params)));
}

}  // namespace tmcld::handlers
