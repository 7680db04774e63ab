// An answer belongs to its question: what comes twice, too late or in another order is nobody's.
#include <array>
#include <deque>
#include <random>

#include <gmock/gmock.h>

#include "bus/bus_core.hpp"
#include "engine/bus_engine.hpp"
#include "support/scripted_bus.hpp"
#include "support/seed.hpp"
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

using Random = std::mt19937_64;

/// Of a line on which replies come twice, or late and past each other.
struct Line {
  unsigned doubled_percent = 0;
  Duration doubled_within{};  ///< After the first.
  unsigned late_percent = 0;
  Duration late_from{}, late_to{};
  unsigned lost_percent = 0;
};

std::function<std::vector<Duration>(std::size_t)> ways_of(const Line& line, Random& random) {
  const auto between = [&random](Duration from, Duration to) {
    return from + Duration(random() % static_cast<std::uint64_t>((to - from).count() + 1));
  };
  return [=, &random](std::size_t) -> std::vector<Duration> {
    constexpr Duration usual = 1ms;
    if (random() % 100 < line.lost_percent) return {};
    if (random() % 100 < line.late_percent) return {between(line.late_from, line.late_to)};
    if (random() % 100 >= line.doubled_percent) return {usual};
    return {usual, usual + between(Duration{}, line.doubled_within)};
  };
}

/// Reads of any parameter of three motors, so many of them waiting at a time; how many of their
/// values belong to another question.
std::size_t wrong_reads(ScriptedBus& bus, Random& random, std::size_t waiting, std::size_t reads) {
  struct Asked {
    engine::Ticket ticket;
    std::int32_t expected;
  };
  std::deque<Asked> asked;
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < reads + waiting; ++i) {
    if (asked.size() == waiting || i >= reads) {
      if (asked.empty()) break;
      bus.settle({asked.front().ticket});
      const auto& result = bus.result(asked.front().ticket);
      if (result && result->reply.value != asked.front().expected) ++wrong;
      asked.pop_front();
    }
    if (i >= reads) continue;
    // Reads that wait together differ: equal ones would be one exchange, and be counted twice.
    const auto type = static_cast<std::uint8_t>(i % 100);
    const auto motor = static_cast<std::uint8_t>(random() % 3);
    asked.push_back({bus.submit(gap(1, type, motor)), bus.module(1).parameter(motor, type)});
  }
  return wrong;
}

/// Before a line is known to give more replies than it is asked for, so many reads in a row can
/// get the value of the one before.
constexpr std::size_t most_unnoticed = 64;

class DoubledReplies : public testing::TestWithParam<Framing> {};

TEST_P(DoubledReplies, AreTheAnswerToOneQuestionOnceTheyWereNoticed) {
  for (const auto within : {Duration{}, Duration(200us), Duration(3ms)}) {
    Random random(test::seed());
    ScriptedBus bus(GetParam());
    bus.add_module(1);
    bus.ways = ways_of({.doubled_percent = 1, .doubled_within = within}, random);
    EXPECT_LE(wrong_reads(bus, random, 8, 2000), most_unnoticed);
    EXPECT_EQ(wrong_reads(bus, random, 8, 6000), 0U);
  }
}

TEST_P(DoubledReplies, SendNoRelativeMoveAnywhereElse) {
  Random random(test::seed());
  ScriptedBus bus(GetParam());
  auto& module = bus.add_module(1);
  bus.ways = ways_of({.doubled_percent = 2, .doubled_within = 3ms}, random);
  std::size_t wrong = 0;
  for (int i = 0; i < 500; ++i) {
    module.parameter(0, 1) = 0;
    bus.submit(gap(1, 4));
    bus.submit(gap(1, 5, 1));
    const auto target = bus.run(verbs::move_by({ModuleAddress{1}, 0}, Microsteps{10}));
    if (target && target->value != 10) ++wrong;
    if (module.parameter(0, 0) != 10 && target) ++wrong;
    bus.pass(std::chrono::milliseconds(random() % 5));
  }
  EXPECT_EQ(wrong, 0U);
}

/// The module says these positions, one after the other, and the last one from then on.
Result<Microsteps> move_from(std::vector<std::int32_t> positions, ScriptedBus& bus) {
  auto& module = bus.add_module(1);
  std::size_t next = 0;
  module.play = [&](const Request& request) -> std::optional<Reply> {
    if (request.command != Command::GAP || request.type != 1) return std::nullopt;
    const auto position = positions[std::min(next++, positions.size() - 1)];
    return Reply{default_host_address, 1, Status::ok, Command::GAP, position};
  };
  return bus.run(verbs::move_by({ModuleAddress{1}, 0}, Microsteps{10}));
}

// Of an axis that moves no two readings are the same; what answers another question stands out.
TEST_P(DoubledReplies, LeadNoAxisThatMovesAnywhereElse) {
  const std::vector<std::vector<std::int32_t>> all{{0, 30, 60},
                                                   {0, 30, 500'000, 90, 120, 150},
                                                   {500'000, 30, 60, 90},
                                                   {0, 500'000, 60, 90, 120}};
  for (const auto& positions : all) {
    ScriptedBus bus(GetParam());
    EXPECT_EQ(move_from(positions, bus), Microsteps{positions.back() + 10});
  }
}

TEST_P(DoubledReplies, LeadNoAxisByReadingsThatDoNotFitTogether) {
  ScriptedBus bus(GetParam());
  const auto moved = move_from({0, 900, -70, 80'000, 5, 7'777'777, -3, 600, 9}, bus);
  ASSERT_FALSE(moved);
  EXPECT_EQ(moved.error().code, Errc::unexpected_value);
  EXPECT_EQ(moved.error().outcome, Outcome::not_sent);
}

TEST_P(DoubledReplies, OneOfThemShiftsNoAnswersForLong) {
  for (const std::size_t waiting : {1U, 2U, 8U}) {
    Random random(test::seed());
    ScriptedBus bus(GetParam());
    bus.add_module(1);
    bool done = false;
    bus.ways = [&](std::size_t datagram) -> std::vector<Duration> {
      if (datagram < 100 || std::exchange(done, true)) return {1ms};
      return {1ms, 1500us};
    };
    EXPECT_LE(wrong_reads(bus, random, waiting, 1000), most_unnoticed);
    EXPECT_EQ(wrong_reads(bus, random, waiting, 1000), 0U);
  }
}

TEST_P(DoubledReplies, TellNobodyThatAnUnseenMovementWasDone) {
  ScriptedBus bus(GetParam());
  bus.add_module(1);
  bus.submit(mvp(1, 100));
  bus.run_actions();
  const auto second = bus.submit(mvp(1, 200));
  bus.deliver(reply_to(mvp(1, 100), 100));
  bus.run_actions();
  ASSERT_EQ(bus.sent().back(), mvp(1, 200));
  bus.deliver(reply_to(mvp(1, 100), 100));
  bus.run_actions();
  EXPECT_FALSE(bus.has_ended(second));
  bus.deliver(reply_to(mvp(1, 200), 200));
  bus.run_actions();
  EXPECT_TRUE(bus.result(second));
}

class ReorderedReplies : public testing::TestWithParam<Framing> {};

// Where a reply is late and another one is late, too, just when the first comes, only reading again
// tells them apart: one in some ten thousands gets through, 23 of a million here, most of them
// before a line is known to do that. Of so many reads more than one in ten thousand is no chance.
TEST_P(ReorderedReplies, AreHardlyEverTakenForOthers) {
  constexpr std::size_t lines = 20, reads_on_each = 5000;
  Random random(test::seed());
  std::size_t wrong = 0;
  for (std::size_t line = 0; line < lines; ++line) {
    ScriptedBus bus(GetParam());
    bus.add_module(1);
    bus.ways = ways_of({.late_percent = 2, .late_from = 150ms, .late_to = 1500ms}, random);
    wrong += wrong_reads(bus, random, 1, reads_on_each);
  }
  EXPECT_LE(wrong, lines * reads_on_each / 10'000);
}

TEST_P(ReorderedReplies, DoNotConfirmMovementsThatWereLost) {
  Random random(test::seed());
  ScriptedBus bus(GetParam());
  auto& module = bus.add_module(1);
  bus.ways = ways_of({.late_percent = 20, .late_from = 110ms, .late_to = 1500ms}, random);
  bus.chance = [&](std::size_t) {
    return random() % 10 == 0 ? std::optional(Fault::lost_request) : std::nullopt;
  };
  for (std::int32_t i = 0; i < 1000; ++i) {
    const auto move = bus.submit(mvp(1, i));
    bus.settle({move});
    if (bus.result(move)) {
      ASSERT_EQ(module.parameter(0, 0), i);
    }
  }
}

// ---- what came before

TEST(AnswersInTime, BeginAfterTheirQuestionWentOut) {
  ScriptedBus bus;
  bus.add_module(1);
  const auto stale = encode_serial(reply_to(gap(1), 777));
  const auto head = std::span(stale).first(4);
  bus.engine().on_bytes(head, bus.clock().now());
  const auto read = bus.submit(gap(1));
  bus.run_actions();
  bus.engine().on_bytes(std::span(stale).subspan(4), bus.clock().now());
  bus.settle();
  EXPECT_EQ(bus.result(read)->reply.value, bus.module(1).parameter(0, 1));
  EXPECT_EQ(bus.counters().surplus, 1U);
}

/// A bus whose far end the test plays, one request at a time.
class QuietLine : public testing::TestWithParam<Framing> {
 protected:
  QuietLine() : ends_(Link::memory_pair(GetParam()).value()), core(std::move(ends_.first), {}) {}

  void come(const Reply& reply) {
    if (GetParam() == Framing::serial) {
      ASSERT_TRUE(ends_.second.write(encode_serial(reply)));
    } else {
      ASSERT_TRUE(ends_.second.write_frame(encode_can(reply, default_can_reply_id)));
    }
  }
  void go_on() {
    core.run_actions(
        now, [this](const engine::Completion& done) { results.push_back(done.result); },
        [](const BusEvent&) {});
  }
  std::optional<Request> sent() {
    if (GetParam() == Framing::can) {
      const auto input = ends_.second.read_frame().value();
      return input ? decode_can_request(std::get<CanFrame>(*input)) : std::nullopt;
    }
    SerialBytes bytes{};
    const auto count = ends_.second.read(bytes).value();
    return count == bytes.size() ? decode_serial_request(bytes) : std::nullopt;
  }

 private:
  std::pair<Link, Link> ends_;

 protected:
  BusCore core;
  TimePoint now{1h};
  std::vector<Result<Answer>> results;
};

TEST_P(QuietLine, IsLookedForBeforeEachRequest) {
  come(reply_to(gap(1), 777));
  core.engine().submit(1, gap(1), {}, now);
  std::vector<Request> all;
  for (int i = 0; i < 10 && results.empty(); ++i) {
    go_on();
    if (const auto request = sent()) {
      all.push_back(*request);
      come(reply_to(*request, 4));
    }
    core.on_readable(now);
  }
  ASSERT_EQ(results.size(), 1U);
  EXPECT_EQ(results[0]->reply.value, 4);
  EXPECT_EQ(core.engine().counters().surplus, 1U);
  // Out of step, so with a fence first; and suspect, so with one behind.
  EXPECT_THAT(commands_of(all),
              testing::ElementsAre(Command::GET_FIRMWARE_VERSION, Command::GAP, testing::_));
}

TEST_P(QuietLine, IsNotWaitedForForEver) {
  core.engine().submit(1, gap(1), {}, now);
  std::size_t rounds = 0;
  for (; rounds < 100 && !sent(); ++rounds) {
    come(reply_to(gap(7), 777));
    go_on();
  }
  EXPECT_LT(rounds, 20U);
}

// ---- lines that echo

TEST(LineEcho, IsLeftOutAndToldOnce) {
  for (const auto address : std::array<std::uint8_t, 3>{1, 2, 9}) {
    ScriptedBus bus;
    bus.add_module(address);
    bus.chance = [&](std::size_t number) {
      bus.engine().on_bytes(encode_serial(bus.sent()[number]), bus.clock().now());
      return std::nullopt;
    };
    for (std::uint8_t type = 0; type < 10; ++type) {
      const auto read = bus.submit(gap(address, static_cast<std::uint8_t>(100 + type)));
      bus.submit(mvp(address, 5));
      bus.settle();
      EXPECT_EQ(bus.result(read)->reply.value,
                bus.module(address).parameter(0, static_cast<std::uint8_t>(100 + type)));
    }
    EXPECT_EQ(bus.counters().garbage_bytes, 0U);
    EXPECT_EQ(bus.counters().surplus, 0U);
    EXPECT_EQ(bus.sent().size(), 20U);
    ASSERT_EQ(bus.events().size(), 1U);
    EXPECT_THAT(bus.events()[0].text, testing::HasSubstr("every request comes back"));
  }
}

// ---- silence

// The first reply ends the silence, and every later request is served: half a second at most after
// the module answers again.
TEST(Silence, EndsHalfASecondAfterTheModuleAnswersAgain) {
  for (const auto framing : {Framing::serial, Framing::can}) {
    for (int silent_ms = 100; silent_ms < 9000; silent_ms += 370) {
      ScriptedBus bus(framing);
      bus.add_module(1);
      const auto back = bus.clock().now() + std::chrono::milliseconds(silent_ms);
      bus.chance = [&](std::size_t) {
        return bus.clock().now() < back ? std::optional(Fault::lost_request) : std::nullopt;
      };
      std::optional<TimePoint> served;
      for (int i = 0; !served && i < 2000; ++i) {
        const auto read = bus.submit(gap(1));
        const auto move = bus.submit(mvp(1, i));
        bus.settle({read, move});
        if (bus.result(read) && bus.result(move)) served = bus.clock().now();
        bus.pass(5ms);
      }
      ASSERT_TRUE(served);
      EXPECT_LE(*served - back, 500ms) << silent_ms;
    }
  }
}

constexpr auto link_name = [](const auto& parameter) {
  return parameter.param == Framing::serial ? "serial" : "can";
};
INSTANTIATE_TEST_SUITE_P(Links, DoubledReplies, testing::Values(Framing::serial, Framing::can),
                         link_name);
INSTANTIATE_TEST_SUITE_P(Links, QuietLine, testing::Values(Framing::serial, Framing::can),
                         link_name);
INSTANTIATE_TEST_SUITE_P(Links, ReorderedReplies, testing::Values(Framing::serial, Framing::can),
                         link_name);

}  // namespace
}  // namespace tmcl
