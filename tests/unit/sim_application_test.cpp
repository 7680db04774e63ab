// How a host loads a stand-alone program, runs it and looks at it.
#include "sim_program_fixture.hpp"

namespace tmcl::sim {
namespace {

using program::Instruction;

constexpr std::int32_t stopped = 0;
constexpr std::int32_t run_state = 1;
constexpr std::int32_t stepping = 2;
constexpr std::int32_t after_reset = 3;

class ApplicationTest : public ProgramTest {
 protected:
  Status record(const Instruction& line) {
    return application.record({ModuleAddress{1}, line.command, line.type, line.motor, line.value})
        .status;
  }
  void download(std::int32_t first, const std::string& text) {
    ASSERT_EQ(status_of(Command::START_DOWNLOAD, 0, first), Status::ok);
    for (const auto& line : assembled(text)) ASSERT_EQ(record(line), Status::command_loaded);
  }
  Instruction line(std::int32_t address) {
    const auto answer = control(Command::READ_TMCL_MEMORY, 0, address);
    EXPECT_EQ(answer.form, Answer::Form::program_line);
    return answer.line;
  }
  std::int32_t state() { return control(Command::GET_APPLICATION_STATUS).value >> 24; }
  std::int32_t address() { return control(Command::GET_APPLICATION_STATUS).value & 0xffffff; }
};

TEST_F(ApplicationTest, KnowsItsCommands) {
  for (int number = 0; number < 256; ++number) {
    const bool control = (number >= 128 && number <= 135) || number == 141;
    EXPECT_EQ(Application::is_control(static_cast<Command>(number)), control) << number;
  }
}

TEST_F(ApplicationTest, ADownloadIsStoredAndRuns) {
  download(0, "CALCV LOAD, 0, 42\n STOP");
  EXPECT_EQ(application.download_mode(), 1);
  EXPECT_EQ(status_of(Command::END_DOWNLOAD), Status::ok);
  EXPECT_EQ(application.download_mode(), 0);
  EXPECT_EQ(line(0), (Instruction{Command::CALCV, 9, 0, 42}));
  EXPECT_EQ(line(1), (Instruction{Command::STOP}));
  EXPECT_EQ(line(2), Instruction{});
  control(Command::RUN_APPLICATION);
  EXPECT_EQ(state(), run_state);
  pass(milliseconds(1));
  EXPECT_EQ(variable(0), 42);
  EXPECT_EQ(state(), stopped);
}

TEST_F(ApplicationTest, TellsBelowTheStateWhereItIs) {
  download(5, "MST 0\n MST 1");
  EXPECT_EQ(address(), 7) << "where the next line of the download goes";
  control(Command::END_DOWNLOAD);
  EXPECT_EQ(address(), 0);
  load("MST 0\n WAIT TICKS, 0, 10\n STOP");
  control(Command::RUN_APPLICATION);
  pass(milliseconds(1));
  EXPECT_EQ(state(), run_state);
  EXPECT_EQ(address(), 1);
}

TEST_F(ApplicationTest, ADownloadLeavesTheRestAsItIs) {
  load("MST 0\n MST 1\n STOP");
  download(1, "ROR 0, 5");
  control(Command::END_DOWNLOAD);
  EXPECT_EQ(line(0), (Instruction{Command::MST}));
  EXPECT_EQ(line(1), (Instruction{Command::ROR, 0, 0, 5}));
  EXPECT_EQ(line(2), (Instruction{Command::STOP}));
}

TEST_F(ApplicationTest, ADownloadTakesEffectAsAWhole) {
  load("MST 0\n STOP");
  download(0, "ROR 0, 5\n STOP");
  EXPECT_EQ(line(0), (Instruction{Command::MST}));
  application.power_on(false, host.now);
  EXPECT_EQ(application.download_mode(), 0);
  EXPECT_EQ(line(0), (Instruction{Command::MST}));
  EXPECT_EQ(status_of(Command::END_DOWNLOAD), Status::ok);
  EXPECT_EQ(line(0), (Instruction{Command::MST}));
}

TEST_F(ApplicationTest, ADownloadThatIsBegunAgainForgetsWhatCame) {
  download(0, "ROR 0, 5\n ROR 1, 5");
  download(1, "MST 1");
  control(Command::END_DOWNLOAD);
  EXPECT_EQ(line(0), Instruction{});
  EXPECT_EQ(line(1), (Instruction{Command::MST, 0, 1, 0}));
}

TEST_F(ApplicationTest, ADownloadStopsTheProgram) {
  load("Loop: CALCV ADD, 0, 1\n JA Loop");
  control(Command::RUN_APPLICATION);
  pass(milliseconds(1));
  download(100, "MST 0");
  EXPECT_EQ(state(), stopped);
  const auto counted = variable(0);
  pass(milliseconds(1));
  EXPECT_EQ(variable(0), counted);
}

TEST_F(ApplicationTest, NothingRunsDuringADownload) {
  load("MST 0\n STOP");
  download(100, "MST 0");
  EXPECT_EQ(status_of(Command::RUN_APPLICATION), Status::command_not_available);
  EXPECT_EQ(status_of(Command::RUN_APPLICATION, 1, 0), Status::command_not_available);
  EXPECT_EQ(status_of(Command::STEP_APPLICATION), Status::command_not_available);
  pass(milliseconds(1));
  EXPECT_TRUE(host.performed.empty());
}

TEST_F(ApplicationTest, MoreThanMemoryIsRefusedAndChangesNothing) {
  load("MST 0");
  download(2046, "MST 0\n MST 1");
  EXPECT_EQ(record({Command::STOP}), Status::maximum_exceeded);
  EXPECT_EQ(status_of(Command::END_DOWNLOAD), Status::download_not_possible);
  EXPECT_EQ(application.download_mode(), 0);
  EXPECT_EQ(line(2046), Instruction{});
  EXPECT_EQ(line(0), (Instruction{Command::MST}));
}

TEST_F(ApplicationTest, TheWholeMemoryCanBeFilled) {
  ASSERT_EQ(status_of(Command::START_DOWNLOAD), Status::ok);
  for (std::int32_t i = 0; i < 2048; ++i)
    ASSERT_EQ(record({Command::ROR, 0, 0, i}), Status::command_loaded);
  EXPECT_EQ(status_of(Command::END_DOWNLOAD), Status::ok);
  EXPECT_EQ(line(2047).value, 2047);
}

TEST_F(ApplicationTest, AddressesAreWithinTheMemory) {
  for (const auto command : {Command::START_DOWNLOAD, Command::READ_TMCL_MEMORY}) {
    EXPECT_EQ(status_of(command, 0, 2048), Status::invalid_value);
    EXPECT_EQ(status_of(command, 0, -1), Status::invalid_value);
  }
  EXPECT_EQ(status_of(Command::RUN_APPLICATION, 1, 2048), Status::invalid_value);
  EXPECT_EQ(status_of(Command::RUN_APPLICATION, 1, -1), Status::invalid_value);
  EXPECT_EQ(status_of(Command::RUN_APPLICATION, 2, 0), Status::wrong_type);
  EXPECT_EQ(application.download_mode(), 0);
}

TEST_F(ApplicationTest, RunsFromAnAddress) {
  load("CALCV LOAD, 0, 1\n STOP\n CALCV LOAD, 0, 2\n STOP");
  control(Command::RUN_APPLICATION, 1, 2);
  pass(milliseconds(1));
  EXPECT_EQ(variable(0), 2);
}

TEST_F(ApplicationTest, AStoppedProgramGoesOnWhereItWas) {
  load("WAIT TICKS, 0, 100\n CALCV ADD, 0, 1\n STOP");
  control(Command::RUN_APPLICATION);
  pass(milliseconds(300));
  control(Command::STOP_APPLICATION);
  EXPECT_EQ(state(), stopped);
  EXPECT_EQ(application.next_due(), never);
  pass(milliseconds(10000));
  EXPECT_EQ(variable(0), 0);
  control(Command::RUN_APPLICATION);
  pass(milliseconds(999));
  EXPECT_EQ(variable(0), 0);  // the wait begins anew
  pass(milliseconds(2));
  EXPECT_EQ(variable(0), 1);
}

TEST_F(ApplicationTest, RunningWhatRunsChangesNothing) {
  load("WAIT TICKS, 0, 100\n CALCV ADD, 0, 1\n STOP");
  control(Command::RUN_APPLICATION);
  pass(milliseconds(999));
  control(Command::RUN_APPLICATION);
  pass(milliseconds(2));
  EXPECT_EQ(variable(0), 1);
}

TEST_F(ApplicationTest, ResetGoesBackToTheStart) {
  load("Loop: CALCV ADD, 0, 1\n JA Loop");
  control(Command::RUN_APPLICATION);
  pass(milliseconds(1));
  control(Command::RESET_APPLICATION);
  EXPECT_EQ(state(), after_reset);
  EXPECT_EQ(application.program_counter(), 0);
  EXPECT_EQ(application.next_due(), never);
}

TEST_F(ApplicationTest, StepsOneCommandAtATime) {
  load("CALCV ADD, 0, 1\n CALCV ADD, 0, 10\n CALCV ADD, 0, 100\n STOP");
  control(Command::STEP_APPLICATION);
  EXPECT_EQ(variable(0), 1);
  EXPECT_EQ(state(), stepping);
  EXPECT_EQ(application.program_counter(), 1);
  pass(milliseconds(10));
  EXPECT_EQ(variable(0), 1);
  control(Command::STEP_APPLICATION);
  EXPECT_EQ(variable(0), 11);
  control(Command::RUN_APPLICATION);
  pass(milliseconds(1));
  EXPECT_EQ(variable(0), 111);
  EXPECT_EQ(state(), stopped);
}

TEST_F(ApplicationTest, AStepWaitsForAWait) {
  load("WAIT TICKS, 0, 1\n CALCV ADD, 0, 1\n STOP");
  control(Command::STEP_APPLICATION);
  EXPECT_EQ(application.program_counter(), 0);
  control(Command::STEP_APPLICATION);
  pass(milliseconds(50));
  EXPECT_EQ(application.program_counter(), 1);
  EXPECT_EQ(variable(0), 0);
  EXPECT_EQ(state(), stepping);
}

TEST_F(ApplicationTest, HaltsBeforeABreakpoint) {
  load("Loop: CALCV ADD, 0, 1\n CALCV ADD, 0, 10\n JA Loop");
  EXPECT_EQ(status_of(Command::BREAKPOINT, 0, 1), Status::ok);
  control(Command::RUN_APPLICATION);
  pass(milliseconds(10));
  EXPECT_EQ(variable(0), 1);
  EXPECT_EQ(state(), stepping);
  EXPECT_EQ(application.program_counter(), 1);
  control(Command::RUN_APPLICATION);
  pass(milliseconds(10));
  EXPECT_EQ(variable(0), 12);
  control(Command::STEP_APPLICATION);
  EXPECT_EQ(variable(0), 22);
  EXPECT_EQ(status_of(Command::BREAKPOINT, 1, 1), Status::ok);
  control(Command::RUN_APPLICATION);
  pass(milliseconds(10));
  EXPECT_EQ(state(), run_state);
}

TEST_F(ApplicationTest, TenBreakpoints) {
  EXPECT_EQ(control(Command::BREAKPOINT, 3).value, 10);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(status_of(Command::BREAKPOINT, 0, i), Status::ok);
  EXPECT_EQ(status_of(Command::BREAKPOINT, 0, 3), Status::ok);  // it is there
  EXPECT_EQ(status_of(Command::BREAKPOINT, 0, 10), Status::maximum_exceeded);
  EXPECT_EQ(status_of(Command::BREAKPOINT, 1, 3), Status::ok);
  EXPECT_EQ(status_of(Command::BREAKPOINT, 0, 10), Status::ok);
  EXPECT_EQ(status_of(Command::BREAKPOINT, 2), Status::ok);
  EXPECT_EQ(status_of(Command::BREAKPOINT, 0, 11), Status::ok);
  EXPECT_EQ(status_of(Command::BREAKPOINT, 0, 2048), Status::invalid_value);
  EXPECT_EQ(status_of(Command::BREAKPOINT, 1, -1), Status::invalid_value);
  EXPECT_EQ(status_of(Command::BREAKPOINT, 4), Status::wrong_type);
}

TEST_F(ApplicationTest, StartsAtPowerOnIfItShould) {
  load("CALCV ADD, 0, 1\n STOP");
  application.power_on(false, host.now);
  pass(milliseconds(1));
  EXPECT_EQ(variable(0), 0);
  application.power_on(true, host.now);
  pass(milliseconds(1));
  EXPECT_EQ(variable(0), 1);
}

TEST_F(ApplicationTest, ProtectedFromReading) {
  load("MST 0");
  host.protection = 1;
  const auto answer = control(Command::READ_TMCL_MEMORY, 0, 0);
  EXPECT_EQ(answer.form, Answer::Form::reply);
  EXPECT_EQ(answer.status, Status::write_protected);
  EXPECT_EQ(status_of(Command::START_DOWNLOAD), Status::ok);
}

TEST_F(ApplicationTest, ProtectedFromWriting) {
  load("MST 0");
  host.protection = 2;
  EXPECT_EQ(line(0), (Instruction{Command::MST}));
  EXPECT_EQ(status_of(Command::START_DOWNLOAD), Status::write_protected);
  EXPECT_EQ(application.download_mode(), 0);
}

TEST_F(ApplicationTest, WhoAllowsReadingAgainErases) {
  for (const auto& [from, to, erased] : std::vector<std::tuple<int, int, bool>>{{0, 1, false},
                                                                                {0, 3, false},
                                                                                {2, 0, false},
                                                                                {1, 3, false},
                                                                                {3, 1, false},
                                                                                {1, 0, true},
                                                                                {3, 0, true},
                                                                                {3, 2, true},
                                                                                {1, 2, true}}) {
    load("MST 0");
    application.change_protection(from, to);
    EXPECT_EQ(line(0) == Instruction{}, erased) << from << " to " << to;
  }
}

TEST_F(ApplicationTest, AProgramMayEraseItself) {
  host.on_perform = [&](const Request&) { application.change_protection(1, 0); };
  run("CALCV LOAD, 0, 1\n SGP 81, 0, 0\n CALCV LOAD, 0, 2\n STOP");
  EXPECT_EQ(variable(0), 1);
  EXPECT_EQ(state(), stopped);
  EXPECT_EQ(application.program_counter(), 0);
  EXPECT_EQ(line(0), Instruction{});
}

}  // namespace
}  // namespace tmcl::sim
