// program upload, verify, download: programs between files and modules.
#include <fmt/format.h>

#include "following.hpp"
#include "json_read.hpp"
#include "names.hpp"
#include "output_file.hpp"
#include "print.hpp"
#include "program_file.hpp"
#include "progress_line.hpp"
#include "tmcl/disassembler.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;
using tmcl::program::Program;

Result<json::object> params_for(const std::string& module,
                                const std::optional<std::int32_t>& first_address) {
  return parse_module(module).map([&](const ModuleName& name) {
    json::object params{{"address", name.address}};
    if (!name.bus.empty()) params["bus"] = name.bus;
    if (first_address) params["first_address"] = *first_address;
    return params;
  });
}

/// With a line that says how far it is, and an end when the user has had enough.
Result<json::object> perform(const std::string& method, json::object params, Context& context) {
  ProgressLine line(context.output);
  auto result = context.target.perform(method, std::move(params), [&](const json::object& news) {
    const auto done = number_at(news, "done").value_or(0);
    const auto of = number_at(news, "of").value_or(1);
    line.show(fmt::format("{} {} {:.0f} of {:.0f}", text_at(news, "phase"),
                          bar(done / of, usual_bar_width, line.screen().utf8), done, of));
    return context.host.signal() == 0;
  });
  line.clear();
  if (result || context.host.signal() == 0) return result;
  const bool writes = method == "program.load";
  return tl::unexpected(interrupted_error(
      context.host.signal(), "interrupted",
      writes ? "The module may hold no program now that starts at its first command: upload again"
             : ""));
}

VerbResult compare(const verb::Upload& verb, json::object params, Context& context) {
  const auto result = perform("program.compare", std::move(params), context);
  if (!result) return tl::unexpected(result.error());
  if (context.output.json) {
    print_json(*result, context.output);
  } else {
    context.output.out << fmt::format("module {} holds the program of {}\n", verb.module,
                                      verb.file);
  }
  return ExitCode::done;
}

VerbResult load(const verb::Upload& verb, json::object params, Context& context) {
  auto run_params = params;
  run_params.erase("program");
  if (verb.no_compare) params["compare"] = false;
  const auto result = perform("program.load", std::move(params), context);
  if (!result) return tl::unexpected(result.error());
  if (verb.run) {
    run_params["first_address"] = verb.first_address.value_or(0);
    const auto running = context.target.perform("program.run", std::move(run_params), {});
    if (!running) return tl::unexpected(running.error());
  }
  if (context.output.json) {
    print_json(*result, context.output);
  } else {
    context.output.out << fmt::format("{} commands in module {}{}{}\n",
                                      integer_at<std::int64_t>(*result, "commands"), verb.module,
                                      verb.no_compare ? ", not compared" : ", compared",
                                      verb.run ? ", running" : "");
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

VerbResult run(const verb::Upload& verb, Context& context) {
  const auto program = program_from(verb.file, context.output);
  if (!program) return tl::unexpected(program.error());
  auto params = params_for(verb.module, verb.first_address);
  if (!params) return tl::unexpected(params.error());
  (*params)["program"] = tmcl::program::to_hex(*program);
  return verb.only_compare ? compare(verb, std::move(*params), context)
                           : load(verb, std::move(*params), context);
}

VerbResult run(const verb::Download& verb, Context& context) {
  auto params = params_for(verb.module, verb.first_address);
  if (!params) return tl::unexpected(params.error());
  if (verb.length) (*params)["length"] = *verb.length;
  const auto result = perform("program.read", std::move(*params), context);
  if (!result) return tl::unexpected(result.error());
  const auto program = tmcl::program::from_hex(text_at(*result, "program"));
  if (!program) return tl::unexpected(usage_error("bad_program", program.error()));
  if (!verb.output.empty()) {
    const auto written = write_program(verb.output, *program);
    if (!written) return tl::unexpected(written.error());
  }
  if (context.output.json) {
    print_json(*result, context.output);
  } else if (verb.output.empty()) {
    context.output.out << tmcl::program::disassemble(*program);
  }
  return ExitCode::done;
}

}  // namespace tmclctl
