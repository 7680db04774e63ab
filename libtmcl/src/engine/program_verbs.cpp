#include "tmcl/program_verbs.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "engine/verb_steps.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/verbs.hpp"

namespace tmcl::verbs {
namespace {

using program::Instruction;
using program::Program;

constexpr std::uint8_t first_control_function = 128;
constexpr std::int32_t no_reading = 1;  // bits of parameter 81
constexpr std::int32_t no_writing = 2;
enum class Breakpoint : std::uint8_t { add = 0, remove = 1, remove_all = 2, limit = 3 };

Request to_request(ModuleAddress module, const Instruction& line) {
  return {module, line.command, line.type, line.motor, line.value};
}

Error refused_unsent(Status status, std::string message, std::string hint) {
  return {Errc::refused_by_module,
          Outcome::refused,
          std::move(message),
          std::move(hint),
          {},
          {},
          status};
}

std::optional<Error> objection(const Program& program, std::size_t first_address) {
  if (program.empty()) return bad_argument("the program is empty");
  if (first_address + program.size() > program::most_commands) {
    return bad_argument(
        fmt::format("{} commands from address {} on do not fit", program.size(), first_address),
        fmt::format("a module has room for {}", program::most_commands));
  }
  const auto control = std::ranges::find_if(program, [](const Instruction& line) {
    return static_cast<std::uint8_t>(line.command) >= first_control_function;
  });
  if (control == program.end()) return std::nullopt;
  return bad_argument(
      fmt::format("{} at address {} is no command for a program", name_of(control->command),
                  first_address + static_cast<std::size_t>(control - program.begin())),
      "programs have commands below 128");
}

/// One program on its way into, or out of, a module.
struct Loading {
  ModuleAddress module;
  std::shared_ptr<const Hold> hold;
  LoadOptions options;
  LoadProgress progress{};

  CallOptions call() const { return {.hold = hold}; }
  CallOptions line() const { return {.hold = hold, .is_program_line = true}; }
  bool goes_on(LoadProgress::Phase phase, std::size_t steps) {
    progress.phase = phase;
    progress.done += steps;
    return !options.progress || options.progress(progress);
  }
};

Error cancelled() {
  return {Errc::download_broken, Outcome::refused, "it was cancelled", {}, {}, {}, {}};
}

/// It is unknown then what was recorded, and a second try may go well.
bool is_worth_another_try(const Error& error) {
  return is_silence(error) || error.status == Status::wrong_checksum ||
         error.status == Status::command_loaded || error.code == Errc::unexpected_value ||
         (error.code == Errc::download_broken && error.outcome == Outcome::not_sent);
}

/// The module has left download mode by itself, so it was reset; what it executed may move.
Script<Result<void>> stop_what_was_started(const Loading& loading, Instruction line) {
  if (effect_of(line.command, line.type) == Effect::moves)
    co_await exchange({loading.module, Command::MST, 0, line.motor, 0});
  Error error{
      Errc::download_broken, Outcome::done, {}, {}, {}, to_request(loading.module, line), {}};
  error.message = "the module executed a line of the program instead of recording it";
  error.hint =
      "it was probably reset: check its power; if the line moves a motor, that was stopped";
  co_return tl::unexpected(std::move(error));
}

Script<Result<void>> record_lines(Loading& loading, std::span<const Instruction> lines) {
  for (const auto& line : lines) {
    const auto answer = co_await must(exchange(to_request(loading.module, line), loading.line()));
    if (answer.reply.status != Status::command_loaded) {
      co_return co_await stop_what_was_started(loading, line);
    }
    if (!loading.goes_on(LoadProgress::Phase::writing, 1)) co_return tl::unexpected(cancelled());
  }
  co_return Result<void>{};
}

/// One download. Whatever happens, the module is told that it ends.
Script<Result<void>> download_once(Loading& loading, std::uint16_t address,
                                   std::span<const Instruction> lines) {
  const auto begun =
      co_await exchange({loading.module, Command::START_DOWNLOAD, 0, 0, address}, loading.call());
  if (!begun && begun.error().outcome != Outcome::unknown) co_return tl::unexpected(begun.error());
  Result<void> recorded;
  if (!begun) {
    recorded = tl::unexpected(begun.error());
  } else if (begun->reply.status == Status::command_loaded) {
    // A download that was left unfinished: this was only recorded.
    recorded = tl::unexpected(
        refusal({loading.module, Command::START_DOWNLOAD, 0, 0, address}, begun->reply.status));
  } else {
    recorded = co_await record_lines(loading, lines);
  }
  const auto ended =
      co_await exchange({loading.module, Command::END_DOWNLOAD, 0, 0, 0}, loading.call());
  if (recorded && !ended) recorded = tl::unexpected(ended.error());
  co_return recorded;
}

Error differs(ModuleAddress module, std::size_t address, const Instruction& held,
              const Instruction& wanted) {
  Error error{Errc::unexpected_value, Outcome::done, {}, {}, {}, {}, {}};
  const auto text = [](const Instruction& line) {
    return fmt::format("{} {}, {}, {}", name_of(line.command), line.type, line.motor, line.value);
  };
  error.message = fmt::format("module {} holds {} at address {}, and not {}", number(module),
                              text(held), address, text(wanted));
  error.hint = "load the program again";
  return error;
}

Script<Result<Instruction>> read_line(ModuleAddress module, std::size_t address,
                                      CallOptions options) {
  const auto answer = co_await must(exchange(
      {module, Command::READ_TMCL_MEMORY, 0, 0, static_cast<std::int32_t>(address)}, options));
  co_return program::line_of(answer.reply);
}

Script<Result<void>> compare_lines(Loading& loading, std::size_t address,
                                   std::span<const Instruction> lines) {
  for (const auto& line : lines) {
    const auto held = co_await must(read_line(loading.module, address, loading.call()));
    if (held != line) co_return tl::unexpected(differs(loading.module, address, held, line));
    if (!loading.goes_on(LoadProgress::Phase::comparing, 1)) co_return tl::unexpected(cancelled());
    ++address;
  }
  co_return Result<void>{};
}

Script<Result<void>> load_section(Loading& loading, std::uint16_t address,
                                  std::span<const Instruction> lines) {
  if (lines.empty()) co_return Result<void>{};
  for (unsigned attempt = 1;; ++attempt) {
    const auto before = loading.progress;
    auto loaded = co_await download_once(loading, address, lines);
    if (loaded && loading.options.compare) loaded = co_await compare_lines(loading, address, lines);
    if (loaded || attempt >= loading.options.attempts || !is_worth_another_try(loaded.error()))
      co_return loaded;
    loading.progress = before;
  }
}

/// 0 for modules that do not know the parameter.
Script<Result<std::int32_t>> protection_of(ModuleAddress module, CallOptions options) {
  const Request request{module, Command::GGP, global_parameter::code_protection, 0, 0};
  const auto value = co_await must(unless_refused(command(request, options)));
  co_return value && value->reply.status == Status::ok ? value->reply.value : 0;
}

Script<Result<void>> be_readable(ModuleAddress module, CallOptions options) {
  const auto protection = co_await must(protection_of(module, options));
  if ((protection & no_reading) == 0) co_return Result<void>{};
  co_return tl::unexpected(refused_unsent(
      Status::write_protected,
      fmt::format("the program of module {} is protected from reading", number(module)),
      "global parameter 81 says so; setting it to 0 erases the program"));
}

/// Firmware puts the state into the highest byte of what it answers to command 135 (and an address
/// below), or into the lowest. So parameter 128 decides; without that, whichever of the two says
/// that a program runs.
Script<Result<bool>> is_running(ModuleAddress module, CallOptions options) {
  constexpr std::int32_t running = 1;
  constexpr int highest_byte = 24;
  const Request parameter{module, Command::GGP, global_parameter::application_status, 0, 0};
  const auto state = co_await must(unless_refused(command(parameter, options)));
  if (state && state->reply.status == Status::ok) co_return state->reply.value == running;
  const Request request{module, Command::GET_APPLICATION_STATUS, 0, 0, 0};
  const auto packed = co_await must(unless_refused(command(request, options)));
  if (!packed || packed->reply.status != Status::ok) co_return false;
  co_return packed->reply.value == running || packed->reply.value >> highest_byte == running;
}

Script<Result<void>> be_writable(ModuleAddress module, CallOptions options) {
  const auto protection = co_await must(protection_of(module, options));
  if ((protection & no_writing) != 0) {
    co_return tl::unexpected(refused_unsent(
        Status::write_protected,
        fmt::format("the program of module {} is protected from writing", number(module)),
        "global parameter 81 says so; setting it to 0 erases the program"));
  }
  const bool runs = co_await must(is_running(module, options));
  if (!runs) co_return Result<void>{};
  co_return tl::unexpected(
      refused_unsent(Status::download_not_possible,
                     fmt::format("a program is running on module {}", number(module)),
                     "stop it first; motors that it has started go on"));
}

/// The first command last: until then nothing would run.
Script<Result<void>> load_in_order(Loading& loading, const Program& program) {
  const Program nothing(1);
  const std::span lines(program);
  const auto first = loading.options.first_address;
  const auto second = static_cast<std::uint16_t>(first + 1);
  co_await must(load_section(loading, first, nothing));
  co_await must(load_section(loading, second, lines.subspan(1)));
  co_return co_await load_section(loading, first, lines.first(1));
}

Script<Result<std::optional<std::int32_t>>> global_if_there(ModuleAddress module,
                                                            std::uint8_t parameter) {
  return unless_refused(get_global(module, 0, parameter));
}

Request breakpoint(ModuleAddress module, Breakpoint what, std::int32_t address = 0) {
  return {module, Command::BREAKPOINT, static_cast<std::uint8_t>(what), 0, address};
}

}  // namespace

Script<Result<void>> load_program(ModuleAddress module, Program program, LoadOptions options) {
  if (auto error = objection(program, options.first_address))
    co_return tl::unexpected(std::move(*error));
  Loading loading{module, std::make_shared<const Hold>(), options};
  // The first place is written twice.
  loading.progress.of = (program.size() + 1) * (options.compare ? 2U : 1U);
  co_await must(be_writable(module, loading.call()));
  if (options.compare) co_await must(be_readable(module, loading.call()));
  co_return co_await load_in_order(loading, program);
}

Script<Result<Program>> read_program(ModuleAddress module, ReadOptions options) {
  co_await must(be_readable(module, {}));
  const auto room =
      program::most_commands - std::min<std::size_t>(options.first_address, program::most_commands);
  const auto most = std::min<std::size_t>(options.length.value_or(program::most_commands), room);
  Program program;
  std::size_t empty = 0;
  while (program.size() < most && (options.length || empty < empty_lines_after_a_program)) {
    const auto line = co_await read_line(module, options.first_address + program.size(), {});
    // Some modules have room for fewer commands.
    const bool is_end = !line && line.error().outcome == Outcome::refused && !program.empty();
    if (is_end) break;
    if (!line) co_return tl::unexpected(line.error());
    empty = line->command == Command{} ? empty + 1 : 0;
    program.push_back(*line);
    const LoadProgress progress{LoadProgress::Phase::comparing, program.size(), most};
    if (options.progress && !options.progress(progress)) co_return tl::unexpected(cancelled());
  }
  if (!options.length) program.resize(program.size() - empty);
  co_return program;
}

Script<Result<void>> compare_program(ModuleAddress module, Program program, LoadOptions options) {
  co_await must(be_readable(module, {}));
  Loading loading{module, nullptr, options};
  loading.progress.of = program.size();
  co_return co_await compare_lines(loading, options.first_address, program);
}

Script<Result<void>> run_program(ModuleAddress module, std::optional<std::uint16_t> address) {
  const std::uint8_t from_address = address ? 1 : 0;
  return act({module, Command::RUN_APPLICATION, from_address, 0, address.value_or(0)});
}
Script<Result<void>> stop_program(ModuleAddress module) {
  return act({module, Command::STOP_APPLICATION, 0, 0, 0});
}
Script<Result<void>> step_program(ModuleAddress module) {
  return act({module, Command::STEP_APPLICATION, 0, 0, 0});
}
Script<Result<void>> reset_program(ModuleAddress module) {
  return act({module, Command::RESET_APPLICATION, 0, 0, 0});
}

Script<Result<ProgramStatus>> program_status(ModuleAddress module) {
  const auto state =
      co_await must(ask({module, Command::GGP, global_parameter::application_status, 0, 0}));
  const auto counter = co_await must(global_if_there(module, global_parameter::program_counter));
  const auto error = co_await must(global_if_there(module, global_parameter::tmcl_error));
  co_return ProgramStatus{static_cast<ProgramStatus::State>(state & 3), counter, error};
}

Script<Result<void>> add_breakpoint(ModuleAddress module, std::uint16_t address) {
  return act(breakpoint(module, Breakpoint::add, address));
}
Script<Result<void>> delete_breakpoint(ModuleAddress module, std::uint16_t address) {
  return act(breakpoint(module, Breakpoint::remove, address));
}
Script<Result<void>> delete_all_breakpoints(ModuleAddress module) {
  return act(breakpoint(module, Breakpoint::remove_all));
}
Script<Result<std::int32_t>> most_breakpoints(ModuleAddress module) {
  return ask(breakpoint(module, Breakpoint::limit));
}

}  // namespace tmcl::verbs
