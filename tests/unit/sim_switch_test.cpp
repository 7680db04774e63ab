// Limit switches as a module sees them, and what they do to a movement.
#include <gtest/gtest.h>

#include "sim_fixture.hpp"

namespace tmcl::sim {
namespace {

namespace ap = axis_parameter;
using std::chrono::hours;
using std::chrono::seconds;

constexpr std::uint8_t right_switch = 10;
constexpr std::uint8_t left_switch = 11;
constexpr std::uint8_t right_switch_disable = 12;

class SimSwitches : public SimTest {
 protected:
  void set(std::uint8_t parameter, std::int32_t value) {
    EXPECT_EQ(status_of(Command::SAP, parameter, 0, value), Status::ok) << int{parameter};
  }
  // Where the stage is.
  double place() const { return static_cast<double>(bench.modules().front()->stage(0).position()); }
  void move_to(std::int32_t position) { ask(Command::MVP, 0, 0, position); }
  void expect_stands_at(std::int32_t position) {
    EXPECT_EQ(get(ap::actual_velocity), 0);
    EXPECT_EQ(get(ap::actual_position), position);
  }
};

TEST_F(SimSwitches, EndAMovementWhereTheyClose) {
  add(1110, StageSettings{.right_switch = 20'000});
  move_to(100'000);
  pass(seconds(5));
  EXPECT_EQ(get(right_switch), 1);
  EXPECT_EQ(get(left_switch), 0);
  EXPECT_EQ(get(ap::position_reached), 0);
  EXPECT_EQ(get(ap::actual_velocity), 0);
  EXPECT_NEAR(get(ap::actual_position), 20'000, 1);
  EXPECT_EQ(place(), get(ap::actual_position));
  EXPECT_EQ(bench.next_due(), never);
}

TEST_F(SimSwitches, LetTheMotorLeave) {
  add(1110, StageSettings{.right_switch = 20'000});
  move_to(100'000);
  pass(seconds(5));
  move_to(10'000);
  pass(seconds(5));
  expect_stands_at(10'000);
  EXPECT_EQ(get(right_switch), 0);
  move_to(30'000);
  pass(seconds(5));
  EXPECT_NEAR(get(ap::actual_position), 20'000, 1);
}

TEST_F(SimSwitches, DoNothingWhenDisabled) {
  add(1110, StageSettings{.left_switch = -20'000, .right_switch = 20'000});
  set(right_switch_disable, 1);
  move_to(30'000);
  pass(seconds(5));
  expect_stands_at(30'000);
  EXPECT_EQ(get(right_switch), 1);
  move_to(-30'000);
  pass(seconds(5));
  EXPECT_NEAR(get(ap::actual_position), -20'000, 1);
  EXPECT_EQ(get(left_switch), 1);
}

TEST_F(SimSwitches, BarTheWayOfRotations) {
  add(1110, StageSettings{.left_switch = -20'000});
  ask(Command::ROL, 0, 0, 500);
  pass(seconds(5));
  EXPECT_NEAR(get(ap::actual_position), -20'000, 1);
  ask(Command::ROL, 0, 0, 500);
  pass(seconds(5));
  EXPECT_NEAR(get(ap::actual_position), -20'000, 1);
  ask(Command::ROR, 0, 0, 500);
  pass(seconds(1));
  EXPECT_GT(get(ap::actual_position), 0);
}

TEST_F(SimSwitches, StayWhereTheyAreWhateverThePositionIsCalled) {
  add(1110, StageSettings{.right_switch = 20'000});
  ask(Command::MST, 0, 0);
  set(ap::actual_position, 1'000'000);
  move_to(2'000'000);
  pass(seconds(60));
  EXPECT_NEAR(get(ap::actual_position), 1'020'000, 1);
  EXPECT_NEAR(place(), 20'000, 1);
}

TEST_F(SimSwitches, AreFoundBehindTheEndOfThePositionCounter) {
  add(1110, StageSettings{.right_switch = 100'000'000});
  ask(Command::ROR, 0, 0, 2047);
  pass(hours(1));
  EXPECT_NEAR(place(), 100'000'000, 1);
  EXPECT_EQ(get(ap::actual_velocity), 0);
  EXPECT_NEAR(get(ap::actual_position), 100'000'000 - 6 * (1 << 24), 1);
}

TEST_F(SimSwitches, CountInStepsOfTheResolution) {
  add(1110, StageSettings{.right_switch = 16'000});
  set(140, 4);
  move_to(100'000);
  pass(seconds(5));
  EXPECT_NEAR(get(ap::actual_position), 1000, 1);
  EXPECT_NEAR(place(), 16'000, 16);
}

TEST_F(SimSwitches, StopTheMotorOfASixPointModule) {
  add(6212, StageSettings{.left_switch = -30'000, .right_switch = 30'000});
  move_to(100'000);
  pass(seconds(10));
  EXPECT_NEAR(get(ap::actual_position), 30'000, 5);
  EXPECT_EQ(get(ap::position_reached), 0);
  move_to(-100'000);
  pass(seconds(10));
  EXPECT_NEAR(get(ap::actual_position), -30'000, 5);
  EXPECT_EQ(get(left_switch), 1);
  EXPECT_EQ(bench.next_due(), never);
}

TEST_F(SimSwitches, SlowDownTheMotorOfATmc457) {
  add(142, StageSettings{.right_switch = 30'000});
  constexpr std::uint8_t stop_deceleration = 15;
  ask(Command::SAP, ap::max_velocity, 0, 5'000'000);  // 74,505.8 microsteps/s
  ask(Command::SAP, stop_deceleration, 0, 2'000);     // 116,415 microsteps/s^2
  for (const auto parameter : {std::uint8_t{16}, std::uint8_t{17}})
    ask(Command::SAP, parameter, 0, 24'624);
  move_to(10'000'000);
  pass(seconds(60));
  EXPECT_EQ(get(ap::actual_velocity), 0);
  EXPECT_EQ(get(right_switch), 1);
  EXPECT_NEAR(get(ap::actual_position), 30'000 + 23'842, 3) << "v^2 / 2d behind the switch";
}

TEST_F(SimSwitches, ActInTheMomentTheyArePressed) {
  auto& module = add(1110);
  ask(Command::ROR, 0, 0, 500);
  pass(seconds(1));
  const auto before = get(ap::actual_position);
  module.at_stage(0, [](Stage& stage) { stage.press(StageSwitch::right, true); });
  pass(milliseconds(100));
  EXPECT_EQ(get(right_switch), 1);
  EXPECT_EQ(get(ap::actual_velocity), 0);
  EXPECT_NEAR(get(ap::actual_position), before, 1);
}

TEST_F(SimSwitches, CostNothingWhileTheMotorStands) {
  add(6110, StageSettings{.left_switch = -1000, .right_switch = 1000, .home = Interval{-5, 5}});
  EXPECT_EQ(bench.next_due(), never);
}

TEST_F(SimSwitches, StopSoftlyIfTheyAreToldTo) {
  add(1110, StageSettings{.right_switch = 20'000});
  set(149, 1);
  ask(Command::ROR, 0, 0, 1000);
  pass(seconds(5));
  EXPECT_EQ(get(ap::actual_velocity), 0);
  EXPECT_GT(get(ap::actual_position), 20'100);
}

TEST_F(SimSwitches, AreReadTheOtherWayRoundWithReversedPolarity) {
  add(1110, StageSettings{.right_switch = 20'000, .limits_normally_closed = true});
  EXPECT_EQ(get(left_switch), 1);
  EXPECT_EQ(get(right_switch), 1);
  EXPECT_EQ(status_of(Command::SGP, 79, 0, 1), Status::ok);
  EXPECT_EQ(get(left_switch), 0);
  EXPECT_EQ(get(right_switch), 0);
  move_to(100'000);
  pass(seconds(5));
  EXPECT_EQ(get(right_switch), 1);
  EXPECT_NEAR(get(ap::actual_position), 20'000, 1);
}

TEST_F(SimSwitches, AMotorWithAReversedShaftGoesTheOtherWay) {
  add(1110, StageSettings{.left_switch = -20'000});
  EXPECT_EQ(status_of(Command::SGP, 90, 0, 1), Status::ok);
  move_to(5'000);
  pass(seconds(5));
  EXPECT_EQ(place(), -5'000);
  // The left switch bars negative motion, and the motor drives into it with positive.
  move_to(30'000);
  pass(seconds(5));
  EXPECT_EQ(get(left_switch), 1);
  EXPECT_EQ(place(), -30'000);
}

TEST_F(SimSwitches, OfASixPointModuleAreInvertedAndSwapped) {
  add(6212, StageSettings{.right_switch = 30'000});
  set(25, 1);
  EXPECT_EQ(get(left_switch), 1);
  set(25, 0);
  set(24, 1);
  EXPECT_EQ(get(right_switch), 1);
  set(24, 0);
  set(14, 1);
  move_to(31'000);
  pass(seconds(10));
  EXPECT_EQ(get(left_switch), 1);
  EXPECT_EQ(get(right_switch), 0);
  EXPECT_EQ(get(ap::actual_position), 31'000);
  set(14, 0);
  EXPECT_EQ(get(right_switch), 1);
}

TEST_F(SimSwitches, LatchThePositionOfASixPointModule) {
  add(6212, StageSettings{.right_switch = 30'000, .encoder = EncoderSettings{51'200, false}});
  ask(Command::ROR, 0, 0, 20'000);
  pass(seconds(10));
  EXPECT_EQ(get(198), 30'000);
  EXPECT_EQ(get(199), 30'000);
}

/// There is no lag between what the generator asks for and what the motor does.
TEST_F(SimSwitches, AMotorIsWhereItsGeneratorIsWhateverItsLoad) {
  add(1110, StageSettings{.left_switch = -1'000'000, .load = 900});
  move_to(20'000);
  int looks = 0;
  for (int ms = 0; ms < 5'000; ++ms) {
    pass(std::chrono::milliseconds(1));
    const auto here = get(ap::actual_position);
    ASSERT_EQ(place(), here) << ms;
    looks += here > 0 && here < 20'000 ? 1 : 0;
  }
  EXPECT_GT(looks, 100);
}

TEST_F(SimSwitches, AMotorPressedAgainstAnEndLosesItsSteps) {
  add(1110, StageSettings{.right_stop = 5'000});
  move_to(20'000);
  pass(seconds(5));
  expect_stands_at(20'000);
  EXPECT_EQ(place(), 5'000);
  move_to(0);
  pass(seconds(5));
  expect_stands_at(0);
  EXPECT_EQ(place(), -15'000);
}

}  // namespace
}  // namespace tmcl::sim
