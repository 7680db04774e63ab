/// What the assembler and the disassembler agree upon beside the table of commands.
#pragma once

#include <cstdint>
#include <string_view>

#include "tmcl/program.hpp"

namespace tmcl::program {

/// The directive that takes a command by its numbers: command, type, motor, value.
constexpr std::string_view raw_directive = ".raw";

/// Whether a jump may go there. Right behind a program is a place as well: more may follow.
constexpr bool is_address(std::int64_t value) {
  return value >= 0 && value < static_cast<std::int64_t>(most_commands);
}

inline std::int64_t get_field(const Instruction& instruction, Field field) {
  switch (field) {
    case Field::type: return instruction.type;
    case Field::motor: return instruction.motor;
    case Field::value:
    case Field::address: return instruction.value;
  }
  return 0;
}

/// The value must be within the field's range.
inline void set_field(Instruction& instruction, Field field, std::int64_t value) {
  switch (field) {
    case Field::type: instruction.type = static_cast<std::uint8_t>(value); return;
    case Field::motor: instruction.motor = static_cast<std::uint8_t>(value); return;
    case Field::value:
    case Field::address: instruction.value = static_cast<std::int32_t>(value); return;
  }
}

}  // namespace tmcl::program
