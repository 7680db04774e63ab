#include <gmock/gmock.h>

#include "sim_fixture.hpp"

namespace tmcl::sim {
namespace {

namespace gp = global_parameter;

using SimSerial = SimTest;
using testing::ElementsAre;
using testing::IsEmpty;

const Bytes ask_version{0x01, 0x88, 0x01, 0, 0, 0, 0, 0, 0x8A};
const Bytes version{0x02, 0x01, 0x64, 0x88, 0x04, 0x56, 0x01, 0x0D, 0x57};

TEST_F(SimSerial, AnswersTheGoldenFrames) {
  add(1110);
  EXPECT_EQ(exchange(ask_version), version);
  EXPECT_EQ(exchange({0x01, 0x88, 0, 0, 0, 0, 0, 0, 0x89}),
            (Bytes{0x02, '1', '1', '1', '0', 'V', '1', '1', '3'}));
  EXPECT_EQ(exchange({0x01, 0x06, 0x01, 0, 0, 0, 0, 0, 0xFF}),
            (Bytes{0x02, 0x01, 0x01, 0, 0, 0, 0, 0, 0x04}));
  EXPECT_EQ(exchange({0x01, 0x06, 0x01, 0, 0, 0, 0, 0, 0x08}),
            (Bytes{0x02, 0x01, 0x64, 0x06, 0, 0, 0, 0, 0x6D}));
}

TEST_F(SimSerial, DoesNotCareHowTheBytesAreCut) {
  add(1110);
  for (const auto byte : ask_version) {
    line.receive(std::span(&byte, 1));
    clock.advance(milliseconds(4));
  }
  EXPECT_EQ(heard(), version);
  Bytes twice = ask_version;
  twice.insert(twice.end(), ask_version.begin(), ask_version.end());
  EXPECT_EQ(exchange(twice).size(), 18U);
}

TEST_F(SimSerial, BeginsAnewAfterFiveMillisecondsOfSilence) {
  add(1110);
  line.receive(Bytes{0x01, 0x06, 0x01});
  clock.advance(milliseconds(5));
  line.receive(Bytes{0, 0, 0, 0, 0, 0x08});
  EXPECT_EQ(heard().size(), 9U);  // exactly 5 ms is still one datagram
  line.receive(Bytes{0x01, 0x06, 0x01});
  clock.advance(milliseconds(5) + std::chrono::microseconds(1));
  EXPECT_EQ(exchange(ask_version), version);
}

TEST_F(SimSerial, StaysOutOfStepWithoutSilence) {
  add(1110);
  Bytes shifted{0x01};
  shifted.insert(shifted.end(), ask_version.begin(), ask_version.end());
  const auto reply = reply_in(exchange(shifted));
  EXPECT_EQ(reply->status, Status::wrong_checksum);
  clock.advance(milliseconds(6));
  EXPECT_EQ(exchange(ask_version), version);
}

TEST_F(SimSerial, IgnoresForeignAddressesEvenWithAWrongChecksum) {
  add(1110, 3);
  EXPECT_THAT(exchange(ask_version), IsEmpty());
  EXPECT_THAT(exchange({0x01, 0x06, 0x01, 0, 0, 0, 0, 0, 0xFF}), IsEmpty());
  EXPECT_EQ(ask({ModuleAddress{3}, Command::GET_FIRMWARE_VERSION, 1, 0, 0})->module, 3);
}

TEST_F(SimSerial, DoesNotExecuteWhatCameWithAWrongChecksum) {
  auto& module = add(1110);
  auto bytes = encode_serial(Request{ModuleAddress{1}, Command::ROR, 0, 0, 1000});
  ++bytes[8];
  line.receive(bytes);
  pass(milliseconds(100));
  EXPECT_EQ(module.axis(0).get(axis_parameter::actual_velocity), 0);
}

TEST_F(SimSerial, LetsSeveralModulesShareALine) {
  add(1110, 1);
  add(6110, 2);
  EXPECT_EQ(ask({ModuleAddress{1}, Command::GET_FIRMWARE_VERSION, 1, 0, 0})->value >> 16, 1110);
  EXPECT_EQ(ask({ModuleAddress{2}, Command::GET_FIRMWARE_VERSION, 1, 0, 0})->value >> 16, 6110);
  EXPECT_FALSE(ask({ModuleAddress{3}, Command::GET_FIRMWARE_VERSION, 1, 0, 0}));
}

TEST_F(SimSerial, AnswersTwiceWhenTwoModulesHaveOneAddress) {
  add(1110);
  add(1110);
  EXPECT_EQ(exchange(ask_version).size(), 18U);
}

TEST_F(SimSerial, PausesBeforeItAnswersIfToldTo) {
  add(1110);
  ask(Command::SGP, gp::telegram_pause_time, 0, 15);
  pass(milliseconds(15));
  EXPECT_THAT(exchange(ask_version), IsEmpty());
  pass(milliseconds(14));
  EXPECT_THAT(heard(), IsEmpty());
  pass(milliseconds(1));
  EXPECT_EQ(heard(), version);
  EXPECT_EQ(bench.next_due(), never);
}

// Its number is another one on the TMCM-6214.
TEST_F(SimSerial, ObeysItsSecondaryAddressInSilence) {
  auto& first = add(1110, 1);
  auto& second = add(6214, 2);
  ask({ModuleAddress{1}, Command::SGP, gp::serial_secondary_address, 0, 100});
  ask({ModuleAddress{2}, Command::SGP, 86, 0, 100});
  EXPECT_FALSE(ask({ModuleAddress{100}, Command::ROR, 0, 0, 500}));
  pass(milliseconds(100));
  EXPECT_EQ(first.axis(0).get(axis_parameter::actual_velocity), 500);
  EXPECT_EQ(second.axis(0).get(axis_parameter::actual_velocity), 500);
}

TEST_F(SimSerial, HasNoSecondaryAddressAtFirst) {
  add(1110);
  EXPECT_FALSE(ask({ModuleAddress{0}, Command::GAP, 1, 0, 0}));
}

TEST_F(SimSerial, ChangesItsAddressesAfterTheReply) {
  add(1110);
  EXPECT_EQ(ask(Command::SGP, gp::serial_address, 0, 9)->module, 1);
  EXPECT_FALSE(ask(Command::GAP, 1, 0));
  const auto ninth = [](Command command, std::uint8_t type, std::int32_t value) {
    return Request{ModuleAddress{9}, command, type, 0, value};
  };
  EXPECT_EQ(ask(ninth(Command::GAP, 1, 0))->module, 9);
  EXPECT_EQ(ask(ninth(Command::SGP, gp::serial_host_address, 7))->host, 2);
  EXPECT_EQ(ask(ninth(Command::GAP, 1, 0))->host, 7);
}

TEST_F(SimSerial, AnswersAProbeOfZerosOnlyAtAddressZero) {
  add(1110);
  EXPECT_THAT(exchange(Bytes(9, 0)), IsEmpty());
  ask(Command::SGP, gp::serial_address, 0, 0);
  EXPECT_EQ(reply_in(exchange(Bytes(9, 0)))->status, Status::invalid_command);
}

TEST_F(SimSerial, HasTheBaudRateAndTheModulesOwnTimeIfAsked) {
  add(1110);
  Bytes replies;
  SerialLine paced(bench,
                   [&](auto bytes) { replies.insert(replies.end(), bytes.begin(), bytes.end()); },
                   {.pace = {.bits_per_second = 9600, .to_answer = milliseconds(1)}});
  paced.receive(ask_version);
  // Twice nine bytes of ten bits at 9600 baud, and a millisecond.
  pass(milliseconds(19) + std::chrono::microseconds(749));
  EXPECT_THAT(replies, IsEmpty());
  pass(std::chrono::microseconds(1));
  EXPECT_EQ(replies, version);
}

TEST_F(SimSerial, APacedLineDropsADatagramThatSilenceCutsInTwo) {
  add(1110);
  Bytes replies;
  SerialLine paced(bench,
                   [&](auto bytes) { replies.insert(replies.end(), bytes.begin(), bytes.end()); },
                   {.pace = {.bits_per_second = 115'200}});
  paced.receive(std::span(ask_version).first(4), clock.now());
  pass(milliseconds(6));
  paced.receive(std::span(ask_version).subspan(4), clock.now());
  pass(milliseconds(6));
  EXPECT_THAT(replies, IsEmpty());
  paced.receive(ask_version, clock.now());
  pass(milliseconds(6));
  EXPECT_EQ(replies, version);
}

TEST_F(SimSerial, SurvivesAnythingThatComes) {
  add(6110);
  std::uint32_t random = 1;
  for (int i = 0; i < 200'000; ++i) {
    random = random * 1664525U + 1013904223U;
    const auto byte = static_cast<std::uint8_t>(random >> 24U);
    line.receive(std::span(&byte, 1));
    if (byte == 7) clock.advance(milliseconds(6));
  }
  pass(milliseconds(300));
  EXPECT_EQ(heard().size() % 9, 0U);
}

}  // namespace
}  // namespace tmcl::sim
