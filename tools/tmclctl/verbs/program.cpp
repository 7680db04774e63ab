// program assemble, program disassemble.
#include <filesystem>
#include <span>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "axis_names.hpp"
#include "input_file.hpp"
#include "output_file.hpp"
#include "print.hpp"
#include "program_file.hpp"
#include "text_problems.hpp"
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

Result<Program> program_from(const std::string& path, Output& output) {
  if (path.ends_with(".bin")) return read_program(path);
  return assemble_file(path, output).map([](Assembly assembly) {
    return std::move(assembly.program);
  });
}

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

}  // namespace tmclctl
