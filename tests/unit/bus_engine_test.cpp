#include "engine/bus_engine.hpp"

#include <gmock/gmock.h>

#include "support/scripted_bus.hpp"
#include "unit/engine_requests.hpp"

namespace tmcl {
namespace {

using namespace std::chrono_literals;
using test::commands_of;
using test::Fault;
using test::gap;
using test::mst;
using test::mvp;
using test::reply_to;
using test::ScriptedBus;
using testing::ElementsAre;
using testing::HasSubstr;

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

TEST(BusEngine, ReadsThatAreNotWantedAnyMoreEndAtOnceAndThoseThatJoinedThemGoOn) {
  ScriptedBus bus;
  bus.add_module(1);
  bus.add_module(2);
  bool is_gone = false;
  CallOptions of_one_that_goes;
  of_one_that_goes.objection = [&] {
    return is_gone ? std::optional(bad_argument("it has gone")) : std::nullopt;
  };
  bus.submit(gap(1, 1));
  const auto unwanted = bus.submit(gap(1, 2), of_one_that_goes);
  const auto shared = bus.submit(gap(2, 2), of_one_that_goes);
  const auto joined = bus.submit(gap(2, 2));
  const auto movement = bus.submit(mvp(2, 100), of_one_that_goes);
  bus.run_actions();
  is_gone = true;
  bus.engine().end_unwanted_reads(bus.clock().now());
  bus.run_actions();
  for (const auto read : {unwanted, shared}) {
    ASSERT_TRUE(bus.has_ended(read));
    EXPECT_EQ(bus.result(read).error().message, "it has gone");
    EXPECT_EQ(bus.result(read).error().outcome, Outcome::not_sent);
  }
  EXPECT_FALSE(bus.has_ended(movement)) << "until its turn comes";
  bus.settle();
  EXPECT_TRUE(bus.result(joined));
  EXPECT_FALSE(bus.result(movement));
  EXPECT_THAT(bus.sent(), ElementsAre(gap(1, 1), gap(2, 2)));
}

TEST(BusEngine, AModuleWhoseRepliesAllComeTwiceEndsTheCallsThatWaitForIt) {
  ScriptedBus bus;
  bus.add_module(2);
  bus.submit(gap(1));
  const auto read = bus.submit(gap(1, 3));
  const auto movement = bus.submit(mvp(1, 100));
  const auto stop = bus.submit(mst(1, 1));
  const auto other = bus.submit(gap(2));
  constexpr std::size_t most_requests = 200;
  std::size_t answered = 0;
  bus.run_actions();
  for (int i = 0; i < 1000 && !bus.has_ended(movement); ++i) {
    // Both in one piece, as some adapters give them.
    for (; answered < std::min(bus.sent().size(), most_requests); ++answered) {
      const auto request = bus.sent()[answered];
      if (request.address != ModuleAddress{1}) continue;
      const auto once = encode_serial(reply_to(request));
      std::vector<std::uint8_t> twice(once.begin(), once.end());
      twice.insert(twice.end(), once.begin(), once.end());
      bus.engine().on_bytes(twice, bus.clock().now());
      bus.run_actions();
    }
    bus.pass(1ms);
  }
  for (const auto call : {read, movement}) {
    ASSERT_TRUE(bus.has_ended(call));
    EXPECT_EQ(bus.result(call).error().code, Errc::unexpected_value);
    EXPECT_THAT(bus.result(call).error().hint, HasSubstr("two modules have the address 1"));
  }
  EXPECT_EQ(bus.result(movement).error().outcome, Outcome::not_sent);
  EXPECT_TRUE(bus.has_ended(stop));
  EXPECT_TRUE(bus.result(other));
  EXPECT_EQ(std::ranges::count(bus.sent(), mvp(1, 100)), 0);
  EXPECT_GE(std::ranges::count(bus.sent(), mst(1, 1)), 1);
}

TEST(BusEngine, ACallIsRefusedByItsObjectionWhenItsTurnComes) {
  ScriptedBus bus;
  bus.add_module(1);
  int asked = 0;
  bool refuses = false;
  CallOptions options;
  options.objection = [&]() -> std::optional<Error> {
    ++asked;
    return refuses ? std::optional(bad_argument("not any more")) : std::nullopt;
  };
  bus.submit(gap(1));
  bus.submit(mvp(1, 100), options);
  bus.submit(mvp(1, 200), options);
  bus.run_actions();
  EXPECT_EQ(asked, 0) << "they wait";
  bus.deliver(reply_to(gap(1)));
  bus.run_actions();
  EXPECT_EQ(asked, 1);
  refuses = true;
  bus.settle();
  EXPECT_EQ(asked, 2);
  EXPECT_THAT(bus.sent(), ElementsAre(gap(1), mvp(1, 100)));
  EXPECT_TRUE(bus.result(1));
  EXPECT_EQ(bus.result(2).error().outcome, Outcome::not_sent);
  EXPECT_EQ(bus.result(2).error().message, "not any more");
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

/// How much of the line a module that does not answer takes from the others, asked all the time.
double share_of_a_silent_module(ScriptedBus& bus, Duration duration) {
  const auto begin = bus.clock().now();
  Duration waited{};
  while (bus.clock().now() < begin + duration) {
    const auto before = bus.clock().now();
    bus.submit(gap(1));
    bus.settle();
    waited += bus.clock().now() - before;
    bus.pass(10ms);
  }
  return std::chrono::duration<double>(waited) / duration;
}

TEST(BusEngine, AModuleThatStaysSilentIsAskedLess) {
  ScriptedBus bus;
  const auto first = share_of_a_silent_module(bus, 300ms);
  const auto later = share_of_a_silent_module(bus, 20s);
  EXPECT_GT(first, 0.4);
  EXPECT_LT(later, 0.25);
  bus.add_module(1);
  bus.pass(1s);
  const auto read = bus.submit(gap(1));
  bus.settle();
  EXPECT_TRUE(bus.result(read));
}

TEST(BusEngine, AModuleThatWasHeardIsSoonAskedAgainWhenItFallsSilent) {
  ScriptedBus bus;
  share_of_a_silent_module(bus, 20s);
  bus.add_module(1);
  bus.pass(1s);
  bus.submit(gap(1));
  bus.settle();
  bus.chance = [](std::size_t) { return Fault::lost_request; };
  bus.submit(gap(1));
  bus.settle();
  bus.pass(250ms);
  const auto asked = bus.sent().size();
  bus.submit(gap(1));
  bus.run_actions();
  EXPECT_GT(bus.sent().size(), asked);
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

}  // namespace
}  // namespace tmcl
