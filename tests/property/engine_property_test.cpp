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

INSTANTIATE_TEST_SUITE_P(Links, AnyFaults, testing::Values(Framing::serial, Framing::can),
                         [](const auto& parameter) {
                           return parameter.param == Framing::serial ? "serial" : "can";
                         });

}  // namespace
}  // namespace tmcl
