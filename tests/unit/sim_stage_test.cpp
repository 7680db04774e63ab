// The mechanics that a simulated motor drives, alone.
#include "sim/stage/stage.hpp"

#include <gtest/gtest.h>

#include "support/random.hpp"
#include "support/seed.hpp"

namespace tmcl::sim {
namespace {

TEST(Stage, IsBareUntilSomethingIsBoltedOn) {
  EXPECT_TRUE(Stage().is_bare());
  EXPECT_TRUE(Stage({.load = 300}).is_bare());
  EXPECT_FALSE(Stage({.left_switch = 0}).is_bare());
  EXPECT_FALSE(Stage({.encoder = EncoderSettings{}}).is_bare());
}

TEST(Stage, SwitchesCloseAtTheirPlaces) {
  Stage stage({.left_switch = -100, .right_switch = 100, .home = Interval{10, 20}});
  EXPECT_EQ(stage.inputs(), StageInputs{});
  stage.move(10);
  EXPECT_EQ(stage.inputs(), (StageInputs{.home = true}));
  stage.move(11);
  EXPECT_EQ(stage.inputs(), StageInputs{});
  stage.move(79);
  EXPECT_EQ(stage.inputs(), (StageInputs{.right = true}));
  stage.move(-200);
  EXPECT_EQ(stage.inputs(), (StageInputs{.left = true}));
}

TEST(Stage, AClosedSwitchOpensLater) {
  Stage stage({.position = 1, .left_switch = 0, .switch_tolerance = 5});
  EXPECT_FALSE(stage.inputs().left);
  stage.move(-1);
  EXPECT_TRUE(stage.inputs().left);
  stage.move(5);
  EXPECT_TRUE(stage.inputs().left);
  stage.move(1);
  EXPECT_FALSE(stage.inputs().left);
  stage.move(-5);
  EXPECT_FALSE(stage.inputs().left);
}

TEST(Stage, NormallyClosedSwitchesReadTheOtherWayRound) {
  const Stage stage(
      {.left_switch = 0, .limits_normally_closed = true, .home_normally_closed = true});
  EXPECT_EQ(stage.inputs(), (StageInputs{.left = false, .right = true, .home = true}));
}

TEST(Stage, AFingerHoldsASwitchThatIsNotThere) {
  Stage stage;
  stage.press(StageSwitch::right, true);
  EXPECT_EQ(stage.inputs(), (StageInputs{.right = true}));
  stage.press(StageSwitch::right, false);
  EXPECT_EQ(stage.inputs(), StageInputs{});
}

TEST(Stage, StopsAtItsEnds) {
  Stage stage({.left_stop = -50, .right_stop = 50});
  stage.move(40);
  EXPECT_FALSE(stage.holds(1));
  stage.move(40);
  EXPECT_EQ(stage.position(), 50);
  EXPECT_TRUE(stage.holds(1));
  EXPECT_FALSE(stage.holds(-1));
  stage.move(-20);
  EXPECT_EQ(stage.position(), 30);
}

TEST(Stage, AnOverloadHoldsItBothWays) {
  Stage stage;
  stage.set_load(1000);
  EXPECT_TRUE(stage.holds(1));
  EXPECT_TRUE(stage.holds(-1));
  stage.move(77);
  EXPECT_EQ(stage.position(), 0);
  stage.set_load(999);
  stage.move(77);
  EXPECT_EQ(stage.position(), 77);
}

TEST(Stage, TheEncoderCountsTheWay) {
  Stage stage({.encoder = EncoderSettings{1024, false}});
  stage.move(51'200);
  EXPECT_EQ(stage.encoder_counts(), 1024);
  stage.move(-51'201);
  EXPECT_EQ(stage.encoder_counts(), -1);
  EXPECT_EQ(stage.encoder_angle(), 1023);
  stage.slip(101);
  EXPECT_EQ(stage.encoder_counts(), 100);
}

TEST(Stage, AnEncoderMountedBackwardsCountsDown) {
  Stage stage({.encoder = EncoderSettings{1000, true}});
  stage.move(51'200 * 3);
  EXPECT_EQ(stage.encoder_counts(), -3000);
}

// Nothing changes within the reach, and something does right behind it.
TEST(Stage, ItsReachEndsWhereSomethingChanges) {
  test::Random<> random(test::seed());
  for (int round = 0; round < 3000; ++round) {
    const auto place = [&] { return random.between(-300, 300); };
    const auto home = place();
    StageSettings settings{
        .position = place(),
        .left_switch = place(),
        .right_switch = place(),
        .home = Interval{home, home + random.any_size(50)},
        .switch_tolerance = random.any_size(20),
        .encoder = EncoderSettings{1 + static_cast<std::int32_t>(random.any_size(60'000)),
                                   random.one_in(2)}};
    Stage stage(settings);
    for (int i = 0; i < 3; ++i) stage.move(place());
    const auto inputs_after = [&](Place way) {
      auto copy = stage;
      copy.move(way);
      return copy.inputs();
    };
    const auto counts_after = [&](Place way) {
      auto copy = stage;
      copy.move(way);
      return copy.encoder_counts();
    };
    const auto reach = stage.reach();
    if (reach.ahead < 1000) {
      EXPECT_EQ(inputs_after(reach.ahead), stage.inputs());
      EXPECT_NE(inputs_after(reach.ahead + 1), stage.inputs());
    }
    if (reach.back < 1000) {
      EXPECT_EQ(inputs_after(-reach.back), stage.inputs());
      EXPECT_NE(inputs_after(-reach.back - 1), stage.inputs());
    }
    const auto counting = stage.encoder_reach();
    EXPECT_EQ(counts_after(counting.ahead), stage.encoder_counts());
    EXPECT_NE(counts_after(counting.ahead + 1), stage.encoder_counts());
    EXPECT_EQ(counts_after(-counting.back), stage.encoder_counts());
    EXPECT_NE(counts_after(-counting.back - 1), stage.encoder_counts());
    ASSERT_FALSE(HasFailure());
  }
}

// Whoever looks between, or only then, sees the same.
TEST(StageReach, EndsWhereAnEndHoldsTheMotor) {
  StageSettings settings;
  settings.left_stop = -100;
  settings.right_stop = 100;
  Stage stage(settings);
  for (const auto direction : {1, -1}) {
    const auto way = direction > 0 ? stage.reach().ahead : stage.reach().back;
    stage.move(direction * way);
    EXPECT_FALSE(stage.holds(direction)) << direction;
    stage.move(direction);
    EXPECT_TRUE(stage.holds(direction)) << direction;
  }
}

}  // namespace
}  // namespace tmcl::sim
