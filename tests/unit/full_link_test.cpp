// A link that takes nothing for a while: what it refuses is tried again, a stop longest of all.
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
    // The early stop goes out, and the fence; the stop that would be proven is refused.
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

}  // namespace
}  // namespace tmcl
