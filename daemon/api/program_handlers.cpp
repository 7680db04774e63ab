// Stand-alone programs.
#include "api/handlers.hpp"
#include "api/module_choice.hpp"
#include "gateway/authority/reach.hpp"

namespace tmcld::handlers {
namespace {

using tmcl::program::Program;

Result<Program> program_of(const std::string& text) {
  return tmcl::program::from_hex(text).map_error([](const std::string& problem) {
    return param_error<&program::Load::program>("bad_argument", "'program': " + problem);
  });
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

}  // namespace

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
