// What a module notices of what its motor drives: the encoder, the load, and how long it stands.
#include <gmock/gmock.h>

#include "sim_fixture.hpp"

namespace tmcl::sim {
namespace {

namespace ap = axis_parameter;
using std::chrono::seconds;

constexpr std::uint8_t stall_threshold = 174;
constexpr std::uint8_t current = 180;
constexpr std::uint8_t stop_on_stall = 181;
constexpr std::uint8_t load_value = 206;
constexpr std::uint8_t error_flags = 207;
constexpr std::uint8_t driver_flags = 208;
constexpr std::uint8_t encoder_position = 209;
constexpr std::uint8_t encoder_prescaler = 210;
constexpr std::uint8_t max_deviation = 212;
constexpr std::uint8_t power_down_delay = 214;
constexpr std::uint8_t freewheeling_delay = 204;
constexpr std::int32_t stall_error = 1;
constexpr std::int32_t deviation_error = 2;

class SimWatch : public SimStageTest {
 protected:
  // Asks for nothing, so that asking cannot be what makes something happen.
  std::int32_t look(std::uint8_t parameter) {
    return bench.modules().front()->axis(0).get(parameter).value_or(INT32_MIN);
  }
};

// ---- The encoder

TEST_F(SimWatch, TheEncoderFollowsTheMotor) {
  add(3110, {.encoder = EncoderSettings{1024, false}});
  ask(Command::MVP, 0, 0, 51'200);
  pass(seconds(5));
  EXPECT_EQ(get(encoder_position), 51'200);
  set(encoder_prescaler, 512);
  EXPECT_EQ(get(encoder_position), 1024);
  set(encoder_prescaler, 25'600);
  EXPECT_EQ(get(encoder_position), 51'200);
  set(encoder_position, -7);
  EXPECT_EQ(get(encoder_position), -7);
}

TEST_F(SimWatch, ASlippingEncoderStopsTheMotor) {
  add(3110, {.encoder = EncoderSettings{1024, false}});
  set(max_deviation, 1000);
  ask(Command::ROR, 0, 0, 500);
  pass(seconds(1));
  EXPECT_EQ(get(error_flags), 0);
  EXPECT_NE(get(ap::actual_velocity), 0);
  at_stage([](Stage& stage) { stage.slip(-200); });
  EXPECT_EQ(get(ap::actual_velocity), 0);
  pass(seconds(1));
  EXPECT_EQ(get(ap::actual_velocity), 0);
  EXPECT_EQ(get(error_flags), deviation_error);
  EXPECT_EQ(get(error_flags), 0);
}

TEST_F(SimWatch, StopsTheVeryMicrostepThatDeviates) {
  add(3110, {.right_stop = 20'000, .encoder = EncoderSettings{51'200, false}});
  set(max_deviation, 300);
  ask(Command::MVP, 0, 0, 100'000);
  pass(seconds(10));
  EXPECT_EQ(look(error_flags), deviation_error);
  EXPECT_EQ(get(ap::actual_position), 20'301);
  EXPECT_EQ(get(encoder_position), 20'000);
}

TEST_F(SimWatch, AnEncoderThatCountsTooLittleDeviatesInTheEnd) {
  add(3110, {.encoder = EncoderSettings{51'200, false}});
  set(encoder_prescaler, 500);
  set(max_deviation, 100);
  ask(Command::MVP, 0, 0, 100'000);
  pass(seconds(10));
  EXPECT_EQ(get(error_flags), deviation_error);
  EXPECT_NEAR(get(ap::actual_position), 100 * 512 / 12, 100);
  EXPECT_EQ(get(ap::actual_position) - get(encoder_position), 101);
}

TEST_F(SimWatch, WithoutAnEncoderAWatchedMotorGoesNoFurtherThanThat) {
  add(3110);
  set(max_deviation, 500);
  ask(Command::ROL, 0, 0, 500);
  pass(seconds(2));
  EXPECT_EQ(get(ap::actual_position), -501);
  EXPECT_EQ(get(error_flags), deviation_error);
}

TEST_F(SimWatch, ACoarseEncoderIsNoDeviation) {
  add(3110, {.encoder = EncoderSettings{100, false}});
  set(max_deviation, 600);
  ask(Command::MVP, 0, 0, 500'000);
  pass(seconds(20));
  EXPECT_EQ(get(ap::actual_position), 500'000);
  EXPECT_EQ(get(error_flags), 0);
}

TEST_F(SimWatch, AnEncoderIsBuiltIntoSomeModules) {
  add(1140);
  ask(Command::MVP, 0, 0, 12'800);
  pass(seconds(5));
  EXPECT_EQ(get(encoder_position), 12'800);
  EXPECT_EQ(get(215), 256);
  set(encoder_prescaler, 51'200);
  EXPECT_EQ(get(encoder_position), 25'600);
}

TEST_F(SimWatch, AResolutionScalesTheEncoder) {
  add(1276, {.encoder = EncoderSettings{4000, false}});
  ask(Command::MVP, 0, 0, 51'200);
  pass(seconds(20));
  EXPECT_EQ(get(encoder_position), 51'200);
  set(encoder_prescaler, 4000);
  EXPECT_EQ(get(encoder_position), 51'200);
  set(encoder_prescaler, -8000);
  EXPECT_EQ(get(encoder_position), -25'600);
}

// ---- The load

TEST_F(SimWatch, TheLoadValueFallsWithTheLoad) {
  add(1110);
  EXPECT_EQ(get(load_value), 0);
  EXPECT_EQ(get(driver_flags), 0x80);
  ask(Command::ROR, 0, 0, 500);
  pass(seconds(1));
  EXPECT_EQ(get(load_value), 500);
  EXPECT_EQ(get(driver_flags), 0);
  load(300);
  EXPECT_EQ(get(load_value), 200);
  load(600);
  EXPECT_EQ(get(load_value), 0);
  EXPECT_EQ(get(driver_flags), 1);
  set(stall_threshold, 20);
  EXPECT_EQ(get(load_value), 60);
  EXPECT_NE(get(ap::actual_velocity), 0);
}

TEST_F(SimWatch, AStallStopsTheMotorIfItIsToldTo) {
  add(1110);
  set(stop_on_stall, 100);
  ask(Command::ROR, 0, 0, 500);
  pass(seconds(1));
  EXPECT_EQ(bench.next_due(), never);
  load(700);
  pass(milliseconds(10));
  EXPECT_EQ(get(ap::actual_velocity), 0);
  EXPECT_EQ(get(error_flags), stall_error);
  EXPECT_EQ(get(error_flags), 0);
  pass(seconds(1));
  EXPECT_EQ(bench.next_due(), never);
  load(0);
  ask(Command::ROR, 0, 0, 500);
  pass(seconds(1));
  EXPECT_NE(get(ap::actual_velocity), 0);
}

TEST_F(SimWatch, AStallBelowTheSpeedIsIgnored) {
  add(1110);
  set(stop_on_stall, 600);
  load(700);
  ask(Command::ROR, 0, 0, 500);
  pass(seconds(1));
  EXPECT_EQ(get(ap::actual_velocity), 500);
  EXPECT_EQ(get(error_flags), 0);
}

TEST_F(SimWatch, AMechanicalEndIsAStall) {
  auto& module = add(1110, {.left_stop = -10'000});
  set(stop_on_stall, 1);
  ask(Command::ROL, 0, 0, 300);
  pass(seconds(3));
  EXPECT_EQ(get(error_flags), stall_error);
  EXPECT_EQ(module.stage(0).position(), -10'000);
  EXPECT_LT(get(ap::actual_position), -10'000);
  EXPECT_GT(get(ap::actual_position), -11'000);
}

TEST_F(SimWatch, ALoadThatGrowsWithTheSpeedStallsAtItsSpeed) {
  add(1110, {.load_per_velocity = 1500});
  set(stop_on_stall, 1);
  ask(Command::ROR, 0, 0, 1000);
  pass(seconds(1));
  EXPECT_EQ(get(ap::actual_velocity), 1000);
  ask(Command::ROR, 0, 0, 2000);
  pass(seconds(1));
  EXPECT_EQ(get(ap::actual_velocity), 0);
  EXPECT_EQ(get(error_flags), stall_error);
}

// ---- The current

TEST_F(SimWatch, TheCurrentFallsWhenTheMotorHasStoodForLong) {
  add(1110);
  set(6, 248);
  set(7, 64);
  set(power_down_delay, 100);
  ask(Command::MVP, 0, 0, 5'000);
  pass(milliseconds(50));
  EXPECT_EQ(get(current), 31);
  pass(milliseconds(900));
  EXPECT_EQ(get(ap::position_reached), 1);
  EXPECT_EQ(get(current), 31);
  pass(seconds(1));
  EXPECT_EQ(get(current), 8);
  EXPECT_EQ(bench.next_due(), never);
  set(freewheeling_delay, 300);
  EXPECT_EQ(get(current), 8);
  pass(seconds(2));
  EXPECT_EQ(get(current), 0);
  ask(Command::ROR, 0, 0, 10);
  pass(milliseconds(100));
  EXPECT_EQ(get(current), 31);
}

TEST_F(SimWatch, AnEndSwitchTurnsTheCurrentOffIfItIsToldTo) {
  add(1110, {.right_switch = 1'000});
  set(150, 1);
  ask(Command::ROR, 0, 0, 200);
  pass(seconds(1));
  EXPECT_EQ(get(current), 0);
  ask(Command::ROL, 0, 0, 200);
  pass(milliseconds(100));
  EXPECT_EQ(get(current), 31);
}

}  // namespace
}  // namespace tmcl::sim
