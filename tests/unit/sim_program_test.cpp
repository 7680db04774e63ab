// What the commands of a stand-alone program do, and how it ends.
#include "sim_program_fixture.hpp"

namespace tmcl::sim {
namespace {

constexpr std::int32_t none = 0;

std::int32_t code(Status status) { return static_cast<std::int32_t>(status); }

class ProgramErrorTest : public ProgramTest {
 protected:
  /// Whether a program ends at once, at this command, for this reason.
  void expect_error(Status status, std::int32_t address, const std::string& text) {
    SCOPED_TRACE(text);
    run(text);
    EXPECT_EQ(application.status(), 0);
    EXPECT_EQ(application.last_error(), code(status));
    EXPECT_EQ(application.program_counter(), address);
  }
};

TEST_F(ProgramTest, ANewModuleHasAnEmptyProgram) {
  EXPECT_EQ(application.status(), 0);
  EXPECT_EQ(application.next_due(), never);
  control(Command::RUN_APPLICATION);
  EXPECT_TRUE(running());
  pass(command_time);
  EXPECT_EQ(application.status(), 0);
  EXPECT_EQ(application.last_error(), none);
  EXPECT_EQ(application.program_counter(), 0);
}

TEST_F(ProgramTest, CommandsOfAHostAreGivenToTheModule) {
  run("MVP ABS, 1, -5000\n SAP 4, 1, 77\n MST 1\n STOP");
  ASSERT_EQ(host.performed.size(), 3U);
  EXPECT_EQ(host.performed[0], (Request{ModuleAddress{1}, Command::MVP, 0, 1, -5000}));
  EXPECT_EQ(host.performed[1], (Request{ModuleAddress{1}, Command::SAP, 4, 1, 77}));
  EXPECT_EQ(host.performed[2], (Request{ModuleAddress{1}, Command::MST, 0, 1, 0}));
  EXPECT_EQ(application.last_error(), none);
}

TEST_F(ProgramTest, OneCommandEachCommandTime) {
  run("MST 0\n MST 0\n MST 0\n STOP");
  ASSERT_EQ(host.performed_at.size(), 3U);
  EXPECT_EQ(host.performed_at[1] - host.performed_at[0], command_time);
  EXPECT_EQ(host.performed_at[2] - host.performed_at[0], 2 * command_time);
}

TEST_F(ProgramTest, AnEndlessLoopTakesTime) {
  load("Loop: CALCV ADD, 3, 1\n JA Loop");
  control(Command::RUN_APPLICATION, 1, 0);
  pass(milliseconds(2) - microseconds(1));
  EXPECT_EQ(variable(3), 10);
  EXPECT_TRUE(running());
}

TEST_F(ProgramTest, ReadingLoadsTheAccumulator) {
  host.answers[Command::GAP] = reading(-7);
  host.answers[Command::GGP] = reading(8);
  host.answers[Command::GIO] = reading(9);
  host.answers[Command::GCO] = reading(10);
  host.answers[Command::RFS] = reading(11);
  run("GAP 1, 0\n CALCVA LOAD, 0\n GGP 132, 0\n CALCVA LOAD, 1\n GIO 0, 1\n CALCVA LOAD, 2\n"
      "GCO 1, 0\n CALCVA LOAD, 3\n RFS STATUS, 0\n CALCVA LOAD, 4\n"
      "RFS START, 0\n CALCVA LOAD, 5\n CALC LOAD, 1\n SAP 1, 0, 12\n CALCVA LOAD, 6\n STOP");
  EXPECT_EQ(std::vector(host.variables.begin(), host.variables.begin() + 7),
            (std::vector<std::int32_t>{-7, 8, 9, 10, 11, 11, 1}));
}

TEST_F(ProgramTest, TheAccumulatorGivesTheValue) {
  run("CALC LOAD, -9\n AAP 4, 1\n AGP 5, 2\n ACO 6, 1\n MVPA REL, 1\n ROLA 0\n RORA 1\n STOP");
  EXPECT_EQ(host.performed, (std::vector<Request>{
                                {ModuleAddress{1}, Command::SAP, 4, 1, -9},
                                {ModuleAddress{1}, Command::SGP, 5, 2, -9},
                                {ModuleAddress{1}, Command::SCO, 6, 1, -9},
                                {ModuleAddress{1}, Command::MVP, 1, 1, -9},
                                {ModuleAddress{1}, Command::ROL, 0, 0, -9},
                                {ModuleAddress{1}, Command::ROR, 0, 1, -9},
                            }));
}

TEST_F(ProgramTest, CalculatesWithAConstant) {
  const auto result = [&](const std::string& operation) {
    run("CALC LOAD, 13\n CALC " + operation + "\n CALCVA LOAD, 0\n STOP");
    return variable(0);
  };
  EXPECT_EQ(result("ADD, -20"), -7);
  EXPECT_EQ(result("SUB, 20"), -7);
  EXPECT_EQ(result("MUL, -5000"), -65000);
  EXPECT_EQ(result("DIV, -5"), -2);
  EXPECT_EQ(result("MOD, 5"), 3);
  EXPECT_EQ(result("AND, 6"), 4);
  EXPECT_EQ(result("OR, 6"), 15);
  EXPECT_EQ(result("XOR, 6"), 11);
  EXPECT_EQ(result("NOT, 0"), -14);
  EXPECT_EQ(result("LOAD, 6"), 6);
}

TEST_F(ProgramTest, CalculationsWrap) {
  const auto result = [&](const std::string& first, const std::string& operation) {
    run("CALC LOAD, " + first + "\n CALC " + operation + "\n CALCVA LOAD, 0\n STOP");
    return variable(0);
  };
  EXPECT_EQ(result("2147483647", "ADD, 1"), INT32_MIN);
  EXPECT_EQ(result("-2147483648", "SUB, 1"), INT32_MAX);
  EXPECT_EQ(result("65536", "MUL, 65537"), 65536);
  EXPECT_EQ(result("-2147483648", "DIV, -1"), INT32_MIN);
  EXPECT_EQ(result("-2147483648", "MOD, -1"), 0);
  EXPECT_EQ(result("-7", "DIV, 2"), -3);
  EXPECT_EQ(result("-7", "MOD, 2"), -1);
}

TEST_F(ProgramTest, CalculatesWithTheXRegister) {
  run("CALC LOAD, 6\n CALCX LOAD\n CALC LOAD, 40\n CALCX SUB\n CALCVA LOAD, 0\n"
      "CALCX SWAP\n CALCVA LOAD, 1\n CALCVX LOAD, 2\n CALCX NOT\n CALCVX LOAD, 3\n STOP");
  EXPECT_EQ(variable(0), 34);
  EXPECT_EQ(variable(1), 6);
  EXPECT_EQ(variable(2), 34);
  EXPECT_EQ(variable(3), ~34);
}

TEST_F(ProgramTest, CalculatesWithUserVariables) {
  run("CALCV LOAD, 0, 10\n CALCV LOAD, 1, 3\n CALCVV MOD, 0, 1\n"  // 0: 1
      "CALCV SUB, 1, 8\n"                                          // 1: -5
      "CALC LOAD, 2\n CALCVA MUL, 1\n"                             // 1: -10
      "CALCAV ADD, 1\n"                                            // accumulator: -8
      "CALCXV LOAD, 1\n CALCVX ADD, 0\n"                           // 0: -9
      "CALCVA LOAD, 2\n CALCVV SWAP, 2, 0\n STOP");                // 2: -8, swapped
  EXPECT_EQ(variable(0), -8);
  EXPECT_EQ(variable(1), -10);
  EXPECT_EQ(variable(2), -9);
}

TEST_F(ProgramTest, VariablesByIndex) {
  run("CALC LOAD, 200\n CALCX LOAD\n SIV 42\n GIV\n CALC ADD, 1\n AIV\n GIV\n CALCVA LOAD, 0\n "
      "STOP");
  EXPECT_EQ(variable(200), 43);
  EXPECT_EQ(variable(0), 43);
}

TEST_F(ProgramTest, JumpsUponComparison) {
  const auto jumps = [&](const std::string& condition, int value) {
    host.variables[0] = 0;
    run("CALC LOAD, " + std::to_string(value) + "\n COMP 5\n JC " + condition +
        ", Yes\n STOP\n Yes: CALCV LOAD, 0, 1\n STOP");
    return variable(0) == 1;
  };
  const auto less_equal_greater = [&](const std::string& condition) {
    return std::vector<bool>{jumps(condition, 4), jumps(condition, 5), jumps(condition, 6)};
  };
  EXPECT_EQ(less_equal_greater("EQ"), (std::vector<bool>{false, true, false}));
  EXPECT_EQ(less_equal_greater("NE"), (std::vector<bool>{true, false, true}));
  EXPECT_EQ(less_equal_greater("GT"), (std::vector<bool>{false, false, true}));
  EXPECT_EQ(less_equal_greater("GE"), (std::vector<bool>{false, true, true}));
  EXPECT_EQ(less_equal_greater("LT"), (std::vector<bool>{true, false, false}));
  EXPECT_EQ(less_equal_greater("LE"), (std::vector<bool>{true, true, false}));
}

TEST_F(ProgramTest, ComparesVariables) {
  run("CALCV LOAD, 1, 8\n CALCV COMP, 1, 9\n JC LT, Yes\n STOP\n Yes: CALCV LOAD, 0, 1\n STOP");
  EXPECT_EQ(variable(0), 1);
  EXPECT_EQ(variable(1), 8);
}

TEST_F(ProgramTest, ZeroIsWhatWasLastCalculatedOrRead) {
  host.answers[Command::GIO] = reading(0);
  run("CALC LOAD, 4\n GIO 0, 0\n JC NZ, No\n CALCV LOAD, 0, 1\n"
      "CALC LOAD, 3\n CALC SUB, 3\n COMP 17\n JC ZE, Yes\n No: STOP\n Yes: CALCV ADD, 0, 1\n STOP");
  EXPECT_EQ(variable(0), 2);
}

TEST_F(ProgramTest, CountsDown) {
  run("CALCV LOAD, 9, 3\n Loop: CALCV ADD, 0, 1\n DJNZ 9, Loop\n STOP");
  EXPECT_EQ(variable(0), 3);
  EXPECT_EQ(variable(9), 0);
}

TEST_F(ProgramTest, SubroutinesReturnBehindTheirCall) {
  run("CSUB Twice\n CALC LOAD, 1\n CALL NZ, Twice\n CALL ZE, Twice\n STOP\n"
      "Twice: CSUB Once\n Once: CALCV ADD, 0, 1\n RSUB");
  EXPECT_EQ(variable(0), 4);
  EXPECT_EQ(application.last_error(), none);
}

TEST_F(ProgramTest, EightSubroutinesMayBeWithinOneAnother) {
  const std::string descend = "CALCV LOAD, 1, ";
  const std::string rest =
      "\n CSUB Down\n STOP\n Down: CALCV ADD, 0, 1\n DJNZ 1, More\n RSUB\n More: CSUB Down\n RSUB";
  run(descend + "8" + rest);
  EXPECT_EQ(variable(0), 8);
  EXPECT_EQ(application.last_error(), none);
  run(descend + "9" + rest);
  EXPECT_EQ(application.last_error(), code(Status::maximum_exceeded));
}

TEST_F(ProgramTest, RestartForgetsEverythingButVariables) {
  run("CALCV ADD, 0, 1\n CALCV COMP, 0, 3\n JC EQ, End\n CALC LOAD, 9\n CSUB Again\n"
      "Again: RST 0\n End: CALCVA LOAD, 1\n RSUB");
  EXPECT_EQ(variable(0), 3);
  EXPECT_EQ(variable(1), 0);
  EXPECT_EQ(application.last_error(), code(Status::command_not_available));
}

TEST_F(ProgramTest, StopLeavesTheCounterBehindIt) {
  run("CALCV ADD, 0, 1\n STOP\n CALCV ADD, 0, 10\n STOP");
  EXPECT_EQ(variable(0), 1);
  EXPECT_EQ(application.program_counter(), 2);
  control(Command::RUN_APPLICATION);
  pass(milliseconds(1));
  EXPECT_EQ(variable(0), 11);
}

// Waiting.

TEST_F(ProgramTest, TicksAreTenMillisecondsToTheDot) {
  run("WAIT TICKS, 0, 1\n MST 0\n WAIT TICKS, 0, 250\n MST 0\n WAIT TICKS, 0, 0\n MST 0\n STOP");
  ASSERT_EQ(host.performed_at.size(), 3U);
  EXPECT_EQ(host.performed_at[0] - TimePoint{}, milliseconds(10));
  EXPECT_EQ(host.performed_at[1] - host.performed_at[0], milliseconds(2500) + command_time);
  EXPECT_EQ(host.performed_at[2] - host.performed_at[1], 2 * command_time);
}

TEST_F(ProgramTest, WaitsForAMotor) {
  const auto arrival = TimePoint{} + milliseconds(1234);
  host.future[arrival] = [&] { host.motor_conditions[1].at_target = true; };
  run("WAIT POS, 1, 0\n MST 0\n STOP");
  ASSERT_EQ(host.performed_at.size(), 1U);
  EXPECT_EQ(host.performed_at[0], arrival);
}

TEST_F(ProgramTest, WhatHasHappenedIsNotWaitedFor) {
  host.motor_conditions[0] = {.at_target = true, .home_switch = true, .right_switch = true};
  run("WAIT POS, 0, 5\n WAIT REFSW, 0, 5\n WAIT LIMSW, 0, 5\n WAIT RFS, 0, 5\n MST 0\n STOP");
  ASSERT_EQ(host.performed_at.size(), 1U);
  EXPECT_EQ(host.performed_at[0] - TimePoint{}, 4 * command_time);
}

TEST_F(ProgramTest, WaitsForEachCondition) {
  auto& motor = host.motor_conditions[0];
  motor.searching = true;
  const auto at = [](int seconds) { return TimePoint{} + std::chrono::seconds(seconds); };
  host.future[at(1)] = [&] { motor.home_switch = true; };
  host.future[at(2)] = [&] { motor.left_switch = true; };
  host.future[at(3)] = [&] { motor.searching = false; };
  run("WAIT REFSW, 0, 0\n MST 0\n WAIT LIMSW, 0, 0\n MST 0\n WAIT RFS, 0, 0\n MST 0\n STOP");
  EXPECT_EQ(host.performed_at, (std::vector{at(1), at(2), at(3)}));
}

TEST_F(ProgramTest, PatienceEnds) {
  run("WAIT POS, 0, 3\n JC ETO, Late\n STOP\n"
      "Late: MST 0\n CLE ETO\n JC ETO, Bad\n WAIT TICKS, 0, 1\n JC ETO, Bad\n STOP\n"
      "Bad: CALCV LOAD, 0, 1\n STOP");
  ASSERT_EQ(host.performed_at.size(), 1U);
  EXPECT_EQ(host.performed_at[0] - TimePoint{}, milliseconds(30) + command_time);
  EXPECT_EQ(variable(0), 0);
}

TEST_F(ProgramTest, AModuleThatForeseesNothingIsAskedOften) {
  host.unforeseen = true;
  const auto arrival = TimePoint{} + milliseconds(5) + microseconds(30);
  host.future[arrival] = [&] { host.motor_conditions[0].at_target = true; };
  load("WAIT POS, 0, 0\n MST 0\n STOP");
  control(Command::RUN_APPLICATION, 1, 0);
  pass(milliseconds(6));
  EXPECT_EQ(host.performed.size(), 0U);  // `never` was its answer
  application.run_due(host.now);         // something has changed, says the module
  EXPECT_EQ(host.performed.size(), 1U);
}

TEST_F(ProgramTest, WhoWaitsNeedsNoAttention) {
  load("WAIT POS, 0, 0\n STOP");
  control(Command::RUN_APPLICATION, 1, 0);
  pass(milliseconds(1));
  EXPECT_EQ(application.next_due(), never);
}

// Error flags.

TEST_F(ProgramTest, FlagsStayUntilTheyAreCleared) {
  const std::vector<std::pair<std::string, std::function<void(bool)>>> flags{
      {"EAL", [&](bool on) { host.present_alarms.external = on; }},
      {"EDV", [&](bool on) { host.present_alarms.deviation = on; }},
      {"EPO", [&](bool on) { host.present_alarms.position = on; }},
      {"ESD", [&](bool on) { host.present_alarms.shutdown = on; }}};
  for (const auto& [name, set] : flags) {
    SCOPED_TRACE(name);
    host.variables.fill(0);
    const auto count = " \n JC " + name + ", Yes";
    load("JC " + name + ", Bad\n WAIT TICKS, 0, 2\n JC " + name + ", Yes\n Bad: STOP\n" +
         "Yes: CALCV ADD, 0, 1\n CLE " + name + count + "\n CALCV ADD, 0, 10\n STOP");
    control(Command::RUN_APPLICATION, 1, 0);
    pass(milliseconds(5));
    set(true);
    application.run_due(host.now);
    set(false);
    pass(milliseconds(50));
    EXPECT_EQ(variable(0), 11);
  }
}

TEST_F(ProgramTest, AnAlarmThatLastsRaisesItsFlagAgain) {
  host.present_alarms.external = true;
  run("CLE ALL\n JC EAL, Yes\n STOP\n Yes: CALCV LOAD, 0, 1\n STOP");
  EXPECT_EQ(variable(0), 1);
}

// Errors.

TEST_F(ProgramErrorTest, CommandsThatAreNone) {
  expect_error(Status::invalid_command, 1, "MST 0\n .raw 18, 0, 0, 0");
  expect_error(Status::invalid_command, 0, ".raw 129, 0, 0, 0");
  expect_error(Status::invalid_command, 0, ".raw 255, 0, 0, 1234");
}

TEST_F(ProgramErrorTest, Types) {
  for (const auto* command :
       {"CALC 10, 0", "CALC 11, 0", "CALCX 11", "CALCVV 12, 0, 0", "CALCV 10, 0, 0", "JC 13, 0",
        "CALL 12, 0", "WAIT 5, 0, 1", "CLE 6", "MVPA 3, 0", "EI 5", "DI 43", "VECT 255, 0"}) {
    expect_error(Status::wrong_type, 0, command);
  }
  EXPECT_TRUE(host.performed.empty());
}

TEST_F(ProgramErrorTest, Values) {
  for (const auto* command :
       {".raw 22, 0, 0, 2048", ".raw 22, 0, 0, -1", ".raw 21, 1, 0, 2048", ".raw 23, 0, 0, -1",
        ".raw 80, 1, 0, 2048", ".raw 48, 0, 0, 2048", ".raw 49, 0, 0, 2048", ".raw 37, 0, 0, 2048",
        "CALC DIV, 0", "CALC MOD, 0", "CALCVV ADD, 0, 256", "CALCVV ADD, 0, -1", "WAIT POS, 2, 0",
        "WAIT TICKS, 0, -1", "WAIT POS, 0, -1"}) {
    expect_error(Status::invalid_value, 0, command);
  }
}

TEST_F(ProgramErrorTest, AJumpThatIsNotTakenMustHaveAnAddressToo) {
  expect_error(Status::invalid_value, 1, "CALC LOAD, 0\n .raw 21, 1, 0, 2048");
  expect_error(Status::invalid_value, 1, "CALC LOAD, 0\n .raw 80, 1, 0, 2048");
}

TEST_F(ProgramErrorTest, IndexesBeyondTheVariables) {
  for (const auto* command : {"SIV 1", "AIV", "GIV"}) {
    for (const auto* index : {"-1", "256"}) {
      expect_error(Status::invalid_value, 2,
                   std::string("CALC LOAD, ") + index + "\n CALCX LOAD\n " + command);
    }
  }
}

TEST_F(ProgramErrorTest, ReturnsFromNowhere) {
  expect_error(Status::command_not_available, 0, "RSUB");
  expect_error(Status::command_not_available, 0, "RETI");
}

TEST_F(ProgramErrorTest, ACallThatIsNotMadeLeavesNothingToReturnTo) {
  expect_error(Status::command_not_available, 2, "CALC LOAD, 1\n CALL ZE, 0\n RSUB");
}

TEST_F(ProgramErrorTest, WhatTheModuleRefuses) {
  host.answers[Command::SAP] = {Answer::Form::reply, Status::invalid_value, 0};
  expect_error(Status::invalid_value, 1, "MST 0\n SAP 4, 0, 9999\n MST 0");
  EXPECT_EQ(host.performed.size(), 2U);
}

TEST_F(ProgramErrorTest, TheEndOfTheMemory) {
  program::Program full(program::most_commands, {Command::MST});
  application.load(full);
  control(Command::RUN_APPLICATION, 1, 2046);
  pass(milliseconds(1));
  EXPECT_EQ(host.performed.size(), 2U);
  EXPECT_EQ(application.last_error(), code(Status::invalid_value));
  EXPECT_EQ(application.program_counter(), 2048);
}

TEST_F(ProgramErrorTest, ARunForgetsTheErrorBefore) {
  expect_error(Status::command_not_available, 0, "RSUB");
  run("STOP");
  EXPECT_EQ(application.last_error(), none);
}

}  // namespace
}  // namespace tmcl::sim
