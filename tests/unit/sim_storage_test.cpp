#include <gmock/gmock.h>

#include <set>

#include "sim_fixture.hpp"

namespace tmcl::sim {
namespace {

namespace ap = axis_parameter;
namespace gp = global_parameter;

using Area = EepromCell::Area;

constexpr std::int32_t reset_code = 1234;
constexpr std::uint8_t variables = Globals::variable_bank;
constexpr std::uint8_t interrupts = Globals::interrupt_bank;

class SimStorage : public SimTest {
 protected:
  void restart() {
    EXPECT_EQ(status_of(Command::SOFTWARE_RESET, 0, 0, reset_code), Status::ok);
    pass(Module::boot_time);
  }
  std::int32_t global(std::uint8_t number, std::uint8_t bank = 0) {
    return ask(Command::GGP, number, bank).value_or(Reply{.value = INT32_MIN}).value;
  }
  Request to(std::uint16_t address, Command command, std::uint8_t type, std::uint8_t motor,
             std::int32_t value = 0) {
    return {ModuleAddress{address}, command, type, motor, value};
  }
};

TEST_F(SimStorage, KeepsAnAxisParameterOnlyOnceItIsStored) {
  add(3110);
  ask(Command::SAP, ap::max_velocity, 1, 321);
  ask(Command::SAP, ap::max_acceleration, 1, 77);
  EXPECT_EQ(status_of(Command::STAP, ap::max_velocity, 1), Status::ok);
  restart();
  EXPECT_EQ(get(ap::max_velocity, 1), 321);
  EXPECT_EQ(get(ap::max_acceleration, 1), 500);
  EXPECT_EQ(get(ap::max_velocity, 0), 1000);
}

TEST_F(SimStorage, StoresWhatIsInForceAndNotTheValueOfTheCommand) {
  add(1110);
  ask(Command::SAP, ap::max_velocity, 0, 321);
  EXPECT_EQ(ask(Command::STAP, ap::max_velocity, 0, 5)->value, 5);
  ask(Command::SAP, ap::max_velocity, 0, 9);
  EXPECT_EQ(status_of(Command::RSAP, ap::max_velocity, 0), Status::ok);
  EXPECT_EQ(get(ap::max_velocity), 321);
}

TEST_F(SimStorage, RestoresTheFactorySettingOfWhatWasNeverStored) {
  add(1110);
  ask(Command::SAP, ap::max_velocity, 0, 321);
  EXPECT_EQ(status_of(Command::RSAP, ap::max_velocity, 0), Status::ok);
  EXPECT_EQ(get(ap::max_velocity), 1000);
}

TEST_F(SimStorage, FindsErrorsOfStoringInTheOrderOfTheManual) {
  add(1110);
  ask(Command::SGP, 73, 0, 1234);
  for (const auto command : {Command::STAP, Command::RSAP}) {
    EXPECT_EQ(status_of(command, ap::actual_position, 9), Status::wrong_type);
    EXPECT_EQ(status_of(command, 99, 9), Status::wrong_type);
    EXPECT_EQ(status_of(command, ap::max_velocity, 9), Status::invalid_value);
  }
  for (const auto command : {Command::STGP, Command::RSGP}) {
    EXPECT_EQ(status_of(command, 132, 0), Status::wrong_type);
    EXPECT_EQ(status_of(command, 99, 0), Status::wrong_type);
    EXPECT_EQ(status_of(command, gp::serial_address, 1), Status::invalid_value);
    EXPECT_EQ(status_of(command, 56, variables), Status::wrong_type);
  }
}

TEST_F(SimStorage, CountsInTheStoredUnitModeAfterAStart) {
  add(6212);
  ask(Command::SAP, 255, 0, 0);
  ask(Command::SAP, ap::max_velocity, 0, 123'456);
  ask(Command::STAP, 255, 0);
  ask(Command::STAP, ap::max_velocity, 0);
  restart();
  EXPECT_EQ(get(255), 0);
  EXPECT_EQ(get(ap::max_velocity), 123'456);
}

TEST_F(SimStorage, LosesPositionsAndMovementsAtARestart) {
  auto& module = add(3110);
  ask(Command::SAP, ap::actual_position, 0, 5000);
  ask(Command::SAP, ap::target_position, 0, 5000);
  ask(Command::ROR, 0, 1, 1000);
  ask(Command::TARGET_REACHED_EVENT, 1, 0, 7);
  ask(Command::MVP, 0, 2, 100'000);
  pass(milliseconds(50));
  EXPECT_EQ(status_of(Command::SOFTWARE_RESET, 0, 0, reset_code), Status::ok);
  for (std::size_t motor = 0; motor < 3; ++motor) {
    EXPECT_EQ(module.axis(motor).get(ap::actual_velocity), 0);
    EXPECT_EQ(module.axis(motor).get(ap::actual_position), 0);
  }
  heard();
  pass(std::chrono::seconds(10));
  EXPECT_THAT(heard(), testing::IsEmpty());  // the event is forgotten
  EXPECT_EQ(get(ap::actual_position, 1), 0);
}

TEST_F(SimStorage, KnowsAfterAPowerCycleWhatItsEepromHolds) {
  auto& module = add(3110);
  ask(Command::SAP, ap::max_velocity, 0, 321);
  ask(Command::STAP, ap::max_velocity, 0);
  ask(Command::SAP, ap::max_acceleration, 0, 123);
  ask(Command::SGP, 255, 2, 4711);
  ask(Command::ROR, 0, 1, 1000);
  pass(std::chrono::seconds(5));
  EXPECT_EQ(global(132), 5000);
  module.power_cycle();
  EXPECT_EQ(module.axis(1).get(ap::actual_velocity), 0);
  pass(Module::boot_time - milliseconds(1));
  EXPECT_FALSE(ask(Command::GAP, 1, 0));
  pass(milliseconds(1));
  EXPECT_EQ(global(132), Module::boot_time / milliseconds(1)) << "its clock began anew";
  EXPECT_EQ(get(ap::max_velocity), 321);
  EXPECT_NE(get(ap::max_acceleration), 123);
  EXPECT_EQ(get(ap::actual_position, 1), 0);
  EXPECT_EQ(ask(Command::GGP, 255, 2)->value, 0);
}

TEST_F(SimStorage, HasATickTimerInEveryModel) {
  for (const auto& model : models())
    EXPECT_TRUE(find_parameter(global_parameters(model), "tick_timer")) << model.name;
}

TEST_F(SimStorage, IsDeafWhileItStarts) {
  add(1110);
  ask(Command::SOFTWARE_RESET, 0, 0, reset_code);
  EXPECT_FALSE(ask(Command::ROR, 0, 0, 1000));
  pass(Module::boot_time - milliseconds(1));
  EXPECT_FALSE(ask(Command::GAP, 1, 0));
  pass(milliseconds(1));
  EXPECT_EQ(get(ap::actual_velocity), 0);
  EXPECT_EQ(global(132), Module::boot_time / milliseconds(1));
}

TEST_F(SimStorage, RestartsOnlyWithTheRightCode) {
  add(1110);
  ask(Command::SAP, ap::max_velocity, 0, 321);
  EXPECT_EQ(status_of(Command::SOFTWARE_RESET, 0, 0, 1), Status::invalid_value);
  EXPECT_EQ(status_of(Command::FACTORY_RESET, 0, 0, 1), Status::invalid_value);
  EXPECT_EQ(get(ap::max_velocity), 321);
}

TEST_F(SimStorage, AnswersARestartEvenIfRepliesWereSuppressedUntilThen) {
  add(1110);
  ask(Command::SGP, 255, 0, 1);
  EXPECT_FALSE(ask(Command::SOFTWARE_RESET, 0, 0, reset_code));
  pass(Module::boot_time);
  EXPECT_TRUE(ask(Command::MST, 0, 0));
}

TEST_F(SimStorage, WritesGlobalParametersStraightToTheEeprom) {
  auto& module = add(1110);
  const auto before = module.eeprom().writes();
  ask(Command::SGP, gp::telegram_pause_time, 0, 3);
  ask(Command::SGP, 132, 0, 100);
  EXPECT_EQ(module.eeprom().writes(), before + 1);
  pass(milliseconds(3));
  heard();
  line.receive(encode_serial(Request{ModuleAddress{1}, Command::SOFTWARE_RESET, 0, 0, reset_code}));
  pass(Module::boot_time);
  EXPECT_EQ(module.globals().value(gp::telegram_pause_time), 3);
}

TEST_F(SimStorage, KeepsItsAddressUntilAFactoryReset) {
  add(1110, 7);
  EXPECT_EQ(ask(to(7, Command::SGP, gp::serial_address, 0, 9))->module, 7);
  EXPECT_EQ(ask(to(9, Command::SOFTWARE_RESET, 0, 0, reset_code))->module, 9);
  pass(Module::boot_time);
  EXPECT_TRUE(ask(to(9, Command::GAP, 1, 0)));
  EXPECT_FALSE(ask(to(9, Command::FACTORY_RESET, 0, 0, reset_code)));
  pass(Module::boot_time);
  EXPECT_FALSE(ask(to(9, Command::GAP, 1, 0)));
  EXPECT_TRUE(ask(to(1, Command::GAP, 1, 0)));
}

TEST_F(SimStorage, ForgetsEverythingAtAFactoryReset) {
  add(1110);
  ask(Command::SAP, ap::max_velocity, 0, 321);
  ask(Command::STAP, ap::max_velocity, 0);
  ask(Command::SGP, 5, variables, 42);
  ask(Command::STGP, 5, variables);
  ask(Command::SGP, gp::serial_heartbeat, 0, 60'000);
  EXPECT_FALSE(ask(Command::FACTORY_RESET, 0, 0, reset_code));
  pass(Module::boot_time);
  EXPECT_EQ(get(ap::max_velocity), 1000);
  EXPECT_EQ(global(5, variables), 0);
  EXPECT_EQ(global(gp::serial_heartbeat), 0);
}

TEST_F(SimStorage, GoesBackToFactorySettingsWhenTheMagicNumberIsGone) {
  add(1110);
  ask(Command::SAP, ap::max_velocity, 0, 321);
  ask(Command::STAP, ap::max_velocity, 0);
  EXPECT_EQ(status_of(Command::SGP, gp::eeprom_magic, 0, 0), Status::ok);
  EXPECT_EQ(get(ap::max_velocity), 321);
  restart();
  EXPECT_EQ(get(ap::max_velocity), 1000);
  EXPECT_EQ(global(gp::eeprom_magic), 228);
}

TEST_F(SimStorage, WritesNothingWhileTheConfigurationIsLocked) {
  auto& module = add(1110);
  EXPECT_EQ(status_of(Command::SGP, 73, 0, 1), Status::invalid_value);
  EXPECT_EQ(status_of(Command::SGP, 73, 0, 1234), Status::ok);
  EXPECT_EQ(global(73), 1);
  const auto writes = module.eeprom().writes();
  EXPECT_EQ(status_of(Command::STAP, ap::max_velocity, 0), Status::eeprom_locked);
  EXPECT_EQ(status_of(Command::SGP, gp::serial_heartbeat, 0, 100), Status::eeprom_locked);
  EXPECT_EQ(status_of(Command::STGP, gp::serial_heartbeat, 0), Status::eeprom_locked);
  EXPECT_EQ(status_of(Command::STGP, 5, variables), Status::eeprom_locked);
  EXPECT_EQ(status_of(Command::SCO, 1, 255, 0), Status::eeprom_locked);
  EXPECT_EQ(status_of(Command::FACTORY_RESET, 0, 0, reset_code), Status::eeprom_locked);
  EXPECT_EQ(module.eeprom().writes(), writes);
  EXPECT_EQ(global(gp::serial_heartbeat), 0);
  EXPECT_EQ(status_of(Command::SGP, 132, 0, 0), Status::ok);
  EXPECT_EQ(status_of(Command::SGP, 5, variables, 1), Status::ok);
  restart();
  EXPECT_EQ(global(73), 1);
  EXPECT_EQ(status_of(Command::SGP, 73, 0, 4321), Status::ok);
  EXPECT_EQ(global(73), 0);
  EXPECT_EQ(status_of(Command::STAP, ap::max_velocity, 0), Status::ok);
}

TEST_F(SimStorage, KeepsTheFirstUserVariablesIfTheyAreStored) {
  add(1110);
  for (const auto number : std::to_array<std::uint8_t>({0, 55, 56, 255})) {
    EXPECT_EQ(status_of(Command::SGP, number, variables, -1000 - number), Status::ok);
    EXPECT_EQ(global(number, variables), -1000 - number);
  }
  ask(Command::STGP, 55, variables);
  ask(Command::SGP, 55, variables, 7);
  EXPECT_EQ(status_of(Command::RSGP, 55, variables), Status::ok);
  EXPECT_EQ(global(55, variables), -1055);
  restart();
  EXPECT_EQ(global(55, variables), -1055);
  for (const auto number : std::to_array<std::uint8_t>({0, 56, 255}))
    EXPECT_EQ(global(number, variables), 0);
}

TEST_F(SimStorage, StartsWithUserVariablesOfZeroIfToldTo) {
  add(1110);
  ask(Command::SGP, 5, variables, 42);
  ask(Command::STGP, 5, variables);
  ask(Command::SGP, 85, 0, 1);
  restart();
  EXPECT_EQ(global(5, variables), 0);
  ask(Command::RSGP, 5, variables);
  EXPECT_EQ(global(5, variables), 42);
}

TEST_F(SimStorage, KnowsTheSettingsOfInterrupts) {
  add(1110);
  EXPECT_EQ(status_of(Command::SGP, 0, interrupts, 500), Status::ok);
  EXPECT_EQ(global(0, interrupts), 500);
  EXPECT_EQ(status_of(Command::SGP, 0, interrupts, -1), Status::invalid_value);
  EXPECT_EQ(status_of(Command::SGP, 3, interrupts, 1), Status::wrong_type);
  EXPECT_EQ(status_of(Command::SGP, 28, interrupts, 3), Status::ok);
  EXPECT_EQ(status_of(Command::SGP, 28, interrupts, 4), Status::invalid_value);
  EXPECT_EQ(status_of(Command::SGP, 26, interrupts, 1), Status::wrong_type);
  EXPECT_EQ(status_of(Command::SGP, 39, interrupts, 1), Status::ok);
  ask(Command::STGP, 39, interrupts);
  restart();
  EXPECT_EQ(global(39, interrupts), 1);
  EXPECT_EQ(global(0, interrupts), 0);
}

TEST_F(SimStorage, RefusesBanksThatDoNotExist) {
  add(1110);
  EXPECT_EQ(status_of(Command::SGP, gp::serial_heartbeat, 1, 5), Status::invalid_value);
  EXPECT_EQ(status_of(Command::SGP, gp::serial_heartbeat, 4, 5), Status::invalid_value);
  EXPECT_EQ(status_of(Command::GGP, 99, 4), Status::wrong_type);
}

TEST_F(SimStorage, MakesANewRandomNumberEachTime) {
  add(1110);
  std::set<std::int32_t> seen;
  for (int i = 0; i < 100; ++i) seen.insert(global(133));
  EXPECT_GE(*seen.begin(), 0);
  EXPECT_GT(seen.size(), 95U);
  EXPECT_EQ(status_of(Command::SGP, 133, 0, 1), Status::wrong_type);
}

TEST_F(SimStorage, CountsEveryWrite) {
  auto& module = add(6110);
  int calls = 0;
  module.eeprom().on_write([&] { ++calls; });
  ask(Command::STAP, ap::max_velocity, 0);
  ask(Command::STAP, ap::max_velocity, 0);  // the same value wears it as well
  EXPECT_EQ(module.eeprom().writes(), 2U);
  ask(Command::SCO, 0, 255, 0);
  EXPECT_EQ(module.eeprom().writes(), 2U + 20 * 6);
  EXPECT_EQ(calls, 2 + 20 * 6);
}

TEST_F(SimStorage, RemembersBetweenRuns) {
  auto& first = add(3110, 7);
  ask(to(7, Command::SAP, ap::max_velocity, 2, 55));
  ask(to(7, Command::STAP, ap::max_velocity, 2));
  ask(to(7, Command::SGP, 84, 0, 1));
  ask(to(7, Command::SCO, 20, 1, -99));
  first.eeprom().write_program(Bytes(16, 3));
  const auto image = first.eeprom().to_image(first.model());
  ask(to(7, Command::SGP, gp::serial_address, 0, 8));  // out of the way
  auto copy = Eeprom::from_image(image, first.model());
  ASSERT_TRUE(copy) << copy.error();
  auto& second = bench.add(first.model(), std::move(*copy));
  EXPECT_EQ(second.eeprom().writes() + 1, first.eeprom().writes());
  EXPECT_EQ(second.axis(2).get(ap::max_velocity), 55);
  EXPECT_EQ(ask(to(7, Command::GCO, 20, 1))->value, -99);
  EXPECT_TRUE(std::ranges::equal(second.eeprom().program(), Bytes(16, 3)));
}

TEST(EepromImage, IsRefusedWhereverItIsDamaged) {
  const auto& model = *find_model(1110);
  Eeprom eeprom;
  eeprom.write({Area::axis_parameter, 0, 4}, 5);
  eeprom.write_program(Bytes(8, 1));
  const auto image = eeprom.to_image(model);
  ASSERT_TRUE(Eeprom::from_image(image, model));
  for (std::size_t i = 0; i < image.size(); ++i) {
    auto damaged = image;
    damaged[i] ^= 0x10;
    EXPECT_FALSE(Eeprom::from_image(damaged, model)) << i;
    EXPECT_FALSE(Eeprom::from_image(std::span(image).first(i), model)) << i;
  }
}

TEST(EepromImage, SaysWhatIsWrong) {
  const auto refusal = [](std::span<const std::uint8_t> image) {
    const auto result = Eeprom::from_image(image, *find_model(1110));
    return result ? std::string() : result.error();
  };
  Eeprom eeprom;
  auto image = eeprom.to_image(*find_model(6110));
  EXPECT_EQ(refusal(image), "is of a TMCM-6110, not of a TMCM-1110");
  image.back() ^= 1;
  EXPECT_EQ(refusal(image), "is damaged: its checksum is wrong");
  EXPECT_EQ(refusal(Bytes(5)), "is not the memory of a simulated module");
  eeprom.write({Area::coordinate, 1, 1}, 0);  // this model has one motor only
  EXPECT_EQ(refusal(eeprom.to_image(*find_model(1110))), "is damaged: its contents make no sense");
}

TEST(EepromImage, HasTheCoordinatesThatAMotorHas) {
  const auto& model = *find_model(1110);
  Eeprom eeprom;
  eeprom.write({Area::coordinate, 0, 20}, -7);
  const auto good = Eeprom::from_image(eeprom.to_image(model), model);
  ASSERT_TRUE(good) << good.error();
  EXPECT_EQ(good->read({Area::coordinate, 0, 20}), -7);
  eeprom.write({Area::coordinate, 0, 21}, 0);
  EXPECT_FALSE(Eeprom::from_image(eeprom.to_image(model), model));
}

TEST_F(SimStorage, SetsGetsAndCapturesCoordinates) {
  add(3110);
  EXPECT_EQ(ask(Command::SCO, 3, 1, -5000)->value, -5000);
  EXPECT_EQ(ask(Command::GCO, 3, 1, 77)->value, -5000);
  EXPECT_EQ(ask(Command::GCO, 3, 0, 77)->value, 0);
  ask(Command::SAP, ap::actual_position, 2, 1234);
  EXPECT_EQ(status_of(Command::CCO, 20, 2), Status::ok);
  EXPECT_EQ(ask(Command::GCO, 20, 2)->value, 1234);
}

TEST_F(SimStorage, MovesToACoordinate) {
  add(3110);
  ask(Command::SCO, 7, 1, 3000);
  ask(Command::TARGET_REACHED_EVENT, 0, 0, 2);
  EXPECT_EQ(ask(Command::MVP, 2, 1, 7)->value, 7);
  heard();
  pass(std::chrono::seconds(2));
  EXPECT_EQ(heard().size(), 9U);  // the event
  EXPECT_EQ(get(ap::actual_position, 1), 3000);
  EXPECT_EQ(get(ap::actual_position, 0), 0);
}

TEST_F(SimStorage, StartsSeveralMotorsInTheSameInstant) {
  for (const auto model : std::to_array<std::uint16_t>({3110, 6212})) {
    const auto address = model;  // only the module addressed moves
    auto& module = add(model, address);
    const auto tell = [&](Command command, std::uint8_t type, std::uint8_t motor,
                          std::int32_t value) {
      return module.execute({ModuleAddress{address}, command, type, motor, value}, Medium::can,
                            can);
    };
    tell(Command::SCO, 1, 0, 40'000);
    tell(Command::SCO, 1, 1, 3'000);
    tell(Command::SCO, 1, 2, -20'000);
    EXPECT_EQ(tell(Command::MVP, 2, 0x80 | 5, 1).status, Status::ok);
    const auto first = module.axis(0).outlook().arrival;
    EXPECT_EQ(module.axis(1).get(ap::target_position), 0);
    EXPECT_LT(module.axis(2).outlook().arrival, first);
    pass(std::chrono::seconds(10));
    EXPECT_EQ(module.axis(0).get(ap::actual_position), 40'000);
    EXPECT_EQ(module.axis(1).get(ap::actual_position), 0);
    EXPECT_EQ(module.axis(2).get(ap::actual_position), -20'000);
  }
}

TEST_F(SimStorage, LetsSeveralMotorsArriveTogether) {
  for (const auto model : std::to_array<std::uint16_t>({3110, 6212})) {
    auto& module = add(model, model);
    const auto tell = [&](Command command, std::uint8_t type, std::uint8_t motor,
                          std::int32_t value) {
      return module.execute({ModuleAddress{model}, command, type, motor, value}, Medium::can, can);
    };
    tell(Command::SCO, 1, 0, 200'000);
    tell(Command::SCO, 1, 1, 30'000);
    tell(Command::SCO, 1, 2, -100'000);
    const auto speed = module.axis(1).get(ap::max_velocity);
    EXPECT_EQ(tell(Command::MVP, 2, 0x40 | 7, 1).status, Status::ok);
    const auto last = module.axis(0).outlook().arrival;
    for (std::size_t motor = 1; motor < 3; ++motor) {
      const auto arrival = module.axis(motor).outlook().arrival;
      EXPECT_LE(arrival, last);
      // As near as whole units of speed allow.
      EXPECT_GT(arrival - clock.now(), (last - clock.now()) * 98 / 100) << model << ' ' << motor;
      EXPECT_EQ(module.axis(motor).get(ap::max_velocity), speed);
    }
    pass(std::chrono::seconds(10));
    EXPECT_EQ(module.axis(1).get(ap::actual_position), 30'000);
    tell(Command::MVP, 0, 1, 0);  // at full speed again
    const auto back = module.axis(1).outlook().arrival - clock.now();
    EXPECT_LT(back, (last - TimePoint{}) / 2);
    pass(std::chrono::seconds(10));
  }
}

TEST_F(SimStorage, RefusesGroupsOfMotorsThatDoNotExist) {
  add(3110, 1);
  add(1110, 2);
  for (const auto field : std::to_array<std::uint8_t>({0x40, 0x80, 0x48, 0x88, 0xC1, 3})) {
    EXPECT_EQ(status_of(Command::MVP, 2, field, 1), Status::invalid_value) << int{field};
  }
  EXPECT_EQ(ask(to(2, Command::MVP, 2, 0x41, 1))->status, Status::invalid_value);
}

TEST_F(SimStorage, RefusesCoordinatesThatDoNotExist) {
  add(3110);
  for (const auto command : {Command::SCO, Command::GCO, Command::CCO}) {
    EXPECT_EQ(status_of(command, 21, 9), Status::wrong_type);
    EXPECT_EQ(status_of(command, 20, 3), Status::invalid_value);
  }
  EXPECT_EQ(status_of(Command::SCO, 1, 0, 1 << 23), Status::invalid_value);
  EXPECT_EQ(status_of(Command::SCO, 1, 255, 1), Status::invalid_value);
  EXPECT_EQ(status_of(Command::MVP, 2, 0, 21), Status::invalid_value);
  EXPECT_EQ(status_of(Command::MVP, 2, 0, -1), Status::invalid_value);
  EXPECT_EQ(status_of(Command::MVP, 2, 3, 1), Status::invalid_value);
}

TEST_F(SimStorage, KeepsCoordinatesThatAreCopiedToTheEeprom) {
  add(3110);
  for (const auto number : std::to_array<std::uint8_t>({0, 1, 2}))
    ask(Command::SCO, number, 1, 100 + number);
  EXPECT_EQ(status_of(Command::SCO, 2, 255, 0), Status::ok);
  restart();
  EXPECT_EQ(ask(Command::GCO, 2, 1)->value, 0);  // parameter 84 says RAM only
  EXPECT_EQ(status_of(Command::GCO, 0, 255), Status::ok);
  EXPECT_EQ(ask(Command::GCO, 0, 1)->value, 0);
  EXPECT_EQ(ask(Command::GCO, 1, 1)->value, 0);
  EXPECT_EQ(ask(Command::GCO, 2, 1)->value, 102);
}

TEST_F(SimStorage, KeepsAllCoordinatesButTheFirstIfToldTo) {
  auto& module = add(3110);
  ask(Command::SGP, 84, 0, 1);
  ask(Command::SCO, 0, 1, 100);
  ask(Command::SCO, 1, 1, 101);
  ask(Command::SAP, ap::actual_position, 1, 555);
  ask(Command::CCO, 2, 1);
  EXPECT_EQ(module.eeprom().writes(), 3U);
  restart();
  EXPECT_EQ(ask(Command::GCO, 0, 1)->value, 0);
  EXPECT_EQ(ask(Command::GCO, 1, 1)->value, 101);
  EXPECT_EQ(ask(Command::GCO, 2, 1)->value, 555);
}

TEST_F(SimStorage, AlwaysKeepsTheCoordinatesOfAModuleWithoutAChoice) {
  add(142);
  ask(Command::SCO, 1, 0, 1 << 30);
  restart();
  EXPECT_EQ(ask(Command::GCO, 1, 0)->value, 1 << 30);
}

}  // namespace
}  // namespace tmcl::sim
