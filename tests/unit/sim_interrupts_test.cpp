// Interrupts of a stand-alone program.
#include "sim_program_fixture.hpp"

namespace tmcl::sim {
namespace {

using std::chrono::seconds;

TimePoint at(Duration time) { return TimePoint{} + time; }

class InterruptTest : public ProgramTest {
 protected:
  /// An interrupt's routine notes in variable 0 how often it ran; the program waits meanwhile.
  void watch(const std::string& number) {
    load("VECT " + number + ", Routine\n EI " + number +
         "\n EI 255\n WAIT TICKS, 0, 1000\n STOP\n" + "Routine: CALCV ADD, 0, 1\n MST 0\n RETI");
    control(Command::RUN_APPLICATION, 1, 0);
  }
  /// How often the routine runs while a condition comes and goes.
  int count(const std::string& number, const std::function<void(bool)>& set) {
    host.variables.fill(0);
    host.future.clear();
    set(false);
    watch(number);
    for (int i = 0; i < 4; ++i)
      host.future[host.now + milliseconds(100 * (i + 1))] = [set, i] { set(i % 2 == 0); };
    pass(seconds(1));
    return variable(0);
  }
};

TEST_F(InterruptTest, ATimerComesAtItsPeriod) {
  host.settings[1] = 250;
  watch("1");
  pass(seconds(1) + milliseconds(100));
  EXPECT_EQ(variable(0), 4);
  const auto enabled = at(command_time);  // by the second command
  ASSERT_EQ(host.performed_at.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_EQ(host.performed_at[i], enabled + (i + 1) * milliseconds(250) + command_time);
}

TEST_F(InterruptTest, ATimerWithoutPeriodIsOff) {
  watch("0");
  pass(seconds(1));
  EXPECT_EQ(variable(0), 0);
  application.run_due(host.now);  // as a module does when a command comes
  host.settings[0] = 100;
  application.run_due(host.now);
  pass(milliseconds(950));
  EXPECT_EQ(variable(0), 9);
}

TEST_F(InterruptTest, MotorsByTheirConditions) {
  for (std::size_t motor = 0; motor < 2; ++motor) {
    auto& conditions = host.motor_conditions[motor];
    const auto number = [motor](int first) {
      return std::to_string(first + static_cast<int>(motor));
    };
    EXPECT_EQ(count(number(3), [&](bool on) { conditions.at_target = on; }), 2);
    EXPECT_EQ(count(number(15), [&](bool on) { conditions.stalled = on; }), 2);
    EXPECT_EQ(count(number(21), [&](bool on) { conditions.deviated = on; }), 2);
  }
}

TEST_F(InterruptTest, SwitchesByTheirEdges) {
  const auto left = [&](bool on) { host.motor_conditions[1].left_switch = on; };
  const auto right = [&](bool on) { host.motor_conditions[1].right_switch = on; };
  for (const auto& [setting, expected] :
       std::vector<std::pair<int, int>>{{0, 0}, {1, 2}, {2, 2}, {3, 4}}) {
    host.settings[29] = host.settings[30] = setting;
    EXPECT_EQ(count("29", left), expected) << setting;
    EXPECT_EQ(count("30", right), expected) << setting;
  }
  host.settings[29] = 3;
  EXPECT_EQ(count("29", right), 0);
}

TEST_F(InterruptTest, InputsByTheirEdges) {
  const auto input = [&](bool on) { host.input_levels[3] = on; };
  host.settings[42] = 1;
  EXPECT_EQ(count("42", input), 2);
  host.settings[42] = 3;
  EXPECT_EQ(count("42", input), 4);
  EXPECT_EQ(count("41", input), 0);
}

TEST_F(InterruptTest, OnlyWhatIsOnInterrupts) {
  host.settings[0] = 10;
  for (const auto* off :
       {"VECT 0, Routine\n EI 255", "VECT 0, Routine\n EI 0", "EI 0\n EI 255",
        "VECT 0, Routine\n EI 0\n EI 255\n DI 0", "VECT 0, Routine\n EI 0\n EI 255\n DI 255"}) {
    SCOPED_TRACE(off);
    run(std::string(off) + "\n WAIT TICKS, 0, 10\n STOP\n Routine: CALCV ADD, 0, 1\n RETI");
    EXPECT_EQ(variable(0), 0);
  }
}

TEST_F(InterruptTest, WhatHappenedBeforeDoesNotCount) {
  host.motor_conditions[0].at_target = true;
  watch("3");
  pass(seconds(1));
  EXPECT_EQ(variable(0), 0);
}

TEST_F(InterruptTest, WhatHappensMeanwhileIsKept) {
  host.settings[39] = 1;
  host.future[at(milliseconds(5))] = [&] { host.input_levels[0] = true; };
  run("VECT 39, Routine\n EI 39\n WAIT TICKS, 0, 5\n EI 255\n MST 1\n STOP\n"
      "Routine: MST 0\n RETI");
  ASSERT_EQ(host.performed.size(), 2U);
  EXPECT_EQ(host.performed[0].motor, 0);
  EXPECT_EQ(host.performed_at[0], at(milliseconds(50) + 3 * command_time));
}

TEST_F(InterruptTest, SwitchedOffAndOnItIsForgotten) {
  host.settings[39] = 1;
  host.future[at(milliseconds(5))] = [&] { host.input_levels[0] = true; };
  run("VECT 39, Routine\n EI 39\n WAIT TICKS, 0, 5\n DI 39\n EI 39\n EI 255\n MST 1\n STOP\n"
      "Routine: CALCV ADD, 0, 1\n RETI");
  EXPECT_EQ(variable(0), 0);
}

TEST_F(InterruptTest, TheLeastNumberGoesFirstAndNoneWithinAnother) {
  host.settings[39] = host.settings[40] = 1;
  host.future[at(milliseconds(5))] = [&] { host.input_levels[0] = host.input_levels[1] = true; };
  host.future[at(milliseconds(7))] = [&] { host.motor_conditions[0].at_target = true; };
  run("VECT 39, First\n VECT 40, Second\n VECT 3, Third\n EI 3\n EI 39\n EI 40\n EI 255\n"
      "WAIT TICKS, 0, 20\n STOP\n"
      "First: SAP 1, 0, 1\n WAIT TICKS, 0, 1\n SAP 1, 0, 2\n RETI\n"
      "Second: SAP 1, 0, 3\n RETI\n Third: SAP 1, 0, 4\n RETI");
  std::vector<std::int32_t> order;
  for (const auto& request : host.performed) order.push_back(request.value);
  EXPECT_EQ(order, (std::vector<std::int32_t>{1, 2, 4, 3}));
}

TEST_F(InterruptTest, SavesAndRestoresWhatTheProgramComputesWith) {
  host.settings[0] = 5;
  run("VECT 0, Routine\n EI 0\n CALC LOAD, 7\n CALCX LOAD\n CALC LOAD, 8\n COMP 9\n EI 255\n"
      "WAIT TICKS, 0, 1\n DI 0\n JC GE, Bad\n JC ZE, Bad\n"
      "CALCVA LOAD, 1\n CALCVX LOAD, 2\n STOP\n Bad: CALCV LOAD, 3, 1\n STOP\n"
      "Routine: CALC LOAD, 0\n CALCX LOAD\n COMP -1\n CALCV ADD, 0, 1\n RETI");
  EXPECT_GE(variable(0), 1);
  EXPECT_EQ(variable(1), 8);
  EXPECT_EQ(variable(2), 7);
  EXPECT_EQ(variable(3), 0);
}

TEST_F(InterruptTest, AWaitThatIsCutShortLosesNoTime) {
  host.settings[0] = 30;
  run("VECT 0, Routine\n EI 0\n EI 255\n WAIT TICKS, 0, 10\n MST 0\n STOP\n"
      "Routine: WAIT TICKS, 0, 1\n RETI");
  ASSERT_EQ(host.performed_at.size(), 1U);
  EXPECT_EQ(host.performed_at[0], at(3 * command_time + milliseconds(100)));
}

TEST_F(InterruptTest, AWaitThatIsOverMeanwhileIsOver) {
  host.settings[0] = 30;
  run("VECT 0, Routine\n EI 0\n EI 255\n WAIT TICKS, 0, 4\n MST 0\n STOP\n"
      "Routine: DI 0\n WAIT TICKS, 0, 5\n RETI");
  ASSERT_EQ(host.performed_at.size(), 1U);
  EXPECT_LE(host.performed_at[0], at(milliseconds(81)));
}

TEST_F(InterruptTest, ABusyProgramIsInterruptedBetweenCommands) {
  host.settings[0] = 10;
  load(
      "VECT 0, Routine\n EI 0\n EI 255\n Loop: CALCV ADD, 1, 1\n JA Loop\n"
      "Routine: CALCV ADD, 0, 1\n RETI");
  control(Command::RUN_APPLICATION, 1, 0);
  pass(milliseconds(1005));
  EXPECT_EQ(variable(0), 100);
  EXPECT_GT(variable(1), 4800);
}

TEST_F(InterruptTest, StopsWithTheProgram) {
  host.settings[0] = 10;
  watch("0");
  pass(milliseconds(35));
  control(Command::STOP_APPLICATION);
  EXPECT_EQ(application.next_due(), never);
  pass(milliseconds(100));
  EXPECT_EQ(variable(0), 3);
}

TEST_F(InterruptTest, OnlyThoseOfTheModule) {
  const std::vector<std::pair<int, bool>> all{
      {0, true},  {2, true},   {3, true},  {4, true},  {5, false},  {15, true},
      {16, true}, {17, false}, {21, true}, {22, true}, {23, false}, {27, true},
      {30, true}, {31, false}, {39, true}, {42, true}, {43, false}, {254, false}};
  for (const auto& [number, exists] : all) {
    run("EI " + std::to_string(number) + "\n STOP");
    EXPECT_EQ(application.last_error() == 0, exists) << number;
  }
}

}  // namespace
}  // namespace tmcl::sim
