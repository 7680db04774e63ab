// program assemble, program disassemble.
#include <filesystem>
#include <span>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "axis/axis_names.hpp"
#include "command_line/input_file.hpp"
#include "command_line/text_problems.hpp"
#include "output/output_file.hpp"
#include "output/print.hpp"
#include "program_file.hpp"
#include "tmcl/assembler.hpp"
#include "tmcl/disassembler.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;
using tmcl::program::Assembly;
using tmcl::program::Program;

// One byte more than there may be tells a file that is too long.
constexpr std::size_t most_text = tmcl::program::most_source_bytes + 1;
constexpr std::size_t most_binary =
    tmcl::program::most_commands * tmcl::program::instruction_size + 1;

json::object to_json(const std::string& path, const Assembly& assembly) {
  json::array labels;
  for (const auto& label : assembly.labels)
    labels.push_back(json::object{{"name", label.name}, {"address", label.address}});
  json::array commands;
  for (const auto& line : assembly.lines) {
    if (!line.address) continue;
    const auto& command = assembly.program[*line.address];
    commands.push_back(json::object{{"address", *line.address},
                                    {"command", static_cast<int>(command.command)},
                                    {"type", command.type},
                                    {"motor", command.motor},
                                    {"value", command.value},
                                    {"file", assembly.files[line.file]},
                                    {"line", line.line}});
  }
  return {{"file", path}, {"labels", std::move(labels)}, {"program", std::move(commands)}};
}

/// What is read may be all there is of someone's work.
Result<void> write_output(const std::string& path, const std::string& contents,
                          std::span<const std::string> sources) {
  if (path.empty()) return {};
  for (const auto& source : sources) {
    std::error_code unknown;
    if (std::filesystem::equivalent(path, source, unknown)) {
      return tl::unexpected(usage_error("cannot_write",
                                        fmt::format("{} is read; it is not written over", path),
                                        "Name another file with -o"));
    }
  }
  OutputFile file;
  return file.open(path).and_then([&] { return file.write(contents); });
}

std::string contents_of(const Program& program) {
  const auto bytes = tmcl::program::to_bytes(program);
  return {bytes.begin(), bytes.end()};
}

}  // namespace

Result<Program> read_program(const std::string& path) {
  const auto contents = read_file(path, most_binary);
  if (!contents) {
    return tl::unexpected(
        usage_error("cannot_read", fmt::format("cannot read {}: {}", path, contents.error())));
  }
  const std::vector<std::uint8_t> bytes(contents->begin(), contents->end());
  return tmcl::program::from_bytes(bytes).map_error([&](const std::string& problem) {
    return usage_error("bad_program", fmt::format("{}: {}", path, problem));
  });
}

Result<Assembly> assemble_file(const std::string& path, Output& output, const tmcl::Model* model) {
  auto assembly = tmcl::program::assemble(
      path, [](const std::string& name) { return read_file(name, most_text); }, model);
  if (assembly) return std::move(*assembly);
  return tl::unexpected(error_from(path, assembly.error(), tmcl::program::most_problems, output));
}

Result<Assembly> assembly_from(const std::string& path, Output& output, const tmcl::Model* model) {
  if (!path.ends_with(".bin")) return assemble_file(path, output, model);
  const auto program = read_program(path);
  if (!program) return tl::unexpected(program.error());
  const auto text = tmcl::program::disassemble(*program);
  auto assembly = tmcl::program::assemble(
      path, [&](const std::string&) -> tl::expected<std::string, std::string> { return text; });
  if (assembly) return std::move(*assembly);
  return tl::unexpected(error_from(path, assembly.error(), tmcl::program::most_problems, output));
}

Result<Program> program_from(const std::string& path, Output& output) {
  if (path.ends_with(".bin")) return read_program(path);
  return assemble_file(path, output).map([](Assembly assembly) {
    return std::move(assembly.program);
  });
}

namespace {

Result<ExitCode> run(const verb::Assemble& verb, Output& output) {
  Result<const tmcl::Model*> model = nullptr;
  if (!verb.model.empty()) model = parse_model(verb.model);
  if (!model) return tl::unexpected(model.error());
  const auto assembly = assemble_file(verb.file, output, *model);
  if (!assembly) return tl::unexpected(assembly.error());
  return write_output(verb.output, contents_of(assembly->program), assembly->files).map([&] {
    if (output.json) {
      print_json(to_json(verb.file, *assembly), output);
    } else if (verb.listing || verb.output.empty()) {
      output.out << tmcl::program::listing(*assembly);
    }
    return ExitCode::done;
  });
}

Result<ExitCode> run(const verb::Disassemble& verb, Output& output) {
  const auto program = read_program(verb.file);
  if (!program) return tl::unexpected(program.error());
  const auto text = tmcl::program::disassemble(*program);
  return write_output(verb.output, text, {&verb.file, 1}).map([&] {
    if (output.json) {
      print_json({{"file", verb.file}, {"commands", program->size()}, {"text", text}}, output);
    } else if (verb.output.empty()) {
      output.out << text;
    }
    return ExitCode::done;
  });
}

constexpr std::string_view files = "it is about files";

constexpr const char* program_help = R"(
'assemble' and 'disassemble' only work on files. All others speak to the module that they name.

  tmclctl program assemble --help      a program's text: a file for the module
  tmclctl program upload --help        into the module
  tmclctl program run --help           and let it run
)";

constexpr const char* assemble_help = R"(
FILE is a program in the language of the TMCL-IDE:

  #include "speeds.tmc"             // beside this file
  Far = 2 * $C800                   // constants; ( ) - ~ * / % + & ^ |; $FF, 0xFF, %1010
  Loop: MVP ABS, 0, Far             /* labels, alone on a line or before a command */
        WAIT POS, 0, 0
        JA Loop
        .raw 250, 1, 2, 3           // any command by its numbers

#include TMCLParam.tmc, a file of the TMCL-IDE, makes names of axis parameters constants, such as
MaxVelocity; it need not be there. Some names have other numbers on other models: --model says which.

Without -o it prints the listing: address, bytes, line and text. The file that -o names gets eight
bytes for each command, as the TMCL-IDE and PyTrinamic read them; it is written only if there are no
problems. Each problem is a line FILE:LINE:COLUMN: MESSAGE on standard error (exit code 2).
--json prints {"file", "labels": [{"name", "address"}], "program": [{"address", "command", "type",
"motor", "value", "file", "line"}]}, or {"error": {..., "problems": [{"file", "line", "column",
"word", "message"}]}}.

  tmclctl program assemble loop.tmc
  tmclctl program assemble loop.tmc -o loop.bin
  tmclctl program assemble loop.tmc --model TMCM-1110
  tmclctl --json program assemble loop.tmc
)";

constexpr const char* disassemble_help = R"(
FILE has eight bytes for each command, as the TMCL-IDE, TMCLAsm and 'tmclctl program assemble' write
them. The text assembles to the same bytes; what is no command of a program becomes .raw COMMAND,
TYPE, MOTOR, VALUE. --json prints {"file", "commands", "text"}.

  tmclctl program disassemble loop.bin
  tmclctl program disassemble loop.bin -o loop.tmc
)";

}  // namespace

Form add_program(Grammar& grammar) {
  const auto program = grammar.group(
      "program", "Stand-alone programs: text, bytes, and modules that run them", program_help);
  auto assemble =
      grammar.verb<verb::Assemble>(program, "assemble", access::offline(files),
                                   "Make a program file of a program's text", assemble_help, run);
  assemble.word("FILE", "The text", text(assemble->file));
  assemble.option("-o,--output", "FILE", "Write the program into this file",
                  text(assemble->output));
  assemble.option("--model", "MODEL", "Whose parameters TMCLParam.tmc names, such as TMCM-1110",
                  text(assemble->model));
  assemble.flag("--listing", "Print the listing, too: addresses, bytes and text",
                assemble->listing);
  auto disassemble =
      grammar.verb<verb::Disassemble>(program, "disassemble", access::offline(files),
                                      "Make text of a program file", disassemble_help, run);
  disassemble.word("FILE", "The program file", text(disassemble->file));
  disassemble.option("-o,--output", "FILE", "Write the text into this file, do not print it",
                     text(disassemble->output));
  return program;
}

}  // namespace tmclctl
