#include "sim_fixture.hpp"

namespace tmcl::sim {
namespace {

using SimIo = SimTest;

TEST_F(SimIo, ReadsDigitalInputsOneByOneAndAllAtOnce) {
  auto& module = add(1110);
  EXPECT_EQ(ask(Command::GIO, 2, 0, 9)->value, 0);
  EXPECT_TRUE(module.set_input(2, true));
  EXPECT_TRUE(module.set_input(0, true));
  EXPECT_EQ(ask(Command::GIO, 2, 0)->value, 1);
  EXPECT_EQ(ask(Command::GIO, 255, 0)->value, 5);
  EXPECT_FALSE(module.set_input(200, true));
}

TEST_F(SimIo, PullsUpInputsThatNothingDrives) {
  auto& module = add(1110);
  module.set_input(1, false);
  EXPECT_EQ(status_of(Command::SIO, 0, 0, 1), Status::ok);
  EXPECT_EQ(ask(Command::GIO, 255, 0)->value, (1 << module.io().inputs()) - 1 - 2);
  ask(Command::SIO, 0, 0, 0);
  EXPECT_EQ(ask(Command::GIO, 255, 0)->value, 0);
}

TEST_F(SimIo, ReadsAnalogInputs) {
  auto& module = add(1110);
  EXPECT_TRUE(module.set_analog(0, 4095));
  EXPECT_EQ(ask(Command::GIO, 0, 1)->value, 4095);
  EXPECT_EQ(ask(Command::GIO, Io::supply_voltage_port, 1)->value, 240);
  EXPECT_EQ(ask(Command::GIO, Io::temperature_port, 1)->value, 25);
  EXPECT_FALSE(module.set_analog(0, 65536));
  EXPECT_FALSE(module.set_analog(0, -1));
  EXPECT_FALSE(module.set_analog(100, 0));
}

TEST_F(SimIo, SetsAndReadsBackOutputs) {
  auto& module = add(1110);
  EXPECT_EQ(ask(Command::SIO, 1, 2, 1)->value, 1);
  EXPECT_EQ(ask(Command::GIO, 1, 2)->value, 1);
  EXPECT_EQ(ask(Command::GIO, 0, 2)->value, 0);
  EXPECT_EQ(status_of(Command::SIO, 255, 2, 5), Status::ok);
  EXPECT_EQ(module.io().outputs(), 5U);
  ask(Command::SIO, 0, 2, 0);
  EXPECT_EQ(ask(Command::GIO, 255, 2)->value, 4);
}

TEST_F(SimIo, RefusesPortsBanksAndValuesThatDoNotExist) {
  add(1110);
  EXPECT_EQ(status_of(Command::GIO, 100, 0), Status::wrong_type);
  EXPECT_EQ(status_of(Command::GIO, 255, 1), Status::wrong_type);
  EXPECT_EQ(status_of(Command::GIO, 100, 2), Status::wrong_type);
  EXPECT_EQ(status_of(Command::GIO, 0, 3), Status::invalid_value);
  EXPECT_EQ(status_of(Command::SIO, 100, 2, 0), Status::wrong_type);
  EXPECT_EQ(status_of(Command::SIO, 0, 2, 2), Status::invalid_value);
  EXPECT_EQ(status_of(Command::SIO, 255, 2, 1 << 16), Status::invalid_value);
  EXPECT_EQ(status_of(Command::SIO, 255, 2, -1), Status::invalid_value);
  EXPECT_EQ(status_of(Command::SIO, 0, 1, 0), Status::invalid_value);
  EXPECT_EQ(status_of(Command::SIO, 1, 0, 1), Status::wrong_type);
}

TEST_F(SimIo, SwitchesOutputsOffAtARestartAndLeavesTheInputs) {
  auto& module = add(1110);
  ask(Command::SIO, 255, 2, 3);
  module.set_input(1, true);
  ask(Command::SOFTWARE_RESET, 0, 0, 1234);
  EXPECT_EQ(module.io().outputs(), 0U);
  pass(Module::boot_time);
  EXPECT_EQ(ask(Command::GIO, 255, 0)->value, 2);
}

TEST_F(SimIo, AShutdownInputThatNothingDrivesDoesNotAct) {
  EXPECT_FALSE(add(1110, 2).set_shutdown_input(true));  // it has none
  auto& module = add(351);
  EXPECT_EQ(status_of(Command::SGP, global_parameter::shutdown_pin_function, 0, 2), Status::ok);
  ask(Command::ROR, 0, 0, 100);
  pass(milliseconds(100));
  EXPECT_EQ(get(axis_parameter::actual_velocity), 100);
  EXPECT_TRUE(module.set_shutdown_input(false));
  pass(milliseconds(100));
  EXPECT_EQ(get(axis_parameter::actual_velocity), 0);
}

}  // namespace
}  // namespace tmcl::sim
