// The assembler undoes the disassembler, whatever the commands are; and no text does it any harm.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>

#include "support/seed.hpp"
#include "tmcl/assembler.hpp"
#include "tmcl/disassembler.hpp"

namespace tmcl::program {
namespace {

using Random = std::mt19937_64;

tl::expected<Assembly, TextProblems> assembled(const std::string& text) {
  return assemble("random.tmc", [&](const std::string&) -> tl::expected<std::string, std::string> {
    return text;
  });
}

std::uint8_t any_byte(Random& random) { return static_cast<std::uint8_t>(random()); }

/// Zeros and small numbers, where the rules are, are as likely as large ones.
std::uint8_t byte(Random& random) {
  return random() % 2 == 0 ? static_cast<std::uint8_t>(random() % 4) : any_byte(random);
}
std::int32_t value(Random& random) {
  switch (random() % 4) {
    case 0: return 0;
    case 1: return static_cast<std::int32_t>(random() % 64);
    case 2: return static_cast<std::int32_t>(random() % 4096) - 1024;
    default: return static_cast<std::int32_t>(random());
  }
}

Program any_program(Random& random) {
  Program program(random() % 64);
  for (auto& instruction : program) {
    const auto number = random() % 2 == 0 ? random() % 84 : random() % 256;
    instruction = {static_cast<Command>(number), byte(random), byte(random), value(random)};
  }
  return program;
}

TEST(AssemblerProperty, UndoesTheDisassembler) {
  for (auto seed = test::seed(); seed < test::seed() + 3000; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Random random(seed);
    const auto program = any_program(random);
    const auto text = disassemble(program);
    const auto assembly = assembled(text);
    ASSERT_TRUE(assembly) << describe(assembly.error().front()) << '\n' << text;
    ASSERT_EQ(assembly->program, program) << text;
    ASSERT_EQ(disassemble(assembly->program), text);
    ASSERT_EQ(from_bytes(to_bytes(program)).value(), program);
  }
}

// Each command with all its types, and a program that fills the memory.
TEST(AssemblerProperty, UndoesTheDisassemblerForEveryCommandAndType) {
  for (int number = 0; number < 256; ++number) {
    Program program;
    for (int type = 0; type < 256; ++type) {
      for (const auto motor : {std::uint8_t{0}, std::uint8_t{255}}) {
        for (const std::int32_t operand : {0, 2047, 2048, -1})
          program.push_back(
              {static_cast<Command>(number), static_cast<std::uint8_t>(type), motor, operand});
      }
    }
    ASSERT_EQ(program.size(), most_commands);
    const auto assembly = assembled(disassemble(program));
    ASSERT_TRUE(assembly) << number << ": " << describe(assembly.error().front());
    ASSERT_EQ(assembly->program, program) << number;
  }
}

const std::vector<std::string> scraps = {"MVP",
                                         "ABS",
                                         ",",
                                         ",",
                                         " ",
                                         " ",
                                         "0",
                                         "1",
                                         "SAP ",
                                         "Loop",
                                         ":",
                                         "\n",
                                         "\n",
                                         "JA ",
                                         "=",
                                         "(",
                                         ")",
                                         "-",
                                         "+",
                                         "*",
                                         "/",
                                         "%",
                                         "$",
                                         "0x",
                                         "&",
                                         "|",
                                         "^",
                                         "~",
                                         "//",
                                         "/*",
                                         "*/",
                                         "\"",
                                         "#",
                                         ".",
                                         ".raw ",
                                         "STOP",
                                         "\r",
                                         "\t",
                                         "9999999999",
                                         "#include random.tmc",
                                         "#include \"x\"",
                                         "WAIT ",
                                         "2147483648",
                                         "FF",
                                         "Loop: ",
                                         "A = ",
                                         "\xFF"};

// Each problem is about a place that exists, and what is accepted means the same when written anew.
TEST(AssemblerProperty, AnyTextIsAcceptedOrComplainedOf) {
  std::size_t accepted = 0;
  for (auto seed = test::seed(); seed < test::seed() + 20000; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    Random random(seed);
    std::string text;
    for (auto count = random() % 12; count != 0; --count) text += scraps[random() % scraps.size()];
    const auto assembly = assembled(text);
    if (assembly) {
      ++accepted;
      ASSERT_EQ(assembled(disassemble(assembly->program)).value().program, assembly->program);
      ASSERT_FALSE(listing(*assembly).empty() && !text.empty());
      continue;
    }
    ASSERT_FALSE(assembly.error().empty());
    for (const auto& problem : assembly.error()) {
      const auto lines = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')) + 1;
      ASSERT_LE(problem.line, lines);
      ASSERT_LE(problem.column, text.size() + 1);
      ASSERT_FALSE(problem.message.empty());
    }
  }
  EXPECT_GT(accepted, 100U);
}

}  // namespace
}  // namespace tmcl::program
