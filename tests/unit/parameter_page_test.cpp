// docs/PARAMETERS.md: every model and parameter of the tables, as a page to read. TMCL_DRAW=1
// writes it anew.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "support/build_paths.hpp"
#include "tmcl/model.hpp"
#include "tmcl/model_document.hpp"
#include "tmcl/parameter.hpp"

namespace tmcl {
namespace {

using Numbers = std::vector<std::uint16_t>;
using TableOf = std::span<const ParameterInfo> (*)(const Model&);

/// A parameter, and which models have it so.
struct Entry {
  ParameterInfo info;
  Numbers models;
};

void add(std::vector<Entry>& entries, const ParameterInfo& info, std::uint16_t model) {
  const auto same = std::ranges::find(entries, info, &Entry::info);
  if (same == entries.end()) {
    entries.push_back({info, {model}});
  } else {
    same->models.push_back(model);
  }
}

std::vector<Entry> collect(const std::vector<const Model*>& models, TableOf table_of) {
  std::vector<Entry> entries;
  for (const auto* model : models) {
    for (const auto& info : table_of(*model)) add(entries, info, model->number);
  }
  std::ranges::stable_sort(entries, {}, [](const Entry& entry) { return entry.info.number; });
  return entries;
}

std::vector<const Model*> models_of(Family family) {
  std::vector<const Model*> found;
  for (const auto& model : models()) {
    if (model.family == family) found.push_back(&model);
  }
  return found;
}

std::string which(const Numbers& models, const std::vector<const Model*>& of) {
  if (models.size() == of.size()) return "all";
  if (models.size() * 2 <= of.size()) return fmt::format("{}", fmt::join(models, ", "));
  Numbers others;
  for (const auto* model : of) {
    if (std::ranges::count(models, model->number) == 0) others.push_back(model->number);
  }
  return fmt::format("all but {}", fmt::join(others, ", "));
}

std::string limit(std::int32_t value) {
  if (value == INT32_MAX) return "2^31-1";
  return value == INT32_MIN ? "-2^31" : std::to_string(value);
}

std::string range(const ParameterInfo& info) {
  return fmt::format("{}..{}", limit(info.minimum), limit(info.maximum));
}

std::string access(const ParameterInfo& info) {
  if (info.access == Access::read) return "R";
  return info.stored ? "RWE" : "RW";
}

std::string names(const ParameterInfo& info) {
  std::string text = fmt::format("`{}`", info.name);
  for (const auto alias : info.aliases) {
    if (!alias.empty()) text += fmt::format(", {}", alias);
  }
  return text;
}

std::string parameter_table(const std::vector<const Model*>& models, TableOf table_of) {
  std::string page =
      "| # | name | models | access | range | default | unit | register | meaning |\n"
      "| ---: | --- | --- | --- | --- | ---: | --- | --- | --- |\n";
  for (const auto& [info, numbers] : collect(models, table_of)) {
    page += fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} | {} |\n", info.number,
                        names(info), which(numbers, models), access(info), range(info),
                        info.access == Access::read ? "" : limit(info.initial), info.unit,
                        info.chip_register, info.meaning);
  }
  return page;
}

std::string interfaces(const Model& model) {
  std::vector<std::string_view> list;
  if ((model.interfaces & usb) != 0) list.emplace_back("USB");
  if ((model.interfaces & rs232) != 0) list.emplace_back("RS232");
  if ((model.interfaces & rs485) != 0) list.emplace_back("RS485");
  if ((model.interfaces & can) != 0) list.emplace_back("CAN");
  return fmt::format("{}", fmt::join(list, ", "));
}

std::string analog_ports(const Model& model) {
  std::vector<int> ports;
  for (int port = 0; port < 16; ++port) {
    if ((model.ports.analog_inputs >> port & 1) != 0) ports.push_back(port);
  }
  return fmt::format("{}", fmt::join(ports, ", "));
}

std::string model_table() {
  std::string page =
      "| model | axes | ramps | chips | interfaces | digital inputs | analogue ports | outputs | "
      "ranges "
      "and meanings of its parameters |\n"
      "| --- | ---: | --- | --- | --- | ---: | --- | ---: | --- |\n";
  for (const auto& model : models()) {
    page += fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} | {} |\n", model.name, model.axes,
                        name_of(model.family), model.chips, interfaces(model),
                        model.ports.digital_inputs, analog_ports(model), model.ports.outputs,
                        document_of(model));
  }
  return page;
}

std::vector<const Model*> every_model() {
  std::vector<const Model*> all;
  for (const auto& model : models()) all.push_back(&model);
  return all;
}

std::string page() {
  std::string page = R"(# Models and parameters

What the library, the simulator, the daemon and the command line know of each model: this page is written from the
same tables. `tmclctl params --model TMCM-1276` lists the parameters of one model.

Access: R can be read, W written, E kept in the EEPROM. A name in `code style` is the standard name; the others are
understood, too, whatever their case, `_` and `-`. Ranges are those of the unit that a module starts with. A module that
is not in the list works by number.

## Models

The numbers of parameters are from PyTrinamic's lists; the last column names the document that their ranges and meanings
follow. Where no document tells a chip or the ports, the chips are those that have all registers of the model's parameters, and
the ports those of PyTrinamic's lists. The simulator makes the ramps of the family firmware, and the
trapezoids of the family TMC4361, with a sixPoint generator; [RAMPS.md](RAMPS.md#the-tmc4361-a-model) has the S-curves of the latter.

)";
  page += model_table();
  for (const auto family : families) {
    page += fmt::format("\n## Axis parameters: {}\n\n", name_of(family));
    page += parameter_table(models_of(family), axis_parameters);
  }
  page += "\n## Global parameters, bank 0\n\n";
  page += parameter_table(every_model(), global_parameters);
  page += R"(
## Global parameters, other banks

| bank | # | access | range | meaning |
| ---: | --- | --- | --- | --- |
| 2 | 0..55 | RWE | -2^31..2^31-1 | user variables of stand-alone programs |
| 2 | 56..255 | RW | -2^31..2^31-1 | the same, not kept |
| 3 | 0..2 | RWE | 0..2^31-1 | periods of the timers 0 to 2, in ms |
| 3 | 27.. | RWE | 0..3 | left and right stop switch of each motor in turn: edge that interrupts, 0 none, 1 rising, 2 falling, 3 both |
| 3 | 39.. | RWE | 0..3 | the same of the inputs |
)";
  return page;
}

TEST(ParameterPage, IsWrittenFromTheTables) {
  const auto path = std::filesystem::path(TMCL_SOURCE_DIR) / "docs" / "PARAMETERS.md";
  if (std::getenv("TMCL_DRAW") != nullptr) std::ofstream(path) << page();
  std::ifstream in(path);
  const std::string kept{std::istreambuf_iterator<char>(in), {}};
  EXPECT_TRUE(kept == page()) << "docs/PARAMETERS.md is not what the tables say: TMCL_DRAW=1 "
                                 "writes it anew";
}

}  // namespace
}  // namespace tmcl
