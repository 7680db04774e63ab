#include <algorithm>
#include <set>

#include "core/text.hpp"
#include "tmcl/program_debugger.hpp"
#include "tmcl/spelling.hpp"

namespace tmcl::program {
namespace {

constexpr std::uint8_t bank_of_variables = 2;

std::string without_blanks_around(const std::string& line) {
  constexpr auto blank = " \t\r";
  const auto begin = line.find_first_not_of(blank);
  if (begin == std::string::npos) return {};
  return line.substr(begin, line.find_last_not_of(blank) - begin + 1);
}

/// A terminal obeys control characters, and a source may hold any.
std::string printable(std::string text) {
  std::ranges::replace_if(
      text, [](char c) { return (c >= 0 && c < ' ') || c == 127; }, ' ');
  return text;
}

void add_variables(const Instruction& line, std::set<std::uint8_t>& variables) {
  switch (line.command) {
    case Command::SGP:
    case Command::GGP:
    case Command::AGP:
    case Command::STGP:
    case Command::RSGP:
      if (line.motor == bank_of_variables) variables.insert(line.type);
      return;
    case Command::CALCVV:
      if (line.value >= 0 && line.value <= UINT8_MAX)
        variables.insert(static_cast<std::uint8_t>(line.value));
      [[fallthrough]];
    case Command::CALCV:
    case Command::CALCVA:
    case Command::CALCAV:
    case Command::CALCVX:
    case Command::CALCXV: variables.insert(line.motor); return;
    case Command::DJNZ: variables.insert(line.type); return;
    default: return;
  }
}

}  // namespace

std::optional<Place> ProgramMap::at(std::int32_t address) const {
  const auto is_here = [&](const SourceLine& line) {
    return line.address && static_cast<std::int64_t>(*line.address) == address;
  };
  const auto line = std::ranges::find_if(assembly_.lines, is_here);
  if (line == assembly_.lines.end()) return std::nullopt;
  return Place{static_cast<std::uint16_t>(address), assembly_.files[line->file], line->line,
               label_at(*line->address), printable(without_blanks_around(line->text))};
}

std::string ProgramMap::label_at(std::size_t address) const {
  const Label* nearest = nullptr;
  for (const auto& label : assembly_.labels) {
    const bool is_nearer = nearest == nullptr || label.address > nearest->address;
    if (label.address <= address && is_nearer) nearest = &label;
  }
  if (nearest == nullptr) return {};
  const auto behind = address - nearest->address;
  return behind == 0 ? nearest->name : nearest->name + '+' + std::to_string(behind);
}

std::string ProgramMap::name_of(std::int32_t address) const {
  const auto place = at(address);
  return place && !place->label.empty() ? place->label : std::to_string(address);
}

tl::expected<std::uint16_t, std::string> ProgramMap::find(std::string_view name) const {
  const auto label = std::ranges::find_if(assembly_.labels, [&](const Label& one) {
    return text::equal_ignoring_case(one.name, name);
  });
  if (label != assembly_.labels.end() && at(static_cast<std::int32_t>(label->address)))
    return static_cast<std::uint16_t>(label->address);
  if (const auto line = text::parse_integer<std::size_t>(name)) return find_line(0, *line);
  const auto colon = name.rfind(':');
  const auto line = colon == std::string_view::npos
                        ? std::nullopt
                        : text::parse_integer<std::size_t>(name.substr(colon + 1));
  const auto file = std::ranges::find(assembly_.files, name.substr(0, colon));
  if (line && file != assembly_.files.end())
    return find_line(static_cast<std::size_t>(file - assembly_.files.begin()), *line);
  std::vector<std::string_view> labels;
  for (const auto& one : assembly_.labels) labels.push_back(one.name);
  return tl::unexpected(quoted(name) + " is no label and no line of the program." +
                        did_you_mean(name, labels));
}

tl::expected<std::uint16_t, std::string> ProgramMap::find_line(std::size_t file,
                                                               std::size_t line) const {
  for (const auto& one : assembly_.lines) {
    if (one.file == file && one.line >= line && one.address)
      return static_cast<std::uint16_t>(*one.address);
  }
  return tl::unexpected("no command stands on line " + std::to_string(line) + " of " +
                        assembly_.files[file] + ", or below");
}

std::vector<std::uint8_t> ProgramMap::variables() const {
  std::set<std::uint8_t> variables;
  for (const auto& line : assembly_.program) add_variables(line, variables);
  return {variables.begin(), variables.end()};
}

}  // namespace tmcl::program
