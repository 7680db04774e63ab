#include "engine/bus_engine.hpp"

#include <gmock/gmock.h>

#include "support/scripted_bus.hpp"

namespace tmcl {
namespace {

using namespace std::chrono_literals;
using test::Fault;
using test::ScriptedBus;
using testing::ElementsAre;

Request gap(std::uint8_t module, std::uint8_t type = 1, std::uint8_t motor = 0) {
  return {ModuleAddress{module}, Command::GAP, type, motor, 0};
}
Request mvp(std::uint8_t module, std::int32_t target, std::uint8_t motor = 0) {
  return {ModuleAddress{module}, Command::MVP, 0, motor, target};
}
Request mst(std::uint8_t module, std::uint8_t motor = 0) {
  return {ModuleAddress{module}, Command::MST, 0, motor, 0};
}

Reply reply_to(const Request& request, std::int32_t value = 0) {
  return {default_host_address, reply_byte(request.address), Status::ok, request.command, value};
}

std::vector<Command> commands_of(const std::vector<Request>& requests) {
  std::vector<Command> commands;
  for (const auto& request : requests) commands.push_back(request.command);
  return commands;
}

TEST(BusEngine, SerialCarriesOneExchangeAtATime) {
  ScriptedBus bus;
  bus.submit(gap(1));
  bus.submit(gap(2));
  bus.run_actions();
  EXPECT_THAT(bus.sent(), ElementsAre(gap(1)));
  bus.deliver(reply_to(gap(1)));
  bus.run_actions();
  EXPECT_THAT(bus.sent(), ElementsAre(gap(1), gap(2)));
}

TEST(BusEngine, CanAsksSeveralModulesAtOnceButEachOnlyOneThing) {
  ScriptedBus bus(Framing::can);
  bus.submit(gap(1));
  bus.submit(gap(2));
  bus.submit(gap(1, 3));
  bus.run_actions();
  EXPECT_THAT(bus.sent(), ElementsAre(gap(1), gap(2)));
  // All replies carry the host's identifier: data byte 0 tells them apart, whatever their order.
  bus.deliver(reply_to(gap(2), 22));
  bus.deliver(reply_to(gap(1), 11));
  bus.run_actions();
  EXPECT_EQ(bus.result(0)->reply.value, 11);
  EXPECT_EQ(bus.result(1)->reply.value, 22);
  EXPECT_THAT(bus.sent(), ElementsAre(gap(1), gap(2), gap(1, 3)));
}

TEST(BusEngine, StopsGoFirstThenActsThenReads) {
  ScriptedBus bus;
  for (int address = 1; address <= 3; ++address) bus.add_module(static_cast<std::uint8_t>(address));
  bus.submit(gap(1));
  bus.submit(gap(2));
  bus.submit(mvp(3, 100));
  bus.submit(mst(2));
  bus.settle();
  EXPECT_THAT(bus.sent(), ElementsAre(gap(1), mst(2), mvp(3, 100), gap(2)));
}

TEST(BusEngine, AStopRemovesQueuedMovementsOfItsMotorOnly) {
  ScriptedBus bus;
  bus.add_module(1);
  bus.submit(gap(1));
  const auto doomed = bus.submit(mvp(1, 100));
  const auto other_motor = bus.submit(mvp(1, 100, 1));
  const auto current = bus.submit({ModuleAddress{1}, Command::SAP, 6, 0, 10});
  bus.submit(mst(1));
  bus.settle();
  ASSERT_FALSE(bus.result(doomed));
  EXPECT_EQ(bus.result(doomed).error().code, Errc::superseded_by_stop);
  EXPECT_EQ(bus.result(doomed).error().outcome, Outcome::not_sent);
  EXPECT_TRUE(bus.result(other_motor));
  EXPECT_TRUE(bus.result(current));
  EXPECT_EQ(std::ranges::count(bus.sent(), mvp(1, 100)), 0);
}

TEST(BusEngine, AStopRemovesMovementsOfSeveralMotorsIfItsOwnIsOneOfThem) {
  constexpr Request first_and_third{ModuleAddress{1}, Command::MVP, 2, 0x45, 7};
  constexpr Request second{ModuleAddress{1}, Command::MVP, 2, 0x82, 7};
  ScriptedBus bus;
  bus.add_module(1);
  bus.submit(gap(1));
  const auto doomed = bus.submit(first_and_third);
  const auto others = bus.submit(second);
  bus.submit(mst(1));
  bus.settle();
  ASSERT_FALSE(bus.result(doomed));
  EXPECT_EQ(bus.result(doomed).error().code, Errc::superseded_by_stop);
  EXPECT_TRUE(bus.result(others));
}

TEST(BusEngine, AStopGoesOutAtOnceWhenTheLineIsNotInStep) {
  ScriptedBus bus;
  bus.submit(mvp(1, 100));
  bus.pass(101ms);  // the movement was given up; the line is quiet
  const auto stop = bus.submit(mst(1));
  bus.run_actions();
  EXPECT_EQ(bus.sent().back(), mst(1));
  // It counts only when it has been proven: after the fence it goes out again.
  EXPECT_FALSE(bus.has_ended(stop));
  bus.add_module(1);
  bus.settle();
  EXPECT_TRUE(bus.result(stop));
  EXPECT_THAT(commands_of(bus.sent()),
              ElementsAre(Command::MVP, Command::MST, Command::GET_FIRMWARE_VERSION, Command::MST));
}

TEST(BusEngine, AStopToASilentModuleStillGoesOut) {
  ScriptedBus bus;
  bus.submit(gap(1));
  bus.settle();
  const auto before = bus.sent().size();
  const auto read = bus.submit(gap(1));
  bus.run_actions();
  EXPECT_EQ(bus.result(read).error().code, Errc::module_silent);
  EXPECT_EQ(bus.result(read).error().outcome, Outcome::not_sent);
  EXPECT_EQ(bus.sent().size(), before);
  const auto stop = bus.submit(mst(1));
  bus.run_actions();
  EXPECT_EQ(bus.sent().back(), mst(1));
  bus.settle();
  EXPECT_EQ(bus.result(stop).error().outcome, Outcome::unknown);
}

TEST(BusEngine, ASilentModuleCostsTheOthersOnlyTime) {
  ScriptedBus bus;
  bus.add_module(2);
  bus.submit(gap(1));
  const auto healthy = bus.submit(gap(2));
  bus.settle();
  EXPECT_EQ(bus.result(healthy)->reply.value, bus.module(2).parameter(0, 1));
}

TEST(BusEngine, ALateReplyIsNotTheAnswerToTheNextQuestion) {
  ScriptedBus bus;
  bus.add_module(1);
  bus.fail(0, Fault::late_reply);
  const auto movement = bus.submit(mvp(1, 5));
  bus.settle();
  EXPECT_EQ(bus.result(movement).error().outcome, Outcome::unknown);
  const auto next = bus.submit(mvp(1, 6));
  bus.settle();
  EXPECT_EQ(bus.result(next)->reply.value, 6);
  EXPECT_EQ(bus.counters().late_replies, 1U);
  EXPECT_EQ(bus.counters().fences, 1U);
}

TEST(BusEngine, AFenceHasACommandThatNothingAbandonedHad) {
  ScriptedBus bus;
  bus.add_module(1);
  bus.fail(0, Fault::late_reply);
  const Request version{ModuleAddress{1}, Command::GET_FIRMWARE_VERSION, 1, 0, 0};
  bus.submit(version, {.attempts = 1});
  bus.settle();
  bus.submit(gap(1));
  bus.settle();
  // 136 was abandoned and GAP is what comes next.
  EXPECT_THAT(commands_of(bus.sent()),
              ElementsAre(Command::GET_FIRMWARE_VERSION, Command::GGP, Command::GAP));
}

TEST(BusEngine, MovementsAreNeverRepeatedAndReadsAre) {
  ScriptedBus bus;
  bus.add_module(1);
  bus.fail(0, Fault::lost_request);
  const auto read = bus.submit(gap(1));
  bus.settle();
  EXPECT_TRUE(bus.result(read));
  bus.fail(bus.sent().size(), Fault::lost_request);
  const auto movement = bus.submit(mvp(1, 5));
  bus.settle();
  EXPECT_EQ(bus.result(movement).error().outcome, Outcome::unknown);
  EXPECT_EQ(std::ranges::count(bus.sent(), mvp(1, 5)), 1);
}

TEST(BusEngine, IdenticalReadsThatWaitTogetherBecomeOneExchange) {
  ScriptedBus bus;
  bus.add_module(1);
  bus.submit(gap(1, 0));
  const auto first = bus.submit(gap(1));
  const auto second = bus.submit(gap(1));
  const auto other = bus.submit(gap(1, 3));
  bus.settle();
  EXPECT_THAT(bus.sent(), ElementsAre(gap(1, 0), gap(1), gap(1, 3)));
  EXPECT_EQ(bus.result(first)->reply, bus.result(second)->reply);
  EXPECT_NE(bus.result(first)->reply, bus.result(other)->reply);
}

TEST(BusEngine, ADeadlineThatPassesInTheQueueMeansNotSent) {
  ScriptedBus bus;
  bus.submit(gap(1));
  const auto movement = bus.submit(mvp(2, 5), {.deadline = bus.clock().now() + 50ms});
  bus.pass(60ms);
  ASSERT_TRUE(bus.has_ended(movement));
  EXPECT_EQ(bus.result(movement).error().code, Errc::deadline_passed);
  EXPECT_EQ(bus.result(movement).error().outcome, Outcome::not_sent);
}

TEST(BusEngine, TheQueueIsBoundedButAStopFindsRoom) {
  ScriptedBus bus;
  for (std::size_t i = 0; i <= max_queued_calls; ++i)
    bus.submit(mvp(1, static_cast<std::int32_t>(i)));
  const auto too_many = bus.submit(mvp(1, -1));
  bus.run_actions();
  EXPECT_EQ(bus.result(too_many).error().code, Errc::queue_full);
  EXPECT_EQ(bus.result(too_many).error().outcome, Outcome::not_sent);
  const auto stop = bus.submit(mst(1, 2));
  bus.run_actions();
  EXPECT_FALSE(bus.has_ended(stop));
}

TEST(BusEngine, TwoRepliesToOneRequestAreReportedAsDuplicateAddress) {
  for (const auto framing : {Framing::serial, Framing::can}) {
    ScriptedBus bus(framing);
    bus.submit(gap(1));
    bus.run_actions();
    bus.deliver(reply_to(gap(1), 7));
    bus.deliver(reply_to(gap(1), 8));
    bus.run_actions();
    EXPECT_EQ(bus.result(0)->reply.value, 7);
    ASSERT_EQ(bus.events().size(), 1U);
    EXPECT_EQ(bus.events()[0].kind, BusEvent::Kind::duplicate_address);
    EXPECT_EQ(bus.events()[0].module, ModuleAddress{1});
    EXPECT_EQ(bus.counters().unexpected_replies, 1U);
  }
}

TEST(BusEngine, TheTargetReachedEventIsNoAnswer) {
  ScriptedBus bus;
  const Request ask{ModuleAddress{1}, Command::TARGET_REACHED_EVENT, 0, 0, 1};
  bus.submit(ask);
  bus.run_actions();
  bus.deliver({2, 1, Status::delayed, Command::TARGET_REACHED_EVENT, 1});
  bus.run_actions();
  EXPECT_FALSE(bus.has_ended(0));
  ASSERT_EQ(bus.events().size(), 1U);
  EXPECT_EQ(bus.events()[0].kind, BusEvent::Kind::target_reached);
  EXPECT_EQ(bus.events()[0].value, 1);
  bus.deliver(reply_to(ask, 1));
  bus.run_actions();
  EXPECT_TRUE(bus.has_ended(0));
}

TEST(BusEngine, TheVersionAsTextIsUnderstoodOnBothKindsOfLink) {
  const Request ask{ModuleAddress{1}, Command::GET_FIRMWARE_VERSION, 0, 0, 0};
  ScriptedBus serial;
  serial.submit(ask);
  serial.run_actions();
  const std::array<std::uint8_t, 9> text{2, '1', '1', '1', '0', 'V', '1', '0', '1'};
  serial.engine().on_bytes(text, serial.clock().now());
  serial.run_actions();
  EXPECT_EQ(serial.result(0)->version_text, (FirmwareVersion{1110, 1, 1}));

  ScriptedBus can(Framing::can);
  can.submit(ask);
  can.run_actions();
  can.engine().on_frame({2, false, 7, {'1', '1', '1', '0', 'V', '1', '0'}}, can.clock().now());
  can.run_actions();
  EXPECT_EQ(can.result(0)->version_text, (FirmwareVersion{1110, 1, 0}));
}

TEST(BusEngine, ACommandWithoutReplyIsDoneOnceItIsOut) {
  ScriptedBus bus;
  const auto reset = bus.submit({ModuleAddress{1}, Command::FACTORY_RESET, 0, 0, 1234});
  bus.run_actions();
  EXPECT_TRUE(bus.result(reset));
  EXPECT_EQ(bus.sent().size(), 1U);
}

TEST(BusEngine, ALostLinkTellsWhatMayHaveBeenExecuted) {
  ScriptedBus bus;
  const auto in_flight = bus.submit(mvp(1, 5));
  const auto queued = bus.submit(mvp(1, 6));
  bus.run_actions();
  bus.engine().on_link_lost("unplugged");
  const auto after = bus.submit(gap(1));
  bus.run_actions();
  EXPECT_EQ(bus.result(in_flight).error().outcome, Outcome::unknown);
  EXPECT_EQ(bus.result(queued).error().outcome, Outcome::not_sent);
  EXPECT_EQ(bus.result(after).error().outcome, Outcome::not_sent);
  EXPECT_EQ(bus.result(after).error().code, Errc::link_lost);
}

TEST(BusEngine, AModuleThatReceivedGarbageIsAskedAgainUnlessItIsAMovement) {
  ScriptedBus bus;
  bus.submit(gap(1));
  bus.run_actions();
  bus.deliver({2, 1, Status::wrong_checksum, Command{0}, 0});
  bus.run_actions();
  EXPECT_THAT(bus.sent(), ElementsAre(gap(1), gap(1)));
  bus.deliver(reply_to(gap(1), 3));
  bus.submit(mvp(1, 5));
  bus.run_actions();
  bus.deliver({2, 1, Status::wrong_checksum, Command{0}, 0});
  bus.run_actions();
  EXPECT_EQ(bus.result(1).error().status, Status::wrong_checksum);
  EXPECT_EQ(std::ranges::count(bus.sent(), mvp(1, 5)), 1);
}

TEST(BusEngine, TheTelegramPauseIsWaitedForOnSerialLines) {
  ScriptedBus bus(Framing::serial, {.reply_timeout = 100ms, .telegram_pause = 50ms, .attempts = 1});
  bus.submit(gap(1));
  bus.pass(149ms);
  EXPECT_FALSE(bus.has_ended(0));
  bus.pass(2ms);
  EXPECT_TRUE(bus.has_ended(0));
}

TEST(BusEngine, OnCanNoCallIsLessPatientThanTheBus) {
  for (const auto framing : {Framing::serial, Framing::can}) {
    ScriptedBus bus(framing, {.reply_timeout = 100ms});
    bus.submit(gap(1), {.reply_timeout = 10ms, .attempts = 1});
    bus.pass(11ms);
    EXPECT_EQ(bus.has_ended(0), framing == Framing::serial);
    bus.pass(90ms);
    EXPECT_TRUE(bus.has_ended(0));
  }
}

TEST(BusEngine, AnAddressThatCannotBeIsRefusedUnsent) {
  ScriptedBus serial;
  serial.submit({ModuleAddress{256}, Command::GAP, 0, 0, 0});
  serial.run_actions();
  EXPECT_EQ(serial.result(0).error().code, Errc::bad_argument);
  ScriptedBus can(Framing::can);
  can.submit({ModuleAddress{0x7FF}, Command::GAP, 0, 0, 0});
  can.submit({ModuleAddress{0x800}, Command::GAP, 0, 0, 0});
  can.run_actions();
  EXPECT_FALSE(can.has_ended(0));
  EXPECT_EQ(can.result(1).error().code, Errc::bad_argument);
}

// A read that has a deadline, is sent once or holds the module can end without an answer: whoever
// asks the same plainly does not end with it.
TEST(BusEngine, APlainReadDoesNotJoinOneThatHasLimits) {
  const std::vector<CallOptions> limits{{.deadline = TimePoint{} + 1s},
                                        {.reply_timeout = 5ms},
                                        {.attempts = 1},
                                        {.hold = std::make_shared<Hold>()}};
  for (const auto& options : limits) {
    ScriptedBus bus;
    bus.add_module(1);
    bus.submit(gap(1, 0));
    bus.submit(gap(1), options);
    bus.submit(gap(1));
    bus.settle();
    EXPECT_EQ(std::ranges::count(bus.sent(), gap(1)), 2);
  }
  ScriptedBus bus;
  bus.add_module(1);
  bus.submit(gap(2));
  const auto hasty = bus.submit(gap(1), {.deadline = bus.clock().now() + 50ms});
  const auto plain = bus.submit(gap(1));
  bus.settle();
  EXPECT_EQ(bus.result(hasty).error().code, Errc::deadline_passed);
  EXPECT_TRUE(bus.result(plain));
}

// The answer may be that of the first one: more could follow.
TEST(BusEngine, TheAnswerToAnEndThatWasSentTwiceProvesNothing) {
  ScriptedBus bus;
  bus.add_module(1);
  const auto hold = std::make_shared<Hold>();
  const Request end{ModuleAddress{1}, Command::END_DOWNLOAD, 0, 0, 0};
  bus.submit({ModuleAddress{1}, Command::START_DOWNLOAD, 0, 0, 0}, {.hold = hold});
  bus.fail(1, Fault::late_reply);
  bus.submit(end, {.hold = hold});
  bus.settle();
  const auto read = bus.submit(gap(1), {.hold = hold});
  bus.settle();
  EXPECT_TRUE(bus.result(read));
  EXPECT_THAT(commands_of(bus.sent()),
              ElementsAre(Command::START_DOWNLOAD, Command::END_DOWNLOAD, Command::END_DOWNLOAD,
                          Command::GET_FIRMWARE_VERSION, Command::GAP));
}

// ---- a link that takes nothing now

/// Takes so many datagrams at once, and one more each millisecond.
void give_queue(ScriptedBus& bus, std::size_t room) {
  const auto begin = bus.clock().now();
  const auto taken = std::make_shared<std::size_t>(0);
  bus.takes = [&bus, begin, room, taken](const Request&) {
    const auto drained = static_cast<std::size_t>((bus.clock().now() - begin) / 1ms);
    return *taken < room + drained && ++*taken > 0;
  };
}

/// Takes nothing until then.
void stick_until(ScriptedBus& bus, TimePoint then) {
  bus.takes = [&bus, then](const Request&) { return bus.clock().now() >= then; };
}

TEST(FullLink, SixteenStopsToSixteenModulesAreAllExecuted) {
  ScriptedBus bus(Framing::can);
  give_queue(bus, 10);
  for (std::uint8_t address = 1; address <= 16; ++address) {
    bus.add_module(address);
    bus.submit(mst(address));
  }
  bus.settle();
  for (std::uint8_t address = 1; address <= 16; ++address) {
    EXPECT_TRUE(bus.result(address - 1U)) << int{address};
    EXPECT_THAT(bus.module(address).executed(), ElementsAre(mst(address)));
  }
  EXPECT_EQ(bus.counters().requests, 16U);
  EXPECT_LT(bus.clock().now() - TimePoint{}, 50ms);
}

TEST(FullLink, WhatWasRefusedGoesOutInTheOrderInWhichItCame) {
  ScriptedBus bus(Framing::can);
  for (std::uint8_t address = 1; address <= 4; ++address) bus.add_module(address);
  give_queue(bus, 1);
  bus.submit(gap(4));
  bus.submit(mvp(1, 10));
  bus.submit(mvp(1, 20));
  bus.submit(mvp(2, 10));
  bus.submit(mvp(3, 10));
  bus.submit(mst(4));
  bus.settle();
  std::vector<Request> movements;
  std::ranges::copy_if(bus.sent(), std::back_inserter(movements), [](const Request& request) {
    return request.command == Command::MVP && request.value == 10;
  });
  EXPECT_THAT(movements, ElementsAre(mvp(1, 10), mvp(2, 10), mvp(3, 10)));
  EXPECT_THAT(bus.module(1).executed(), ElementsAre(mvp(1, 10), mvp(1, 20)));
}

TEST(FullLink, AStopIsTriedForTwoSecondsAndThenSaysThatItWasNotSent) {
  for (const auto framing : {Framing::serial, Framing::can}) {
    ScriptedBus bus(framing);
    bus.add_module(1);
    stick_until(bus, TimePoint::max());
    const auto late = bus.submit(mst(1));
    bus.pass(1900ms);
    EXPECT_FALSE(bus.has_ended(late));
    bus.pass(200ms);
    ASSERT_TRUE(bus.has_ended(late));
    EXPECT_EQ(bus.result(late).error().code, Errc::queue_full);
    EXPECT_EQ(bus.result(late).error().outcome, Outcome::not_sent);
    const auto in_time = bus.submit(mst(1));
    stick_until(bus, bus.clock().now() + 1900ms);
    bus.settle();
    EXPECT_TRUE(bus.result(in_time));
    EXPECT_EQ(bus.counters().requests, 1U);
  }
}

TEST(FullLink, StopsOnASerialLineWaitTogetherAndNotOneAfterTheOther) {
  ScriptedBus bus;
  stick_until(bus, TimePoint::max());
  for (std::uint8_t address = 1; address <= 16; ++address) bus.submit(mst(address));
  bus.settle();
  EXPECT_LT(bus.clock().now() - TimePoint{}, 2100ms);
}

TEST(FullLink, AnOrdinaryCallIsTriedAsLongAsAnAnswerIsWaitedFor) {
  for (const auto framing : {Framing::serial, Framing::can}) {
    for (const auto& request : {gap(1), mvp(1, 5)}) {
      ScriptedBus bus(framing);
      bus.add_module(1);
      stick_until(bus, bus.clock().now() + 90ms);
      const auto in_time = bus.submit(request);
      bus.settle();
      EXPECT_TRUE(bus.result(in_time));

      stick_until(bus, TimePoint::max());
      const auto begin = bus.clock().now();
      const auto late = bus.submit(request);
      bus.settle();
      EXPECT_EQ(bus.result(late).error().code, Errc::queue_full);
      EXPECT_EQ(bus.result(late).error().outcome, Outcome::not_sent);
      EXPECT_LT(bus.clock().now() - begin, 110ms);
      EXPECT_EQ(bus.sent().size(), 1U);
    }
  }
}

TEST(FullLink, ADeadlineHoldsThereToo) {
  ScriptedBus bus(Framing::can);
  stick_until(bus, TimePoint::max());
  const auto movement = bus.submit(mvp(1, 5), {.deadline = bus.clock().now() + 20ms});
  bus.pass(21ms);
  ASSERT_TRUE(bus.has_ended(movement));
  EXPECT_EQ(bus.result(movement).error().code, Errc::deadline_passed);
  EXPECT_EQ(bus.result(movement).error().outcome, Outcome::not_sent);
}

TEST(FullLink, TheAdviceIsAboutTheLinkThatItIs) {
  for (const auto framing : {Framing::serial, Framing::can}) {
    ScriptedBus bus(framing);
    stick_until(bus, TimePoint::max());
    bus.submit(gap(1));
    bus.settle();
    const auto text = describe(bus.result(0).error());
    EXPECT_EQ(text.find("txqueuelen") != std::string::npos, framing == Framing::can) << text;
    EXPECT_EQ(text.find("adapter") != std::string::npos, framing == Framing::serial) << text;
  }
}

TEST(FullLink, AMovementThatWaitsForItIsRemovedByAStop) {
  ScriptedBus bus(Framing::can);
  bus.add_module(1);
  stick_until(bus, bus.clock().now() + 50ms);
  const auto movement = bus.submit(mvp(1, 5));
  bus.pass(10ms);
  const auto stop = bus.submit(mst(1));
  bus.settle();
  EXPECT_EQ(bus.result(movement).error().code, Errc::superseded_by_stop);
  EXPECT_EQ(bus.result(movement).error().outcome, Outcome::not_sent);
  EXPECT_TRUE(bus.result(stop));
  EXPECT_THAT(bus.module(1).executed(), ElementsAre(mst(1)));
}

TEST(FullLink, AMovementThatIsRefusedWhenAStopWaitsAlreadyIsRemovedToo) {
  ScriptedBus bus(Framing::can);
  bus.add_module(1);
  stick_until(bus, bus.clock().now() + 50ms);
  const auto movement = bus.submit(mvp(1, 5));
  const auto stop = bus.submit(mst(1));
  bus.settle();
  EXPECT_EQ(bus.result(movement).error().code, Errc::superseded_by_stop);
  EXPECT_EQ(bus.result(movement).error().outcome, Outcome::not_sent);
  EXPECT_TRUE(bus.result(stop));
  EXPECT_THAT(bus.module(1).executed(), ElementsAre(mst(1)));
}

TEST(FullLink, ARepeatThatIsRefusedDoesNotEndAStop) {
  for (const auto framing : {Framing::serial, Framing::can}) {
    ScriptedBus bus(framing);
    bus.add_module(1);
    bus.fail(0, Fault::lost_request);
    const auto stop = bus.submit(mst(1));
    bus.pass(50ms);
    ASSERT_EQ(bus.sent().size(), 1U);
    // The shout goes out, and the fence; the stop that would be proven is refused.
    bus.takes = [&, then = bus.clock().now() + 1s, stops = 0](const Request& request) mutable {
      return request != mst(1) || stops++ == 0 || bus.clock().now() >= then;
    };
    bus.settle();
    EXPECT_TRUE(bus.result(stop));
    EXPECT_GE(std::ranges::count(bus.module(1).executed(), mst(1)), 1);
  }
}

TEST(FullLink, AStopThatWentOutOnceAndNeverAgainMayHaveBeenExecuted) {
  ScriptedBus bus;
  bus.fail(0, Fault::lost_reply);
  const auto stop = bus.submit(mst(1));
  bus.pass(50ms);
  stick_until(bus, TimePoint::max());
  bus.settle();
  EXPECT_EQ(bus.result(stop).error().code, Errc::queue_full);
  EXPECT_EQ(bus.result(stop).error().outcome, Outcome::unknown);
}

// Out of step, a stop goes out at once, unproven, before it does so provably.
TEST(FullLink, AShoutThatIsRefusedWasNotSent) {
  for (const bool comes_back : {false, true}) {
    ScriptedBus bus;
    bus.submit(gap(1), {.attempts = 1});
    bus.pass(101ms);
    bus.add_module(1);
    const auto before = bus.counters().requests;
    stick_until(bus, comes_back ? bus.clock().now() + 50ms : TimePoint::max());
    const auto stop = bus.submit(mst(1));
    bus.settle();
    if (comes_back) {
      EXPECT_TRUE(bus.result(stop));
      EXPECT_THAT(
          commands_of(bus.sent()),
          ElementsAre(Command::GAP, Command::MST, Command::GET_FIRMWARE_VERSION, Command::MST));
    } else {
      EXPECT_EQ(bus.result(stop).error().outcome, Outcome::not_sent);
      EXPECT_EQ(bus.counters().requests, before);
      EXPECT_EQ(bus.sent().size(), 1U);
    }
  }
}

TEST(FullLink, ACommandWithoutReplyIsDoneOnlyWhenItIsOut) {
  const Request reset{ModuleAddress{1}, Command::FACTORY_RESET, 0, 0, 1234};
  ScriptedBus bus;
  stick_until(bus, TimePoint::max());
  const auto never = bus.submit(reset);
  bus.settle();
  EXPECT_EQ(bus.result(never).error().outcome, Outcome::not_sent);
  stick_until(bus, bus.clock().now() + 50ms);
  const auto later = bus.submit(reset);
  bus.settle();
  EXPECT_TRUE(bus.result(later));
  EXPECT_THAT(bus.sent(), ElementsAre(reset));
}

// What a module records must not go out when the download has ended.
TEST(FullLink, ALineOfAProgramThatWaitsForItEndsWithTheDownload) {
  ScriptedBus bus;
  bus.add_module(1);
  const auto hold = std::make_shared<Hold>();
  bus.submit({ModuleAddress{1}, Command::START_DOWNLOAD, 0, 0, 0}, {.hold = hold});
  bus.settle();
  stick_until(bus, bus.clock().now() + 50ms);
  const auto line = bus.submit(mvp(1, 5), {.hold = hold, .is_program_line = true});
  bus.pass(10ms);
  const auto stop = bus.submit(mst(1));
  bus.settle();
  EXPECT_EQ(bus.result(line).error().code, Errc::superseded_by_stop);
  EXPECT_EQ(bus.result(line).error().outcome, Outcome::not_sent);
  EXPECT_TRUE(bus.result(stop));
  EXPECT_THAT(commands_of(bus.sent()),
              ElementsAre(Command::START_DOWNLOAD, Command::END_DOWNLOAD, Command::MST));
}

// ---- more replies than were asked for

/// Another program's question is answered now.
void answer_another(ScriptedBus& bus, std::int32_t value) { bus.deliver(reply_to(gap(1), value)); }

/// The bus has noticed that somebody else asks.
void make_suspicious(ScriptedBus& bus) {
  bus.run(verbs::get({ModuleAddress{1}, 0}, 4));
  for (int i = 0; i < 3; ++i) {
    bus.pass(20ms);
    answer_another(bus, 0);
  }
  bus.run_actions();
  ASSERT_EQ(bus.events().size(), 1U);
}

TEST(SurplusReplies, AreReportedWithBothOfTheirCauses) {
  ScriptedBus bus(Framing::can);
  bus.add_module(1);
  make_suspicious(bus);
  const auto& event = bus.events()[0];
  EXPECT_EQ(event.kind, BusEvent::Kind::duplicate_address);
  EXPECT_THAT(event.text, testing::HasSubstr("two modules have the address 1"));
  EXPECT_THAT(event.text, testing::HasSubstr("another program asks on this bus"));
}

// One is what another program may have left behind, and two more can be that of two others.
TEST(SurplusReplies, AFewOverALongTimeMeanNothing) {
  ScriptedBus bus(Framing::can);
  bus.add_module(1);
  bus.run(verbs::get({ModuleAddress{1}, 0}, 4));
  for (int i = 0; i < 20; ++i) {
    bus.pass(6s);
    answer_another(bus, 0);
  }
  bus.run_actions();
  EXPECT_TRUE(bus.events().empty());
}

TEST(SurplusReplies, AreToldOnceUntilTheyHaveStayedAwayForAMinute) {
  ScriptedBus bus(Framing::can);
  bus.add_module(1);
  make_suspicious(bus);
  for (int i = 0; i < 10; ++i) {
    bus.pass(50s);
    answer_another(bus, 0);
  }
  bus.run_actions();
  EXPECT_EQ(bus.events().size(), 1U);
  bus.pass(61s);
  const auto trusted = bus.submit(gap(1));
  bus.settle();
  EXPECT_FALSE(bus.result(trusted)->duplicate_suspected);
  bus.deliver(reply_to(gap(1)));
  bus.run_actions();
  EXPECT_EQ(bus.events().size(), 2U);
}

TEST(SurplusReplies, NoForeignValueIsGivenOutOnceTheyAreSuspected) {
  for (const auto framing : {Framing::serial, Framing::can}) {
    for (const auto before : {0us, 500us, 1500us}) {
      ScriptedBus bus(framing);
      bus.add_module(1);
      make_suspicious(bus);
      const auto right = bus.module(1).parameter(0, 1);
      // Each second question of ours meets an answer to somebody else's.
      int questions = 0;
      bus.chance = [&](std::size_t number) -> std::optional<Fault> {
        if (bus.sent()[number] == gap(1) && questions++ % 2 == 0) answer_another(bus, 777);
        return std::nullopt;
      };
      for (int i = 0; i < 50; ++i) {
        const auto read = bus.submit(gap(1));
        bus.pass(before);
        bus.settle();
        ASSERT_TRUE(bus.result(read));
        EXPECT_EQ(bus.result(read)->reply.value, right);
        EXPECT_TRUE(bus.result(read)->duplicate_suspected);
      }
    }
  }
}

TEST(SurplusReplies, AForeignRefusalIsNotGivenOutEither) {
  ScriptedBus bus(Framing::can);
  bus.add_module(1);
  make_suspicious(bus);
  int questions = 0;
  bus.chance = [&](std::size_t number) -> std::optional<Fault> {
    if (bus.sent()[number] == gap(1) && questions++ == 0)
      bus.deliver({2, 1, Status::wrong_type, Command::GAP, 0});
    return std::nullopt;
  };
  const auto read = bus.submit(gap(1));
  bus.settle();
  EXPECT_EQ(bus.result(read)->reply.value, bus.module(1).parameter(0, 1));
}

TEST(SurplusReplies, AValueThatCannotBeProvenIsAnError) {
  ScriptedBus bus(Framing::can);
  bus.add_module(1);
  make_suspicious(bus);
  bus.chance = [&](std::size_t) -> std::optional<Fault> {
    answer_another(bus, 777);
    return std::nullopt;
  };
  const auto read = bus.submit(gap(1));
  bus.settle();
  ASSERT_FALSE(bus.result(read));
  EXPECT_EQ(bus.result(read).error().code, Errc::unexpected_value);
  EXPECT_THAT(describe(bus.result(read).error()), testing::HasSubstr("another program asks"));
  EXPECT_LT(bus.sent().size(), 20U);
}

// A value that waits for its proof was read before the second question was asked.
TEST(SurplusReplies, AValueThatWaitsForItsProofIsNoAnswerToALaterQuestion) {
  ScriptedBus bus(Framing::can);
  bus.add_module(1);
  make_suspicious(bus);
  std::optional<engine::Ticket> second;
  bus.chance = [&](std::size_t number) -> std::optional<Fault> {
    const bool is_fence = bus.sent()[number].command == Command::GET_FIRMWARE_VERSION;
    if (is_fence && !second && number > 2) {
      bus.module(1).parameter(0, 1) = 4321;
      second = bus.submit(gap(1));
    }
    return std::nullopt;
  };
  bus.submit(gap(1));
  bus.settle();
  ASSERT_TRUE(second);
  EXPECT_EQ(bus.result(*second)->reply.value, 4321);
}

TEST(SurplusReplies, StopsAndMovementsGoOutOnce) {
  ScriptedBus bus(Framing::can);
  bus.add_module(1);
  make_suspicious(bus);
  const auto settled = bus.submit(gap(1));
  bus.settle();
  EXPECT_TRUE(bus.result(settled));
  const auto before = bus.sent().size();
  bus.submit(mvp(1, 7));
  bus.settle();
  bus.submit(mst(1));
  bus.settle();
  const std::vector<Request> since(bus.sent().begin() + static_cast<std::ptrdiff_t>(before),
                                   bus.sent().end());
  EXPECT_THAT(since, ElementsAre(mvp(1, 7), mst(1)));
}

// ---- reports of arrivals

TEST(ArrivalReports, ComeFromModulesThatWereSpokenToOnly) {
  ScriptedBus bus(Framing::can);
  const Reply arrival{2, 1, Status::delayed, Command::TARGET_REACHED_EVENT, 1};
  bus.deliver(arrival);
  bus.run_actions();
  EXPECT_TRUE(bus.events().empty());
  EXPECT_EQ(bus.counters().unexpected_replies, 1U);
  // On CAN a reply has only the low byte of the module's address.
  bus.submit({ModuleAddress{257}, Command::GAP, 1, 0, 0});
  bus.run_actions();
  bus.deliver(arrival);
  bus.run_actions();
  ASSERT_EQ(bus.events().size(), 1U);
  EXPECT_EQ(bus.events()[0].module, ModuleAddress{257});
}

}  // namespace
}  // namespace tmcl
