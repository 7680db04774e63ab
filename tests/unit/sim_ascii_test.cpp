// A person at a terminal, and a simulated module in ASCII mode.
#include <gmock/gmock.h>

#include "sim_fixture.hpp"

namespace tmcl::sim {
namespace {

namespace gp = global_parameter;

class SimAscii : public SimTest {
 protected:
  /// What comes back when this is typed.
  std::string type(std::string_view text) {
    const auto bytes = exchange(Bytes(text.begin(), text.end()));
    return {bytes.begin(), bytes.end()};
  }
  void enter(std::uint16_t address = 1) {
    EXPECT_EQ(ask({ModuleAddress{address}, Command::ENTER_ASCII_MODE, 0, 0, 0})->status,
              Status::ok);
  }
  /// In ASCII mode, and without an echo from then on.
  Module& quiet_module(std::uint16_t address = 1) {
    auto& module = add(1110, address);
    ask({ModuleAddress{address}, Command::SGP, gp::ascii_mode, 0, 0x20});
    enter(address);
    return module;
  }
};

TEST_F(SimAscii, ALineIsACommandAndItsReplyALine) {
  quiet_module();
  EXPECT_EQ(type("AMVP ABS, 0, 50000\r"), "BA 100 50000\r");
  pass(std::chrono::minutes(2));
  EXPECT_EQ(type("A GAP 1, 0\r"), "BA 100 50000\r");
  EXPECT_EQ(type("a mvp rel, 0, -70000\r"), "BA 100 -70000\r");
  pass(std::chrono::minutes(2));
  EXPECT_EQ(type("AGAP 1, 0\r\n"), "BA 100 -20000\r");
}

TEST_F(SimAscii, WhatIsWrongComesAsItsStatus) {
  quiet_module();
  EXPECT_EQ(type("ANONSENSE\r"), "BA 2 0\r");
  EXPECT_EQ(type("A\r"), "BA 2 0\r");
  EXPECT_EQ(type("AMVP UP, 0, 1\r"), "BA 3 0\r");
  EXPECT_EQ(type("AMVP ABS,\r"), "BA 4 0\r");
  EXPECT_EQ(type("AGAP 1, 7\r"), "BA 4 0\r") << "a motor that it does not have";
  EXPECT_EQ(type("ASAP 4, 0, 99999\r"), "BA 4 99999\r");
  EXPECT_EQ(type("A" + std::string(1000, 'X') + "\rAMST 0\r"), "BA 2 0\rBA 100 0\r");
}

TEST_F(SimAscii, WhatIsLeftOutAtTheEndIsZero) {
  quiet_module();
  EXPECT_EQ(type("AROR 0, 300\r"), "BA 100 300\r");
  EXPECT_EQ(type("AMST\r"), "BA 100 0\r");
  EXPECT_EQ(type("AGAP 2\r"), "BA 100 0\r");
  EXPECT_EQ(type("AMVP\r"), "BA 100 0\r");
  EXPECT_EQ(type("AGAP\r"), "BA 100 0\r");
  EXPECT_EQ(type("ASIO 0, 2\r"), "BA 100 0\r");
}

TEST_F(SimAscii, ForeignLettersAndEmptyLinesAreSilence) {
  quiet_module();
  EXPECT_EQ(type("BMST 0\r"), "");
  EXPECT_EQ(type("\r\r\n7\r"), "");
  EXPECT_EQ(type("AMST 0\r"), "BA 100 0\r");
}

TEST_F(SimAscii, BinLeavesIt) {
  quiet_module();
  EXPECT_EQ(type("ABIN\r"), "BA 100 0\r");
  EXPECT_EQ(status_of(Command::GAP, 1, 0), Status::ok);
}

TEST_F(SimAscii, DatagramsAreNotUnderstoodInIt) {
  quiet_module();
  EXPECT_EQ(ask(Command::GAP, 1, 0), std::nullopt);
}

TEST_F(SimAscii, EachCharacterIsEchoed) {
  add(1110);
  enter();
  EXPECT_EQ(type("A"), "A");
  EXPECT_EQ(type("MS"), "MS");
  EXPECT_EQ(type("T 0\r"), "T 0\rBA 100 0\r");
  EXPECT_EQ(type("BMST 0\r"), "") << "nor is what is meant for others";
}

TEST_F(SimAscii, OrTheWholeLine) {
  add(1110);
  ask(Command::SGP, gp::ascii_mode, 0, 0x10);
  enter();
  EXPECT_EQ(type("AMST 0"), "");
  EXPECT_EQ(type("\r"), "AMST 0\rBA 100 0\r");
}

TEST_F(SimAscii, BackspaceTakesACharacterBack) {
  add(1110);
  enter();
  EXPECT_EQ(type("AMXX\b\x7FST 0\r"), "AMXX\b \b\b \bST 0\rBA 100 0\r");
  EXPECT_EQ(type("A\b\b\b"), "A\b \b");
  EXPECT_EQ(type("AMST 0\r"), "AMST 0\rBA 100 0\r");
}

TEST_F(SimAscii, StartsInItIfParameter67SaysSo) {
  add(1110);
  ask(Command::SGP, gp::ascii_mode, 0, 0x21);
  EXPECT_EQ(ask(Command::SOFTWARE_RESET, 0, 0, 1234)->status, Status::ok);
  pass(Module::boot_time);
  EXPECT_EQ(type("AMST 0\r"), "BA 100 0\r");
  type("ABIN\r");
  EXPECT_EQ(status_of(Command::GAP, 1, 0), Status::ok);
  ask(Command::SGP, gp::ascii_mode, 0, 0);
  ask(Command::SOFTWARE_RESET, 0, 0, 1234);
  pass(Module::boot_time);
  EXPECT_EQ(status_of(Command::GAP, 1, 0), Status::ok);
}

TEST_F(SimAscii, TheHostsLetterIsThatOfItsAddress) {
  auto& module = quiet_module(3);
  EXPECT_EQ(module.globals().byte(gp::serial_host_address), 2);
  EXPECT_EQ(type("CSGP 76, 0, 5\r"), "BC 100 5\r");
  EXPECT_EQ(type("CMST 0\r"), "EC 100 0\r");
  EXPECT_EQ(type("CSGP 66, 0, 4\r"), "EC 100 4\r");
  EXPECT_EQ(type("DMST 0\r"), "ED 100 0\r");
}

TEST_F(SimAscii, SeveralModulesShareALine) {
  quiet_module(1);
  add(1110, 2);
  EXPECT_EQ(type("AMST 0\r"), "BA 100 0\r");
  pass(milliseconds(10));
  EXPECT_EQ(ask({ModuleAddress{2}, Command::GAP, 1, 0, 0})->status, Status::ok);
}

TEST_F(SimAscii, EventsAreLinesAsWell) {
  add(1110);
  ask(Command::TARGET_REACHED_EVENT, 1, 0, 1);
  ask(Command::SGP, gp::ascii_mode, 0, 0x20);
  enter();
  type("AMVP ABS, 0, 100\r");
  heard();
  pass(std::chrono::seconds(20));
  const auto bytes = heard();
  EXPECT_EQ(std::string(bytes.begin(), bytes.end()), "BA 128 1\r");
}

TEST_F(SimAscii, WithoutALetterItStaysWithDatagrams) {
  add(1110, 27);
  EXPECT_EQ(ask({ModuleAddress{27}, Command::ENTER_ASCII_MODE, 0, 0, 0})->status,
            Status::command_not_available);
}

TEST_F(SimAscii, WaitsBeforeItsRepliesLikeInBinary) {
  quiet_module();
  type("ASGP 75, 0, 20\r");
  pass(milliseconds(20));
  EXPECT_EQ(type("AMST 0\r"), "");
  pass(milliseconds(20));
  const auto bytes = heard();
  EXPECT_EQ(std::string(bytes.begin(), bytes.end()), "BA 100 0\r");
}

TEST_F(SimAscii, ProgramsAreRunAndStopped) {
  quiet_module();
  EXPECT_EQ(type("ARUN\r"), "BA 100 0\r");
  EXPECT_EQ(type("ASTOP\r"), "BA 100 0\r");
}

}  // namespace
}  // namespace tmcl::sim
