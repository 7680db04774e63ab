#include "sim_fixture.hpp"

namespace tmcl::sim {
namespace {

namespace ap = axis_parameter;

using SimSystem = SimTest;

TEST_F(SimSystem, TellsOfItself) {
  add(6212);
  const auto info = [&](std::uint8_t type) { return ask(Command::GET_INFO, type, 0, 99)->value; };
  EXPECT_EQ(info(0), 6212);
  EXPECT_EQ(info(1), 0x00010001);
  EXPECT_EQ(info(2), 3);
  EXPECT_EQ(info(3), 0);
  EXPECT_EQ(info(10), 6212);
  EXPECT_EQ(info(11), 0x00010001);
  EXPECT_EQ(info(20), 8);
  EXPECT_EQ(info(21), 8);
  EXPECT_EQ(status_of(Command::GET_INFO, 30, 0), Status::ok);
  EXPECT_EQ(status_of(Command::GET_INFO, 4, 0), Status::wrong_type);
}

TEST_F(SimSystem, TellsTheRangesOfAxisParameters) {
  add(1110);
  EXPECT_EQ(ask(Command::GET_AP_MIN, ap::target_velocity, 0)->value, -2047);
  EXPECT_EQ(ask(Command::GET_AP_MAX, ap::target_velocity, 0)->value, 2047);
  EXPECT_EQ(status_of(Command::GET_AP_MAX, 99, 9), Status::wrong_type);
  EXPECT_EQ(status_of(Command::GET_AP_MAX, ap::target_velocity, 1), Status::invalid_value);
}

TEST_F(SimSystem, MeasuresTheSpeed) {
  add(3110);
  ask(Command::ROR, 0, 2, 500);
  pass(milliseconds(100));
  EXPECT_EQ(ask(Command::MEASURED_SPEED, 0, 2)->value, 500);
  EXPECT_EQ(status_of(Command::MEASURED_SPEED, 0, 3), Status::invalid_value);
}

TEST_F(SimSystem, ResetsItsChipsButNotItself) {
  add(3110);
  ask(Command::SAP, ap::max_velocity, 0, 99);
  ask(Command::STAP, ap::max_velocity, 0);
  ask(Command::SAP, ap::max_velocity, 1, 98);
  ask(Command::TARGET_REACHED_EVENT, 1, 0, 4);
  ask(Command::MVP, 0, 2, 100'000);
  ask(Command::SGP, 7, 2, 5);
  pass(milliseconds(100));
  EXPECT_EQ(status_of(Command::BOARD_RESET, 0, 0), Status::ok);
  heard();
  pass(std::chrono::seconds(5));
  EXPECT_TRUE(heard().empty());  // the movement is over, and was not completed
  EXPECT_EQ(get(ap::actual_position, 2), 0);
  EXPECT_EQ(get(ap::max_velocity, 0), 99);
  EXPECT_EQ(get(ap::max_velocity, 1), 1000);
  EXPECT_EQ(ask(Command::GGP, 7, 2)->value, 5);
  EXPECT_EQ(ask(Command::BOARD_ERROR, 0, 0, 9)->value, 0);
}

TEST_F(SimSystem, KnowsWhatOtherFirmwareHas) {
  add(1110);
  for (const auto command : {Command::UF0, Command::UF7, Command::GET_IDS,
                             Command::WRITE_USER_CHANNEL, Command::READ_USER_CHANNEL}) {
    EXPECT_EQ(status_of(command, 0, 0), Status::command_not_available) << name_of(command);
  }
  for (const auto command : {Command::WLAN0, Command::OTP, Command{16}, Command{0}}) {
    EXPECT_EQ(status_of(command, 0, 0), Status::invalid_command) << name_of(command);
  }
  EXPECT_EQ(status_of(Command::SECURITY_CODE, 0, 0, 4711), Status::ok);
}

}  // namespace
}  // namespace tmcl::sim
