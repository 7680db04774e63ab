// The bytes as a program file, and as the text of a program that may include itself and a copy.
#include "tmcl/assembler.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <string>

#include "tmcl/disassembler.hpp"

namespace {

namespace program = tmcl::program;

void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %s\n", what);
  std::abort();
}

auto assembled(const std::string& text) {
  return program::assemble(
      "fuzz.tmc",
      [&](const std::string&) -> tl::expected<std::string, std::string> { return text; });
}

void require_way_back(const program::Program& commands) {
  const auto again = assembled(program::disassemble(commands));
  require(again && again->program == commands, "the assembler undoes the disassembler");
}

void as_text(std::span<const std::uint8_t> bytes) {
  const auto assembly = assembled(std::string(bytes.begin(), bytes.end()));
  if (!assembly) {
    require(!assembly.error().empty(), "there is a reason");
    return;
  }
  (void)program::listing(*assembly);
  require_way_back(assembly->program);
}

void as_file(std::span<const std::uint8_t> bytes) {
  if (const auto commands = program::from_bytes(bytes)) {
    const auto written = program::to_bytes(*commands);
    require(std::ranges::equal(written, bytes), "a file is written as it was read");
  }
}

// Without sums to get right.
void as_commands(std::span<const std::uint8_t> bytes) {
  program::Program commands;
  for (; bytes.size() >= 7 && commands.size() < program::most_commands; bytes = bytes.subspan(7))
    commands.push_back({static_cast<tmcl::Command>(bytes[0]), bytes[1], bytes[2],
                        static_cast<std::int32_t>(bytes[3] << 8 | bytes[4]) - bytes[5]});
  require_way_back(commands);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span bytes(data, size);
  as_text(bytes);
  as_file(bytes);
  as_commands(bytes);
  return 0;
}
