/// Stand-alone programs as text that the assembler turns into the same commands.
#pragma once

#include <span>
#include <string>

#include "tmcl/program.hpp"

namespace tmcl::program {

/// One command a line. Jumps into the program, or to right behind it, go to labels: L and the
/// address. Types have their standard names. What cannot be written as a command (a number that
/// TMCL does not define, a field that the command does not use and that is not 0, a jump out of the
/// memory) becomes ".raw COMMAND, TYPE, MOTOR, VALUE". At most most_commands make sense.
std::string disassemble(std::span<const Instruction> program);

}  // namespace tmcl::program
