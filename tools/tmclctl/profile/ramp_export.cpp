#include "profile/ramp_export.hpp"

#include <algorithm>
#include <array>
#include <map>

#include <fmt/format.h>
#include <boost/json/array.hpp>
#include <boost/json/object.hpp>
#include <boost/json/serialize.hpp>

#include "tmcl/parameter.hpp"
#include "tmcl/plan/ramp_registers.hpp"
#include "tmcl/ramp/tmc429.hpp"

namespace tmclctl::profile {
namespace {

namespace json = boost::json;
using tmcl::plan::RampRegisters;
using tmcl::plan::RegisterWrite;

const tmcl::ParameterInfo& row_of(const tmcl::plan::Setting& setting, const tmcl::Model& model) {
  return *find_parameter(axis_parameters(model), setting.parameter);
}

/// On a TMC429 the factor of the deceleration follows from the others: on a module its firmware
/// writes it.
void add_factor(std::vector<RegisterWrite>& writes) {
  using Register = tmcl::ramp::Tmc429::Register;
  // Always set in the chip.
  constexpr std::int64_t lead_bit = 0x80;
  tmcl::ramp::Tmc429 chip;
  for (const auto& write : writes) chip.write(static_cast<Register>(write.index), write.value);
  for (const auto name : {Register::pmul, Register::pdiv}) {
    const auto value = chip.read(name);
    writes.push_back(
        {static_cast<std::size_t>(name), name == Register::pmul ? value | lead_bit : value});
  }
}

std::vector<RegisterWrite> writes_of(const RampExport& ramp, const RampRegisters& registers) {
  std::vector<RegisterWrite> writes;
  for (const auto& setting : ramp.settings)
    for (const auto& write : registers.writes_of(row_of(setting, ramp.model), setting.value))
      writes.push_back(write);
  if (ramp.model.family == tmcl::Family::tmc429) add_factor(writes);
  return writes;
}

void add(const tmcl::ramp::RegisterInfo& info, std::int64_t value, ChipWord& word) {
  const auto bits = static_cast<std::uint64_t>(value) << info.bits.shift;
  auto mask = ((std::uint64_t{1} << info.bits.count) - 1) << info.bits.shift;
  // A value with the bit that is always set has it in its mask, too.
  mask |= value > 0 ? bits : 0;
  word.mask |= static_cast<std::uint32_t>(mask);
  word.value |= static_cast<std::uint32_t>(bits & mask);
  word.registers += fmt::format("{}{} = {}", word.registers.empty() ? "" : ", ", info.name, value);
}

std::string sap_lines(const RampExport& ramp) {
  std::string text = fmt::format("// {}, motor {}: {}\n", ramp.model.name, ramp.motor, ramp.title);
  for (const auto& setting : ramp.settings) {
    const auto line = fmt::format("SAP {}, {}, {}", setting.parameter, ramp.motor, setting.value);
    text += fmt::format("{:<24}// {}\n", line, row_of(setting, ramp.model).name);
  }
  return text;
}

std::string c_table(const RampExport& ramp) {
  auto text = fmt::format(
      "/* {}: {}\n"
      "   At 16 MHz; addresses are those of the chip's first motor. Bits that are not in the mask "
      "stay. */\n"
      "static const struct {{\n"
      "  unsigned char address;\n"
      "  unsigned long mask;\n"
      "  unsigned long value;\n"
      "}} ramp[] = {{\n",
      ramp.model.name, ramp.title);
  for (const auto& word : chip_words(ramp))
    text += fmt::format("    {{0x{:02X}, 0x{:08X}ul, 0x{:08X}ul}}, /* {} */\n", word.address,
                        word.mask, word.value, word.registers);
  return text + "};\n";
}

json::object document(const RampExport& ramp) {
  json::array parameters;
  for (const auto& setting : ramp.settings) {
    parameters.push_back(json::object{{"number", setting.parameter},
                                      {"name", row_of(setting, ramp.model).name},
                                      {"value", setting.value}});
  }
  json::array registers;
  for (const auto& word : chip_words(ramp)) {
    registers.push_back(json::object{{"address", word.address},
                                     {"mask", word.mask},
                                     {"value", word.value},
                                     {"registers", word.registers}});
  }
  return {{"model", ramp.model.name},
          {"motor", ramp.motor},
          {"gives", ramp.title},
          {"parameters", std::move(parameters)},
          {"registers", std::move(registers)}};
}

}  // namespace

tl::expected<ExportForm, std::string> export_form(std::string_view word) {
  constexpr std::array<std::string_view, 4> names{"sap", "tmc", "c", "json"};
  const auto found = std::ranges::find(names, word);
  if (found == names.end())
    return tl::unexpected(fmt::format("'{}' is none of sap, tmc, c and json", word));
  return static_cast<ExportForm>(found - names.begin());
}

std::vector<ChipWord> chip_words(const RampExport& ramp) {
  const auto registers = RampRegisters::of(ramp.model);
  if (!registers) return {};
  std::map<std::uint8_t, ChipWord> words;
  for (const auto& [index, value] : writes_of(ramp, *registers)) {
    const auto& info = registers->registers()[index];
    if (info.bits.count == 0) continue;
    auto& word = words[info.bits.address];
    word.address = info.bits.address;
    add(info, value, word);
  }
  std::vector<ChipWord> all;
  for (auto& [address, word] : words) all.push_back(std::move(word));
  return all;
}

std::string text_of(const RampExport& ramp, ExportForm form) {
  switch (form) {
    case ExportForm::sap: return sap_lines(ramp);
    case ExportForm::tmc: return sap_lines(ramp) + "STOP\n";
    case ExportForm::c: return c_table(ramp);
    case ExportForm::json: break;
  }
  return json::serialize(document(ramp)) + '\n';
}

}  // namespace tmclctl::profile
