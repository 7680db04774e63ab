// program upload, verify, download: programs between files and modules.
#include <fmt/format.h>

#include "arrival_wait.hpp"
#include "output_file.hpp"
#include "print.hpp"
#include "program_file.hpp"
#include "progress_line.hpp"
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
        verb.no_compare ? ", not compared" : ", compared", verb.run ? ", running" : "");
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

}  // namespace

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

}  // namespace tmclctl
