// What a motor has to drive its stage with, and what becomes of one that has too little.
#include "sim/stage/motor_load.hpp"

#include <gtest/gtest.h>

namespace tmcl::sim {
namespace {

constexpr std::int32_t half_current = full_current / 2;

TEST(MotorLoad, AsksForTheLoadWhateverTheSpeed) {
  const StageSettings stage{.load = 300};
  EXPECT_EQ(torque_demanded(stage, {.speed = 0}), 300);
  EXPECT_EQ(torque_demanded(stage, {.speed = 5000, .acceleration = 90'000}), 300);
}

TEST(MotorLoad, AsksForMoreTheFasterItTurns) {
  const StageSettings stage{.load = 100, .load_per_velocity = 50};
  EXPECT_EQ(torque_demanded(stage, {.speed = 0}), 100);
  EXPECT_EQ(torque_demanded(stage, {.speed = 2000}), 200);
}

TEST(MotorLoad, AnInertiaAsksForTorqueToSpeedUpAndGivesItBack) {
  const StageSettings stage{.load = 100, .inertia = 4000};
  EXPECT_EQ(torque_demanded(stage, {.speed = 500, .acceleration = 50'000}), 300);
  EXPECT_EQ(torque_demanded(stage, {.speed = 500, .acceleration = -10'000}), 60);
  EXPECT_EQ(torque_demanded(stage, {.speed = 500, .acceleration = -50'000}), 100)
      << "it has to brake";
}

TEST(MotorLoad, APullAsksForTorqueOneWayAndGivesItTheOther) {
  const StageSettings stage{.load = 100, .pull = 250};
  EXPECT_EQ(torque_demanded(stage, {.speed = 10, .direction = 1}), 350);
  EXPECT_EQ(torque_demanded(stage, {.speed = 10, .direction = -1}), 150) << "it has to brake";
  EXPECT_EQ(torque_demanded_at_rest(stage), 150);
  EXPECT_EQ(torque_demanded_at_rest({.load = 100, .pull = -250}), 150);
  EXPECT_EQ(torque_demanded_at_rest({.load = 300, .pull = 250}), 0) << "friction holds it";
}

TEST(MotorLoad, HasAllItsTorqueUnlessToldOtherwise) {
  EXPECT_EQ(torque_available({}, {}), full_torque);
  EXPECT_EQ(torque_available({}, {.speed = 1'000'000, .current = 1, .supply = 120}), full_torque);
}

TEST(MotorLoad, TorqueFollowsTheCurrentIfToldTo) {
  const StageSettings stage{.torque_follows_current = true};
  EXPECT_EQ(torque_available(stage, {}), 1000);
  EXPECT_EQ(torque_available(stage, {.current = half_current}), 500);
}

TEST(MotorLoad, TorqueFallsAboveTheCornerSpeed) {
  const StageSettings stage{.corner_speed = 600};
  EXPECT_EQ(torque_available(stage, {.speed = 0}), 1000);
  EXPECT_EQ(torque_available(stage, {.speed = 600}), 1000);
  EXPECT_EQ(torque_available(stage, {.speed = 1200}), 500);
  EXPECT_EQ(torque_available(stage, {.speed = 6000}), 100);
}

TEST(MotorLoad, TheCornerMovesWithTheSupply) {
  const StageSettings stage{.corner_speed = 600};
  EXPECT_EQ(torque_available(stage, {.speed = 600, .supply = 120}), 500);
  EXPECT_EQ(torque_available(stage, {.speed = 1200, .supply = 480}), 1000);
}

// The supply drives no more than that through the coils, so a greater current is of no use.
TEST(MotorLoad, FarAboveTheCornerTheCurrentDoesNotMatter) {
  const StageSettings stage{.corner_speed = 600, .torque_follows_current = true};
  EXPECT_EQ(torque_available(stage, {.speed = 600, .current = half_current}), 500);
  EXPECT_EQ(torque_available(stage, {.speed = 1200, .current = half_current}), 500);
  EXPECT_EQ(torque_available(stage, {.speed = 2400, .current = half_current}), 250);
  EXPECT_EQ(torque_available(stage, {.speed = 2400}), 250);
}

TEST(MotorLoad, ADriverThatIsOffHasNone) {
  EXPECT_EQ(torque_available({}, {.is_on = false}), 0);
  EXPECT_GE(relative_load({}, {.is_on = false}), full_torque);
}

TEST(MotorLoad, TheRelativeLoadIsThatOfTheTorqueThereIs) {
  EXPECT_EQ(relative_load({.load = 300}, {}), 300);
  const StageSettings stage{.load = 300, .torque_follows_current = true};
  EXPECT_EQ(relative_load(stage, {.current = half_current}), 600);
}

TEST(MotorLoad, OnlyTheSpeedIsWatchedThatMatters) {
  EXPECT_FALSE(changes_with_speed({.load = 500, .pull_in_speed = 10}));
  EXPECT_TRUE(changes_with_speed({.load_per_velocity = 1}));
  EXPECT_TRUE(changes_with_speed({.pull = 1}));
  EXPECT_TRUE(changes_with_speed({.inertia = 1}));
  EXPECT_TRUE(changes_with_speed({.corner_speed = 1}));
  EXPECT_TRUE(changes_with_speed({.torque_follows_current = true}));
}

// ---- The rotor

struct Driven {
  StageSettings stage;
  Rotor rotor{};
  bool slips_at(const MotorState& motor, bool driven = true) {
    rotor.look(stage, motor, driven);
    return rotor.slips();
  }
};

TEST(Rotor, SlipsWhereItIsAskedForAsMuchAsThereIs) {
  Driven motor{{.load = 499, .corner_speed = 600}};
  EXPECT_FALSE(motor.slips_at({.speed = 1200}));
  motor.stage.load = 500;
  EXPECT_TRUE(motor.slips_at({.speed = 1200}));
}

TEST(Rotor, CatchesOnWhenItHasEnough) {
  Driven motor{{.load = 500, .corner_speed = 600}};
  EXPECT_TRUE(motor.slips_at({.speed = 1200}));
  EXPECT_FALSE(motor.slips_at({.speed = 1190}));
}

TEST(Rotor, CatchesOnOnlyBelowThePullInSpeed) {
  Driven motor{{.load = 500, .corner_speed = 600, .pull_in_speed = 200}};
  EXPECT_TRUE(motor.slips_at({.speed = 1200}));
  EXPECT_TRUE(motor.slips_at({.speed = 201}));
  EXPECT_FALSE(motor.slips_at({.speed = 200}));
  EXPECT_FALSE(motor.slips_at({.speed = 1000})) << "it was not lost again";
}

TEST(Rotor, CatchesOnAtRest) {
  Driven motor{{.load = 2000, .pull_in_speed = 0}};
  EXPECT_TRUE(motor.slips_at({.speed = 100}));
  EXPECT_FALSE(motor.slips_at({.speed = 0}, false));
  EXPECT_TRUE(motor.slips_at({.speed = 0}, true));
}

TEST(Rotor, IsPulledAlongAtRestByMoreThanItHas) {
  Driven motor{{.load = 100, .pull = 600, .torque_follows_current = true}};
  EXPECT_FALSE(motor.slips_at({.speed = 0}, false));
  EXPECT_TRUE(motor.slips_at({.speed = 0, .current = half_current}, false));
}

TEST(Rotor, IsLooseWithoutACurrent) {
  Driven motor{{}};
  EXPECT_TRUE(motor.slips_at({.speed = 0, .is_on = false}, false));
  EXPECT_FALSE(motor.slips_at({.speed = 0}, false));
}

}  // namespace
}  // namespace tmcl::sim
