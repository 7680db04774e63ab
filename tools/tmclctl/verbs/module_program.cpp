// program upload, verify, download: programs between files and modules.
#include <fmt/format.h>

#include "ask.hpp"
#include "axis/arrival_wait.hpp"
#include "output/output_file.hpp"
#include "output/print.hpp"
#include "output/progress_line.hpp"
#include "program_file.hpp"
#include "tmcl/api/program.hpp"
#include "tmcl/api/system.hpp"
#include "tmcl/disassembler.hpp"

namespace tmclctl {
namespace {

namespace api = tmcl::api;
using tmcl::program::Program;

std::optional<std::uint16_t> in_program(const std::optional<std::int32_t>& typed) {
  return typed ? std::optional(static_cast<std::uint16_t>(*typed)) : std::nullopt;
}

/// With a line that says how far it is, and an end when the user has had enough.
template <class Method>
Result<typename Method::Result> perform(const Method& method, Context& context) {
  ProgressLine line(context.output);
  const tmcl::client::Hearing<api::LoadProgress> hearing(
      context.gateway.caller, api::progress_notification, [&](const api::LoadProgress& news) {
        const auto part = static_cast<double>(news.done) / static_cast<double>(news.of);
        line.show(fmt::format("{} {} {} of {}", news.phase,
                              bar(part, usual_bar_width, line.screen().utf8), news.done, news.of));
      });
  auto result = context.call(method);
  line.clear();
  if (result || context.host.signal() == 0) return result;
  constexpr bool writes = Method::method.effect != tmcl::Effect::reads;
  return tl::unexpected(interrupted_error(
      context.host.signal(), "interrupted",
      writes ? "The module may hold no program now that starts at its first command: upload again"
             : ""));
}

Result<ExitCode> compare(const verb::Upload& verb, const api::program::Compare& program,
                         Context& context) {
  const auto same = perform(program, context);
  if (!same) return tl::unexpected(same.error());
  if (context.output.json) {
    print_json(api::to_json(*same), context.output);
  } else {
    context.output.out << fmt::format("module {} holds the program of {}\n", verb.module,
                                      verb.file);
  }
  return ExitCode::done;
}

Result<ExitCode> load(const verb::Upload& verb, const api::program::Load& program,
                      Context& context) {
  const auto loaded = perform(program, context);
  if (!loaded) return tl::unexpected(loaded.error());
  if (verb.run) {
    const auto running = context.call(
        api::program::Run{{{program.bus, program.address}}, program.first_address.value_or(0)});
    if (!running) return tl::unexpected(running.error());
  }
  if (context.output.json) {
    print_json(api::to_json(*loaded), context.output);
  } else {
    context.output.out << fmt::format(
        "{} commands in module {}{}{}\n", loaded->commands, verb.module,
        verb.no_compare ? ", not compared" : ", compared", verb.run ? ", started" : "");
  }
  return ExitCode::done;
}

/// A program file for *.bin, text for everything else.
Result<void> write_program(const std::string& path, const Program& program) {
  auto contents = tmcl::program::disassemble(program);
  if (path.ends_with(".bin")) {
    const auto bytes = tmcl::program::to_bytes(program);
    contents.assign(bytes.begin(), bytes.end());
  }
  OutputFile file;
  return file.open(path).and_then([&] { return file.write(contents); });
}

Result<ExitCode> run(const verb::Upload& verb, Context& context) {
  const auto program = program_from(verb.file, context.output);
  if (!program) return tl::unexpected(program.error());
  const auto module = on_module(verb.module, context);
  if (!module) return tl::unexpected(module.error());
  const auto first = in_program(verb.first_address);
  auto text = tmcl::program::to_hex(*program);
  if (verb.only_compare) return compare(verb, {*module, std::move(text), first}, context);
  const auto compared = verb.no_compare ? std::optional(false) : std::nullopt;
  return load(verb, {*module, std::move(text), first, compared}, context);
}

Result<ExitCode> run(const verb::Download& verb, Context& context) {
  const auto module = on_module(verb.module, context);
  if (!module) return tl::unexpected(module.error());
  const auto read =
      perform(api::program::Read{*module, in_program(verb.first_address), in_program(verb.length)},
              context);
  if (!read) return tl::unexpected(read.error());
  const auto program = tmcl::program::from_hex(read->program);
  if (!program) return tl::unexpected(usage_error("bad_program", program.error()));
  if (!verb.output.empty()) {
    const auto written = write_program(verb.output, *program);
    if (!written) return tl::unexpected(written.error());
  }
  if (context.output.json) {
    print_json(api::to_json(*read), context.output);
  } else if (verb.output.empty()) {
    context.output.out << tmcl::program::disassemble(*program);
  }
  return ExitCode::done;
}

constexpr std::int32_t greatest_place = 2047;
constexpr std::int32_t most_lines = 2048;

void add_program_verb(Grammar& grammar, const Form& program, const std::string& name,
                      const Access& access, const char* method, const std::string& description,
                      const char* footer) {
  auto form = ask(grammar, program, name, access, method, description, footer);
  form.module(form->module);
}

constexpr const char* verify_help = R"(
Exit code 1 if the module holds another program, and where they differ first.

  tmclctl program verify loop.tmc 1
)";

constexpr const char* upload_help = R"(
FILE is assembled (see 'tmclctl program assemble --help') or, if its name ends in .bin, taken as it
is. While it is loaded, everybody else's commands to that module wait. A stop does not: it ends the
upload. The first command is loaded last, so no half of a program can ever run. Needs a module
whose program does not run, and is not protected (global parameter 81).

  tmclctl program upload loop.tmc 1 --run
  tmclctl --direct serial:/dev/ttyACM0 program upload loop.bin 1
)";

constexpr const char* download_help = R"(
Prints the program as text that 'tmclctl program assemble' makes the same program of. Ends after 16
empty commands, unless --length says how many there are.

  tmclctl program download 1 -o saved.tmc
)";

constexpr const char* program_run_help = R"(
Comes back when the module has begun; the program goes on by itself. Without --start it goes on where
it stands; after 'tmclctl program reset' that is its first command.

  tmclctl program run 1
  tmclctl program run bench:1 --start 0
)";

constexpr const char* program_stop_help = R"(
The program ends; motors that turn go on turning: stop those with 'tmclctl stop AXIS'.

  tmclctl program stop 1; tmclctl stop --all
)";

constexpr const char* program_step_help = R"(
Executes the next command of the program, which then waits for another step. A command that moves a
motor moves it.

  tmclctl program step 1; tmclctl program status 1
)";

constexpr const char* program_reset_help = R"(
Ends the program; the next run begins at its first command. Motors that turn go on turning.

  tmclctl program reset 1
)";

constexpr const char* program_status_help = R"(
state is stopped, running, stepping (it also is while it stands at a breakpoint) or reset. What the
module does not tell is "-".

  tmclctl program status 1
  tmclctl --json program status 1
)";

constexpr const char* breakpoint_help = R"(
The program stands before the command at this address, and goes on by 'tmclctl program run'. Addresses
are those of the listing of 'tmclctl program assemble'.

  tmclctl program breakpoint 1 7
  tmclctl program clear-breakpoint 1 7
  tmclctl program clear-breakpoints 1
)";

}  // namespace

void add_module_programs(Grammar& grammar, const Form& program) {
  for (const bool compares : {false, true}) {
    auto upload = grammar.verb<verb::Upload>(
        program, compares ? "verify" : "upload", compares ? access::reads : access::acts,
        compares ? "Compare a file with the program in a module" : "Load a program into a module",
        compares ? verify_help : upload_help, run);
    upload->only_compare = compares;
    upload.word("FILE", "A program's text, or a program file (*.bin)", text(upload->file));
    upload.module(upload->module);
    upload.option("--start", "ADDRESS", "Where its first command is (default 0)",
                  number(upload->first_address, 0, greatest_place));
    if (compares) continue;
    upload.flag("--no-verify", "Do not read it back and compare", upload->no_compare);
    upload.flag("--run", "Run it then", upload->run);
  }
  auto download = grammar.verb<verb::Download>(program, "download", access::reads,
                                               "Read a module's program", download_help, run);
  download.module(download->module);
  download.option("-o,--output", "FILE", "Write it there: text, or a program file (*.bin)",
                  text(download->output));
  download.option("--start", "ADDRESS", "From here on (default 0)",
                  number(download->first_address, 0, greatest_place));
  download.option("--length", "N", "So many commands; otherwise up to its end",
                  number(download->length, 1, most_lines));
  auto started = ask(grammar, program, "run", access::acts, "program.run",
                     "Run the program in a module", program_run_help);
  started.module(started->module);
  started.option("--start", "ADDRESS", "From there; otherwise from where it stands",
                 number(started->first_address, 0, greatest_place));
  add_program_verb(grammar, program, "stop", access::acts, "program.stop", "End it; motors go on",
                   program_stop_help);
  add_program_verb(grammar, program, "step", access::acts, "program.step",
                   "Execute one command of it", program_step_help);
  add_program_verb(grammar, program, "reset", access::acts, "program.reset",
                   "End it, and back to its start", program_reset_help);
  add_program_verb(grammar, program, "status", access::reads, "program.status", "Show what it does",
                   program_status_help);
  auto set = ask(grammar, program, "breakpoint", access::acts, "program.set_breakpoint",
                 "Stop it somewhere", breakpoint_help);
  set.module(set->module);
  set.word("ADDRESS", "Where", number(set->at, 0, greatest_place));
  auto clear = ask(grammar, program, "clear-breakpoint", access::acts, "program.clear_breakpoint",
                   "Do not stop it there any more", breakpoint_help);
  clear.module(clear->module);
  clear.word("ADDRESS", "Where", number(clear->at, 0, greatest_place));
  add_program_verb(grammar, program, "clear-breakpoints", access::acts, "program.clear_breakpoints",
                   "Do not stop it anywhere any more", breakpoint_help);
}

}  // namespace tmclctl
