// A serial line that is not perfect: rates that differ, answers that collide, echo and noise.
#include <gmock/gmock.h>

#include <algorithm>

#include "sim/wire/rates.hpp"
#include "sim_fixture.hpp"

namespace tmcl::sim {
namespace {

namespace gp = global_parameter;
using testing::IsEmpty;
using testing::SizeIs;

constexpr std::int32_t code_of_115200 = 7;

Bytes bytes_of(const Request& request) {
  const auto bytes = encode_serial(request);
  return {bytes.begin(), bytes.end()};
}
const Bytes question = bytes_of({ModuleAddress{1}, Command::GAP, 4, 0, 0});

class SimWire : public SimTest {
 protected:
  // What a host hears that sends these bytes at once, and waits.
  Bytes exchange_on(SerialLine& wire, const Bytes& bytes) {
    received.clear();
    wire.receive(bytes);
    pass(milliseconds(100));
    return received;
  }
  SerialLine::Output hear() {
    return [this](auto bytes) { received.insert(received.end(), bytes.begin(), bytes.end()); };
  }
  Bytes answer() { return exchange(question); }

  Bytes received;
};

SerialWire at(std::uint32_t rate) {
  return {.pace = {.bits_per_second = rate}, .has_rates_of_modules = true};
}

TEST(Rates, AreThoseOfTheTablesOfTheManuals) {
  EXPECT_EQ(serial_rate(0), 9'600U);
  EXPECT_EQ(serial_rate(7), 115'200U);
  EXPECT_EQ(serial_rate(11), 1'000'000U);
  EXPECT_EQ(serial_rate(12), 0U);
  EXPECT_EQ(serial_rate(-1), 0U);
  EXPECT_EQ(can_rate(0), 0U);
  EXPECT_EQ(can_rate(1), 10'000U);
  EXPECT_EQ(can_rate(8), 1'000'000U);
  EXPECT_EQ(can_rate(9), 0U);
}

TEST_F(SimWire, AModuleIsUnderstoodAtItsOwnRateOnly) {
  add(1110);
  SerialLine wire(bench, hear(), at(9'600));
  EXPECT_EQ(exchange_on(wire, question), answer());
  wire.set_host_rate(115'200);
  EXPECT_THAT(exchange_on(wire, question), IsEmpty());
  ask(Command::SGP, gp::serial_baud_rate, 0, code_of_115200);
  EXPECT_EQ(exchange_on(wire, question), answer());
  wire.set_host_rate(9'600);
  EXPECT_THAT(exchange_on(wire, question), IsEmpty());
}

TEST_F(SimWire, AnAnswerIsGarbageForAHostOfAnotherRate) {
  add(1110);
  SerialLine wire(bench, hear(), at(9'600));
  const auto change = bytes_of({ModuleAddress{1}, Command::SGP, gp::serial_baud_rate, 0, 7});
  const auto garbage = exchange_on(wire, change);
  ASSERT_THAT(garbage, SizeIs(9));
  EXPECT_NE(garbage, exchange(change));
}

TEST_F(SimWire, ModulesAreAskedAtTheLinesRateIfItIsGiven) {
  add(1110);
  SerialLine wire(bench, hear(), {.pace = {.bits_per_second = 57'600}});
  EXPECT_EQ(exchange_on(wire, question), answer());
}

TEST_F(SimWire, TwoModulesOfOneAddressMakeNineBytesOfGarbage) {
  add(1110);
  add(1110);
  SerialLine wire(bench, hear(), {.pace = {.bits_per_second = 9'600}});
  const auto garbage = exchange_on(wire, question);
  ASSERT_THAT(garbage, SizeIs(9));
  const auto both = answer();
  ASSERT_THAT(both, SizeIs(18)) << "without a pace nothing takes time, so nothing meets";
  EXPECT_NE(garbage, Bytes(both.begin(), both.begin() + 9));
}

TEST_F(SimWire, ModulesThatTakeTurnsDoNotCollide) {
  add(1110, 1);
  add(1110, 2);
  ask({ModuleAddress{2}, Command::SGP, gp::telegram_pause_time, 0, 30});
  SerialLine wire(bench, hear(), {.pace = {.bits_per_second = 9'600}});
  auto both = question;
  const auto second = bytes_of({ModuleAddress{2}, Command::GAP, 4, 0, 0});
  both.insert(both.end(), second.begin(), second.end());
  EXPECT_THAT(exchange_on(wire, both), SizeIs(18));
  EXPECT_EQ(received[1], 1);
  EXPECT_EQ(received[10], 2);
  EXPECT_EQ(Bytes(received.begin(), received.begin() + 9), answer());
}

TEST_F(SimWire, AnAdapterThatEchoesDoesSoBeforeTheAnswer) {
  add(1110);
  SerialLine wire(bench, hear(), {.echoes = true});
  auto expected = question;
  const auto reply = answer();
  expected.insert(expected.end(), reply.begin(), reply.end());
  EXPECT_EQ(exchange_on(wire, question), expected);
  const auto unheard = bytes_of({ModuleAddress{9}, Command::GAP, 4, 0, 0});
  EXPECT_EQ(exchange_on(wire, unheard), unheard);
}

// Of a thousand bytes there and a thousand back.
TEST_F(SimWire, NoiseTurnsBitsOverAsOftenAsItIsTold) {
  add(1110, 1);
  constexpr int exchanges = 2'000;
  const auto answered_well = [&](double noise, std::uint64_t seed) {
    SerialLine wire(bench, hear(), {.noise = noise, .seed = seed});
    const auto good = answer();
    int count = 0;
    for (int i = 0; i < exchanges; ++i) count += exchange_on(wire, question) == good ? 1 : 0;
    return count;
  };
  EXPECT_EQ(answered_well(0, 1), exchanges);
  EXPECT_EQ(answered_well(1, 1), 0);
  // 18 bytes: 0.99^18 of them, 1669; the standard deviation is 17.
  const auto some = answered_well(0.01, 1);
  EXPECT_NEAR(some, 1669, 100);
  EXPECT_EQ(answered_well(0.01, 1), some);
  EXPECT_NE(answered_well(0.01, 2), some);
}

}  // namespace
}  // namespace tmcl::sim
