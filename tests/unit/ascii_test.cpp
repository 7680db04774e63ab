// The ASCII mode: lines to commands, replies to text, and both ways back.
#include "tmcl/ascii.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tmcl::ascii {
namespace {

using testing::HasSubstr;

Request request(std::uint16_t address, Command command, std::uint8_t type, std::uint8_t motor,
                std::int32_t value) {
  return {ModuleAddress{address}, command, type, motor, value};
}

Order order_of(std::string_view line) {
  const auto order = parse(line);
  EXPECT_TRUE(order) << line << ": " << (order ? "" : order.error().message);
  return order.value_or(Order{});
}

TEST(Ascii, ReadsTheLinesOfTheManuals) {
  EXPECT_EQ(order_of("AMVP ABS, 1, 50000"), Order(request(1, Command::MVP, 0, 1, 50000)));
  EXPECT_EQ(order_of("A MVP ABS, 1, 50000"), Order(request(1, Command::MVP, 0, 1, 50000)));
  EXPECT_EQ(order_of("AROL 2, 500"), Order(request(1, Command::ROL, 0, 2, 500)));
  EXPECT_EQ(order_of("A MST 1"), Order(request(1, Command::MST, 0, 1, 0)));
  EXPECT_EQ(order_of("AGAP 0, 1"), Order(request(1, Command::GAP, 0, 1, 0)));
  EXPECT_EQ(order_of("ABIN"), Order(Leave{ModuleAddress{1}}));
}

TEST(Ascii, CaseBlanksAndLettersDoNotMatter) {
  EXPECT_EQ(order_of("c  mvp  rel ,0 ,  -7  "), Order(request(3, Command::MVP, 1, 0, -7)));
  EXPECT_EQ(order_of("zsap\t4,0,1000"), Order(request(26, Command::SAP, 4, 0, 1000)));
  EXPECT_EQ(order_of("B bin"), Order(Leave{ModuleAddress{2}}));
}

TEST(Ascii, ProgramsAreRunAndStoppedByAWord) {
  EXPECT_EQ(order_of("A RUN"), Order(request(1, Command::RUN_APPLICATION, 0, 0, 0)));
  EXPECT_EQ(order_of("Astop"), Order(request(1, Command::STOP_APPLICATION, 0, 0, 0)));
}

TEST(Ascii, OperandsThatMayBeLeftOutAreZero) {
  EXPECT_EQ(order_of("AGCO 3, 0"), Order(request(1, Command::GCO, 3, 0, 0)));
  EXPECT_EQ(order_of("AGCO 3, 255, 0"), Order(request(1, Command::GCO, 3, 255, 0)));
  EXPECT_EQ(order_of("AUF0"), Order(request(1, Command::UF0, 0, 0, 0)));
  EXPECT_EQ(order_of("AUF7 1, 2, 3"), Order(request(1, Command::UF7, 1, 2, 3)));
}

TEST(Ascii, TellsWhatIsWrongWhereAndWithWhichStatus) {
  struct Case {
    std::string line;
    std::size_t column;
    std::string message;
    Status status;
  };
  const std::vector<Case> cases{
      {"", 1, "begins with the letter", Status::invalid_command},
      {"1MST 0", 1, "begins with the letter", Status::invalid_command},
      {"A", 2, "there is no command ''", Status::invalid_command},
      {"A MVQ ABS, 0, 1", 3, "there is no command 'MVQ' in ASCII mode. Did you mean 'MVP'?",
       Status::invalid_command},
      {"AJA 3", 2, "there is no command 'JA'", Status::invalid_command},
      {"AGET_INFO 0", 2, "there is no command 'GET_INFO'", Status::invalid_command},
      {"A136", 2, "there is no command '136'", Status::invalid_command},
      {"AMVP UP, 0, 1", 6, "'UP' is no type", Status::wrong_type},
      {"AMVP 256, 0, 1", 6, "'256' is no type", Status::invalid_value},
      {"AMVP , 0, 1", 6, "',' is no type", Status::invalid_value},
      {"AMVP ABS, 256, 1", 11, "'256' is no motor", Status::invalid_value},
      {"AMVP ABS, 0, 2147483648", 14, "'2147483648' is no position", Status::invalid_value},
      {"AMVP ABS, 0, $FF", 14, "'$' is no position", Status::invalid_value},
      {"AMVP ABS 0 1", 10, "a comma is missing", Status::invalid_value},
      {"AMVP ABS, 0,", 13, "nothing follows the comma", Status::invalid_value},
      {"AMST 0, 1", 9, "MST takes no more than this", Status::invalid_value},
      {"ABIN 1", 6, "BIN stands alone", Status::invalid_value},
      {"ARUN 1", 6, "RUN stands alone", Status::invalid_value},
      {"A" + std::string(longest_line, ' '), 1, "a line has at most 80 characters",
       Status::invalid_command},
  };
  for (const auto& expected : cases) {
    const auto order = parse(expected.line);
    ASSERT_FALSE(order) << expected.line;
    EXPECT_EQ(order.error().column, expected.column) << expected.line;
    EXPECT_THAT(order.error().message, HasSubstr(expected.message)) << expected.line;
    EXPECT_EQ(order.error().status, expected.status) << expected.line;
  }
}

TEST(Ascii, AnAddressIsALetter) {
  EXPECT_EQ(letter_of(1), 'A');
  EXPECT_EQ(letter_of(26), 'Z');
  EXPECT_EQ(letter_of(0), std::nullopt);
  EXPECT_EQ(letter_of(27), std::nullopt);
  EXPECT_EQ(address_of("c nonsense"), ModuleAddress{3});
  EXPECT_EQ(address_of("?"), std::nullopt);
  EXPECT_EQ(address_of(""), std::nullopt);
}

TEST(Ascii, RepliesAreFourWords) {
  const Reply reply{2, 1, Status::ok, Command{}, -5000};
  EXPECT_EQ(to_text(reply), "BA 100 -5000");
  EXPECT_EQ(parse_reply("BA 100 -5000"), reply);
  EXPECT_EQ(to_text({30, 1, Status::wrong_type, Command::SAP, 7}), "?A 3 7");
  for (const auto* bad : {"", "B", "BA", "BA 100", "BA 100 ", "BA 256 1", "1A 100 1", "BA 100 1 2",
                          "BA x 1", "BA 100 2147483648"}) {
    EXPECT_FALSE(parse_reply(bad)) << bad;
  }
}

TEST(Ascii, EveryDirectCommandSurvivesItsLine) {
  std::size_t direct = 0;
  for (const auto& row : command_table()) {
    const auto line = to_line(request(7, row.command, 1, 2, -3));
    if (!line) continue;
    ++direct;
    const auto order = order_of(*line);
    ASSERT_TRUE(std::holds_alternative<Request>(order)) << *line;
    EXPECT_EQ(std::get<Request>(order).command, row.command) << *line;
    EXPECT_EQ(to_line(order), line);
  }
  EXPECT_EQ(direct, 15U + 3U + 8U + 1U);  // ROR to GIO, coordinates, user functions, STOP
  EXPECT_EQ(to_line(Leave{ModuleAddress{2}}), "BBIN");
  EXPECT_EQ(to_line(request(1, Command::RUN_APPLICATION, 0, 0, 0)), "ARUN");
  EXPECT_EQ(to_line(request(1, Command::MVP, 0, 0, 50000)), "AMVP ABS, 0, 50000");
  EXPECT_EQ(to_line(request(27, Command::MST, 0, 0, 0)), std::nullopt);
  EXPECT_EQ(to_line(request(1, Command::GET_INFO, 0, 0, 0)), std::nullopt);
}

}  // namespace
}  // namespace tmcl::ascii
