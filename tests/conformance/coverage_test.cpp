// docs/COVERAGE.md: every command and every parameter of every family, and where it is proven.
// TMCL_DRAW=1 writes it anew.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <utility>

#include "case.hpp"
#include "support/build_paths.hpp"
#include "tmcl/parameter.hpp"

namespace tmcl::conformance {
namespace {

constexpr auto page = TMCL_SOURCE_DIR "/docs/COVERAGE.md";
constexpr std::string_view nowhere = "—";

/// The first case that proves something about a number, on a module of a family.
class Proofs {
 public:
  void add(Family family, int number, const Case& proof) {
    proofs_.try_emplace({family, number}, &proof);
  }
  bool has(Family family, int number) const { return proofs_.contains({family, number}); }
  std::string link(Family family, int number) const {
    const auto found = proofs_.find({family, number});
    if (found == proofs_.end()) return std::string(nowhere);
    const auto& proof = *found->second;
    return "[" + proof.file + "](../tests/conformance/cases/" + proof.file + ".txt#L" +
           std::to_string(proof.line) + ")";
  }

 private:
  std::map<std::pair<Family, int>, const Case*> proofs_;
};

struct Coverage {
  Proofs commands;
  Proofs axis_parameters;
  Proofs global_parameters;
};

bool reaches_axis_parameter(Command command) {
  using enum Command;
  return command == SAP || command == GAP || command == STAP || command == RSAP || command == AAP;
}
bool reaches_global_parameter(Command command) {
  using enum Command;
  return command == SGP || command == GGP || command == STGP || command == RSGP || command == AGP;
}

void note(Coverage& coverage, const Case& proof, Command command, std::uint8_t type,
          std::uint8_t bank) {
  const auto family = proof.model->family;
  coverage.commands.add(family, static_cast<int>(command), proof);
  if (reaches_axis_parameter(command)) coverage.axis_parameters.add(family, type, proof);
  if (reaches_global_parameter(command) && bank == 0) {
    coverage.global_parameters.add(family, type, proof);
  }
}

void note(Coverage& coverage, const Case& proof, const Line& line) {
  if (const auto* ask = std::get_if<Ask>(&line.action)) {
    note(coverage, proof, ask->request.command, ask->request.type, ask->request.motor);
  } else if (const auto* download = std::get_if<Download>(&line.action)) {
    note(coverage, proof, Command::START_DOWNLOAD, 0, 0);
    note(coverage, proof, Command::END_DOWNLOAD, 0, 0);
    for (const auto& one : download->program) {
      note(coverage, proof, one.command, one.type, one.motor);
    }
  } else if (const auto* raw = std::get_if<RawExchange>(&line.action);
             raw != nullptr && raw->request.size() == serial_datagram_size) {
    note(coverage, proof, static_cast<Command>(raw->request.at(1)), raw->request.at(2),
         raw->request.at(3));
  }
}

Coverage coverage_of(const std::vector<Case>& cases) {
  Coverage coverage;
  for (const auto& one : cases) {
    for (const auto& line : one.lines) note(coverage, one, line);
  }
  return coverage;
}

std::string heading(std::string_view what) {
  std::string text = "\n| " + std::string(what) + " |";
  std::string rule = "| --- |";
  for (const auto family : families) {
    text += " " + std::string(name_of(family)) + " |";
    rule += " --- |";
  }
  return text + "\n" + rule + "\n";
}

std::string row(const std::string& what, const Proofs& proofs, int number) {
  std::string text = "| " + what + " |";
  for (const auto family : families) text += " " + proofs.link(family, number) + " |";
  return text + "\n";
}

std::string command_rows(const Coverage& coverage) {
  std::string text;
  for (const auto& info : command_table()) {
    const auto number = static_cast<int>(info.command);
    text += row(std::to_string(number) + " " + std::string(info.name), coverage.commands, number);
  }
  return text;
}

using Table = std::span<const ParameterInfo> (*)(const Model&);

/// The names of every number that the models of a family have.
std::map<int, std::string> names_of(Family family, Table table) {
  std::map<int, std::string> names;
  for (const auto& model : models()) {
    if (model.family != family) continue;
    for (const auto& info : table(model)) names.try_emplace(info.number, info.name);
  }
  return names;
}

std::string parameter_rows(const Proofs& proofs, Table table) {
  std::string text;
  for (const auto family : families) {
    text += "\n### " + std::string(name_of(family)) + "\n\n| parameter | proof |\n| --- | --- |\n";
    for (const auto& [number, name] : names_of(family, table)) {
      text +=
          "| " + std::to_string(number) + " " + name + " | " + proofs.link(family, number) + " |\n";
    }
  }
  return text;
}

std::string written(const Coverage& coverage) {
  std::string text =
      "# What is proven where\n\n"
      "Every command of TMCL and every parameter, by family of modules, with the first of the\n"
      "[conformance cases](../tests/conformance/cases) in which it is asked for: the library must\n"
      "send that request and understand the reply, and the simulator must answer so over a real\n"
      "pty. How the cases are written is told in\n"
      "[case.hpp](../tests/conformance/case.hpp). This page is generated; do not edit it.\n\n"
      "## Commands\n";
  text += heading("command") + command_rows(coverage);
  text += "\n## Axis parameters\n" + parameter_rows(coverage.axis_parameters, axis_parameters);
  text += "\n## Global parameters of bank 0\n" +
          parameter_rows(coverage.global_parameters, global_parameters);
  return text;
}

std::string contents(const char* path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(Coverage, PageIsWhatTheCasesProve) {
  const auto cases = load_cases();
  const auto text = written(coverage_of(cases));
  if (std::getenv("TMCL_DRAW") != nullptr) std::ofstream(page) << text;
  EXPECT_TRUE(contents(page) == text) << "TMCL_DRAW=1 writes docs/COVERAGE.md anew";
}

TEST(Coverage, EveryParameterIsProven) {
  const auto cases = load_cases();
  const auto coverage = coverage_of(cases);
  for (const auto family : families) {
    for (const auto& [number, name] : names_of(family, axis_parameters)) {
      EXPECT_TRUE(coverage.axis_parameters.has(family, number))
          << name_of(family) << ": axis parameter " << number << " " << name;
    }
    for (const auto& [number, name] : names_of(family, global_parameters)) {
      EXPECT_TRUE(coverage.global_parameters.has(family, number))
          << name_of(family) << ": global parameter " << number << " " << name;
    }
  }
}

TEST(Coverage, EveryCommandIsProven) {
  const auto cases = load_cases();
  const auto coverage = coverage_of(cases);
  for (const auto& info : command_table()) {
    const auto number = static_cast<int>(info.command);
    EXPECT_TRUE(std::ranges::any_of(families, [&](Family family) {
      return coverage.commands.has(family, number);
    })) << info.name;
  }
}

}  // namespace
}  // namespace tmcl::conformance
