#include "tmcl/program.hpp"

#include "tmcl/datagram.hpp"
#include "tmcl/hex.hpp"

namespace tmcl::program {
namespace {

constexpr std::size_t summed_size = instruction_size - 1;

std::string wrong_sum(std::size_t address, unsigned found, unsigned computed) {
  return "the sum of command " + std::to_string(address) + " is " + std::to_string(found) +
         " and should be " + std::to_string(computed) + ": the file is damaged, or no TMCL program";
}

}  // namespace

std::vector<std::uint8_t> to_bytes(std::span<const Instruction> program) {
  std::vector<std::uint8_t> bytes(program.size() * instruction_size);
  for (std::size_t i = 0; i < program.size(); ++i) {
    const auto out = std::span(bytes).subspan(i * instruction_size, instruction_size);
    out[0] = static_cast<std::uint8_t>(program[i].command);
    out[1] = program[i].type;
    out[2] = program[i].motor;
    detail::put_value(out.subspan(3, 4), program[i].value);
    out[summed_size] = checksum(out.first(summed_size));
  }
  return bytes;
}

tl::expected<Program, std::string> from_bytes(std::span<const std::uint8_t> bytes) {
  const auto count = bytes.size() / instruction_size;
  if (bytes.size() > most_commands * instruction_size) {
    return tl::unexpected("a program has at most " + std::to_string(most_commands) +
                          " commands of eight bytes; these are more");
  }
  if (bytes.size() % instruction_size != 0) {
    return tl::unexpected("a program has eight bytes for each command; " +
                          std::to_string(bytes.size()) + " is no multiple of eight");
  }
  Program program;
  for (std::size_t i = 0; i < count; ++i) {
    const auto in = bytes.subspan(i * instruction_size, instruction_size);
    const auto sum = checksum(in.first(summed_size));
    if (sum != in[summed_size]) return tl::unexpected(wrong_sum(i, in[summed_size], sum));
    program.push_back(
        {static_cast<Command>(in[0]), in[1], in[2], detail::get_value(in.subspan(3, 4))});
  }
  return program;
}

std::string to_hex(std::span<const Instruction> program) { return tmcl::to_hex(to_bytes(program)); }

tl::expected<Program, std::string> from_hex(std::string_view text) {
  return tmcl::from_hex(text).and_then(
      [](const std::vector<std::uint8_t>& bytes) { return from_bytes(bytes); });
}

}  // namespace tmcl::program
