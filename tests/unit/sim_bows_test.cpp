// S-shaped ramps of modules with a TMC4361.
#include "sim_fixture.hpp"

namespace tmcl::sim {
namespace {

namespace ap = axis_parameter;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr std::uint8_t ramp_type = 14;
constexpr std::uint8_t max_deceleration = 17;
constexpr std::uint8_t soft_stop = 34;

class SimBows : public SimTest {
 protected:
  Status set(std::uint8_t parameter, std::int32_t value) {
    return status_of(Command::SAP, parameter, 0, value);
  }
  void set_bows(std::int32_t first, std::int32_t second, std::int32_t third, std::int32_t fourth) {
    set(22, first);
    set(23, second);
    set(24, third);
    set(25, fourth);
  }
  // Seven phases: .2, .35 and .1 s up, .2, .775 and .25 s down.
  void set_up(std::uint16_t model) {
    add(model);
    set(ap::max_velocity, 100'000);
    set(ap::max_acceleration, 200'000);
    set(max_deceleration, 100'000);
    set_bows(1'000'000, 2'000'000, 500'000, 400'000);
  }
};

TEST_F(SimBows, GoThroughTheirPhases) {
  set_up(1111);
  EXPECT_EQ(set(ramp_type, 1), Status::ok);
  ask(Command::MVP, 0, 0, 300'000);
  pass(milliseconds(200));
  EXPECT_NEAR(get(ap::actual_velocity), 20'000, 10);
  EXPECT_NEAR(get(ap::actual_position), 1'333, 2);
  pass(milliseconds(350));
  EXPECT_NEAR(get(ap::actual_velocity), 90'000, 10);
  pass(milliseconds(100));
  EXPECT_EQ(get(ap::actual_velocity), 100'000);
  EXPECT_EQ(get(ap::position_reached), 0);
  pass(seconds(5));
  EXPECT_EQ(get(ap::actual_velocity), 0);
  EXPECT_EQ(get(ap::actual_position), 300'000);
  EXPECT_EQ(get(ap::position_reached), 1);
}

TEST_F(SimBows, MakeNoDifferenceToATrapezoid) {
  set_up(1111);
  ask(Command::MVP, 0, 0, 300'000);
  pass(milliseconds(200));
  EXPECT_NEAR(get(ap::actual_velocity), 40'000, 100);
  pass(milliseconds(300));
  EXPECT_NEAR(get(ap::actual_velocity), 100'000, 200);
}

TEST_F(SimBows, BeginAtRestAndWithTheNextCommand) {
  set_up(1111);
  ask(Command::MVP, 0, 0, 300'000);
  pass(milliseconds(200));
  EXPECT_EQ(set(ramp_type, 1), Status::ok);
  EXPECT_EQ(get(ramp_type), 1);
  pass(milliseconds(200));
  EXPECT_NEAR(get(ap::actual_velocity), 80'000, 200);
  pass(seconds(5));
  EXPECT_EQ(get(ap::actual_position), 300'000);
  EXPECT_EQ(get(ap::target_position), 300'000);
  ask(Command::MVP, 1, 0, -300'000);
  pass(milliseconds(200));
  EXPECT_NEAR(get(ap::actual_velocity), -20'000, 10);
  pass(seconds(6));
  EXPECT_EQ(get(ap::actual_position), 0);
  EXPECT_EQ(set(ramp_type, 0), Status::ok);
  ask(Command::MVP, 0, 0, 300'000);
  pass(milliseconds(200));
  EXPECT_NEAR(get(ap::actual_velocity), 40'000, 100);
}

TEST_F(SimBows, RotateAndStop) {
  set_up(3351);
  set(ramp_type, 1);
  EXPECT_EQ(status_of(Command::ROL, 0, 0, 100'000), Status::ok);
  EXPECT_EQ(get(ap::target_velocity), -100'000);
  pass(milliseconds(200));
  EXPECT_NEAR(get(ap::actual_velocity), -20'000, 10);
  pass(seconds(1));
  EXPECT_EQ(get(ap::actual_velocity), -100'000);
  ask(Command::MST, 0, 0);
  pass(milliseconds(200));
  EXPECT_NEAR(get(ap::actual_velocity), -90'000, 10);
  pass(milliseconds(775 + 250 + 1));
  EXPECT_EQ(get(ap::actual_velocity), 0);
  EXPECT_EQ(status_of(Command::ROR, 0, 0, 8'388'607), Status::ok);
  EXPECT_EQ(status_of(Command::ROR, 0, 0, 8'388'608), Status::invalid_value);
}

TEST_F(SimBows, KeepTheTargetOfAMotorThatWasStopped) {
  set_up(1111);
  ask(Command::MVP, 0, 0, 300'000);
  pass(seconds(1));
  ask(Command::MST, 0, 0);
  pass(seconds(3));
  const auto position = get(ap::actual_position);
  EXPECT_EQ(set(ramp_type, 1), Status::ok);
  pass(seconds(1));
  EXPECT_EQ(get(ap::actual_position), position);
  EXPECT_EQ(get(ap::target_position), 300'000);
}

TEST_F(SimBows, AreSteepWhileTheyAre0) {
  set_up(1111);
  set_bows(0, 0, 0, 0);
  set(ramp_type, 1);
  ask(Command::MVP, 0, 0, 300'000);
  pass(milliseconds(200));
  EXPECT_NEAR(get(ap::actual_velocity), 40'000, 10);
}

/// The figures of GoThroughTheirPhases, in the units of the chip.
TEST_F(SimBows, GoThroughTheirPhasesByRegistersAlone) {
  add(1111);
  const std::pair<std::uint8_t, std::int32_t> registers[] = {
      {0x28, 800'000}, {0x29, 400'000},    {0x2D, 1'000'000}, {0x2E, 2'000'000}, {0x2F, 500'000},
      {0x30, 400'000}, {0x24, 25'600'000}, {0x20, 6},         {0x37, 300'000},
  };
  for (const auto& [address, value] : registers)
    ASSERT_EQ(status_of(Command::WRITE_MC, address, 0, value), Status::ok) << int{address};
  pass(milliseconds(200));
  EXPECT_NEAR(ask(Command::READ_MC, 0x22, 0)->value, 20'000, 10);
  EXPECT_NEAR(ask(Command::READ_MC, 0x21, 0)->value, 1'333, 2);
  pass(milliseconds(450));
  EXPECT_EQ(get(ap::actual_velocity), 100'000);
  pass(seconds(5));
  EXPECT_EQ(get(ap::actual_position), 300'000);
}

/// A trapezoid of 100,000 microsteps/s with 200,000 up and 100,000 down, which starts and stops
/// with 10,000.
TEST_F(SimBows, LeaveATrapezoidItsEdgesByRegisters) {
  add(1111);
  const std::pair<std::uint8_t, std::int32_t> registers[] = {
      {0x25, 256 * 10'000}, {0x26, 256 * 10'000}, {0x28, 800'000},
      {0x29, 400'000},      {0x24, 25'600'000},   {0x20, 5},
      {0x37, 300'000},
  };
  for (const auto& [address, value] : registers)
    ASSERT_EQ(status_of(Command::WRITE_MC, address, 0, value), Status::ok) << int{address};
  pass(milliseconds(1));
  EXPECT_NEAR(get(ap::actual_velocity), 10'200, 100) << "it starts with VSTART";
  pass(milliseconds(199));
  EXPECT_NEAR(get(ap::actual_velocity), 50'000, 200);
  pass(seconds(5));
  EXPECT_EQ(get(ap::actual_position), 300'000);
}

TEST_F(SimBows, TakeARegisteredProfileOnlyAtRest) {
  set_up(1111);
  ask(Command::MVP, 0, 0, 300'000);
  pass(milliseconds(200));
  EXPECT_EQ(status_of(Command::WRITE_MC, 0x20, 0, 6), Status::ok);
  EXPECT_EQ(ask(Command::READ_MC, 0x20, 0)->value, 5);
  pass(milliseconds(200));
  EXPECT_NEAR(get(ap::actual_velocity), 80'000, 200);
  pass(seconds(5));
  ASSERT_EQ(status_of(Command::WRITE_MC, 0x37, 0, 0), Status::ok);
  EXPECT_EQ(ask(Command::READ_MC, 0x20, 0)->value, 6);
  pass(milliseconds(200));
  EXPECT_NEAR(get(ap::actual_velocity), -20'000, 10);
  pass(seconds(6));
  EXPECT_EQ(get(ap::actual_position), 0);
}

class SimBowsAtASwitch : public SimBows {
 protected:
  // Where it stands that was sent beyond a switch at 50,000 microsteps.
  std::int32_t stop_at_switch(bool softly) {
    add(1111, StageSettings{.right_switch = 50'000});
    set(ap::max_velocity, 50'000);
    set(ap::max_acceleration, 200'000);
    set(max_deceleration, 100'000);
    set_bows(1'000'000, 1'000'000, 1'000'000, 1'000'000);
    set(soft_stop, softly ? 1 : 0);
    set(ramp_type, 1);
    ask(Command::MVP, 0, 0, 200'000);
    pass(seconds(5));
    EXPECT_EQ(get(ap::actual_velocity), 0);
    const auto position = get(ap::actual_position);
    ask(Command::MVP, 0, 0, 0);
    pass(seconds(5));
    EXPECT_EQ(get(ap::actual_position), 0);
    return position;
  }
};

TEST_F(SimBowsAtASwitch, AreToldSoByReferenceConf) {
  add(1111, StageSettings{.right_switch = 50'000});
  set_bows(1'000'000, 1'000'000, 1'000'000, 1'000'000);
  set(ap::max_velocity, 50'000);
  set(ap::max_acceleration, 200'000);
  set(max_deceleration, 100'000);
  EXPECT_EQ(ask(Command::READ_MC, 0x01, 0)->value, 3);
  EXPECT_EQ(status_of(Command::WRITE_MC, 0x01, 0, 0), Status::ok);
  ask(Command::MVP, 0, 0, 60'000);
  pass(seconds(5));
  EXPECT_EQ(get(ap::actual_position), 60'000) << "trapezoid";
  EXPECT_EQ(status_of(Command::WRITE_MC, 0x20, 0, 6), Status::ok);
  ask(Command::MVP, 0, 0, 70'000);
  pass(seconds(5));
  EXPECT_EQ(get(ap::actual_position), 70'000) << "S-curve";
}

TEST_F(SimBowsAtASwitch, StopAtOnce) { EXPECT_NEAR(stop_at_switch(false), 50'000, 1); }

// From 50,000 pps with 100,000 pps/s, without bows.
TEST_F(SimBowsAtASwitch, StopLinearly) { EXPECT_NEAR(stop_at_switch(true), 62'500, 2); }

}  // namespace
}  // namespace tmcl::sim
