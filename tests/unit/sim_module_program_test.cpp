// Stand-alone programs on a whole module, through its serial line and CAN.
#include <string>

#include "sim/program/calculation.hpp"
#include "sim/program/interrupts.hpp"
#include "sim_fixture.hpp"
#include "support/program_host.hpp"
#include "tmcl/program.hpp"

namespace tmcl::sim {
namespace {

using program::Instruction;
using program::Program;

constexpr std::uint8_t variables = 2;
constexpr std::uint8_t interrupts = 3;
constexpr std::int32_t reset_code = 1234;

constexpr std::uint8_t type_of(Calculation calculation) {
  return static_cast<std::uint8_t>(calculation);
}

class ModuleProgramTest : public SimTest {
 protected:
  Status send(const Instruction& to_send) {
    return status_of(to_send.command, to_send.type, to_send.motor, to_send.value);
  }
  void download(const std::string& text, std::int32_t first = 0) {
    ASSERT_EQ(status_of(Command::START_DOWNLOAD, 0, 0, first), Status::ok);
    for (const auto& each : assembled(text)) ASSERT_EQ(send(each), Status::command_loaded);
    ASSERT_EQ(status_of(Command::END_DOWNLOAD, 0, 0), Status::ok);
  }
  void run(const std::string& text) {
    download(text);
    ASSERT_EQ(status_of(Command::RUN_APPLICATION, 1, 0, 0), Status::ok);
  }
  void restart() {
    ASSERT_EQ(status_of(Command::SOFTWARE_RESET, 0, 0, reset_code), Status::ok);
    pass(Module::boot_time);
  }
  std::int32_t global(std::uint8_t number, std::uint8_t bank = 0) {
    return ask(Command::GGP, number, bank).value_or(Reply{.value = INT32_MIN}).value;
  }
  Status set_global(std::uint8_t number, std::int32_t value, std::uint8_t bank = 0) {
    return status_of(Command::SGP, number, bank, value);
  }
  Instruction line_at(std::int32_t address) {
    return program::line_of(*ask(Command::READ_TMCL_MEMORY, 0, 0, address));
  }

  Module& module = add(6110);
};

TEST_F(ModuleProgramTest, WhatIsLoadedCanBeReadAndRun) {
  run("SGP 7, 2, 42\n STOP");
  EXPECT_EQ(line_at(0), (Instruction{Command::SGP, 7, 2, 42}));
  EXPECT_EQ(line_at(1), (Instruction{Command::STOP}));
  EXPECT_EQ(line_at(2), Instruction{});
  pass(milliseconds(1));
  EXPECT_EQ(global(7, variables), 42);
}

TEST_F(ModuleProgramTest, WhatAModuleIsSentDuringADownloadIsStored) {
  ASSERT_EQ(status_of(Command::START_DOWNLOAD, 0, 0), Status::ok);
  EXPECT_EQ(status_of(Command::ROR, 0, 0, 1000), Status::command_loaded);
  EXPECT_EQ(status_of(Command::GGP, 129, 0), Status::command_loaded);
  EXPECT_EQ(status_of(Command::GET_FIRMWARE_VERSION, 1, 0), Status::ok);
  EXPECT_EQ(status_of(Command::END_DOWNLOAD, 0, 0), Status::ok);
  EXPECT_EQ(get(axis_parameter::target_velocity), 0);
  EXPECT_EQ(line_at(0), (Instruction{Command::ROR, 0, 0, 1000}));
  EXPECT_EQ(line_at(1), (Instruction{Command::GGP, 129}));
}

TEST_F(ModuleProgramTest, ALineIsReadOverCanAsWell) {
  download("ROR 1, -5\n STOP");
  can.receive(encode_can(Request{ModuleAddress{1}, Command::READ_TMCL_MEMORY, 0, 0, 0}));
  ASSERT_EQ(can_sent.size(), 1U);
  EXPECT_EQ(program::line_of(*decode_can_reply(can_sent[0])),
            (Instruction{Command::ROR, 0, 1, -5}));
}

TEST_F(ModuleProgramTest, RefusesToReadBeyondTheMemory) {
  const Request request{ModuleAddress{1}, Command::READ_TMCL_MEMORY, 0, 0, 2048};
  EXPECT_TRUE(program::refuses_memory(*ask(request), request));
}

TEST_F(ModuleProgramTest, CommandsOfProgramsAreNotForHosts) {
  for (const auto command :
       {Command::COMP, Command::JA, Command::WAIT, Command::STOP, Command::RETI, Command::CALL}) {
    EXPECT_EQ(status_of(command, 0, 0), Status::command_not_available) << name_of(command);
  }
  EXPECT_EQ(status_of(Command{18}, 0, 0), Status::invalid_command);
}

TEST_F(ModuleProgramTest, AHostCanCalculate) {
  EXPECT_EQ(status_of(Command::CALC, type_of(Calculation::load), 0, 700), Status::ok);
  EXPECT_EQ(status_of(Command::AGP, 3, variables), Status::ok);
  EXPECT_EQ(global(3, variables), 700);
  EXPECT_EQ(status_of(Command::CALCX, type_of(Calculation::load), 0), Status::ok);
  EXPECT_EQ(status_of(Command::CALCXV, type_of(Calculation::add), 3), Status::ok);
  EXPECT_EQ(status_of(Command::CALCVX, type_of(Calculation::load), 4), Status::ok);
  EXPECT_EQ(global(4, variables), 1400);
  EXPECT_EQ(status_of(Command::AAP, axis_parameter::max_velocity, 0), Status::ok);
  EXPECT_EQ(get(axis_parameter::max_velocity), 700);
  EXPECT_EQ(status_of(Command::MVPA, 0, 0), Status::ok);
  EXPECT_EQ(get(axis_parameter::target_position), 700);
  EXPECT_EQ(ask(Command::CALC, type_of(Calculation::divide), 0, 0)->status, Status::invalid_value);
  EXPECT_EQ(status_of(Command::CALC, 99, 0, 0), Status::wrong_type);
}

TEST_F(ModuleProgramTest, AHostCanSetUpInterrupts) {
  download("JA 0\n SGP 0, 2, 1\n RETI");
  EXPECT_EQ(status_of(Command::SGP, 0, 3, 20), Status::ok);
  EXPECT_EQ(status_of(Command::RUN_APPLICATION, 0, 0), Status::ok);
  EXPECT_EQ(status_of(Command::VECT, interrupt::timer, 0, 1), Status::ok);
  EXPECT_EQ(status_of(Command::EI, interrupt::timer, 0), Status::ok);
  EXPECT_EQ(status_of(Command::EI, interrupt::global_enable, 0), Status::ok);
  pass(milliseconds(10));
  EXPECT_EQ(global(0, variables), 0);
  pass(milliseconds(20));
  EXPECT_EQ(global(0, variables), 1);
  EXPECT_EQ(status_of(Command::DI, interrupt::global_enable, 0), Status::ok);
  ask(Command::SGP, 0, variables, 0);
  pass(milliseconds(100));
  EXPECT_EQ(global(0, variables), 0);
  EXPECT_EQ(status_of(Command::VECT, 99, 0, 1), Status::wrong_type);
  EXPECT_EQ(status_of(Command::VECT, interrupt::timer, 0, 99'999), Status::invalid_value);
}

TEST_F(ModuleProgramTest, TellsHowTheProgramIsDoing) {
  run("WAIT TICKS, 0, 10\n MST 9\n STOP");
  EXPECT_EQ(global(128), 1);
  EXPECT_EQ(global(130), 0);
  EXPECT_EQ(global(131), 0);
  EXPECT_EQ(ask(Command::GET_APPLICATION_STATUS, 0, 0)->value, 1 << 24);
  pass(milliseconds(101));
  EXPECT_EQ(global(128), 0);
  EXPECT_EQ(global(130), 1);
  EXPECT_EQ(global(131), static_cast<std::int32_t>(Status::invalid_value));
}

TEST_F(ModuleProgramTest, MovesAMotorAndWaitsForIt) {
  run("MVP ABS, 2, 4000\n WAIT POS, 2, 0\n GAP 1, 2\n AGP 0, 2\n MVP ABS, 2, 0\n STOP");
  pass(std::chrono::seconds(20));
  EXPECT_EQ(global(0, variables), 4000);
  EXPECT_EQ(get(axis_parameter::actual_position, 2), 0);
  EXPECT_EQ(global(131), 0);
}

TEST_F(ModuleProgramTest, WaitsToTheTick) {
  run("MVP ABS, 0, 4000\n WAIT POS, 0, 0\n GGP 132, 0\n AGP 0, 2\n STOP");
  TimePoint arrived{};
  while (clock.now() < TimePoint{} + std::chrono::seconds(20)) {
    pass(milliseconds(1));
    if (arrived == TimePoint{} && get(axis_parameter::position_reached) == 1) arrived = clock.now();
  }
  const auto noticed = milliseconds(global(0, variables));
  EXPECT_GE(arrived - TimePoint{}, noticed);
  EXPECT_LE(arrived - TimePoint{}, noticed + milliseconds(1));
}

TEST_F(ModuleProgramTest, ABusyProgramLeavesTheModuleFree) {
  run("Loop: CALCV ADD, 0, 1\n JA Loop");
  pass(milliseconds(100));
  EXPECT_EQ(get(axis_parameter::actual_position), 0);
  const auto counted = global(0, variables);
  EXPECT_NEAR(counted, 500, 5);
  EXPECT_EQ(status_of(Command::STOP_APPLICATION, 0, 0), Status::ok);
  pass(milliseconds(100));
  EXPECT_NEAR(global(0, variables), counted, 2);
}

TEST_F(ModuleProgramTest, AHostMayInterfere) {
  run("WAIT POS, 0, 0\n SGP 0, 2, 1\n STOP");
  pass(milliseconds(1));
  EXPECT_EQ(global(0, variables), 1);
  ask(Command::MVP, 0, 0, 100000);
  ask(Command::RUN_APPLICATION, 1, 0, 0);
  set_global(0, 0, variables);
  pass(milliseconds(100));
  EXPECT_EQ(global(0, variables), 0);
  ask(Command::SAP, axis_parameter::target_position, 0, get(axis_parameter::actual_position));
}

TEST_F(ModuleProgramTest, AnInputInterruptsAtOnce) {
  set_global(39, 1, interrupts);
  run("VECT 39, Pressed\n EI 39\n EI 255\n Loop: WAIT TICKS, 0, 1000\n JA Loop\n"
      "Pressed: GGP 132, 0\n AGP 0, 2\n RETI");
  pass(milliseconds(1234));
  ASSERT_TRUE(module.set_input(0, true));
  pass(milliseconds(1));
  EXPECT_EQ(global(0, variables), 1234);
}

TEST_F(ModuleProgramTest, ATimerInterrupts) {
  set_global(0, 20, interrupts);
  run("VECT 0, Tick\n EI 0\n EI 255\n Loop: JA Loop\n Tick: CALCV ADD, 0, 1\n RETI");
  pass(milliseconds(1010));
  EXPECT_EQ(global(0, variables), 50);
}

TEST_F(ModuleProgramTest, AStopSwitchInterrupts) {
  module.mount(1, {.right_switch = 100'000});
  set_global(30, 1, interrupts);
  run("VECT 30, Struck\n EI 30\n EI 255\n ROR 1, 500\n Loop: JA Loop\n"
      "Struck: GAP 1, 1\n AGP 0, 2\n RETI");
  pass(std::chrono::seconds(10));
  const auto struck = global(0, variables);
  EXPECT_GT(struck, 0);
  EXPECT_EQ(struck, get(axis_parameter::actual_position, 1));
}

TEST_F(ModuleProgramTest, WhoeverPressesASwitchIsSeenAtOnce) {
  module.mount(2, {.home = Interval{5000, 6000}});
  run("WAIT REFSW, 2, 0\n GGP 132, 0\n AGP 0, 2\n STOP");
  pass(milliseconds(777));
  module.at_stage(2, [](Stage& stage) { stage.press(StageSwitch::home, true); });
  pass(milliseconds(1));
  EXPECT_EQ(global(0, variables), 777);
}

TEST_F(ModuleProgramTest, AStallInterrupts) {
  constexpr std::uint8_t stop_on_stall = 181;
  module.mount(0, {.load = 100});
  ask(Command::SAP, stop_on_stall, 0, 50);
  run("VECT 15, Stalled\n EI 15\n EI 255\n ROR 0, 500\n Loop: WAIT TICKS, 0, 1000\n JA Loop\n"
      "Stalled: CALCV ADD, 0, 1\n RETI");
  pass(std::chrono::seconds(3));
  EXPECT_EQ(global(0, variables), 0);
  module.at_stage(0, [](Stage& stage) { stage.set_load(1000); });
  pass(std::chrono::seconds(1));
  EXPECT_EQ(global(0, variables), 1);
  EXPECT_EQ(get(axis_parameter::actual_velocity), 0);
}

TEST_F(ModuleProgramTest, WaitsForAReferenceSearch) {
  module.mount(0, {.left_switch = -20'000});
  run("SAP 193, 0, 1\n RFS START, 0\n RFS STATUS, 0\n AGP 0, 2\n WAIT RFS, 0, 0\n RFS STATUS, 0\n"
      "AGP 1, 2\n GAP 1, 0\n AGP 2, 2\n STOP");
  pass(std::chrono::seconds(60));
  EXPECT_EQ(global(128), 0);
  EXPECT_NE(global(0, variables), 0);
  EXPECT_EQ(global(1, variables), 0);
}

TEST_F(ModuleProgramTest, StartsByItself) {
  download("SGP 60, 2, 7\n STOP");
  ASSERT_EQ(set_global(77, 1), Status::ok);
  restart();
  pass(milliseconds(1));
  EXPECT_EQ(global(60, variables), 7);
}

TEST_F(ModuleProgramTest, CodeProtection) {
  download("SGP 60, 2, 7\n STOP");
  ASSERT_EQ(set_global(81, 3), Status::ok);
  const Request read{ModuleAddress{1}, Command::READ_TMCL_MEMORY, 0, 0, 0};
  EXPECT_TRUE(program::refuses_memory(*ask(read), read));
  EXPECT_EQ(status_of(Command::START_DOWNLOAD, 0, 0), Status::write_protected);
  ASSERT_EQ(set_global(81, 0), Status::ok);
  EXPECT_EQ(line_at(0), Instruction{});
  restart();
  EXPECT_EQ(line_at(0), Instruction{});
}

TEST_F(ModuleProgramTest, AProgramSurvivesARestart) {
  download("SGP 60, 2, 7\n STOP");
  restart();
  EXPECT_EQ(line_at(0), (Instruction{Command::SGP, 60, 2, 7}));
  EXPECT_EQ(global(128), 0);
  pass(milliseconds(10));
  EXPECT_EQ(global(60, variables), 0);
}

TEST_F(ModuleProgramTest, ADownloadThatARestartCutsShortLeavesTheOldProgram) {
  download("SGP 60, 2, 7\n STOP");
  ASSERT_EQ(status_of(Command::START_DOWNLOAD, 0, 0), Status::ok);
  ASSERT_EQ(status_of(Command::ROR, 0, 0, 1000), Status::command_loaded);
  restart();
  EXPECT_EQ(global(129), 0);
  EXPECT_EQ(line_at(0), (Instruction{Command::SGP, 60, 2, 7}));
}

TEST_F(ModuleProgramTest, IsGoneAfterAFactoryReset) {
  download("SGP 60, 2, 7\n STOP");
  EXPECT_EQ(ask(Command::FACTORY_RESET, 0, 0, reset_code), std::nullopt);
  pass(Module::boot_time);
  EXPECT_EQ(line_at(0), Instruction{});
}

TEST_F(ModuleProgramTest, AProgramThatReadsItsOwnState) {
  run("GGP 128, 0\n AGP 0, 2\n GGP 130, 0\n AGP 1, 2\n STOP");
  pass(milliseconds(1));
  EXPECT_EQ(global(0, variables), 1);
  EXPECT_EQ(global(1, variables), 2);
}

}  // namespace
}  // namespace tmcl::sim
