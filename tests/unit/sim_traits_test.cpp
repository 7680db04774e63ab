// Each trait of a module makes the difference that it stands for.
#include <gtest/gtest.h>

#include "sim/wire/usb_line.hpp"
#include "sim_fixture.hpp"
#include "support/lone_module.hpp"
#include "tmcl/parameter_number.hpp"

namespace tmcl::sim {
namespace {

namespace ap = axis_parameter;
using namespace std::chrono_literals;

class SimTraits : public SimTest {
 protected:
  template <class Variant>
  Module& add_with(Trait trait, Variant variant, std::uint16_t model = 1110) {
    ModuleSettings settings;
    settings.traits.set(trait, variant);
    return bench.add(*find_model(model), ModuleAddress{1}, settings);
  }
  std::int32_t value_of(Command command, std::uint8_t type, std::int32_t value = 0) {
    return ask(command, type, 0, value)->value;
  }
  /// From before it moves until it stands.
  Duration time_of_one_microstep() {
    for (const auto& [parameter, value] : {std::pair{ap::max_velocity, 1000},
                                           {ap::max_acceleration, 500},
                                           {number_of("minimum_velocity"), 1},
                                           {number_of("ramp_divisor"), 5},
                                           {number_of("pulse_divisor"), 5}})
      EXPECT_EQ(status_of(Command::SAP, parameter, 0, value), Status::ok);
    value_of(Command::MVP, 0, 1);
    for (Duration time{}; time < 1s; time += 1ms) {
      if (value_of(Command::GAP, ap::actual_position) == 1) return time;
      pass(1ms);
    }
    return 1s;
  }
  void stop_halfway_to(std::int32_t target) {
    value_of(Command::MVP, 0, target);
    while (value_of(Command::GAP, ap::actual_position) < target / 2) pass(1ms);
    value_of(Command::MST, 0);
    pass(3s);
  }
};

TEST_F(SimTraits, ATmc429TakesItsLastStepAsItIsSaidTo) {
  add_with(Trait::last_step, ramp::Tmc429::LastStep::r3);
  EXPECT_GT(time_of_one_microstep(), 100ms);
}

TEST_F(SimTraits, AndFasterByAnotherRule) {
  add_with(Trait::last_step, ramp::Tmc429::LastStep::r2);
  EXPECT_LT(time_of_one_microstep(), 60ms);
}

TEST_F(SimTraits, ARelativeMoveCountsFromWhereTheMotorIs) {
  add_with(Trait::relative_from, RelativeFrom::actual);
  stop_halfway_to(20000);
  const auto here = value_of(Command::GAP, ap::actual_position);
  value_of(Command::MVP, 1, 100);
  EXPECT_EQ(value_of(Command::GAP, ap::target_position), here + 100);
}

TEST_F(SimTraits, OrFromItsTarget) {
  add_with(Trait::relative_from, RelativeFrom::target);
  stop_halfway_to(20000);
  const auto target = value_of(Command::GAP, ap::target_position);
  ASSERT_NE(target, value_of(Command::GAP, ap::actual_position));
  value_of(Command::MVP, 1, 100);
  EXPECT_EQ(value_of(Command::GAP, ap::target_position), target + 100);
}

TEST_F(SimTraits, ARelativeMoveIsAnsweredWithItsDistance) {
  add_with(Trait::relative_answer, RelativeAnswer::distance, 1276);
  value_of(Command::MVP, 0, 1000);
  EXPECT_EQ(value_of(Command::MVP, 1, 100), 100);
}

TEST_F(SimTraits, OrWithItsTarget) {
  add_with(Trait::relative_answer, RelativeAnswer::target);
  value_of(Command::MVP, 0, 50);
  pass(5s);
  EXPECT_EQ(value_of(Command::MVP, 1, 100), 150);
}

TEST_F(SimTraits, AMotorThatTurnsByVelocityGoesOnWhateverItsTarget) {
  add_with(Trait::velocity_target, VelocityTarget::turns_on);
  value_of(Command::ROR, 0, 500);
  pass(1s);
  value_of(Command::SAP, ap::target_position, 10);
  pass(20s);
  EXPECT_NE(value_of(Command::GAP, ap::actual_velocity), 0);
}

class SimVelocityTarget : public SimTraits, public testing::WithParamInterface<std::uint16_t> {};

TEST_P(SimVelocityTarget, IsWhereItGoes) {
  add_with(Trait::velocity_target, VelocityTarget::goes_there, GetParam());
  value_of(Command::ROR, 0, GetParam() == 1110 ? 500 : 5000);
  pass(1s);
  value_of(Command::SAP, ap::target_position, 10);
  pass(60s);
  EXPECT_EQ(value_of(Command::GAP, ap::actual_velocity), 0);
  EXPECT_EQ(value_of(Command::GAP, ap::actual_position), 10);
}
INSTANTIATE_TEST_SUITE_P(Models, SimVelocityTarget, testing::Values(1110, 1276, 142));

// The parameter is read as it was set.
TEST(SimLimitStop, IsHardOrSoftWhateverTheParameterSays) {
  const auto soft_stop = number_of(Family::tmc429, "soft_stop");
  StageSettings stage;
  stage.right_switch = 20000;
  for (const auto stop : {LimitStop::hard, LimitStop::soft, LimitStop::as_set}) {
    for (const auto set : {0, 1}) {
      ModuleSettings settings;
      settings.traits.set(Trait::limit_stop, stop);
      test::LoneModule one(1110, stage, settings);
      one.ask(Command::SAP, soft_stop, set);
      EXPECT_EQ(one.ask(Command::GAP, soft_stop, 0).value, set);
      one.ask(Command::ROR, 0, 1000);
      one.look_at(one.clock.now() + 10s);
      const bool is_soft = stop == LimitStop::soft || (stop == LimitStop::as_set && set == 1);
      const auto beyond = one.ask(Command::GAP, ap::actual_position, 0).value - 20000;
      EXPECT_EQ(beyond > 100, is_soft) << index_of(stop) << " " << set << ": " << beyond;
    }
  }
}

TEST_F(SimTraits, TheStateOfAProgramIsInTheLowByte) {
  add_with(Trait::program_state, ProgramState::low_byte);
  value_of(Command::RESET_APPLICATION, 0);
  EXPECT_EQ(value_of(Command::GET_APPLICATION_STATUS, 0),
            ask(Command::GGP, global_parameter::application_status, 0)->value);
}

TEST_F(SimTraits, AHeartbeatIsKeptAndIgnored) {
  add_with(Trait::heartbeat, tmcl::Heartbeat::ignored);
  ASSERT_EQ(status_of(Command::SGP, global_parameter::serial_heartbeat, 0, 100), Status::ok);
  value_of(Command::ROR, 0, 500);
  pass(2s);
  EXPECT_NE(value_of(Command::GAP, ap::actual_velocity), 0);
}

TEST_F(SimTraits, CommandsForAnyAddressAreTaken) {
  add_with(Trait::addressing, Addressing::any);
  const auto request = encode_serial(Request{ModuleAddress{9}, Command::GAP, 1, 0, 0});
  const auto bytes = exchange(Bytes(request.begin(), request.end()));
  ASSERT_EQ(bytes.size(), 9U);
  EXPECT_EQ(bytes[1], 1) << "its own";
}

TEST_F(SimTraits, AnAnswerTakesAsLongAsWasMeasured) {
  ModuleSettings settings;
  settings.to_answer = 1500us;
  auto& module = bench.add(*find_model(1110), ModuleAddress{1}, settings);
  const auto request = encode_serial(Request{ModuleAddress{1}, Command::GAP, 1, 0, 0});
  EXPECT_TRUE(exchange(Bytes(request.begin(), request.end())).empty());
  pass(1499us);
  EXPECT_TRUE(heard().empty());
  pass(1us);
  EXPECT_EQ(heard().size(), serial_datagram_size);

  Bytes by_usb;
  UsbLine usb(
      bench, module, [&](auto bytes) { by_usb.assign(bytes.begin(), bytes.end()); }, 0);
  usb.receive(request);
  pass(1499us);
  EXPECT_TRUE(by_usb.empty());
  pass(1us);
  EXPECT_EQ(by_usb.size(), serial_datagram_size);
}

}  // namespace
}  // namespace tmcl::sim
