// A module that a host has put into ASCII mode understands no datagrams. Its motor is stopped all
// the same, and nothing else on the line changes.
#include <gmock/gmock.h>

#include <numeric>
#include <random>
#include <vector>

#include <fmt/format.h>

#include "support/scripted_bus.hpp"
#include "support/seed.hpp"
#include "tmcl/parameter.hpp"
#include "unit/engine_on_line.hpp"
#include "unit/engine_requests.hpp"

namespace tmcl {
namespace {

using namespace std::chrono_literals;
using test::EngineOnLine;
using test::gap;
using test::mst;
using testing::ElementsAre;

Request enter_ascii(std::uint8_t module) {
  return {ModuleAddress{module}, Command::ENTER_ASCII_MODE, 0, 0, 0};
}
Request ror(std::uint8_t module, std::int32_t speed) {
  return {ModuleAddress{module}, Command::ROR, 0, 0, speed};
}

/// What a module holds, but for what changes by itself while it moves.
std::vector<std::int32_t> settings_of(EngineOnLine& line, std::uint8_t module) {
  std::vector<std::int32_t> all;
  for (const auto& row : axis_parameters(*find_model(1110))) {
    if (row.access == Access::read || row.number == axis_parameter::actual_position) continue;
    const auto answer = line.ask({ModuleAddress{module}, Command::GAP, row.number, 0, 0});
    all.push_back(answer ? answer->reply.value : -1);
  }
  for (const auto& row : global_parameters(*find_model(1110))) {
    if (row.access == Access::read || row.number == global_parameter::tick_timer) continue;
    const auto answer = line.ask({ModuleAddress{module}, Command::GGP, row.number, 0, 0});
    all.push_back(answer ? answer->reply.value : -1);
  }
  return all;
}

class ModulesOnALine : public testing::TestWithParam<unsigned> {};

// One turns and is in ASCII mode; one moves for another client; one stands and is asked.
TEST_P(ModulesOnALine, OneInAsciiModeIsStoppedAndNothingElseChanges) {
  const auto seed = test::seed();
  std::mt19937_64 random(seed);
  for (int round = 0; round < 12; ++round) {
    std::vector<std::uint8_t> addresses(26);
    std::iota(addresses.begin(), addresses.end(), std::uint8_t{1});
    std::ranges::shuffle(addresses, random);
    // The address that is a carriage return, too.
    if (round == 0) std::swap(*std::ranges::find(addresses, 13), addresses[0]);
    const auto lost = addresses[0];
    const auto moving = addresses[1];
    const auto standing = addresses[2];
    SCOPED_TRACE(fmt::format("lost {}, moving {}, standing {}", lost, moving, standing));
    EngineOnLine line(GetParam());
    for (const auto address : {lost, moving, standing}) line.add(address);
    ASSERT_TRUE(line.ask(ror(lost, 500)));
    ASSERT_TRUE(line.ask(ror(moving, 300)));
    line.pass(3s);
    const auto of_moving = settings_of(line, moving);
    const auto of_standing = settings_of(line, standing);
    line.inject(enter_ascii(lost));
    // What it hears now are characters to it: it is in the middle of a line.
    for (const std::int32_t text : {0x41424344, 0x4D535420})
      line.ask({ModuleAddress{standing}, Command::SIO, 0x42, 2, text});
    const auto stop = line.submit(mst(lost));
    while (!line.has_ended(stop)) {
      for (const auto address : {moving, standing}) {
        const auto speed = line.ask(gap(address, axis_parameter::actual_velocity));
        ASSERT_TRUE(speed) << describe(speed.error());
        ASSERT_EQ(speed->reply.value, address == moving ? 300 : 0);
      }
    }
    EXPECT_TRUE(line.result(stop)) << describe(line.result(stop).error());
    line.pass(5s);
    EXPECT_EQ(line.ask(gap(lost, axis_parameter::actual_velocity))->reply.value, 0);
    EXPECT_EQ(settings_of(line, moving), of_moving);
    EXPECT_EQ(settings_of(line, standing), of_standing);
  }
}

INSTANTIATE_TEST_SUITE_P(Rates, ModulesOnALine, testing::Values(9'600, 115'200, 1'000'000));

TEST(AsciiMode, TheStopOfASilentModuleIsFollowedByBinAFenceAndTheStop) {
  test::ScriptedBus bus;
  std::size_t before = 0;
  bus.on_line = [&] {
    before = bus.sent().size();
    bus.add_module(4);
  };
  const auto stop = bus.submit(mst(4));
  bus.settle();
  EXPECT_TRUE(bus.result(stop));
  EXPECT_THAT(bus.lines(), ElementsAre("\rDBIN\r"));
  ASSERT_EQ(bus.sent().size(), before + 2);
  EXPECT_EQ(effect_of(bus.sent()[before].command, bus.sent()[before].type), Effect::reads);
  EXPECT_EQ(bus.sent().back(), mst(4));
}

TEST(AsciiMode, OneLineServesAllStopsOfAModule) {
  test::ScriptedBus bus;
  bus.on_line = [&] { bus.add_module(4); };
  std::vector<engine::Ticket> stops;
  for (std::uint8_t motor = 0; motor < 3; ++motor) stops.push_back(bus.submit(mst(4, motor)));
  bus.settle();
  for (const auto stop : stops) EXPECT_TRUE(bus.result(stop));
  EXPECT_THAT(bus.lines(), testing::SizeIs(testing::AllOf(testing::Ge(1), testing::Le(2))));
}

TEST(AsciiMode, AStopThatNobodyAnswersEndsAllTheSame) {
  test::ScriptedBus bus;
  const auto stop = bus.submit(mst(4));
  bus.settle();
  ASSERT_FALSE(bus.result(stop));
  EXPECT_EQ(bus.result(stop).error().outcome, Outcome::unknown);
  EXPECT_THAT(bus.lines(), testing::SizeIs(1));
  EXPECT_LE(bus.clock().now() - TimePoint{}, 600ms);
}

TEST(AsciiMode, IsLeftForNothingElseAndNowhereElse) {
  test::ScriptedBus bus;
  bus.submit(gap(4));
  bus.submit(test::mvp(4, 100));
  bus.submit(mst(27));
  bus.submit(mst(0));
  bus.settle();
  EXPECT_THAT(bus.lines(), testing::IsEmpty()) << "there is no letter for these addresses";
  test::ScriptedBus can(Framing::can);
  can.submit(mst(4));
  can.settle();
  EXPECT_THAT(can.lines(), testing::IsEmpty());
}

}  // namespace
}  // namespace tmcl
