// How a line of a program travels in the answer to READ_TMCL_MEMORY.
#include <gtest/gtest.h>

#include "tmcl/program.hpp"

namespace tmcl::program {
namespace {

const Request read_line_7{ModuleAddress{1}, Command::READ_TMCL_MEMORY, 0, 0, 7};

TEST(ProgramMemory, ALineIsAllOfTheAnswerButHostAndSum) {
  const Instruction line{Command::MVP, 1, 2, -3};
  const SerialBytes bytes = encode_serial(memory_reply(line));
  EXPECT_EQ(bytes, (SerialBytes{2, 4, 1, 2, 0xFF, 0xFF, 0xFF, 0xFD, 0x03}));
  EXPECT_EQ(line_of(*decode_serial_reply(bytes)), line);
}

TEST(ProgramMemory, OnCanALineFillsTheFrame) {
  const Instruction line{Command::JC, 9, 0, 2047};
  const auto frame = encode_can(memory_reply(line), default_can_reply_id);
  EXPECT_EQ(frame.length, can_datagram_size);
  EXPECT_EQ(line_of(*decode_can_reply(frame)), line);
}

TEST(ProgramMemory, ARefusalIsAnOrdinaryReply) {
  const Reply refusal{2, 1, Status::write_protected, Command::READ_TMCL_MEMORY, 7};
  EXPECT_TRUE(refuses_memory(refusal, read_line_7));
  EXPECT_FALSE(refuses_memory(memory_reply({Command::ROR, 0, 0, 7}), read_line_7));
  EXPECT_FALSE(refuses_memory(memory_reply({}), read_line_7));
}

}  // namespace
}  // namespace tmcl::program
