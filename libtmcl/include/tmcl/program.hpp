/// Stand-alone programs: commands that a module keeps in its memory and runs by itself.
///
/// A program file has eight bytes for each command: command, type, motor or bank, four bytes of the
/// value (most significant first), and the sum of these seven modulo 256. It is the form in which
/// the TMCL-IDE and TMCLAsm leave their binary files, and that PyTrinamic's LoadTMCLBinary.py
/// downloads: a serial datagram without its first byte, the module's address.
///
/// Loading one into a module: START_DOWNLOAD, whose value is the first address; then each command,
/// which is answered with status 101 and stored instead of executed, as is everything below 128
/// that anyone sends to the module until then; END_DOWNLOAD. Whether a module stores lines at once
/// or all of them at the end is not documented. So that no half of a program can run, whatever is
/// lost when: load a single command 0 at the first address, then everything from the second address
/// on, compare, and load the first command last.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "tmcl/command.hpp"
#include "tmcl/datagram.hpp"

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

/// The bytes of a program file as hexadecimal text, two digits each, for JSON.
std::string to_hex(std::span<const Instruction> program);
/// And back; either case. Errors as from_bytes().
tl::expected<Program, std::string> from_hex(std::string_view text);

/// How a module answers READ_TMCL_MEMORY, whose value is the address of a command; type and motor
/// mean nothing. All seven bytes of a reply are the stored command: it stands where other replies
/// have the module's address, the status and the command number. On a serial line the host's
/// address stays before it and the sum behind it, so a host that only checks the sum reads it; on
/// CAN only the identifier of the frame tells that it is a reply. What was never written, and the
/// end of a program, reads as command 0. (The rule is that of PyTrinamic's example that loads a
/// program from a module, which calls it the older of two. The newer one is told by a flag of
/// GET_INFO; nothing here uses it.)
constexpr Reply memory_reply(const Instruction& line, std::uint8_t host = default_host_address) {
  return {host, static_cast<std::uint8_t>(line.command), static_cast<Status>(line.type),
          static_cast<Command>(line.motor), line.value};
}
constexpr Instruction line_of(const Reply& memory_reply) {
  return {static_cast<Command>(memory_reply.module), static_cast<std::uint8_t>(memory_reply.status),
          static_cast<std::uint8_t>(memory_reply.command), memory_reply.value};
}
/// A module that refuses to read its memory answers as it refuses anything else: with its own
/// address, a status below 100, the command number and the request's value. No line that means
/// something looks so unless it stands at the address that its value names, for the motor or
/// variable 134; nothing documents how real modules tell the two apart.
constexpr bool refuses_memory(const Reply& reply, const Request& request) {
  return reply.module == reply_byte(request.address) && !is_success(reply.status) &&
         reply.command == Command::READ_TMCL_MEMORY && reply.value == request.value;
}

}  // namespace tmcl::program
