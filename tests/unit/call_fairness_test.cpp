// Who goes out when many want to: a stop waits for nobody, and nobody waits for ever.
#include <gmock/gmock.h>

#include <functional>
#include <map>

#include "support/random.hpp"
#include "support/scripted_bus.hpp"
#include "support/seed.hpp"
#include "unit/engine_requests.hpp"

namespace tmcl {
namespace {

using namespace std::chrono_literals;
using test::Fault;
using test::gap;
using test::mst;
using test::mvp;
using test::ScriptedBus;
using testing::ElementsAre;

Request sap(std::uint8_t module, std::int32_t value, std::uint8_t motor = 0) {
  return {ModuleAddress{module}, Command::SAP, 4, motor, value};
}

TEST(CallFairness, EqualStopsThatWaitTogetherBecomeOneExchange) {
  ScriptedBus bus;
  bus.add_module(1);
  bus.submit(gap(1));
  for (int i = 0; i < 1280; ++i) bus.submit(mst(1, 1));
  const auto other = bus.submit(mst(1, 2));
  bus.settle();
  EXPECT_THAT(bus.sent(), ElementsAre(gap(1), mst(1, 1), mst(1, 2)));
  for (engine::Ticket ticket = 0; ticket <= other; ++ticket) EXPECT_TRUE(bus.result(ticket));
}

TEST(CallFairness, AStopThatJoinsAnotherEndsTheMovementsBetweenThem) {
  ScriptedBus bus;
  bus.add_module(1);
  bus.submit(gap(1));
  bus.submit(mst(1));
  const auto movement = bus.submit(mvp(1, 100));
  bus.submit(mst(1));
  bus.settle();
  EXPECT_EQ(bus.result(movement).error().code, Errc::superseded_by_stop);
  EXPECT_THAT(bus.sent(), ElementsAre(gap(1), mst(1)));
}

TEST(CallFairness, AStopThatNobodyAnswersGoesBehindThoseOfOtherMotors) {
  ScriptedBus bus;
  bus.add_module(2);
  bus.submit(mst(1));
  bus.run_actions();
  bus.submit(mst(2));
  bus.settle();
  EXPECT_EQ(bus.sent().at(1), mst(2));
}

TEST(CallFairness, AStopThatComesWhileTheLastFenceIsOutGoesOutAllTheSame) {
  ScriptedBus bus;
  bus.submit(mvp(1, 100));
  bus.pass(350ms);
  bus.submit(gap(1));
  while (bus.counters().fences < 2) bus.pass(1ms);
  bus.submit(mst(1));
  bus.settle();
  EXPECT_EQ(std::ranges::count(bus.sent(), mst(1)), 1);
}

/// The one before may have been lost.
TEST(CallFairness, AStopWhileTheLastFenceIsOutGoesOutThoughOneBeforeItDid) {
  ScriptedBus bus;
  bus.submit(mvp(1, 100));
  bus.pass(350ms);
  bus.submit(gap(1));
  while (bus.counters().fences < 1) bus.pass(1ms);
  bus.submit(mst(1));
  while (bus.counters().fences < 2) bus.pass(1ms);
  ASSERT_EQ(std::ranges::count(bus.sent(), mst(1)), 1);
  bus.submit(mst(1));
  bus.settle();
  EXPECT_EQ(std::ranges::count(bus.sent(), mst(1)), 2);
}

TEST(CallFairness, FloodsOfOneKindLeaveRoomInTheQueueForTheOthers) {
  ScriptedBus bus;
  for (std::size_t i = 0; i <= 2 * max_queued_calls; ++i)
    bus.submit(mvp(1, static_cast<std::int32_t>(i)));
  const auto read = bus.submit(gap(1));
  const auto stop = bus.submit(mst(1, 2));
  bus.run_actions();
  EXPECT_FALSE(bus.has_ended(read));
  EXPECT_FALSE(bus.has_ended(stop));
}

/// Many who each ask again as soon as they have been answered.
class Crowd {
 public:
  using Ask = std::function<Request()>;

  explicit Crowd(ScriptedBus& bus) : bus_(bus) {}
  void add(int members, const Ask& ask) {
    for (int i = 0; i < members; ++i) waiting_.emplace(bus_.submit(ask()), ask);
  }
  /// Lets `exchanges` begin.
  void go_on(std::size_t exchanges) {
    const auto end = bus_.sent().size() + exchanges;
    while (bus_.sent().size() < end) go_on_once();
  }
  void go_on_once() {
    bus_.pass(5ms);
    std::erase_if(waiting_, [&](const auto& one) {
      if (!bus_.has_ended(one.first)) return false;
      again_.push_back(one.second);
      return true;
    });
    for (const auto& ask : std::exchange(again_, {})) waiting_.emplace(bus_.submit(ask()), ask);
  }

 private:
  ScriptedBus& bus_;
  std::map<engine::Ticket, Ask> waiting_;
  std::vector<Ask> again_;
};

/// The exchanges from one that is `wanted` to the next, at most.
std::size_t longest_gap(const std::vector<Request>& sent, Command wanted) {
  std::size_t longest = 0;
  std::size_t since = 0;
  for (const auto& request : sent) {
    since = request.command == wanted ? 0 : since + 1;
    longest = std::max(longest, since);
  }
  return longest;
}

TEST(CallFairness, NoKindOfCallWaitsForEverForAnother) {
  for (const auto framing : {Framing::serial, Framing::can}) {
    ScriptedBus bus(framing);
    bus.answer_time = 30ms;
    bus.add_module(1);
    Crowd crowd(bus);
    int value = 0;
    crowd.add(64, [&] { return sap(1, ++value); });
    crowd.add(8, [&] { return gap(1, static_cast<std::uint8_t>(++value % 100)); });
    crowd.add(20, [] { return mst(1, 1); });
    crowd.go_on(400);
    for (const auto command : {Command::SAP, Command::GAP, Command::MST})
      EXPECT_LE(longest_gap(bus.sent(), command), 8U) << static_cast<int>(command);
  }
}

TEST(CallFairness, EvenStopsForVeryManyMotorsLetOthersThroughNowAndThen) {
  ScriptedBus bus;
  bus.add_module(1, 255);
  Crowd crowd(bus);
  std::uint8_t motor = 0;
  crowd.add(200, [&] { return mst(1, ++motor); });
  crowd.add(1, [] { return sap(1, 1); });
  crowd.add(1, [] { return gap(1); });
  crowd.go_on(1000);
  EXPECT_LE(longest_gap(bus.sent(), Command::SAP), 40U);
  EXPECT_LE(longest_gap(bus.sent(), Command::GAP), 40U);
}

TEST(CallFairness, AStopIsOnTheWireAfterTheExchangeInFlightWhoeverFloods) {
  const auto seed = test::seed();
  test::Random<int> random(seed);
  for (int round = 0; round < 20; ++round) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed) + ", round " + std::to_string(round));
    ScriptedBus bus;
    bus.answer_time = 30ms;
    for (std::uint8_t address = 1; address <= 3; ++address) bus.add_module(address, 16);
    const auto lost_percent = round % 2 == 0 ? 0 : random.between(1, 30);
    bus.chance = [&](std::size_t) {
      const bool lost = random.between(1, 100) <= lost_percent;
      return lost ? std::optional(Fault::lost_reply) : std::nullopt;
    };
    Crowd crowd(bus);
    const auto module = [&] { return static_cast<std::uint8_t>(random.between(1, 3)); };
    const auto motor = [&] { return static_cast<std::uint8_t>(random.between(0, 4)); };
    int value = 0;
    crowd.add(random.between(0, 100), [&] { return sap(module(), ++value, motor()); });
    crowd.add(random.between(0, 100),
              [&] { return mvp(module(), ++value, static_cast<std::uint8_t>(1 + motor())); });
    crowd.add(random.between(0, 100), [&] { return gap(module(), 1, motor()); });
    // Nothing moves this one, so after the first stop all others are repetitions.
    crowd.add(64, [&] { return mst(1, 0); });
    for (int probe = 0; probe < 5; ++probe) {
      crowd.go_on(static_cast<std::size_t>(random.between(3, 40)));
      for (int i = random.between(0, 40); i > 0; --i) crowd.go_on_once();
      const auto stop = mst(module(), static_cast<std::uint8_t>(6 + probe));
      bus.run_actions();
      const auto before = bus.sent().size();
      const auto asked = bus.clock().now();
      bus.submit(stop);
      while (bus.sent().size() == before) crowd.go_on_once();
      EXPECT_EQ(bus.sent().at(before), stop) << describe(bus.sent().at(before));
      EXPECT_LE(bus.clock().now() - asked, 105ms) << "an answer that does not come takes so long";
    }
  }
}

}  // namespace
}  // namespace tmcl
