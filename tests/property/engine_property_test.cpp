// Whatever goes wrong on the wire, nobody gets somebody else's answer and no movement goes out
// twice.

#include <gmock/gmock.h>

#include <cstdlib>
#include <iostream>
#include <random>

#include "support/scripted_bus.hpp"
#include "support/seed.hpp"

namespace tmcl {
namespace {

using test::Fault;
using test::ScriptedBus;

class AnyFaults : public testing::TestWithParam<Framing> {};

struct Asked {
  engine::Ticket ticket;
  Request request;
  std::int32_t expected;
};

Asked ask_at_random(ScriptedBus& bus, std::mt19937_64& random) {
  const auto pick = [&](int limit) {
    return static_cast<std::uint8_t>(random() % static_cast<unsigned>(limit));
  };
  const auto address = static_cast<std::uint8_t>(1 + pick(3));
  Request request{ModuleAddress{address}, Command::GAP, static_cast<std::uint8_t>(100 + pick(20)),
                  pick(3), 0};
  auto expected = bus.module(address).parameter(request.motor, request.type);
  if (pick(4) == 0) {
    request = {request.address, Command::MVP, 0, request.motor,
               static_cast<std::int32_t>(random() % 1'000'000)};
    expected = request.value;
  }
  return {bus.submit(request), request, expected};
}

TEST_P(AnyFaults, NobodyGetsSomebodyElsesAnswer) {
  const auto seed = test::seed();
  std::mt19937_64 random(seed);
  for (int round = 0; round < 400; ++round) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed) + ", round " + std::to_string(round));
    ScriptedBus bus(GetParam());
    for (int address = 1; address <= 3; ++address)
      bus.add_module(static_cast<std::uint8_t>(address));
    const auto fault_percent = random() % 60;
    bus.chance = [&](std::size_t) -> std::optional<Fault> {
      if (random() % 100 >= fault_percent) return std::nullopt;
      return test::all_faults[random() % test::all_faults.size()];
    };
    std::vector<Asked> all;
    std::map<Request, int> movements;
    for (int i = 0; i < 40; ++i) {
      all.push_back(ask_at_random(bus, random));
      if (all.back().request.command == Command::MVP) ++movements[all.back().request];
      if (random() % 3 == 0) bus.pass(std::chrono::milliseconds(random() % 200));
    }
    bus.settle();
    for (const auto& asked : all) {
      ASSERT_TRUE(bus.has_ended(asked.ticket));
      const auto& result = bus.result(asked.ticket);
      if (result) {
        ASSERT_EQ(result->reply.value, asked.expected) << describe(asked.request);
      }
      if (!result && result.error().outcome == Outcome::not_sent) --movements[asked.request];
    }
    for (const auto& [request, asked] : movements) {
      if (request.command != Command::MVP) continue;
      ASSERT_EQ(std::ranges::count(bus.sent(), request), asked) << describe(request);
    }
  }
}

class FullLinks : public testing::TestWithParam<Framing> {};

/// A link that is shut for up to 1.9 s, which is as long as a stop is tried, and takes some of what
/// it is given for a while then.
void open_and_shut(ScriptedBus& bus, std::mt19937_64& random) {
  const auto begin = bus.clock().now();
  const auto shut_for = std::chrono::milliseconds(random() % 1900);
  const auto open_for = std::chrono::milliseconds(100 + random() % 400);
  const auto refused_percent = random() % 80;
  bus.takes = [=, &bus, &random](const Request&) {
    const auto at = (bus.clock().now() - begin) % (shut_for + open_for);
    return at >= shut_for && random() % 100 >= refused_percent;
  };
}

struct AskedStop {
  engine::Ticket ticket;
  std::size_t sent_before;
  std::vector<Request> movements_before;  ///< Of its motor, none of which is sent from then on.
};

TEST_P(FullLinks, EveryStopGoesOutAndNoMovementAfterAStop) {
  const auto seed = test::seed();
  std::mt19937_64 random(seed);
  for (int round = 0; round < 200; ++round) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed) + ", round " + std::to_string(round));
    ScriptedBus bus(GetParam());
    for (std::uint8_t address = 1; address <= 3; ++address) bus.add_module(address);
    open_and_shut(bus, random);
    std::map<std::pair<ModuleAddress, std::uint8_t>, std::vector<Request>> movements;
    std::map<engine::Ticket, Request> asked;
    std::vector<AskedStop> stops;
    for (int i = 0; i < 40; ++i) {
      const ModuleAddress address{static_cast<std::uint16_t>(1 + random() % 3)};
      const auto motor = static_cast<std::uint8_t>(random() % 2);
      auto& of_motor = movements[{address, motor}];
      Request request{address, Command::GAP, 4, motor, 0};
      // Every movement has a target of its own, so that it is recognised.
      if (random() % 3 == 0) request = {address, Command::MVP, 0, motor, i};
      if (random() % 5 == 0) request = {address, Command::MST, 0, motor, 0};
      const auto ticket = bus.submit(request);
      asked[ticket] = request;
      if (request.command == Command::MVP) of_motor.push_back(request);
      if (request.command == Command::MST) stops.push_back({ticket, bus.sent().size(), of_motor});
      // A movement and a stop may also come in one go: then the link refuses the one or the other.
      if (random() % 4 != 0) bus.run_actions();
      if (random() % 3 == 0) bus.pass(std::chrono::milliseconds(random() % 100));
    }
    bus.settle();
    for (const auto& [ticket, request] : asked) {
      const auto& result = bus.result(ticket);
      const auto times = std::ranges::count(bus.sent(), request);
      if (request.command != Command::MVP) continue;
      ASSERT_EQ(times, result ? 1 : 0) << describe(request);
    }
    for (const auto& stop : stops) {
      ASSERT_TRUE(bus.result(stop.ticket)) << describe(bus.result(stop.ticket).error());
      const auto since = bus.sent().begin() + static_cast<std::ptrdiff_t>(stop.sent_before);
      const auto stopped = std::find(since, bus.sent().end(), asked[stop.ticket]);
      ASSERT_NE(stopped, bus.sent().end());
      for (const auto& movement : stop.movements_before) {
        ASSERT_EQ(std::count(stopped, bus.sent().end(), movement), 0) << describe(movement);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Links, FullLinks, testing::Values(Framing::serial, Framing::can),
                         [](const auto& parameter) {
                           return parameter.param == Framing::serial ? "serial" : "can";
                         });

INSTANTIATE_TEST_SUITE_P(Links, AnyFaults, testing::Values(Framing::serial, Framing::can),
                         [](const auto& parameter) {
                           return parameter.param == Framing::serial ? "serial" : "can";
                         });

}  // namespace
}  // namespace tmcl
