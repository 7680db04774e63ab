#include "tmcl/disassembler.hpp"

#include <set>

#include "program/encoding.hpp"

namespace tmcl::program {
namespace {

constexpr std::string_view indent = "        ";

using Targets = std::set<std::int64_t>;

std::string label(std::int64_t address) { return "L" + std::to_string(address); }

/// Null if the command has no place in a program's text.
const CommandInfo* row_of(const Instruction& instruction) {
  const auto* row = find_command(static_cast<std::uint8_t>(instruction.command));
  return row != nullptr && row->operands ? row : nullptr;
}

/// Whether the text of its operands says all there is in the command.
bool is_said_by_operands(const Instruction& instruction, const CommandInfo& row) {
  Instruction said{instruction.command};
  for (const auto& operand : *row.operands) {
    const auto value = get_field(instruction, operand.field);
    if (operand.field == Field::address && !is_address(value)) return false;
    set_field(said, operand.field, value);
  }
  return said == instruction;
}

Targets jump_targets(std::span<const Instruction> program) {
  Targets targets;
  for (const auto& instruction : program) {
    const auto* row = row_of(instruction);
    if (row == nullptr || !is_said_by_operands(instruction, *row)) continue;
    for (const auto& operand : *row->operands) {
      const auto value = get_field(instruction, operand.field);
      if (operand.field == Field::address && value <= std::ssize(program)) targets.insert(value);
    }
  }
  return targets;
}

std::string operand_text(const Instruction& instruction, const Operand& operand,
                         const Targets& targets) {
  const auto value = get_field(instruction, operand.field);
  if (operand.field == Field::address && targets.contains(value)) return label(value);
  if (operand.field == Field::type) {
    const auto name = name_of_subtype(instruction.command, instruction.type);
    if (!name.empty()) return std::string(name);
  }
  return std::to_string(value);
}

/// Optional operands are left out as long as nothing but zeros follows.
std::size_t operands_to_say(const Instruction& instruction, std::span<const Operand> operands) {
  auto count = operands.size();
  while (count > 0 && operands[count - 1].optional &&
         get_field(instruction, operands[count - 1].field) == 0)
    --count;
  return count;
}

std::string command_text(const Instruction& instruction, const CommandInfo& row,
                         const Targets& targets) {
  std::string text(row.name);
  const auto count = operands_to_say(instruction, *row.operands);
  for (std::size_t i = 0; i < count; ++i)
    text += (i == 0 ? " " : ", ") + operand_text(instruction, (*row.operands)[i], targets);
  return text;
}

std::string raw_text(const Instruction& instruction) {
  return std::string(raw_directive) + ' ' +
         std::to_string(static_cast<std::uint8_t>(instruction.command)) + ", " +
         std::to_string(instruction.type) + ", " + std::to_string(instruction.motor) + ", " +
         std::to_string(instruction.value);
}

}  // namespace

std::string disassemble(std::span<const Instruction> program) {
  const auto targets = jump_targets(program);
  std::string text;
  const auto say_label = [&](std::size_t address) {
    const auto place = static_cast<std::int64_t>(address);
    if (targets.contains(place)) text += label(place) + ":\n";
  };
  for (std::size_t i = 0; i < program.size(); ++i) {
    say_label(i);
    const auto* row = row_of(program[i]);
    const bool plain = row != nullptr && is_said_by_operands(program[i], *row);
    text += indent;
    text += plain ? command_text(program[i], *row, targets) : raw_text(program[i]);
    text += '\n';
  }
  say_label(program.size());
  return text;
}

}  // namespace tmcl::program
