// Modules whose ramps are those of a TMC457 or of a sixPoint chip, next to those with a TMC429.
#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "sim/module/tick_clock.hpp"
#include "sim_fixture.hpp"
#include "support/seed.hpp"
#include "tmcl/ramp/sixpoint.hpp"
#include "tmcl/ramp/tmc429.hpp"
#include "tmcl/ramp/tmc4361.hpp"
#include "tmcl/ramp/tmc457.hpp"

namespace tmcl::sim {
namespace {

namespace ap = axis_parameter;
using std::chrono::hours;
using std::chrono::seconds;
using testing::ElementsAre;

constexpr auto arm = Command::TARGET_REACHED_EVENT;

constexpr std::uint8_t unit_mode = 255;

class SimFamilies : public SimTest {
 protected:
  Status set(std::uint8_t parameter, std::int32_t value, std::uint8_t motor = 0) {
    return status_of(Command::SAP, parameter, motor, value);
  }
  // What the three kinds of modules at the addresses 1, 2 and 3 answer, in this order.
  std::vector<Status> statuses(Command command, std::uint8_t type, std::int32_t value = 0) {
    std::vector<Status> all;
    for (const auto address : std::to_array<std::uint16_t>({1, 2, 3})) {
      all.push_back(ask({ModuleAddress{address}, command, type, 0, value})->status);
    }
    return all;
  }
  std::vector<std::int32_t> readings(std::uint8_t parameter) {
    std::vector<std::int32_t> all;
    for (const auto address : std::to_array<std::uint16_t>({1, 2, 3})) {
      all.push_back(ask({ModuleAddress{address}, Command::GAP, parameter, 0, 0})->value);
    }
    return all;
  }
  struct ChipParameter {
    std::uint8_t parameter, address;
    std::int32_t value;
  };
  void expect_registers(std::uint8_t mode, std::initializer_list<ChipParameter> all) {
    for (const auto& [parameter, address, value] : all) {
      // In the mode of velocity nothing else changes the target velocity.
      EXPECT_EQ(set(mode, 2), Status::ok);
      EXPECT_EQ(set(parameter, value), Status::ok);
      EXPECT_EQ(ask(Command::READ_MC, address, 0)->value, value) << int{parameter};
    }
  }
  void add_one_of_each() {
    add(1110, 1);
    add(142, 2);
    add(6212, 3);
  }
};

constexpr auto ok = Status::ok;
constexpr auto no_type = Status::wrong_type;
constexpr auto no_value = Status::invalid_value;

// ---- Registers ---------------------------------------------------------------------------------

template <class Chip>
void expect_bits_apart() {
  std::map<std::uint8_t, std::uint64_t> taken;
  for (const auto& info : Chip::registers()) {
    const auto mask = ((std::uint64_t{1} << info.bits.count) - 1) << info.bits.shift;
    auto& word = taken[info.bits.address];
    EXPECT_EQ(word & mask, 0U) << info.name;
    EXPECT_EQ(mask >> Chip::position_bits, 0U) << info.name;
    if (info.minimum < 0) {
      EXPECT_EQ(info.bits.shift, 0) << info.name;
    }
    word |= mask;
  }
}

TEST(SimRegisters, ShareNoBitOfTheirChip) {
  expect_bits_apart<ramp::Tmc429>();
  expect_bits_apart<ramp::Tmc457>();
  expect_bits_apart<ramp::SixPoint>();
  expect_bits_apart<ramp::Tmc4361>();
}

// ---- Parameters --------------------------------------------------------------------------------

class SimModels : public SimTest, public testing::WithParamInterface<Model> {};

TEST_P(SimModels, AnswersEveryAxisParameterOfItsTable) {
  const auto& model = GetParam();
  add(model.number);
  const auto motor = static_cast<std::uint8_t>(model.axes - 1);
  const auto set = [&](const ParameterInfo& row, std::int64_t value) {
    if (value < INT32_MIN || value > INT32_MAX) return no_value;
    return status_of(Command::SAP, row.number, motor, static_cast<std::int32_t>(value));
  };
  for (const auto& row : axis_parameters(model)) {
    SCOPED_TRACE(row.name);
    EXPECT_EQ(status_of(Command::GAP, row.number, motor), ok);
    if (row.access == Access::read) {
      EXPECT_EQ(set(row, row.maximum), no_type);
      continue;
    }
    EXPECT_EQ(set(row, row.minimum), ok);
    EXPECT_EQ(set(row, row.maximum), ok);
    EXPECT_EQ(set(row, std::int64_t{row.maximum} + 1), no_value);
    EXPECT_EQ(set(row, std::int64_t{row.minimum} - 1), no_value);
    EXPECT_EQ(set(row, row.initial), ok);
  }
}

TEST_P(SimModels, StartsWithWhatItsTableSays) {
  const auto& model = GetParam();
  add(model.number);
  for (const auto& row : axis_parameters(model)) {
    if (!row.stored) continue;
    // An acceleration is read back as what its register comes to.
    const double slack = row.scale == Scale::acceleration ? row.initial / 100.0 : 0;
    EXPECT_NEAR(get(row.number), row.initial, slack) << row.name;
  }
  EXPECT_EQ(get(ap::position_reached), 1);
  EXPECT_EQ(bench.next_due(), never);
}

TEST_P(SimModels, KnowsNoParameterThatItsTableDoesNotHave) {
  add(GetParam().number);
  for (int number = 0; number < 256; ++number) {
    const auto parameter = static_cast<std::uint8_t>(number);
    if (find_parameter(axis_parameters(GetParam()), parameter) != nullptr) continue;
    EXPECT_EQ(status_of(Command::GAP, parameter, 0), no_type) << number;
    EXPECT_EQ(status_of(Command::SAP, parameter, 0, 0), no_type) << number;
  }
}

TEST_P(SimModels, SaysWhatItIs) {
  const auto& model = GetParam();
  add(model.number);
  const auto value = ask(Command::GET_FIRMWARE_VERSION, 1, 0)->value;
  EXPECT_EQ(version_from_value(value).model, model.number);
  EXPECT_EQ(status_of(Command::MST, 0, static_cast<std::uint8_t>(model.axes - 1)), ok);
  EXPECT_EQ(status_of(Command::MST, 0, model.axes), no_value);
}

INSTANTIATE_TEST_SUITE_P(All, SimModels, testing::ValuesIn(models().begin(), models().end()),
                         [](const auto& test) { return std::to_string(test.param.number); });

TEST_F(SimFamilies, MeanDifferentThingsByTheSameNumber) {
  add_one_of_each();
  // 15: d_stop, A1
  EXPECT_THAT(statuses(Command::SAP, 15, 60'000), ElementsAre(no_type, ok, ok));
  // 16: a_max, V1; 5 reads a_max on the one, and is AMAX on the other
  EXPECT_THAT(statuses(Command::SAP, 5, 2'000), ElementsAre(ok, ok, ok));
  EXPECT_THAT(statuses(Command::SAP, 16, 3'000), ElementsAre(no_type, ok, ok));
  EXPECT_THAT(readings(5), ElementsAre(2'000, 3'000, 1'980));
  EXPECT_THAT(statuses(Command::SAP, 16, 999'999), ElementsAre(no_type, ok, ok));
  EXPECT_THAT(statuses(Command::SAP, 16, 1'000'000), ElementsAre(no_type, ok, no_value));
  // 17: d_max, DMAX
  EXPECT_THAT(statuses(Command::SAP, 17, 16'777'213), ElementsAre(no_type, ok, no_value));
  // 18: bow_max, D1
  EXPECT_THAT(statuses(Command::SAP, 18, 18), ElementsAre(no_type, ok, ok));
  EXPECT_THAT(statuses(Command::SAP, 18, 19), ElementsAre(no_type, no_value, ok));
  // 19 to 21: only the sixPoint registers VSTART, VSTOP and TZEROWAIT
  for (const auto number : std::to_array<std::uint8_t>({19, 20, 21})) {
    EXPECT_THAT(statuses(Command::SAP, number, 20), ElementsAre(no_type, no_type, ok));
  }
  // 128: ramp mode; 129: status flags; 130: minimum velocity, velocity reached; 138: ramp mode
  EXPECT_THAT(statuses(Command::SAP, 128, 2), ElementsAre(no_type, ok, no_type));
  EXPECT_THAT(statuses(Command::GAP, 129), ElementsAre(no_type, ok, no_type));
  EXPECT_THAT(statuses(Command::SAP, 130, 5), ElementsAre(ok, no_type, no_type));
  EXPECT_THAT(readings(130), ElementsAre(5, 1, 0));
  EXPECT_THAT(statuses(Command::SAP, 138, 2), ElementsAre(ok, no_type, no_type));
  // 153 and 154: dividers; 255: unit mode
  EXPECT_THAT(statuses(Command::SAP, 153, 3), ElementsAre(ok, no_type, no_type));
  EXPECT_THAT(statuses(Command::SAP, 154, 2), ElementsAre(ok, no_type, no_type));
  EXPECT_THAT(statuses(Command::SAP, 255, 1), ElementsAre(no_type, ok, ok));
  EXPECT_THAT(statuses(Command::SAP, 255, 2), ElementsAre(no_type, no_value, no_value));
}

TEST_F(SimFamilies, HaveThePositionsOfTheirChips) {
  add_one_of_each();
  EXPECT_THAT(statuses(Command::MVP, 0, 1 << 23), ElementsAre(no_value, ok, ok));
  EXPECT_THAT(statuses(Command::MVP, 0, INT32_MIN), ElementsAre(no_value, ok, ok));
  EXPECT_THAT(readings(ap::target_position), ElementsAre(0, INT32_MIN, INT32_MIN));
}

TEST_F(SimFamilies, HaveTheVelocitiesOfTheirChips) {
  add_one_of_each();
  EXPECT_THAT(statuses(Command::ROR, 0, 2048), ElementsAre(no_value, ok, ok));
  EXPECT_THAT(statuses(Command::ROL, 0, 7'999'511), ElementsAre(no_value, ok, ok));
  EXPECT_THAT(statuses(Command::ROL, 0, 7'999'512), ElementsAre(no_value, ok, no_value));
  EXPECT_THAT(statuses(Command::ROR, 0, 0x7FFF0000), ElementsAre(no_value, ok, no_value));
  EXPECT_THAT(statuses(Command::ROR, 0, 0x7FFF0001), ElementsAre(no_value, no_value, no_value));
  EXPECT_THAT(statuses(Command::ROL, 0, INT32_MIN), ElementsAre(no_value, no_value, no_value));
  EXPECT_THAT(readings(ap::target_velocity), ElementsAre(0, 0x7FFF0000, -7'999'511));
}

// ---- Units -------------------------------------------------------------------------------------

TEST_F(SimFamilies, CountInPulsesPerSecondWhenToldTo) {
  add(142);
  const std::array<std::uint8_t, 4> accelerations{5, 15, 16, 17};
  EXPECT_EQ(get(unit_mode), 0);
  EXPECT_EQ(set(2, -(1 << 30)), ok);
  EXPECT_EQ(set(4, 1 << 26), ok);
  for (const auto number : accelerations) EXPECT_EQ(set(number, 1 << 22), ok);
  EXPECT_EQ(set(18, 11), ok);

  EXPECT_EQ(set(unit_mode, 1), ok);
  EXPECT_EQ(get(2), -16'000'000);
  EXPECT_EQ(get(4), 1'000'000);
  for (const auto number : accelerations) EXPECT_EQ(get(number), 244'140'625);
  EXPECT_EQ(get(18), 11);

  EXPECT_EQ(set(2, 31'999'023), ok);
  EXPECT_EQ(set(2, 31'999'024), no_value);
  EXPECT_EQ(set(2, -31'999'023), ok);
  EXPECT_EQ(set(2, -31'999'024), no_value);
  EXPECT_EQ(set(4, 31'999'024), no_value);
  for (const auto number : accelerations) {
    EXPECT_EQ(set(number, 976'562'325), ok);
    EXPECT_EQ(set(number, 976'562'326), no_value);
    EXPECT_EQ(set(number, 100), ok);
    EXPECT_EQ(get(number), 59);  // one unit of the register is 58.2
  }
  EXPECT_EQ(status_of(Command::ROR, 0, 0, 31'999'024), no_value);

  EXPECT_EQ(set(unit_mode, 0), ok);
  EXPECT_EQ(get(4), 1 << 26);
  for (const auto number : accelerations) EXPECT_EQ(get(number), 1);
}

TEST_F(SimFamilies, ReadTheActualVelocityInTheUnitOfTheMoment) {
  add(142);
  set(unit_mode, 1);
  ask(Command::ROL, 0, 0, 100'000);
  pass(seconds(1));
  EXPECT_EQ(get(ap::actual_velocity), -100'000);
  const auto before = get(ap::actual_position);
  pass(seconds(1));
  EXPECT_NEAR(get(ap::actual_position) - before, -100'000, 2);
  set(unit_mode, 0);
  EXPECT_EQ(get(ap::actual_velocity), -6'710'886);
}

TEST_F(SimFamilies, RoundAsTheOpenFirmwareOfTheVendor) {
  add(6212);
  EXPECT_EQ(get(unit_mode), 1);
  EXPECT_EQ(get(4), 51'200);
  EXPECT_EQ(get(5), 51'107);  // 439 in the register
  set(unit_mode, 0);
  EXPECT_EQ(get(4), 53'687);
  EXPECT_EQ(get(5), 439);
  EXPECT_EQ(get(16), 26'843);
  EXPECT_EQ(set(4, 8'388'096), ok);
  EXPECT_EQ(set(4, 8'388'097), no_value);
  EXPECT_EQ(set(5, 65'535), ok);
  EXPECT_EQ(set(5, 65'536), no_value);
}

TEST_F(SimFamilies, ReadVelocitiesInPulsesPerSecondAsTheyWereWritten) {
  add_one_of_each();
  ask({ModuleAddress{2}, Command::SAP, unit_mode, 0, 1});
  std::mt19937_64 random(test::seed());
  SCOPED_TRACE("TMCL_SEED=" + std::to_string(test::seed()));
  for (int i = 0; i < 1000; ++i) {
    const auto greatest = std::uniform_int_distribution<std::int32_t>(1, 7'999'511)(random);
    const auto velocity = std::uniform_int_distribution<std::int32_t>(0, greatest)(random);
    for (const auto address : std::to_array<std::uint16_t>({2, 3})) {
      ask({ModuleAddress{address}, Command::SAP, 4, 0, velocity});
      ASSERT_EQ(ask({ModuleAddress{address}, Command::GAP, 4, 0, 0})->value, velocity) << address;
    }
  }
}

// ---- TMC457 ------------------------------------------------------------------------------------

TEST_F(SimFamilies, ATmc457ChoosesItsModeByCommand) {
  add(146);
  EXPECT_EQ(get(128), 0);
  ask(Command::ROR, 0, 0, 5'000'000);
  EXPECT_EQ(get(128), 2);
  EXPECT_EQ(get(130), 0);
  pass(seconds(1));
  EXPECT_EQ(get(ap::actual_velocity), 5'000'000);
  EXPECT_EQ(get(130), 1);
  EXPECT_EQ(get(129), 2);
  ask(Command::MVP, 0, 0, -1000);
  EXPECT_EQ(get(128), 0);
  pass(seconds(3));
  EXPECT_EQ(get(ap::actual_position), -1000);
  EXPECT_EQ(get(129) & 5, 5);
  ask(Command::MST, 0, 0);
  EXPECT_EQ(get(128), 2);
  EXPECT_EQ(set(128, 3), ok);
  EXPECT_EQ(set(2, -77'000), ok);  // at once
  pass(milliseconds(1));
  EXPECT_EQ(get(ap::actual_velocity), -77'000);
  EXPECT_EQ(set(128, 1), no_value);
  EXPECT_EQ(get(128), 3);
}

/// The lists at the end of the note on ramps, with the addresses of the data sheets.
TEST_F(SimFamilies, ATmc429HasItsRegistersAsParameters) {
  add(3110);
  expect_registers(
      138, {{4, 0x06, 1000}, {2, 0x08, 300}, {0, 0x00, 500}, {1, 0x02, 700}, {5, 0x0C, 900}});
  ask(Command::ROR, 0, 0, 200);
  pass(seconds(1));
  EXPECT_EQ(get(3), 200);
  EXPECT_EQ(ask(Command::READ_MC, 0x0A, 0)->value, 200);
}

TEST_F(SimFamilies, ATmc457HasItsRegistersAsParameters) {
  add(142);
  expect_registers(128, {{4, 0x03, 1000},
                         {2, 0x04, 300},
                         {16, 0x05, 900},
                         {17, 0x06, 800},
                         {15, 0x07, 700},
                         {18, 0x08, 9},
                         {0, 0x09, 500},
                         {1, 0x01, 600}});
}

TEST_F(SimFamilies, ATmc429ChoosesItsModeByCommand) {
  add(3110);
  constexpr std::uint8_t mode = 138;
  ask(Command::ROR, 0, 0, 300);
  EXPECT_EQ(get(mode), 2);
  EXPECT_EQ(get(2), 300);
  ask(Command::MVP, 0, 0, 20'000);
  EXPECT_EQ(get(mode), 0);
  ask(Command::ROL, 0, 0, 300);
  EXPECT_EQ(get(mode), 2);
  EXPECT_EQ(get(2), -300);
  ask(Command::MVP, 0, 0, 20'000);
  ask(Command::MST, 0, 0);
  EXPECT_EQ(get(mode), 2);
  EXPECT_EQ(get(2), 0);
}

TEST_F(SimFamilies, ATmc457SetsAccelerationAndDecelerationTogether) {
  add(142);
  EXPECT_EQ(set(5, 12'345), ok);
  EXPECT_EQ(get(16), 12'345);
  EXPECT_EQ(get(17), 12'345);
  EXPECT_EQ(set(17, 999), ok);
  EXPECT_EQ(get(5), 12'345);
  EXPECT_EQ(set(16, 888), ok);
  EXPECT_EQ(get(5), 888);
  EXPECT_EQ(get(17), 999);
}

TEST_F(SimFamilies, ATmc457MovesAlongAnSCurve) {
  add(142);
  set(unit_mode, 1);
  set(4, 100'000);
  set(5, 1'000'000);
  set(18, 1);
  ask(Command::MVP, 0, 0, 50'000);
  // Bow 1 is f^3 / 2^52 microsteps/s^3. The acceleration rises for a tenth of a second.
  const double bow = std::pow(16e6, 3) / std::pow(2.0, 52);
  pass(milliseconds(100));
  EXPECT_NEAR(get(ap::actual_position), bow * std::pow(0.1, 3) / 6, 1);
  EXPECT_NEAR(get(ap::actual_velocity), bow * 0.1 * 0.1 / 2, 2);
  pass(seconds(5));
  EXPECT_EQ(get(ap::actual_position), 50'000);
  EXPECT_EQ(get(ap::actual_velocity), 0);
}

// ---- sixPoint ----------------------------------------------------------------------------------

TEST_F(SimFamilies, ASixPointMotorPositionsWithParameterFourAgainAfterTurning) {
  add(6212);
  set(4, 20'000, 5);
  ask(Command::ROL, 0, 5, 60'000);
  pass(seconds(3));
  EXPECT_EQ(get(ap::actual_velocity, 5), -60'000);
  EXPECT_EQ(get(ap::target_velocity, 5), -60'000);
  EXPECT_EQ(get(4, 5), 20'000);
  set(4, 30'000, 5);  // for the next positioning
  pass(seconds(3));
  EXPECT_EQ(get(ap::actual_velocity, 5), -60'000);
  ask(Command::MVP, 0, 5, 1'000'000);
  pass(seconds(6));
  EXPECT_EQ(get(ap::actual_velocity, 5), 30'000);
  set(4, 10'000, 5);
  pass(seconds(1));
  EXPECT_EQ(get(ap::actual_velocity, 5), 10'000);
}

TEST_F(SimFamilies, ASixPointMotorTurnsWhenItsTargetVelocityIsWritten) {
  add(6212);
  EXPECT_EQ(set(2, -5'000), ok);
  pass(seconds(1));
  EXPECT_EQ(get(ap::actual_velocity), -5'000);
  ask(Command::MST, 0, 0);
  EXPECT_EQ(get(2), 0);
  pass(seconds(1));
  EXPECT_EQ(get(ap::actual_velocity), 0);
  EXPECT_EQ(bench.next_due(), never);
}

TEST_F(SimFamilies, ASixPointMotorMovesRelativeToWhatItWasTold) {
  add(6212);
  ask(Command::MVP, 0, 0, 1'000'000);
  pass(seconds(1));
  EXPECT_EQ(ask(Command::MVP, 1, 0, 500)->value, 1'000'500);
  EXPECT_EQ(get(ap::target_position), 1'000'500);
  EXPECT_EQ(set(127, 1), ok);
  const auto here = get(ap::actual_position);
  EXPECT_EQ(ask(Command::MVP, 1, 0, 500)->value, here + 500);
  EXPECT_EQ(set(127, 2), no_value);  // there is no encoder
  ask(Command::SAP, ap::actual_position, 0, INT32_MAX);
  EXPECT_EQ(ask(Command::MVP, 1, 0, 1)->value, INT32_MIN);  // round the corner
}

TEST_F(SimFamilies, ASixPointMotorWaitsBeforeItTurnsRound) {
  add(6212);
  set(21, 62'500);  // 2 s
  ask(Command::MVP, 0, 0, 10'000);
  pass(seconds(4));
  EXPECT_EQ(get(ap::actual_position), 10'000);
  ask(Command::MVP, 0, 0, 0);
  pass(milliseconds(100));
  EXPECT_LT(get(ap::actual_velocity), 0);
  ask(Command::MVP, 0, 0, 10'000);
  pass(milliseconds(1500));
  EXPECT_EQ(get(ap::actual_velocity), 0);
  EXPECT_LT(get(ap::actual_position), 10'000);
  pass(seconds(4));
  EXPECT_EQ(get(ap::actual_position), 10'000);
}

// ---- Time --------------------------------------------------------------------------------------

TEST(SimTickClock, IsExact) {
  std::mt19937_64 random(test::seed());
  SCOPED_TRACE("TMCL_SEED=" + std::to_string(test::seed()));
  const TimePoint power_on(seconds(12'345) + Duration(678));
  for (const std::uint64_t rate : {31'250ULL, 500'000ULL, 16'000'000ULL, 999'999'999ULL}) {
    const TickClock clock(power_on, rate);
    EXPECT_EQ(clock.at(power_on), 0U);
    EXPECT_EQ(clock.of(0), power_on);
    EXPECT_EQ(clock.at(power_on + hours(24 * 365)), rate * 24 * 365 * 3600);
    EXPECT_EQ(clock.of(ramp::forever), never);
    for (int i = 0; i < 10'000; ++i) {
      const auto tick = random() >> std::uniform_int_distribution<int>(8, 63)(random);
      const auto time = clock.of(tick);
      if (time == never) continue;
      ASSERT_EQ(clock.at(time), tick) << rate;
      ASSERT_TRUE(tick == 0 || clock.at(time - Duration(1)) == tick - 1) << rate << " " << tick;
    }
  }
}

// The first tick that is not before this one, in nanoseconds; worked out another way than by the
// simulator.
TimePoint time_of(ramp::Tick tick, double per_second) {
  return TimePoint(Duration(static_cast<Duration::rep>(
      std::ceil(static_cast<long double>(tick) * 1e9L / static_cast<long double>(per_second)))));
}

TEST_F(SimFamilies, ReportTheArrivalWhenTheGeneratorSaysSo) {
  using G429 = ramp::Tmc429;
  G429 tmc429;
  tmc429.write(G429::Register::pulse_div, 2);
  tmc429.write(G429::Register::ramp_div, 3);
  tmc429.write(G429::Register::v_min, 1);
  tmc429.write(G429::Register::v_max, 1000);
  tmc429.write(G429::Register::a_max, 500);
  tmc429.write(G429::Register::x_target, 4'000'000);

  using G457 = ramp::Tmc457;
  G457 tmc457;
  tmc457.write(G457::Register::v_max, 5'000'000);
  tmc457.write(G457::Register::a_max_d_max, 0x6030);
  tmc457.write(G457::Register::bow_max, 11);
  tmc457.write(G457::Register::x_target, 4'000'000);

  using G6 = ramp::SixPoint;
  G6 sixpoint;
  sixpoint.write(G6::Register::vstart, 1);
  sixpoint.write(G6::Register::a1, 219);
  sixpoint.write(G6::Register::v1, 26'843);
  sixpoint.write(G6::Register::amax, 439);
  sixpoint.write(G6::Register::vmax, 53'687);
  sixpoint.write(G6::Register::dmax, 439);
  sixpoint.write(G6::Register::d1, 219);
  sixpoint.write(G6::Register::vstop, 10);
  sixpoint.write(G6::Register::xtarget, 4'000'000);

  const auto arrival = [](const auto& generator) {
    using G = std::decay_t<decltype(generator)>;
    return time_of(ramp::arrival(generator, ramp::last_tick).value(), G::ticks_per_second(16e6));
  };
  add_one_of_each();
  const std::array expected{arrival(tmc429), arrival(tmc457), arrival(sixpoint)};
  const std::set in_order(expected.begin(), expected.end());
  statuses(arm, 0, 1);
  statuses(Command::MVP, 0, 4'000'000);
  for (const auto time : in_order) {
    EXPECT_GT(time, TimePoint(seconds(30)));
    EXPECT_EQ(bench.next_due(), time);
    clock.advance_to(time - Duration(1));
    bench.run_due();
    heard();
    clock.advance_to(time);
    bench.run_due();
    EXPECT_EQ(reply_in(heard())->status, Status::delayed);
  }
  EXPECT_THAT(readings(ap::actual_position), ElementsAre(4'000'000, 4'000'000, 4'000'000));
  EXPECT_THAT(readings(ap::actual_velocity), ElementsAre(0, 0, 0));
  EXPECT_EQ(bench.next_due(), never);
}

TEST_F(SimFamilies, NeedNoAttentionWhileNobodyAskedToBeTold) {
  add_one_of_each();
  EXPECT_EQ(bench.next_due(), never);
  statuses(Command::MVP, 0, 8'000'000);
  EXPECT_EQ(bench.next_due(), never);
  pass(seconds(10));
  EXPECT_THAT(readings(ap::position_reached), ElementsAre(0, 0, 0));
  EXPECT_EQ(bench.next_due(), never);
  statuses(Command::ROR, 0, 1000);
  EXPECT_EQ(bench.next_due(), never);
  pass(seconds(10));
  EXPECT_EQ(bench.next_due(), never);
  statuses(Command::MST, 0);
  EXPECT_EQ(bench.next_due(), never);
}

TEST_F(SimFamilies, AreUpToDateAfterAWeekInWhichNobodyLooked) {
  add_one_of_each();
  statuses(Command::ROR, 0, 100);
  clock.advance(hours(24 * 7));
  bench.run_due();
  const double week = 7 * 24 * 3600;
  const auto x = readings(ap::actual_position);
  const auto turns = [&](double pps, double turn) { return std::remainder(pps * week, turn); };
  EXPECT_NEAR(x[0], turns(to_pps({100}, Tmc429Dividers{2, 3}).value, 1 << 24), 100);
  EXPECT_NEAR(x[1], 100 * 16e6 / (1 << 30) * week, 2);
  EXPECT_NEAR(x[2], std::floor(100 * 1.048576) / 1.048576 * week, 100);
}

TEST_F(SimFamilies, AreLookedAtOnceASecondWhenTheyGoToAndFroForEver) {
  add(142);
  set(5, 1000);
  set(18, 18);  // a bow of 131072 is too much for that
  ask(Command::MVP, 0, 0, 100'000);
  for (int i = 0; i < 60; ++i) {
    const auto due = clock.now() + seconds(1);
    ASSERT_EQ(bench.next_due(), due);
    clock.advance_to(due);
    bench.run_due();
  }
  EXPECT_NEAR(get(ap::actual_position), 100'000, 10'000);
  set(18, 0);
  EXPECT_EQ(bench.next_due(), never);
  pass(hours(1));
  EXPECT_EQ(get(ap::actual_position), 100'000);
}

// ---- Anything ----------------------------------------------------------------------------------

// A module that is awake only when it asked to be, or more often than that.
class Listener {
 public:
  explicit Listener(const Model& model) { bench_.add(model, ModuleAddress{1}); }

  void look_at(TimePoint time) {
    for (auto due = bench_.next_due(); due <= time; due = bench_.next_due()) wake(due);
    clock_.advance_to(std::max(time, clock_.now()));
  }
  void wake(TimePoint time) {
    clock_.advance_to(std::max(time, clock_.now()));
    bench_.run_due();
  }
  void tell(const Request& request) { line_.receive(encode_serial(request)); }
  const Bytes& said() const { return said_; }

 private:
  VirtualClock clock_;
  Bench bench_{clock_};
  Bytes said_;
  SerialLine line_{bench_, [this](std::span<const std::uint8_t> bytes) {
                     said_.insert(said_.end(), bytes.begin(), bytes.end());
                   }};
};

class AnyScript {
 public:
  explicit AnyScript(std::uint64_t seed)
      : random_(seed), model_(models()[below(models().size())]) {}

  const Model& model() const { return model_; }
  Request request() {
    constexpr std::array commands{Command::ROR, Command::ROL, Command::MST, Command::MVP,
                                  Command::SAP, Command::SAP, Command::SAP, Command::GAP,
                                  Command::GAP, Command::GAP, arm};
    const auto command = commands[below(commands.size())];
    const auto table = axis_parameters(model_);
    const bool parameter = command == Command::SAP || command == Command::GAP;
    const auto type = parameter ? table[below(table.size())].number : below(2);
    return {ModuleAddress{1}, command, static_cast<std::uint8_t>(type), 0, value()};
  }
  Duration pause() { return Duration(static_cast<Duration::rep>(below(1ULL << below(31)))); }
  std::uint64_t below(std::uint64_t limit) { return random_() % limit; }

 private:
  std::int32_t value() {
    const auto magnitude = static_cast<std::int64_t>(below(1ULL << below(33)));
    return static_cast<std::int32_t>(below(4) == 0 ? -magnitude : magnitude);
  }

  std::mt19937_64 random_;
  const Model& model_;
};

TEST(SimAnything, AnswersTheSameHoweverOftenItIsLookedAt) {
  for (auto seed = test::seed(); seed != test::seed() + 2000; ++seed) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed));
    AnyScript script(seed);
    Listener seldom(script.model());
    Listener often(script.model());
    TimePoint now{};
    for (int i = 0; i < 40; ++i) {
      for (auto looks = script.below(4); looks != 0; --looks) {
        now += script.pause();
        often.look_at(now);
        often.wake(now);
      }
      now += script.pause();
      seldom.look_at(now);
      often.look_at(now);
      const auto request = script.request();
      seldom.tell(request);
      often.tell(request);
      ASSERT_EQ(seldom.said(), often.said()) << "request " << i;
    }
    ASSERT_GE(seldom.said().size(), 40 * serial_datagram_size);
  }
}

}  // namespace
}  // namespace tmcl::sim
