/// Stand-alone programs: commands that a module keeps in its memory and runs by itself.
///
/// A program file has eight bytes for each command: command, type, motor or bank, four bytes of the
/// value (most significant first), and the sum of these seven modulo 256. It is the form in which
/// the TMCL-IDE and TMCLAsm leave their binary files, and that PyTrinamic's LoadTMCLBinary.py
/// downloads: a serial datagram without its first byte, the module's address.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "tmcl/command.hpp"

namespace tmcl::program {

/// One command. Its address is its place in the program, counted from 0.
struct Instruction {
  Command command{};
  std::uint8_t type = 0;
  std::uint8_t motor = 0;  ///< Motor, bank or user variable.
  std::int32_t value = 0;
  auto operator<=>(const Instruction&) const = default;
};

using Program = std::vector<Instruction>;

/// So many commands fit into a module's memory, as the vendor's firmware headers have it; some
/// models have room for fewer.
constexpr std::size_t most_commands = 2048;
constexpr std::size_t instruction_size = 8;  ///< Bytes.

/// The contents of a program file.
std::vector<std::uint8_t> to_bytes(std::span<const Instruction> program);

/// Reads a program file. Any command, type and motor will do. What is wrong comes as a sentence
/// without a full stop: a length that is no multiple of eight, more than most_commands, a wrong
/// sum.
tl::expected<Program, std::string> from_bytes(std::span<const std::uint8_t> bytes);

}  // namespace tmcl::program
