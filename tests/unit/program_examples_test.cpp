// The example programs of libtmcl/examples/programs, run on a simulated module in virtual time.
#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>

#include "sim_fixture.hpp"
#include "support/build_paths.hpp"
#include "support/program_host.hpp"

namespace tmcl::sim {
namespace {

namespace ap = axis_parameter;
using std::chrono::seconds;

constexpr std::uint8_t variables = 2;
constexpr std::uint8_t outputs = 2;

std::string example(const std::string& name) {
  std::ifstream file(TMCL_SOURCE_DIR "/libtmcl/examples/programs/" + name + ".tmc");
  EXPECT_TRUE(file.is_open()) << name;
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

class ExampleProgram : public SimTest {
 protected:
  void run(const std::string& name) {
    ask(Command::START_DOWNLOAD, 0, 0);
    for (const auto& [command, type, motor, value] : assembled(example(name)))
      ASSERT_EQ(status_of(command, type, motor, value), Status::command_loaded);
    ASSERT_EQ(status_of(Command::END_DOWNLOAD, 0, 0), Status::ok);
    ask(Command::SAP, ap::max_velocity, 0, 100);  // slow enough to look at
    ASSERT_EQ(status_of(Command::RUN_APPLICATION, 1, 0, 0), Status::ok);
  }
  void TearDown() override { EXPECT_EQ(ask(Command::GGP, 131, 0)->value, 0) << "a program failed"; }

  std::int32_t position() { return get(ap::actual_position); }
  bool at_target() { return get(ap::position_reached) == 1; }
  std::int32_t variable(std::uint8_t number) { return ask(Command::GGP, number, variables)->value; }
  bool output(std::uint8_t port) { return ask(Command::GIO, port, outputs)->value == 1; }

  /// Lets time pass until the motor stands on its target; false if it never does.
  bool arrive() {
    for (int i = 0; i < 60'000; ++i) {
      pass(milliseconds(1));
      if (at_target()) return true;
    }
    return false;
  }
  /// Presses a button, for long enough that a program must see it.
  void press(std::uint8_t input) {
    module.set_input(input, true);
    pass(milliseconds(200));
    module.set_input(input, false);
    pass(milliseconds(200));
  }

  Module& module = add(6110);
};

TEST_F(ExampleProgram, PingPong) {
  run("ping_pong");
  while (variable(1) == 0 && clock.now() < TimePoint{} + seconds(60)) pass(milliseconds(1));
  const auto leg = clock.now() - TimePoint{};
  constexpr int legs = 12;
  std::int32_t least = 0;
  std::int32_t greatest = 0;
  for (auto left = legs * leg; left > Duration::zero(); left -= milliseconds(10)) {
    pass(milliseconds(10));
    least = std::min(least, position());
    greatest = std::max(greatest, position());
  }
  EXPECT_GE(least, 0);
  EXPECT_GT(greatest, 19'000);
  EXPECT_LE(greatest, 20'000);
  EXPECT_EQ(variable(1), legs + 1);
  const auto passed = std::chrono::duration_cast<seconds>(clock.now() - TimePoint{}).count();
  EXPECT_NEAR(variable(0), static_cast<double>(passed), 1);
}

TEST_F(ExampleProgram, TeachIn) {
  constexpr std::uint8_t button = 0;
  constexpr std::uint8_t play = 1;
  run("teach_in");
  const std::vector<std::int32_t> places{500, -1500, 800};
  for (const auto place : places) {
    ask(Command::MVP, 0, 0, place);
    ASSERT_TRUE(arrive());
    press(button);
  }
  EXPECT_EQ(variable(0), 3);
  module.set_input(play, true);
  for (std::size_t i = 0; i < 7; ++i) {
    // Where the motor stands it does not stay: the next place is another one.
    const auto expected = places[i % places.size()];
    for (int k = 0; k < 60'000 && position() != expected; ++k) pass(milliseconds(1));
    ASSERT_EQ(position(), expected) << i;
  }
  module.set_input(play, false);
  ASSERT_TRUE(arrive());
  pass(seconds(2));
  const auto rest = position();
  pass(seconds(2));
  EXPECT_EQ(position(), rest);
}

TEST_F(ExampleProgram, ADoorOpensAndCloses) {
  constexpr std::uint8_t open = 0;
  constexpr std::uint8_t close = 1;
  constexpr std::uint8_t lamp = 0;
  run("door");
  pass(seconds(1));
  EXPECT_EQ(variable(0), 0);
  press(open);
  EXPECT_EQ(variable(0), 1);
  EXPECT_TRUE(output(lamp));
  ASSERT_TRUE(arrive());
  pass(milliseconds(10));
  EXPECT_EQ(position(), 30'000);
  EXPECT_EQ(variable(0), 2);
  EXPECT_FALSE(output(lamp));
  press(close);
  EXPECT_EQ(variable(0), 3);
  ASSERT_TRUE(arrive());
  pass(milliseconds(10));
  EXPECT_EQ(position(), 0);
  EXPECT_EQ(variable(0), 0);
}

TEST_F(ExampleProgram, ADoorOpensAgainBeforeAnObstacle) {
  constexpr std::uint8_t open = 0;
  constexpr std::uint8_t close = 1;
  constexpr std::uint8_t obstacle = 2;
  run("door");
  press(open);
  ASSERT_TRUE(arrive());
  pass(milliseconds(10));
  press(close);
  pass(seconds(1));
  const auto turned = position();
  module.set_input(obstacle, true);
  std::int32_t least = turned;
  do {
    pass(milliseconds(1));
    least = std::min(least, position());
  } while (!at_target());
  EXPECT_GT(least, 0);
  EXPECT_EQ(position(), 30'000);
  press(close);
  EXPECT_EQ(variable(0), 2);  // not while there is an obstacle
  module.set_input(obstacle, false);
  press(close);
  EXPECT_EQ(variable(0), 3);
}

TEST_F(ExampleProgram, AKnobRulesTheSpeed) {
  constexpr std::uint8_t knob = 0;
  const auto speed_at = [&](std::int32_t reading) {
    module.set_analog(knob, reading);
    pass(seconds(20));
    return get(ap::actual_velocity);
  };
  run("speed_knob");
  EXPECT_EQ(speed_at(2048), 0);
  EXPECT_EQ(speed_at(2048 + 500), 500);
  EXPECT_EQ(speed_at(4095), 2047);
  EXPECT_EQ(speed_at(2048 + 59), 0);
  EXPECT_EQ(speed_at(2048 - 500), -500);
  EXPECT_EQ(speed_at(0), -2047);
  EXPECT_EQ(speed_at(2048 - 60), 0);
}

class HomingProgram : public ExampleProgram {
 protected:
  static constexpr std::uint8_t ready = 0;
  static constexpr std::uint8_t failed = 1;

  /// Loads the program and lets the module run it after its next start.
  void power_up() {
    ask(Command::START_DOWNLOAD, 0, 0);
    for (const auto& [command, type, motor, value] : assembled(example("home_on_power_up")))
      ASSERT_EQ(status_of(command, type, motor, value), Status::command_loaded);
    ASSERT_EQ(status_of(Command::END_DOWNLOAD, 0, 0), Status::ok);
    ASSERT_EQ(status_of(Command::SGP, 77, 0, 1), Status::ok);
    ASSERT_EQ(status_of(Command::SOFTWARE_RESET, 0, 0, 1234), Status::ok);
    pass(Module::boot_time);
  }
  bool running() { return ask(Command::GGP, 128, 0)->value == 1; }
};

TEST_F(HomingProgram, FindsItsReferenceAndGoesToWork) {
  module.mount(0, {.position = 100'000, .left_switch = -30'000});
  power_up();
  EXPECT_TRUE(running());
  EXPECT_FALSE(output(ready));
  for (int second = 0; second < 100 && running(); ++second) pass(seconds(1));
  EXPECT_FALSE(running());
  EXPECT_TRUE(output(ready));
  EXPECT_FALSE(output(failed));
  EXPECT_EQ(position(), 5000);
  // Where that is on the stage: at the finest resolution, which has 256 to a full step.
  const auto per_microstep = 256 >> get(140);
  EXPECT_NEAR(static_cast<double>(module.stage(0).position()), -30'000 + 5000 * per_microstep,
              4 * per_microstep);
}

TEST_F(HomingProgram, GivesUpAfterAMinuteWithoutASwitch) {
  power_up();
  pass(seconds(59));
  EXPECT_TRUE(running());
  EXPECT_NE(get(ap::actual_velocity), 0);
  pass(seconds(2));
  EXPECT_FALSE(running());
  EXPECT_TRUE(output(failed));
  pass(seconds(30));
  EXPECT_EQ(get(ap::actual_velocity), 0);
}

}  // namespace
}  // namespace tmcl::sim
