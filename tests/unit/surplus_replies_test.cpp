// Replies that nobody asked for: who is told, and what is believed meanwhile.
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

/// The module, or a converter before it, stands still until then, and answers everything after it.
void stand_still(ScriptedBus& bus, Duration pause) {
  const auto until = bus.clock().now() + pause;
  bus.ways = [&bus, until, n = 0](std::size_t) mutable -> std::vector<Duration> {
    const auto now = bus.clock().now();
    if (now >= until) return {1ms};
    return {until - now + ++n * 1ms};
  };
}

TEST(LateReplies, AfterAPauseAreNoSecondModule) {
  for (const auto framing : {Framing::serial, Framing::can}) {
    for (const Duration pause : {Duration(1s), Duration(3s), Duration(7s), Duration(3min)}) {
      ScriptedBus bus(framing);
      bus.add_module(1);
      bus.run(verbs::get({ModuleAddress{1}, 0}, 4));
      stand_still(bus, pause);
      const auto begin = bus.clock().now();
      while (bus.clock().now() - begin < pause) {
        bus.submit(gap(1));
        bus.submit({ModuleAddress{1}, Command::GAP, 3, 0, 0});
        bus.pass(700ms);
      }
      bus.submit(mst(1));
      bus.pass(5s);
      EXPECT_TRUE(bus.events().empty()) << pause.count();
      EXPECT_EQ(bus.counters().surplus, 0U) << pause.count();
      EXPECT_GT(bus.counters().late_replies, 0U);
      const auto read = bus.submit(gap(1));
      bus.settle();
      EXPECT_EQ(bus.result(read)->reply.value, bus.module(1).parameter(0, 1));
      EXPECT_FALSE(bus.result(read)->duplicate_suspected);
    }
  }
}

TEST(LateReplies, BeyondThoseThatWereGivenUpAreOfASecondModule) {
  ScriptedBus bus(Framing::can);
  bus.add_module(1);
  bus.run(verbs::get({ModuleAddress{1}, 0}, 4));
  bus.fail(bus.sent().size(), Fault::lost_request);
  bus.submit(gap(1), {.attempts = 1});
  bus.settle();
  bus.pass(20s);
  make_suspicious(bus);
}

// A value that waits for its proof was read before the second question was asked.
TEST(SurplusReplies, AValueThatWaitsForItsProofIsNoAnswerToALaterQuestion) {
  ScriptedBus bus(Framing::can);
  bus.add_module(1);
  make_suspicious(bus);
  std::optional<engine::Ticket> second;
  bus.chance = [&](std::size_t number) -> std::optional<Fault> {
    const bool is_fence = bus.sent()[number].command != Command::GAP;
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
