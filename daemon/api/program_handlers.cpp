// Stand-alone programs.
#include "api/handlers.hpp"
#include "api/module_choice.hpp"

namespace tmcld::handlers {
namespace {

namespace json = boost::json;
using tmcl::program::Program;

Lookup<Program> program_of(const Call& call) {
  return tmcl::program::from_hex(call.params.text("program"))
      .map_error([](const std::string& problem) {
        return param_error("bad_argument", "program", "'program': " + problem);
      });
}

std::uint16_t first_address_of(const Call& call) {
  return static_cast<std::uint16_t>(call.params.integer_or("first_address", 0));
}

/// Tells the client how far it is; ends the verb when nobody wants it any more.
tmcl::OnLoadProgress progress_for(const Call& call, const ModuleChoice& module) {
  return [gateway = call.gateway, peer = call.peer, id = call.id, bus = module.bus->name(),
          address = number(module.address)](const tmcl::LoadProgress& progress) {
    json::object params;
    params["id"] = id;
    params["bus"] = bus;
    params["address"] = address;
    params["phase"] =
        progress.phase == tmcl::LoadProgress::Phase::writing ? "writing" : "comparing";
    params["done"] = progress.done;
    params["of"] = progress.of;
    peer->notify("notify_progress", std::move(params));
    return !peer->is_gone() && !gateway->is_closing();
  };
}

tmcl::LoadOptions load_options(const Call& call, const ModuleChoice& module) {
  tmcl::LoadOptions options;
  options.first_address = first_address_of(call);
  options.compare = call.params.boolean_or("compare", true);
  options.progress = progress_for(call, module);
  return options;
}

json::object with_commands(const Program& program) {
  json::object result;
  result["commands"] = program.size();
  return result;
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

/// A verb that gives nothing back.
Answer act(Call& call, tmcl::Script<tmcl::Result<void>> (*verb)(tmcl::ModuleAddress)) {
  const auto module = module_of(call);
  if (!module) co_return tl::unexpected(module.error());
  auto done = co_await run_on(*module, call, verb(module->address));
  if (!done) co_return tl::unexpected(std::move(done.error()));
  co_return json::object{};
}

}  // namespace

Answer load_program(Call& call) {
  const auto module = module_of(call);
  if (!module) co_return tl::unexpected(module.error());
  const auto program = program_of(call);
  if (!program) co_return tl::unexpected(program.error());
  // The end of the daemon waits a little: a module must not be left in download mode.
  ++call.gateway->stops_in_progress;
  auto script = tmcl::verbs::load_program(module->address, *program, load_options(call, *module));
  auto loaded = co_await run_on(*module, call, std::move(script));
  --call.gateway->stops_in_progress;
  if (!loaded) co_return tl::unexpected(std::move(loaded.error()));
  co_return with_commands(*program);
}

Answer compare_program(Call& call) {
  const auto module = module_of(call);
  if (!module) co_return tl::unexpected(module.error());
  const auto program = program_of(call);
  if (!program) co_return tl::unexpected(program.error());
  auto script =
      tmcl::verbs::compare_program(module->address, *program, load_options(call, *module));
  auto same = co_await run_on(*module, call, std::move(script));
  if (!same) co_return tl::unexpected(std::move(same.error()));
  co_return with_commands(*program);
}

Answer read_program(Call& call) {
  const auto module = module_of(call);
  if (!module) co_return tl::unexpected(module.error());
  tmcl::ReadOptions options;
  options.first_address = first_address_of(call);
  if (call.params.has("length"))
    options.length = static_cast<std::uint16_t>(call.params.integer("length"));
  options.progress = progress_for(call, *module);
  auto script = tmcl::verbs::read_program(module->address, std::move(options));
  const auto program = co_await run_on(*module, call, std::move(script));
  if (!program) co_return tl::unexpected(program.error());
  auto result = with_commands(*program);
  result["program"] = tmcl::program::to_hex(*program);
  co_return result;
}

Answer run_program(Call& call) {
  const auto module = module_of(call);
  if (!module) co_return tl::unexpected(module.error());
  std::optional<std::uint16_t> address;
  if (call.params.has("first_address")) address = first_address_of(call);
  auto done = co_await run_on(*module, call, tmcl::verbs::run_program(module->address, address));
  if (!done) co_return tl::unexpected(std::move(done.error()));
  co_return json::object{};
}

Answer stop_program(Call& call) { return act(call, tmcl::verbs::stop_program); }
Answer step_program(Call& call) { return act(call, tmcl::verbs::step_program); }
Answer reset_program(Call& call) { return act(call, tmcl::verbs::reset_program); }
Answer clear_breakpoints(Call& call) { return act(call, tmcl::verbs::delete_all_breakpoints); }

Answer program_status(Call& call) {
  const auto module = module_of(call);
  if (!module) co_return tl::unexpected(module.error());
  auto status = co_await run_on(*module, call, tmcl::verbs::program_status(module->address));
  if (!status) co_return tl::unexpected(std::move(status.error()));
  json::object result;
  result["state"] = name_of(status->state);
  result["next_address"] = nullptr;
  if (status->next_address) result["next_address"] = *status->next_address;
  result["last_error"] = nullptr;
  if (status->last_error) result["last_error"] = *status->last_error;
  co_return result;
}

Answer set_breakpoint(Call& call) {
  const auto module = module_of(call);
  if (!module) co_return tl::unexpected(module.error());
  const auto at = static_cast<std::uint16_t>(call.params.integer("at"));
  auto done = co_await run_on(*module, call, tmcl::verbs::add_breakpoint(module->address, at));
  if (!done) co_return tl::unexpected(std::move(done.error()));
  co_return json::object{};
}

Answer clear_breakpoint(Call& call) {
  const auto module = module_of(call);
  if (!module) co_return tl::unexpected(module.error());
  const auto at = static_cast<std::uint16_t>(call.params.integer("at"));
  auto done = co_await run_on(*module, call, tmcl::verbs::delete_breakpoint(module->address, at));
  if (!done) co_return tl::unexpected(std::move(done.error()));
  co_return json::object{};
}

}  // namespace tmcld::handlers
