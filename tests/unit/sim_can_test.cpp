#include <gmock/gmock.h>

#include "sim_fixture.hpp"

namespace tmcl::sim {
namespace {

namespace gp = global_parameter;

using std::chrono::seconds;
using testing::IsEmpty;

class SimCan : public SimTest {
 protected:
  std::vector<CanFrame> exchange_frames(const CanFrame& frame) {
    frames();
    can.receive(frame);
    return frames();
  }
  std::optional<CanFrame> ask_frame(const CanFrame& frame) {
    const auto replies = exchange_frames(frame);
    if (replies.empty()) return std::nullopt;
    EXPECT_EQ(replies.size(), 1U);
    return replies.front();
  }
};

Request version_request(std::uint16_t address, VersionForm form) {
  return {ModuleAddress{address}, Command::GET_FIRMWARE_VERSION, static_cast<std::uint8_t>(form), 0,
          0};
}

TEST_F(SimCan, AnswersSevenBytesWithSeven) {
  add(1110);
  const auto reply = ask_frame(encode_can(version_request(1, VersionForm::binary)));
  const CanFrame expected{2, false, 7, {0x01, 0x64, 0x88, 0x04, 0x56, 0x01, 0x0D, 0}};
  EXPECT_EQ(reply, expected);
}

TEST_F(SimCan, AnswersAnyOtherLengthWithEight) {
  add(1110);
  auto request = encode_can(Request{ModuleAddress{1}, Command::GAP, 4, 0, 0});
  for (const auto length : std::to_array<std::uint8_t>({0, 3, 6, 8})) {
    request.length = length;
    request.data[7] = 0x55;
    const auto reply = ask_frame(request);
    ASSERT_TRUE(reply);
    EXPECT_EQ(reply->length, 8);
    EXPECT_EQ(reply->data[7], 0);
  }
}

TEST_F(SimCan, FindsTheBytesThatAShortFrameLacksWhereTheLastFrameWas) {
  add(3110);
  auto& other = add(1110, 5);
  ask_frame(encode_can(Request{ModuleAddress{1}, Command::SAP, 4, 2, 321}));
  ask_frame(encode_can(Request{ModuleAddress{5}, Command::SAP, 4, 0, 654}));
  auto request = encode_can(Request{ModuleAddress{1}, Command::GAP, 4, 0, 0});
  request.length = 2;
  EXPECT_EQ(decode_can_reply(*ask_frame(request))->value, 321);
  EXPECT_EQ(other.axis(0).get(axis_parameter::max_velocity), 654);
}

// The value is that of a reply: its first byte the module, then the status, the command.
TEST_F(SimCan, AModuleWhoseIdentifierIsThatOfTheRepliesExecutesThem) {
  add(1110, 1);
  auto& other = add(1110, 2);
  // ROR motor 0 to module 1 is answered with 1, 100, 1, 300: ROR motor 1. This one has no motor 1.
  EXPECT_EQ(exchange_frames(encode_can(Request{ModuleAddress{1}, Command::ROR, 0, 0, 300})).size(),
            1U);
  pass(milliseconds(100));
  const auto answers = frames();
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(decode_can_reply(answers[0])->module, 2);
  EXPECT_EQ(decode_can_reply(answers[0])->command, Command::ROR);
  EXPECT_EQ(decode_can_reply(answers[0])->status, Status::invalid_value);
  EXPECT_EQ(other.axis(0).get(axis_parameter::actual_velocity), 0);
}

TEST_F(SimCan, AForeignMotorTurnsWhereRepliesAreTakenForCommands) {
  add(1110, 1);
  auto& other = add(3110, 2);
  ask_frame(encode_can(Request{ModuleAddress{1}, Command::ROR, 0, 0, 300}));
  pass(seconds(2));
  EXPECT_EQ(other.axis(1).get(axis_parameter::actual_velocity), 300);
  EXPECT_EQ(other.axis(0).get(axis_parameter::actual_velocity), 0);
}

TEST_F(SimCan, AModuleDoesNotHearItself) {
  add(1110, 2);
  EXPECT_EQ(exchange_frames(encode_can(version_request(2, VersionForm::binary))).size(), 1U);
  pass(seconds(1));
  EXPECT_THAT(frames(), IsEmpty());
}

TEST_F(SimCan, TwoModulesAnswerEachOtherAtThePaceOfTheWire) {
  add(1110, 1);
  auto& other = add(1110, 2);
  ask_frame(encode_can(Request{ModuleAddress{2}, Command::SGP, gp::can_reply_id, 0, 1}));
  frames();
  can.receive(encode_can(version_request(1, VersionForm::binary)));
  EXPECT_EQ(frames().size(), 1U);
  pass(milliseconds(100));
  EXPECT_NEAR(static_cast<double>(frames().size()), 800, 2);
  // A clock that leaps, as when the computer was busy, is no reason for a storm.
  clock.advance(seconds(100));
  bench.run_due();
  EXPECT_LE(frames().size(), 2U);
  ask({ModuleAddress{2}, Command::SGP, gp::can_reply_id, 0, 9});
  pass(milliseconds(1));
  frames();
  pass(seconds(1));
  EXPECT_THAT(frames(), IsEmpty());
  EXPECT_EQ(other.globals().value(gp::can_reply_id), 9);
}

// Each frame is answered by two, and only one fits on the wire meanwhile.
TEST_F(SimCan, NoMoreFramesWaitThanModulesHold) {
  for (int pair = 0; pair < 2; ++pair) {
    add(1110, 1);
    add(1110, 2);
  }
  can.receive(encode_can(Request{ModuleAddress{2}, Command::SGP, gp::can_reply_id, 0, 1}));
  pass(milliseconds(100));
  frames();
  pass(milliseconds(100));
  EXPECT_NEAR(static_cast<double>(frames().size()), 800, 10);
}

TEST_F(SimCan, AnswersInTheIdentifierFormatOfTheRequest) {
  add(1110);
  const auto reply = ask_frame(encode_can(version_request(1, VersionForm::binary), true));
  ASSERT_TRUE(reply);
  EXPECT_TRUE(reply->extended);
  EXPECT_EQ(reply->id, 2U);
}

TEST_F(SimCan, CutsTheVersionTextToTheFrame) {
  add(1110);
  auto request = encode_can(version_request(1, VersionForm::text));
  EXPECT_EQ(*ask_frame(request), (CanFrame{2, false, 7, {'1', '1', '1', '0', 'V', '1', '1', 0}}));
  request.length = 8;
  EXPECT_EQ(*ask_frame(request), (CanFrame{2, false, 8, {'1', '1', '1', '0', 'V', '1', '1', '3'}}));
}

TEST_F(SimCan, IgnoresForeignIdentifiers) {
  add(1110, 5);
  EXPECT_THAT(exchange_frames(encode_can(version_request(1, VersionForm::binary))), IsEmpty());
  CanFrame far{0x12345, true, 7, {6, 1}};
  EXPECT_THAT(exchange_frames(far), IsEmpty());
}

TEST_F(SimCan, ChangesItsIdentifiersAfterTheReply) {
  add(1110);
  const auto set = [&](std::uint16_t to, std::uint8_t number, std::int32_t value) {
    return ask_frame(encode_can(Request{ModuleAddress{to}, Command::SGP, number, 0, value}));
  };
  EXPECT_EQ(set(1, gp::can_id, 0x123)->data[0], 1);
  EXPECT_FALSE(set(1, gp::can_reply_id, 0x700));
  EXPECT_EQ(set(0x123, gp::can_reply_id, 0x700)->id, 2U);
  const auto reply = set(0x123, gp::can_heartbeat, 0);
  EXPECT_EQ(reply->id, 0x700U);
  EXPECT_EQ(reply->data[0], 0x23);  // the low eight bits
}

TEST_F(SimCan, ObeysItsSecondaryIdentifierInSilence) {
  auto& module = add(1110);
  ask_frame(
      encode_can(Request{ModuleAddress{1}, Command::SGP, gp::can_secondary_address, 0, 0x40}));
  EXPECT_FALSE(ask_frame(encode_can(Request{ModuleAddress{0x40}, Command::ROR, 0, 0, 100})));
  pass(milliseconds(100));
  EXPECT_EQ(module.axis(0).get(axis_parameter::actual_velocity), 100);
}

TEST_F(SimCan, AnswersTwiceWhenTwoModulesHaveOneIdentifier) {
  add(1110);
  add(3110);
  EXPECT_EQ(exchange_frames(encode_can(version_request(1, VersionForm::binary))).size(), 2U);
}

TEST_F(SimCan, StopsTheMotorsWhenTheCanHostFallsSilent) {
  auto& module = add(1110);
  ask_frame(encode_can(Request{ModuleAddress{1}, Command::SGP, gp::can_heartbeat, 0, 100}));
  ask_frame(encode_can(Request{ModuleAddress{1}, Command::ROR, 0, 0, 1000}));
  pass(milliseconds(99));
  EXPECT_EQ(module.axis(0).get(axis_parameter::actual_velocity), 1000);
  pass(milliseconds(20));
  EXPECT_EQ(module.axis(0).get(axis_parameter::actual_velocity), 0);
}

TEST_F(SimCan, HasTheBitRateIfAskedAndIsFreeWhileModulesThink) {
  add(1110, 1);
  add(1110, 3);
  std::vector<TimePoint> heard_at;
  CanLine paced(bench, [&](const CanFrame&) { heard_at.push_back(clock.now()); },
                {.bits_per_second = 1'000'000, .to_answer = std::chrono::microseconds(400)});
  const auto begin = clock.now();
  for (const auto address : std::vector<std::uint16_t>{1, 3})
    paced.receive(encode_can(Request{ModuleAddress{address}, Command::GAP, 4, 0, 0}));
  pass(milliseconds(10));
  // Frames of seven bytes take 125 us: the second request passes while the first module thinks.
  const auto first = begin + std::chrono::microseconds(125 + 400 + 125);
  EXPECT_THAT(heard_at, testing::ElementsAre(first, first + std::chrono::microseconds(125)));
}

TEST_F(SimCan, ServesTheSameModuleAsTheSerialLine) {
  add(1110);
  ask_frame(encode_can(Request{ModuleAddress{1}, Command::SAP, 4, 0, 777}));
  EXPECT_EQ(get(4), 777);
}

}  // namespace
}  // namespace tmcl::sim
