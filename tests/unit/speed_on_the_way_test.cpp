// What a motor does when the greatest speed of its positioning is changed on the way: the ramp
// generator of each family, and the simulated firmware above it.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <span>
#include <string>

#include "sim/module/module.hpp"
#include "support/no_events.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/parameter_number.hpp"
#include "tmcl/plan/axis_twin.hpp"

namespace tmcl {
namespace {

using plan::AxisTwin;
using plan::Setting;
using std::chrono::milliseconds;
namespace ap = axis_parameter;

constexpr std::int32_t target = 400'000;
// Trapezoids, without a second acceleration below a speed.
constexpr std::array<Setting, 4> sixpoint_ramp{
    {{number_of("velocity_v1"), 0},
     {ap::max_acceleration, 400'000},
     {number_of("max_deceleration"), 400'000},
     {number_of(Family::sixpoint, "start_velocity"), 0}}};
constexpr std::array<Setting, 3> tmc457_ramp{
    {{number_of("acceleration"), 24'000}, {number_of("max_deceleration"), 24'000}, {18, 0}}};
constexpr std::array<Setting, 3> tmc429_ramp{
    {{number_of("pulse_divisor"), 3}, {number_of("ramp_divisor"), 7}, {ap::max_acceleration, 400}}};

std::span<const Setting> ramp_of(Family family) {
  if (family == Family::tmc429) return tmc429_ramp;
  if (family == Family::tmc457) return tmc457_ramp;
  return sixpoint_ramp;
}

/// A motor that is told parameters and targets.
class Motor {
 public:
  explicit Motor(const Model& model) : twin_(*AxisTwin::of(model)) {}
  virtual ~Motor() = default;

  virtual void set(Setting setting) { ASSERT_TRUE(twin_.set(setting)); }
  virtual void go_to(std::int32_t position) { twin_.move_to({position}); }
  virtual void let_pass(Duration time) { twin_.advance(time); }
  virtual double position() { return twin_.motion().position.value; }
  /// In the unit of parameter 4.
  virtual double velocity() { return twin_.motion().velocity.value / unit(); }
  double unit() const { return twin_.to_pps({1}).value; }
  double acceleration_unit() const { return twin_.to_pps2({1}).value; }

 private:
  AxisTwin twin_;
};

class FirmwareMotor final : public Motor {
 public:
  explicit FirmwareMotor(const Model& model)
      : Motor(model), module_(model, ModuleAddress{1}, clock_) {}

  void set(Setting setting) override {
    Motor::set(setting);  // it knows the units
    ASSERT_EQ(tell(Command::SAP, setting.parameter, setting.value), Status::ok);
  }
  void go_to(std::int32_t position) override {
    ASSERT_EQ(tell(Command::MVP, 0, position), Status::ok);
  }
  void let_pass(Duration time) override {
    clock_.advance(time);
    module_.run_due();
  }
  double position() override { return *module_.axis(0).get(ap::actual_position); }
  double velocity() override { return *module_.axis(0).get(ap::actual_velocity); }

 private:
  Status tell(Command command, std::uint8_t type, std::int32_t value) {
    return module_
        .execute({ModuleAddress{1}, command, type, 0, value}, sim::Medium::serial, events_)
        .status;
  }

  VirtualClock clock_;
  tmcl::test::NoEvents events_;
  sim::Module module_;
};

struct Place {
  std::uint16_t model;
  bool firmware;
};

class SpeedOnTheWay : public testing::TestWithParam<Place> {
 protected:
  SpeedOnTheWay() {
    const auto& model = *find_model(GetParam().model);
    if (GetParam().firmware) {
      motor = std::make_unique<FirmwareMotor>(model);
    } else {
      motor = std::make_unique<Motor>(model);
    }
    for (const auto setting : ramp_of(model.family)) {
      motor->set(setting);
      const bool accelerates = setting.parameter == ap::max_acceleration ||
                               setting.parameter == number_of("max_deceleration");
      if (accelerates) acceleration = setting.value * motor->acceleration_unit() / motor->unit();
    }
    fast = static_cast<std::int32_t>(60'000 / motor->unit());
    slow = fast / 3;
    motor->set({ap::max_velocity, fast});
  }

  void cruise() {
    motor->go_to(target);
    motor->let_pass(milliseconds(1000));
    ASSERT_NEAR(motor->velocity(), fast, 1);
  }
  /// From one speed to another by the set acceleration, at once.
  void expect_ramp(double from, double to) {
    constexpr int looks = 5;
    const double time = std::abs(to - from) / acceleration;
    for (int look = 1; look <= looks; ++look) {
      motor->let_pass(
          std::chrono::duration_cast<Duration>(std::chrono::duration<double>(time / looks)));
      const double planned = from + (to - from) * look / looks;
      EXPECT_NEAR(motor->velocity(), planned, 0.02 * fast + 1) << look;
    }
    motor->let_pass(milliseconds(20));
    EXPECT_NEAR(motor->velocity(), to, 1);
  }
  void expect_arrival() {
    motor->let_pass(std::chrono::seconds(30));
    EXPECT_EQ(motor->velocity(), 0);
    EXPECT_EQ(motor->position(), target);
  }

  std::unique_ptr<Motor> motor;
  double acceleration = 0;  // of parameter 4's unit a second
  std::int32_t fast = 0;
  std::int32_t slow = 0;
};

TEST_P(SpeedOnTheWay, ALowerOneSlowsDownAtOnce) {
  cruise();
  motor->set({ap::max_velocity, slow});
  expect_ramp(fast, slow);
  expect_arrival();
}

TEST_P(SpeedOnTheWay, AGreaterOneSpeedsUpAtOnce) {
  motor->set({ap::max_velocity, slow});
  motor->go_to(target);
  motor->let_pass(milliseconds(1000));
  motor->set({ap::max_velocity, fast});
  expect_ramp(slow, fast);
  expect_arrival();
}

TEST_P(SpeedOnTheWay, ZeroStopsShortOfTheTargetAndAGreaterOneGoesOn) {
  cruise();
  motor->set({ap::max_velocity, 0});
  expect_ramp(fast, 0);
  const auto stands_at = motor->position();
  EXPECT_LT(stands_at, target);
  motor->let_pass(std::chrono::hours(1));
  EXPECT_EQ(motor->position(), stands_at);
  motor->set({ap::max_velocity, slow});
  expect_ramp(0, slow);
  expect_arrival();
}

TEST_P(SpeedOnTheWay, ATargetDoesNotSetOffAMotorWhoseSpeedIsZero) {
  motor->set({ap::max_velocity, 0});
  motor->go_to(target);
  motor->let_pass(std::chrono::seconds(1));
  EXPECT_EQ(motor->position(), 0);
  motor->set({ap::max_velocity, fast});
  expect_ramp(0, fast);
  expect_arrival();
}

// With the slowest there is, it goes on: that is no way to stand.
TEST_P(SpeedOnTheWay, TheSmallestIsAsSlowAsItSays) {
  cruise();
  motor->set({ap::max_velocity, 1});
  motor->let_pass(std::chrono::seconds(1));
  const auto begin = motor->position();
  motor->let_pass(std::chrono::seconds(10));
  EXPECT_NEAR(motor->position() - begin, 10 * motor->unit(), 1);
}

// It turns round by its ramps: as far beyond as braking takes, and back.
TEST_P(SpeedOnTheWay, ANewTargetBehindItTurnsItRound) {
  cruise();
  const auto turned_at = motor->position();
  motor->go_to(0);
  motor->let_pass(
      std::chrono::duration_cast<Duration>(std::chrono::duration<double>(fast / acceleration)));
  EXPECT_NEAR(motor->velocity(), 0, 0.02 * fast + 1);
  EXPECT_NEAR(motor->position() - turned_at, fast * motor->unit() * fast / acceleration / 2, 2000);
  motor->let_pass(milliseconds(400));
  EXPECT_NEAR(motor->velocity(), -fast, 1);
  motor->let_pass(std::chrono::seconds(30));
  EXPECT_EQ(motor->position(), 0);
}

INSTANTIATE_TEST_SUITE_P(Families, SpeedOnTheWay,
                         testing::Values(Place{3110, false}, Place{142, false}, Place{6212, false},
                                         Place{3110, true}, Place{142, true}, Place{6212, true}),
                         [](const auto& place) {
                           const auto family = find_model(place.param.model)->family;
                           const std::string name = family == Family::tmc429   ? "Tmc429"
                                                    : family == Family::tmc457 ? "Tmc457"
                                                                               : "SixPoint";
                           return name + (place.param.firmware ? "Firmware" : "Generator");
                         });

}  // namespace
}  // namespace tmcl
