// A module whose motor can be asked too much: steps that are lost, currents that follow the load,
// and drivers that switch off.
#include <gmock/gmock.h>

#include <set>

#include "sim_fixture.hpp"

namespace tmcl::sim {
namespace {

namespace ap = axis_parameter;
using std::chrono::seconds;

constexpr std::uint8_t max_current = 6;
constexpr std::uint8_t standby_current = 7;
constexpr std::uint8_t short_protection_disable = 177;
constexpr std::uint8_t current_minimum = 168;
constexpr std::uint8_t down_step = 169;
constexpr std::uint8_t hysteresis = 170;
constexpr std::uint8_t up_step = 171;
constexpr std::uint8_t hysteresis_start = 172;
constexpr std::uint8_t toff = 167;
constexpr std::uint8_t global_scaler = 178;
constexpr std::uint8_t vsense = 179;
constexpr std::uint8_t current = 180;
constexpr std::uint8_t stop_on_stall = 181;
constexpr std::uint8_t threshold_speed = 182;
constexpr std::uint8_t slow_run_current = 183;
constexpr std::uint8_t load_value = 206;
constexpr std::uint8_t error_flags = 207;
constexpr std::uint8_t driver_flags = 208;
constexpr std::uint8_t encoder_position = 209;
constexpr std::int32_t stall_flag = 0x01;
constexpr std::int32_t standstill_flag = 0x80;

// In microsteps per second, as the sixPoint modules count.
constexpr std::int32_t full_steps(std::int32_t number) { return 256 * number; }

class SimMotor : public SimStageTest {
 protected:
  // A TMCM-1276, with an encoder that shows where its motor really is.
  Module& add_watched(StageSettings stage, std::uint16_t model = 1276) {
    stage.encoder = EncoderSettings{51'200, false};
    auto& module = add(model, stage);
    if (model == 1276) set(ap::max_acceleration, full_steps(10'000));
    return module;
  }
  void fault(DriverFault which, bool on = true) {
    at_stage([&](Stage& stage) { stage.set_fault(which, on); });
  }
  std::int32_t lost() { return get(ap::actual_position) - get(encoder_position); }
};

// ---- Torque

TEST_F(SimMotor, LosesStepsAboveTheSpeedAtWhichItsTorqueEnds) {
  add_watched({.load = 500, .corner_speed = 400});
  ask(Command::ROR, 0, 0, full_steps(790));
  pass(seconds(2));
  EXPECT_EQ(lost(), 0);
  ask(Command::ROR, 0, 0, full_steps(810));
  pass(seconds(2));
  EXPECT_GT(lost(), full_steps(1'000));
  EXPECT_EQ(get(load_value), 0);
  EXPECT_EQ(get(driver_flags), stall_flag);
  EXPECT_EQ(get(ap::actual_velocity), full_steps(810)) << "the ramp knows nothing of it";
}

TEST_F(SimMotor, GoesOnWhereItWasWhenItIsSlowEnough) {
  add_watched({.load = 500, .corner_speed = 400, .pull_in_speed = 200});
  ask(Command::ROR, 0, 0, full_steps(900));
  pass(seconds(1));
  const auto place = get(encoder_position);
  ask(Command::ROR, 0, 0, full_steps(300));
  pass(seconds(1));
  EXPECT_EQ(get(encoder_position), place);
  ask(Command::ROR, 0, 0, full_steps(190));
  pass(seconds(1));
  const auto lost_for_good = lost();
  EXPECT_GT(get(encoder_position), place);
  pass(seconds(1));
  EXPECT_EQ(lost(), lost_for_good);
}

TEST_F(SimMotor, CatchesOnWhereItTurnsRound) {
  add_watched({.load = 500, .corner_speed = 400, .pull_in_speed = 0});
  ask(Command::ROR, 0, 0, full_steps(900));
  pass(seconds(1));
  const auto place = get(encoder_position);
  ask(Command::ROL, 0, 0, full_steps(300));
  pass(milliseconds(900));
  EXPECT_LT(get(encoder_position), place);
}

TEST_F(SimMotor, CannotStartMoreInertiaThanItHasTorqueFor) {
  add_watched({.inertia = 50'000});
  set(ap::max_acceleration, full_steps(15'000));
  ask(Command::MVP, 0, 0, full_steps(1'000));
  pass(seconds(3));
  EXPECT_EQ(lost(), 0);
  set(ap::max_acceleration, full_steps(25'000));
  ask(Command::MVP, 0, 0, 0);
  pass(seconds(3));
  EXPECT_NE(lost(), 0);
}

TEST_F(SimMotor, TurnsWhatItsCurrentIsEnoughFor) {
  add_watched({.load = 400, .torque_follows_current = true});
  set(max_current, 128);
  ask(Command::ROR, 0, 0, full_steps(100));
  pass(seconds(1));
  EXPECT_EQ(lost(), 0);
  set(max_current, 80);
  pass(seconds(1));
  EXPECT_NEAR(lost(), full_steps(100), 256);
  EXPECT_EQ(get(current), 10);
}

TEST_F(SimMotor, SlidesAtRestWhereItsStandbyCurrentIsTooSmallForWhatPulls) {
  add_watched({.load = 50, .pull = 300, .torque_follows_current = true});
  set(standby_current, 64);
  pass(seconds(5));
  EXPECT_EQ(lost(), 0);
  set(standby_current, 56);
  pass(seconds(1));
  EXPECT_NEAR(lost(), full_steps(125), 256);
  set(standby_current, 64);
  pass(seconds(1));
  EXPECT_NEAR(lost(), full_steps(125), 256);
  EXPECT_EQ(get(ap::actual_position), 0) << "the module knows nothing of it";
}

TEST_F(SimMotor, HasHalfTheCurrentWhereItsResistorsSeeLittle) {
  add_watched({.load = 550, .torque_follows_current = true}, 6212);
  set(max_current, 255);
  ask(Command::ROR, 0, 0, full_steps(100));
  pass(seconds(1));
  set(vsense, 1);
  pass(seconds(1));
  EXPECT_EQ(lost(), 0) << "180 of 320 are enough";
  at_stage([](Stage& stage) { stage.set_load(570); });
  pass(seconds(1));
  EXPECT_NEAR(lost(), full_steps(100), 256);
  set(vsense, 0);
  const auto lost_for_good = lost();
  pass(seconds(1));
  EXPECT_NEAR(lost(), lost_for_good, 256);
}

TEST_F(SimMotor, TheGlobalScalerScalesItsTorque) {
  add_watched({.load = 400, .torque_follows_current = true}, 1211);
  set(max_current, 255);
  ask(Command::ROR, 0, 0, full_steps(100));
  pass(seconds(1));
  EXPECT_EQ(lost(), 0);
  set(global_scaler, 100);
  pass(seconds(1));
  EXPECT_GT(lost(), full_steps(90));
}

TEST_F(SimMotor, AStopEndsAStallAtOnce) {
  add_watched({.load = 500, .corner_speed = 400, .pull_in_speed = 0});
  ask(Command::ROR, 0, 0, full_steps(900));
  pass(seconds(1));
  ask(Command::MST, 0, 0);
  pass(seconds(1));
  EXPECT_EQ(get(ap::actual_velocity), 0);
  EXPECT_EQ(bench.next_due(), never);
}

TEST_F(SimMotor, StopsInTheStallIfItIsToldTo) {
  add_watched({.load = 500, .corner_speed = 400});
  set(stop_on_stall, full_steps(10));
  load(100);
  ask(Command::ROR, 0, 0, full_steps(780));
  pass(seconds(1));
  EXPECT_NE(get(ap::actual_velocity), 0);
  ask(Command::ROR, 0, 0, full_steps(4'100));
  pass(seconds(1));
  EXPECT_EQ(get(error_flags), 1);
  EXPECT_EQ(get(ap::actual_velocity), 0);
}

// stallGuard2 shows what is asked of what there is.
TEST_F(SimMotor, TheLoadValueFallsWithTheTorque) {
  add_watched({.load = 100, .corner_speed = 400});
  ask(Command::ROR, 0, 0, full_steps(400));
  pass(seconds(1));
  EXPECT_EQ(get(load_value), 400);
  ask(Command::ROR, 0, 0, full_steps(1'600));
  pass(seconds(1));
  EXPECT_EQ(get(load_value), 100);
  EXPECT_EQ(lost(), 0);
}

TEST_F(SimMotor, TheLoadValueFallsAsSteeplyAndIsAsUneasyAsItsStageSays) {
  add_watched({.load = 100, .load_value_slope = 2000, .load_value_noise = 10});
  ask(Command::ROR, 0, 0, full_steps(400));
  pass(seconds(1));
  std::set<std::int32_t> readings;
  for (int i = 0; i < 100; ++i) {
    pass(milliseconds(3));
    EXPECT_EQ(get(load_value), get(load_value));
    readings.insert(get(load_value));
  }
  EXPECT_GT(readings.size(), 10U);
  EXPECT_GE(*readings.begin(), 290);
  EXPECT_LE(*readings.rbegin(), 310);
}

TEST_F(SimMotor, TheLoadFollowsTheMotorWhenItsBacklashIsMadeUpFor) {
  StageSettings stage;
  stage.backlash = 40;
  add_watched(stage);
  const auto after = [&](std::int32_t target) {
    ask(Command::MVP, 0, 0, target);
    pass(seconds(1));
    return get(encoder_position);
  };
  EXPECT_EQ(after(30), 0);
  EXPECT_EQ(after(1000), 960);
  EXPECT_EQ(after(970), 960);
  EXPECT_EQ(after(900), 900);
  EXPECT_EQ(after(910), 900);
}

// ---- coolStep

TEST_F(SimMotor, CoolStepTakesTheCurrentThatTheLoadNeeds) {
  add_watched({.load = 100, .torque_follows_current = true}, 1110);
  set(max_current, 248);
  set(hysteresis_start, 4);
  set(hysteresis, 1);
  set(down_step, 3);
  set(up_step, 3);
  ask(Command::ROR, 0, 0, 500);
  pass(milliseconds(1));
  EXPECT_EQ(get(current), 31);
  pass(seconds(2));
  EXPECT_EQ(get(current), 15);
  EXPECT_EQ(get(load_value), 300);
  load(300);
  pass(seconds(1));
  EXPECT_GE(get(load_value), 128 - 32);
  EXPECT_GT(get(current), 20);
  EXPECT_EQ(lost(), 0);
  ask(Command::MST, 0, 0);
  pass(milliseconds(600));
  EXPECT_EQ(get(current), 31) << "it stands, and the standby current is not due";
}

TEST_F(SimMotor, HasNoMoreTorqueThanCoolStepLeavesIt) {
  constexpr std::uint8_t threshold = 174;
  add_watched({.load = 300, .torque_follows_current = true});
  set(max_current, 255);
  set(threshold, 63);
  set(current_minimum, 1);
  set(hysteresis_start, 1);
  set(down_step, 3);
  ask(Command::ROR, 0, 0, full_steps(100));
  pass(seconds(3));
  EXPECT_EQ(lost(), 0);
  EXPECT_EQ(get(current), 9);
  load(400);
  pass(milliseconds(5));
  const auto lost_for_good = lost();
  EXPECT_NE(lost_for_good, 0) << "before it sees that more is asked of it";
  set(hysteresis_start, 0);
  pass(milliseconds(5));
  EXPECT_EQ(get(current), 31);
  const auto lost_at_first = lost();
  pass(seconds(1));
  EXPECT_EQ(lost(), lost_at_first) << "its full current is enough";
}

TEST_F(SimMotor, CoolStepWorksAboveItsThresholdSpeed) {
  add_watched({.load = 100}, 1110);
  set(max_current, 248);
  set(slow_run_current, 80);
  set(hysteresis_start, 4);
  set(down_step, 3);
  set(threshold_speed, 400);
  ask(Command::ROR, 0, 0, 399);
  pass(seconds(2));
  EXPECT_EQ(get(current), 10);
  ask(Command::ROR, 0, 0, 400);
  pass(seconds(2));
  EXPECT_EQ(get(current), 15);
  set(hysteresis_start, 0);
  EXPECT_EQ(get(current), 31);
}

// ---- The driver

TEST_F(SimMotor, TellsWhatIsWrongWithItsDriver) {
  add_watched({}, 1110);
  using enum DriverFault;
  for (const auto which : {overtemperature_warning, short_a, short_b, open_load_a, open_load_b}) {
    fault(which);
    EXPECT_EQ(get(driver_flags), standstill_flag | static_cast<std::int32_t>(which));
    fault(which, false);
    set(toff, 0);
    set(toff, 4);
    EXPECT_EQ(get(driver_flags), standstill_flag);
  }
  fault(overtemperature);
  EXPECT_EQ(get(driver_flags), standstill_flag | 0x06) << "what is too hot is nearly too hot";
}

TEST_F(SimMotor, AShortTakesTheTorqueUntilTheDriverIsEnabledAgain) {
  add_watched({}, 1110);
  ask(Command::ROR, 0, 0, 500);
  pass(seconds(1));
  EXPECT_EQ(lost(), 0);
  fault(DriverFault::short_a);
  pass(seconds(1));
  const auto lost_by_short = lost();
  EXPECT_GT(lost_by_short, 0);
  fault(DriverFault::short_a, false);
  pass(seconds(1));
  EXPECT_GT(lost(), lost_by_short);
  EXPECT_EQ(get(driver_flags), 0x08 | stall_flag);
  set(toff, 0);
  EXPECT_EQ(get(driver_flags), stall_flag) << "it is told no more, but the driver is off";
  set(toff, 4);
  const auto lost_at_last = lost();
  pass(seconds(1));
  EXPECT_EQ(lost(), lost_at_last);
  EXPECT_EQ(get(driver_flags), 0);
}

TEST_F(SimMotor, AShortOnlyCountsUnlessItsProtectionIsOff) {
  add_watched({}, 1110);
  set(short_protection_disable, 1);
  fault(DriverFault::short_b);
  EXPECT_EQ(get(driver_flags), standstill_flag);
  ask(Command::ROR, 0, 0, 500);
  pass(seconds(1));
  EXPECT_EQ(lost(), 0);
  set(short_protection_disable, 0);
  EXPECT_EQ(get(driver_flags), 0x10 | stall_flag);
}

TEST_F(SimMotor, AHotDriverIsOffUntilItsWarningIsOver) {
  add_watched({}, 1110);
  fault(DriverFault::overtemperature_warning);
  ask(Command::ROR, 0, 0, 500);
  pass(seconds(1));
  EXPECT_EQ(lost(), 0);
  EXPECT_EQ(get(driver_flags), 0x04);
  fault(DriverFault::overtemperature);
  pass(seconds(1));
  EXPECT_GT(lost(), 0);
  fault(DriverFault::overtemperature, false);
  EXPECT_EQ(get(driver_flags), 0x06 | stall_flag);
  fault(DriverFault::overtemperature_warning, false);
  EXPECT_EQ(get(driver_flags), 0);
}

TEST_F(SimMotor, AnOpenCoilLeavesTheDriverOnAndTheMotorWithoutTorque) {
  add_watched({}, 1110);
  fault(DriverFault::open_load_b);
  ask(Command::ROR, 0, 0, 500);
  pass(seconds(1));
  EXPECT_EQ(get(encoder_position), 0);
  EXPECT_EQ(get(driver_flags), 0x40 | stall_flag);
  fault(DriverFault::open_load_b, false);
  pass(seconds(1));
  EXPECT_GT(get(encoder_position), 0);
}

TEST_F(SimMotor, FaultsAreThereAfterARestart) {
  auto& module = add_watched({}, 1110);
  fault(DriverFault::short_a);
  module.power_cycle();
  pass(seconds(1));
  EXPECT_EQ(get(driver_flags), standstill_flag | 0x08);
}

TEST_F(SimMotor, AnOldDriverLosesStepsAsWell) {
  auto& module = add(351, {.right_switch = 10'000});
  fault(DriverFault::short_a);
  ask(Command::ROR, 0, 0, 500);
  pass(seconds(2));
  EXPECT_EQ(module.stage(0).position(), 0);
  EXPECT_EQ(get(load_value), 0);
}

// ---- The supply

TEST_F(SimMotor, WithUsbAloneTheModuleAnswersAndItsMotorsStand) {
  auto& module = add_watched({}, 1110);
  module.set_supply(50);
  EXPECT_EQ(ask(Command::GIO, 8, 1)->value, 50);
  ask(Command::MVP, 0, 0, 10'000);
  pass(seconds(5));
  EXPECT_EQ(get(ap::actual_position), 10'000);
  EXPECT_EQ(get(encoder_position), 0);
  module.set_supply(70);
  ask(Command::MVP, 0, 0, 0);
  pass(seconds(5));
  EXPECT_EQ(get(encoder_position), -10'000);
}

TEST_F(SimMotor, ABrownOutCostsSteps) {
  auto& module = add_watched({}, 1110);
  ask(Command::ROR, 0, 0, 500);
  pass(seconds(1));
  module.brown_out(milliseconds(200));
  pass(milliseconds(199));
  EXPECT_EQ(ask(Command::GIO, 8, 1)->value, 60);
  pass(seconds(1));
  const auto pps = 16e6 * 500 / (4 * 2048 * 32);
  EXPECT_NEAR(lost(), pps * 0.2, 2);
  EXPECT_EQ(ask(Command::GIO, 8, 1)->value, 240);
  EXPECT_EQ(get(ap::actual_velocity), 500);
}

TEST_F(SimMotor, ABrownOutForgetsAShort) {
  auto& module = add_watched({}, 1110);
  fault(DriverFault::short_a);
  fault(DriverFault::short_a, false);
  EXPECT_EQ(get(driver_flags), standstill_flag | 0x08);
  module.brown_out(milliseconds(1));
  EXPECT_EQ(get(driver_flags), standstill_flag);
}

TEST_F(SimMotor, ASupplyThatIsSetEndsABrownOut) {
  auto& module = add(1110);
  module.brown_out(milliseconds(100));
  module.brown_out(milliseconds(200));
  pass(milliseconds(150));
  EXPECT_EQ(ask(Command::GIO, 8, 1)->value, 60);
  pass(milliseconds(50));
  EXPECT_EQ(ask(Command::GIO, 8, 1)->value, 240);
  module.brown_out(milliseconds(100));
  module.set_supply(120);
  pass(seconds(1));
  EXPECT_EQ(ask(Command::GIO, 8, 1)->value, 120);
}

// It turns round within its first microstep, so that no way tells of it.
TEST_F(SimMotor, ThatTurnsBackToAnEndIsSeenToStall) {
  add_watched({.right_stop = 256});
  set(ap::microstep_resolution, 0);
  set(ap::max_acceleration, 1000);
  ask(Command::ROR, 0, 0, 5);
  pass(seconds(3));
  ASSERT_EQ(get(load_value), 0);
  ask(Command::ROL, 0, 0, 5);
  pass(milliseconds(100));
  const auto place = get(encoder_position);
  set(stop_on_stall, 1);
  ask(Command::ROR, 0, 0, 5);
  pass(seconds(1));
  EXPECT_EQ(get(encoder_position), place);
  EXPECT_EQ(get(ap::actual_velocity), 0);
  EXPECT_EQ(get(error_flags), 1);
}

}  // namespace
}  // namespace tmcl::sim
