// Commands as text, and program files.
#include "tmcl/disassembler.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tmcl::program {
namespace {

using testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;

TEST(Disassembler, JumpsGoToLabelsAndTypesHaveNames) {
  const Program program = {
      {Command::SAP, 4, 0, 1000}, {Command::MVP, 0, 2, -5},  {Command::WAIT, 1, 2, 0},
      {Command::JC, 8, 0, 6},     {Command::DJNZ, 42, 0, 1}, {Command::CSUB, 0, 0, 6},
      {Command::GIO, 1, 2, 0},    {Command::CALL, 6, 0, 1},  {Command::JA, 0, 0, 10},
      {Command::RSUB, 0, 0, 0},
  };
  EXPECT_EQ(disassemble(program),
            "        SAP 4, 0, 1000\n"
            "L1:\n"
            "        MVP ABS, 2, -5\n"
            "        WAIT POS, 2, 0\n"
            "        JC ETO, L6\n"
            "        DJNZ 42, L1\n"
            "        CSUB L6\n"
            "L6:\n"
            "        GIO 1, 2\n"
            "        CALL LT, L1\n"
            "        JA L10\n"
            "        RSUB\n"
            "L10:\n");
}

std::string text_of(const Instruction& instruction) {
  const auto text = disassemble({&instruction, 1});
  return text.substr(8, text.size() - 9);
}

TEST(Disassembler, SaysNoMoreThanIsThere) {
  EXPECT_EQ(text_of({Command::GCO, 1, 0, 0}), "GCO 1, 0");
  EXPECT_EQ(text_of({Command::GCO, 1, 0, 7}), "GCO 1, 0, 7");
  EXPECT_EQ(text_of({Command::UF2, 0, 0, 0}), "UF2");
  EXPECT_EQ(text_of({Command::UF2, 0, 1, 0}), "UF2 0, 1");
  EXPECT_EQ(text_of({Command::MVP, 9, 0x47, 3}), "MVP 9, 71, 3");
  EXPECT_EQ(text_of({Command::JA, 0, 0, 2047}), "JA 2047") << "another part of the memory";
}

TEST(Disassembler, WhatIsNoCommandOfAProgramIsRaw) {
  EXPECT_EQ(text_of({static_cast<Command>(0), 0, 0, 0}), ".raw 0, 0, 0, 0");
  EXPECT_EQ(text_of({static_cast<Command>(250), 1, 2, INT32_MIN}), ".raw 250, 1, 2, -2147483648");
  EXPECT_EQ(text_of({Command::STOP_APPLICATION, 0, 0, 0}), ".raw 128, 0, 0, 0");
  EXPECT_EQ(text_of({Command::STOP, 0, 0, 1}), ".raw 28, 0, 0, 1");
  EXPECT_EQ(text_of({Command::STOP, 0, 1, 0}), ".raw 28, 0, 1, 0");
  EXPECT_EQ(text_of({Command::JA, 1, 0, 0}), ".raw 22, 1, 0, 0");
  EXPECT_EQ(text_of({Command::JA, 0, 0, 2048}), ".raw 22, 0, 0, 2048");
  EXPECT_EQ(text_of({Command::JA, 0, 0, -1}), ".raw 22, 0, 0, -1");
}

TEST(Disassembler, NothingIsNothing) { EXPECT_EQ(disassemble({}), ""); }

// TMCM-1290 firmware manual, MVP ABS, 0, 90000.
TEST(ProgramFile, HasEightBytesForEachCommand) {
  const Program program = {{Command::MVP, 0, 0, 90000}, {Command::EI, 255, 0, 0}};
  const Bytes bytes = {0x04, 0, 0, 0, 1, 0x5F, 0x90, 0xF4, 0x19, 0xFF, 0, 0, 0, 0, 0, 0x18};
  EXPECT_EQ(to_bytes(program), bytes);
  EXPECT_EQ(from_bytes(bytes).value(), program);
  EXPECT_EQ(from_bytes({}).value(), Program{});
}

TEST(ProgramFile, SaysWhatIsWrong) {
  EXPECT_THAT(from_bytes(Bytes(9)).error(), HasSubstr("9 is no multiple of eight"));
  EXPECT_EQ(from_bytes(Bytes(most_commands * 8)).value().size(), most_commands);
  EXPECT_THAT(from_bytes(Bytes(most_commands * 8 + 1)).error(), HasSubstr("at most 2048 commands"));
  Bytes damaged(24);
  damaged[10] = 1;
  EXPECT_THAT(from_bytes(damaged).error(), HasSubstr("the sum of command 1 is 0 and should be 1"));
}

}  // namespace
}  // namespace tmcl::program
