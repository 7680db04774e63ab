#include <cmath>

#include "sim_fixture.hpp"
#include "tmcl/units.hpp"

namespace tmcl::sim {
namespace {

namespace ap = axis_parameter;
namespace gp = global_parameter;

using SimModule = SimTest;

TEST_F(SimModule, StartsWithTheDefaultsOfTheFirmware) {
  add(1110);
  EXPECT_EQ(get(ap::max_velocity), 1000);
  EXPECT_EQ(get(ap::max_acceleration), 500);
  EXPECT_EQ(get(153), 3);
  EXPECT_EQ(get(154), 2);
  EXPECT_EQ(get(130), 1);
  EXPECT_EQ(get(138), 0);
  EXPECT_EQ(get(ap::position_reached), 1);
}

TEST_F(SimModule, KeepsTheSettingsOfEachMotorApart) {
  add(3110);
  for (std::uint8_t motor = 0; motor < 3; ++motor) {
    EXPECT_EQ(status_of(Command::SAP, ap::max_velocity, motor, 100 + motor), Status::ok);
  }
  for (std::uint8_t motor = 0; motor < 3; ++motor) {
    EXPECT_EQ(get(ap::max_velocity, motor), 100 + motor);
  }
}

TEST_F(SimModule, HasAsManyMotorsAsTheModel) {
  add(1110, 1);
  add(3110, 2);
  add(6110, 3);
  const auto moved = [&](std::uint16_t address, std::uint8_t motor) {
    return ask({ModuleAddress{address}, Command::MST, 0, motor, 0})->status;
  };
  EXPECT_EQ(moved(1, 0), Status::ok);
  EXPECT_EQ(moved(1, 1), Status::invalid_value);
  EXPECT_EQ(moved(2, 2), Status::ok);
  EXPECT_EQ(moved(2, 3), Status::invalid_value);
  EXPECT_EQ(moved(3, 5), Status::ok);
  EXPECT_EQ(moved(3, 6), Status::invalid_value);
}

TEST_F(SimModule, FindsErrorsInTheOrderOfTheManual) {
  add(1110);
  const auto undefined = static_cast<Command>(250);
  EXPECT_EQ(status_of(undefined, 99, 9, 1), Status::invalid_command);
  EXPECT_EQ(status_of(Command::RFS, 99, 9, 1), Status::wrong_type);
  EXPECT_EQ(status_of(Command::SAP, 99, 9, 1), Status::wrong_type);
  EXPECT_EQ(status_of(Command::SAP, 8, 9, 1), Status::wrong_type);  // cannot be written
  EXPECT_EQ(status_of(Command::SAP, 4, 9, 1), Status::invalid_value);
  EXPECT_EQ(status_of(Command::SAP, 4, 0, 2048), Status::invalid_value);
  EXPECT_EQ(status_of(Command::GAP, 99, 9), Status::wrong_type);
  EXPECT_EQ(status_of(Command::GAP, 4, 9), Status::invalid_value);
  EXPECT_EQ(status_of(Command::MVP, 2, 9, 1), Status::invalid_value);
  EXPECT_EQ(status_of(Command::MVP, 3, 0, 1), Status::wrong_type);
  EXPECT_EQ(status_of(Command::MVP, 0, 9, 1), Status::invalid_value);
  EXPECT_EQ(status_of(Command::MVP, 0, 0, 1 << 23), Status::invalid_value);
  EXPECT_EQ(status_of(Command::ROR, 0, 1, 1), Status::invalid_value);
  EXPECT_EQ(status_of(Command::ROR, 0, 0, 2048), Status::invalid_value);
  EXPECT_EQ(status_of(Command::SGP, 99, 1), Status::wrong_type);
  EXPECT_EQ(status_of(Command::SGP, 66, 1), Status::invalid_value);
  EXPECT_EQ(status_of(Command::GGP, 99, 1), Status::wrong_type);
  EXPECT_EQ(status_of(Command::GGP, 66, 1), Status::invalid_value);
  EXPECT_EQ(status_of(Command::GET_FIRMWARE_VERSION, 2, 0), Status::wrong_type);
  EXPECT_EQ(status_of(Command::TARGET_REACHED_EVENT, 2, 0, 1), Status::wrong_type);
  EXPECT_EQ(status_of(Command::TARGET_REACHED_EVENT, 1, 0, 2), Status::invalid_value);
}

TEST_F(SimModule, RepeatsTheValueExceptForAnUnknownReading) {
  add(1110);
  EXPECT_EQ(ask(Command::MST, 0, 0, 77)->value, 77);
  EXPECT_EQ(ask(Command::SAP, 4, 0, 900)->value, 900);
  EXPECT_EQ(ask(Command::SAP, 4, 7, 901)->value, 901);
  EXPECT_EQ(ask(Command::GAP, 4, 7, 902)->value, 902);
  EXPECT_EQ(ask(Command::GAP, 99, 0, 903)->value, 0);
  EXPECT_EQ(ask(Command::GGP, 99, 0, 904)->value, 0);
  EXPECT_EQ(ask(static_cast<Command>(250), 0, 0, 905)->value, 905);
}

TEST_F(SimModule, RotatesBothWaysBeyondTheMaximumSpeed) {
  add(1110);
  EXPECT_EQ(ask(Command::ROR, 0, 0, 2000)->value, 2000);
  pass(milliseconds(100));
  EXPECT_EQ(get(ap::actual_velocity), 2000);
  EXPECT_EQ(get(138), 2);
  ask(Command::ROL, 0, 0, 2000);
  pass(milliseconds(100));
  EXPECT_EQ(get(ap::actual_velocity), -2000);
  ask(Command::ROR, 0, 0, -300);  // as PyTrinamic rotates to the left
  pass(milliseconds(100));
  EXPECT_EQ(get(ap::actual_velocity), -300);
}

TEST_F(SimModule, PositionsWithParameterFourAgainAfterRotating) {
  add(1110);
  ask(Command::SAP, ap::max_velocity, 0, 400);
  ask(Command::ROR, 0, 0, 2000);
  pass(milliseconds(50));
  ask(Command::MVP, 0, 0, 1'000'000);
  EXPECT_EQ(get(138), 0);
  EXPECT_EQ(get(ap::max_velocity), 400);
  pass(milliseconds(100));
  EXPECT_EQ(get(ap::actual_velocity), 400);
}

TEST_F(SimModule, StopsAlongTheRamp) {
  add(1110);
  ask(Command::ROR, 0, 0, 1000);
  pass(milliseconds(100));
  ask(Command::MST, 0, 0);
  pass(milliseconds(4));
  EXPECT_GT(get(ap::actual_velocity), 400);  // 8.2 ms to zero
  EXPECT_LT(get(ap::actual_velocity), 600);
  pass(milliseconds(5));
  EXPECT_EQ(get(ap::actual_velocity), 0);
  const auto x = get(ap::actual_position);
  pass(milliseconds(1000));
  EXPECT_EQ(get(ap::actual_position), x);
}

TEST_F(SimModule, MovesToAPositionInTheTimeOfTheRamp) {
  add(1110);
  ask(Command::MVP, 0, 0, 100'000);
  EXPECT_EQ(get(ap::position_reached), 0);
  EXPECT_EQ(get(ap::target_position), 100'000);
  const double ideal = 100'000 / to_pps({1000}, Tmc429Dividers{2, 3}).value + 0.0082;
  pass(std::chrono::duration_cast<Duration>(std::chrono::duration<double>(ideal - 0.001)));
  EXPECT_EQ(get(ap::position_reached), 0);
  pass(milliseconds(21));  // the last step at minimum speed takes 16 ms
  EXPECT_EQ(get(ap::position_reached), 1);
  EXPECT_EQ(get(ap::actual_position), 100'000);
}

TEST_F(SimModule, MovesRelativeToWhereItIs) {
  add(1110);
  ask(Command::SAP, ap::actual_position, 0, 1000);
  ask(Command::SAP, ap::target_position, 0, 1000);
  EXPECT_EQ(ask(Command::MVP, 1, 0, -300)->value, -300);
  EXPECT_EQ(get(ap::target_position), 700);
  pass(milliseconds(500));
  EXPECT_EQ(get(ap::actual_position), 700);
}

TEST_F(SimModule, FollowsATargetWrittenAsParameterOnlyWhenPositioning) {
  add(1110);
  ask(Command::SAP, ap::target_position, 0, 500);
  pass(milliseconds(200));
  EXPECT_EQ(get(ap::actual_position), 500);
  ask(Command::MST, 0, 0);
  ask(Command::SAP, ap::target_position, 0, 900);
  pass(milliseconds(200));
  EXPECT_EQ(get(ap::actual_position), 500);
  ask(Command::SAP, 138, 0, 0);
  pass(milliseconds(200));
  EXPECT_EQ(get(ap::actual_position), 900);
}

TEST_F(SimModule, RestoresTheMaximumSpeedWhenTheModeIsWritten) {
  add(1110);
  ask(Command::ROR, 0, 0, 2000);
  ask(Command::SAP, ap::target_position, 0, 1'000'000);
  ask(Command::SAP, 138, 0, 0);
  pass(milliseconds(200));
  EXPECT_EQ(get(ap::actual_velocity), 1000);
}

TEST_F(SimModule, TakesChangedDividersIntoTheRamp) {
  add(1110);
  ask(Command::SAP, 154, 0, 5);
  ask(Command::SAP, 153, 0, 7);
  ask(Command::ROR, 0, 0, 1000);
  pass(milliseconds(100));
  const double a = to_pps2({500}, Tmc429Dividers{5, 7}).value;
  EXPECT_NEAR(get(ap::actual_position), a * 0.1 * 0.1 / 2, 2);
  ask(Command::MVP, 0, 0, 2000);
  pass(std::chrono::seconds(10));
  EXPECT_EQ(get(ap::actual_position), 2000);
  EXPECT_EQ(get(ap::position_reached), 1);
}

TEST_F(SimModule, ShowsTheAccelerationWhileRamping) {
  add(1110);
  ask(Command::MVP, 0, 0, 100'000);
  pass(milliseconds(2));
  EXPECT_EQ(get(135), 500);
  pass(milliseconds(500));
  EXPECT_EQ(get(135), 0);
}

TEST_F(SimModule, CountsMillisecondsSinceItsStart) {
  pass(milliseconds(500));
  add(1110);
  pass(milliseconds(1234));
  EXPECT_EQ(ask(Command::GGP, 132, 0)->value, 1234);
  ask(Command::SGP, 132, 0, 0);
  pass(milliseconds(10));
  EXPECT_EQ(ask(Command::GGP, 132, 0)->value, 10);
}

TEST_F(SimModule, SuppressesRepliesToWhatSetsSomething) {
  add(1110);
  EXPECT_FALSE(ask(Command::SGP, 255, 0, 1));
  EXPECT_FALSE(ask(Command::SAP, 4, 0, 800));
  EXPECT_FALSE(ask(Command::MST, 0, 0));
  EXPECT_EQ(get(ap::max_velocity), 800);
  EXPECT_TRUE(ask(Command::SGP, 255, 0, 0));
  EXPECT_TRUE(ask(Command::MST, 0, 0));
}

TEST_F(SimModule, StopsAllMotorsWhenTheSerialHostFallsSilent) {
  auto& module = add(3110);
  ask(Command::SGP, gp::serial_heartbeat, 0, 200);
  ask(Command::ROR, 0, 0, 1000);
  ask(Command::ROL, 0, 2, 1000);
  for (int i = 0; i < 10; ++i) {
    pass(milliseconds(150));
    get(ap::actual_position);
  }
  EXPECT_EQ(get(ap::actual_velocity, 0), 1000);
  pass(milliseconds(199));
  EXPECT_EQ(module.axis(0).get(ap::actual_velocity), 1000);
  pass(milliseconds(12));
  EXPECT_EQ(module.axis(0).get(ap::actual_velocity), 0);
  EXPECT_EQ(module.axis(2).get(ap::actual_velocity), 0);
  ask(Command::ROR, 0, 0, 500);  // the host is back
  pass(milliseconds(100));
  EXPECT_EQ(get(ap::actual_velocity), 500);
}

TEST_F(SimModule, StopsAtTheRightInstantEvenIfNobodyWasAwake) {
  auto& punctual = add(1110, 1);
  ask(Command::SGP, gp::serial_heartbeat, 0, 100);
  ask(Command::ROR, 0, 0, 1000);
  VirtualClock other_clock;
  Bench other(other_clock);
  auto& late = other.add(*find_model(1110), ModuleAddress{1});
  SerialLine other_line(other, [](auto) {});
  for (const auto& request : {Request{ModuleAddress{1}, Command::SGP, gp::serial_heartbeat, 0, 100},
                              Request{ModuleAddress{1}, Command::ROR, 0, 0, 1000}}) {
    other_line.receive(encode_serial(request));
  }
  pass(milliseconds(1000));
  other_clock.advance(milliseconds(1000));
  other.run_due();
  EXPECT_EQ(late.axis(0).get(ap::actual_position), punctual.axis(0).get(ap::actual_position));
  EXPECT_GT(*late.axis(0).get(ap::actual_position), 5000);
}

TEST_F(SimModule, KeepsTheHeartbeatsOfTheTwoMediaApart) {
  add(1110);
  ask(Command::SGP, gp::can_heartbeat, 0, 100);
  ask(Command::ROR, 0, 0, 1000);
  for (int i = 0; i < 4; ++i) {
    pass(milliseconds(40));
    get(ap::actual_position);  // on the serial line only
  }
  EXPECT_EQ(get(ap::actual_velocity), 0);
}

}  // namespace
}  // namespace tmcl::sim
