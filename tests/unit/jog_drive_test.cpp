// Jogs on an axis that is played, in virtual time: whatever fails, nothing goes on moving and its
// speed is as it was.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tmcl/plan/jog_drive.hpp"
#include "unit/drive_scene.hpp"

namespace tmcl::plan {
namespace {

using namespace test;
using testing::IsEmpty;
using testing::SizeIs;

constexpr std::int32_t jog_velocity = 400;

/// Moves in the unit of a TMC429, where a velocity and an acceleration of 1 are 1 a second.
JogAxis played_axis() {
  JogAxis axis;
  axis.model = find_model("TMCM-3110");
  axis.ramp = {{ap::max_velocity, own_velocity}, {ap::max_acceleration, own_acceleration}};
  axis.range = {-100'000, 100'000};
  return axis;
}

// ---- where it is sent ----

TEST(JogTarget, IsAsFarAsItGoesInItsHoldAndOnItsBrakes) {
  const JogWish wish{{jog_velocity}, milliseconds(500)};
  const auto braking = jog_velocity * jog_velocity / (2 * own_acceleration);
  EXPECT_EQ(jog_target(played_axis(), {1000}, {}, wish).value, 1000 + 200 + braking);
  const JogWish back{{-jog_velocity}, milliseconds(500)};
  EXPECT_EQ(jog_target(played_axis(), {1000}, {}, back).value, 1000 - 200 - braking);
}

TEST(JogTarget, OfATwinCountsTheRamp) {
  auto axis = played_axis();
  axis.model = find_model("TMCM-6212");
  axis.ramp = {{ap::max_velocity, 10'000}, {ap::max_acceleration, 20'000}, {17, 10'000}};
  axis.twin = AxisTwin::of(*axis.model);
  ASSERT_TRUE(axis.twin && axis.twin->set(axis.ramp));
  const JogWish wish{{10'000}, seconds(1)};
  // Half a second to speed up, half a second at it, and a second to brake.
  EXPECT_NEAR(jog_target(axis, {}, {}, wish).value, 2500 + 5000 + 5000, 100);
  EXPECT_NEAR(jog_target(axis, {}, {10'000}, wish).value, 10'000 + 5000, 100);
  EXPECT_NEAR(jog_target(axis, {}, {10'000}, {{10'000}, milliseconds(100)}).value, 1000 + 5000,
              100);
}

TEST(JogTarget, CountsTheSlowStageOfARamp) {
  auto axis = played_axis();
  axis.model = find_model("TMCM-6212");
  axis.ramp = {{ap::max_velocity, 10'000},
               {ap::max_acceleration, 10'000},
               {17, 10'000},
               {16, 5000},
               {18, 5000}};
  const JogWish wish{{10'000}, milliseconds(100)};
  EXPECT_EQ(jog_target(axis, {}, {10'000}, wish).value, 1000 + 3750 + 2500);
}

TEST(JogTarget, IsWhereItStandsFirstIfItGoesTheOtherWay) {
  auto axis = played_axis();
  axis.model = find_model("TMCM-6212");
  axis.ramp = {{ap::max_velocity, 10'000}, {ap::max_acceleration, 10'000}, {17, 10'000}};
  axis.twin = AxisTwin::of(*axis.model);
  ASSERT_TRUE(axis.twin && axis.twin->set(axis.ramp));
  const auto target = jog_target(axis, {}, {10'000}, {{-10'000}, milliseconds(100)});
  EXPECT_NEAR(target.value, 5000, 200) << "it cannot turn round in that time";
}

TEST(JogTarget, IsWithinItsRange) {
  auto axis = played_axis();
  axis.range = {-50, 1100};
  EXPECT_EQ(jog_target(axis, {1000}, {}, {{jog_velocity}, seconds(1)}).value, 1100);
  EXPECT_EQ(jog_target(axis, {0}, {}, {{-jog_velocity}, seconds(1)}).value, -50);
  EXPECT_EQ(jog_target(axis, {2000}, {}, {{jog_velocity}, seconds(1)}).value, 2000)
      << "beyond it, it is not sent back by a wish to go further";
  EXPECT_EQ(jog_target(axis, {2000}, {}, {{-jog_velocity}, milliseconds(100)}).value, 1100);
}

// ---- the way ----

class JogScene : public DriveScene {
 public:
  JogScene() : DriveScene(1) {
    drive.know(played_axis());
    wish(jog_velocity);
  }

  void wish(std::int32_t velocity, Duration hold = milliseconds(200)) {
    const auto number = drive.wish({{velocity}, hold});
    ASSERT_TRUE(number && *number);
    last_wish = **number;
  }
  void run() { DriveScene::run(drive); }
  std::int32_t velocity_set() { return axes[0].settings[ap::max_velocity]; }
  void expect_rest() {
    EXPECT_TRUE(all_rest());
    const auto& report = drive.report();
    if (report.unrestored.empty()) {
      EXPECT_EQ(velocity_set(), own_velocity);
    }
  }

  JogDrive drive;
  std::uint64_t last_wish = 0;
};

TEST(JogDrive, EndsAtItsTargetAndGivesTheSpeedBack) {
  JogScene scene;
  scene.run();
  scene.expect_rest();
  EXPECT_FALSE(scene.drive.report().fault);
  EXPECT_EQ(scene.drive.done(), scene.last_wish);
  EXPECT_EQ(scene.axes[0].position(scene.now()), scene.drive.goal().target.value);
  EXPECT_THAT(scene.commands(Kind::stop), IsEmpty()) << "its module ends it";
  const auto sets = scene.commands(Kind::set);
  ASSERT_THAT(sets, SizeIs(2));
  EXPECT_EQ(sets[0].value, jog_velocity);
  EXPECT_EQ(sets[0].before, own_velocity) << "the journal is told";
  EXPECT_EQ(sets[1].value, own_velocity);
}

TEST(JogDrive, GoesOnWithEachWish) {
  JogScene scene;
  auto next = scene.now() + milliseconds(100);
  int wishes = 0;
  std::vector<std::int32_t> targets;
  scene.every_step = [&] {
    if (scene.now() < next || wishes == 20) return;
    next = scene.now() + milliseconds(100);
    ++wishes;
    scene.wish(jog_velocity);
  };
  scene.run();
  scene.expect_rest();
  EXPECT_THAT(scene.commands(Kind::move_to), SizeIs(testing::Ge(10)));
  EXPECT_THAT(scene.commands(Kind::set), SizeIs(2)) << "its speed is set once";
}

TEST(JogDrive, StopsAtAVelocityOfNothing) {
  JogScene scene;
  scene.every_step = [&] {
    if (scene.now() > TimePoint(milliseconds(1100)) && scene.last_wish == 1) scene.wish(0);
  };
  scene.run();
  scene.expect_rest();
  EXPECT_THAT(scene.commands(Kind::stop), SizeIs(1));
  EXPECT_EQ(scene.drive.done(), 2U);
  EXPECT_FALSE(scene.drive.report().fault);
  const auto late = scene.drive.wish({{jog_velocity}, seconds(1)});
  ASSERT_TRUE(late);
  EXPECT_FALSE(*late) << "it takes none any more";
}

TEST(JogDrive, RefusesWhatIsFasterThanTheAxis) {
  JogScene scene;
  const auto fast = scene.drive.wish({{-own_velocity - 1}, seconds(1)});
  ASSERT_FALSE(fast);
  EXPECT_EQ(fast.error().code, Errc::bad_argument);
  scene.run();
  EXPECT_FALSE(scene.drive.report().fault) << "the wish before holds";
}

TEST(JogDrive, MovesNothingIfTheFirstWishIsTooFast) {
  DriveScene scene(1);
  JogDrive drive;
  ASSERT_TRUE(drive.wish({{own_velocity + 1}, seconds(1)}));
  drive.know(played_axis());
  scene.run(drive);
  ASSERT_TRUE(drive.report().fault);
  EXPECT_EQ(drive.report().fault->kind, FaultKind::unsuited);
  EXPECT_THAT(scene.commands(), IsEmpty());
}

TEST(JogDrive, EndsWhenItIsToStop) {
  JogScene scene;
  scene.every_step = [&] {
    if (scene.now() > TimePoint(milliseconds(1100))) scene.drive.stop();
  };
  scene.run();
  scene.expect_rest();
  EXPECT_THAT(scene.commands(Kind::stop), SizeIs(1));
  EXPECT_EQ(scene.drive.report().fault->kind, FaultKind::asked);
}

TEST(JogDrive, WhicheverCommandFailsItStandsAndHasItsSpeedBack) {
  JogScene good;
  good.run();
  for (std::size_t failing = 0; failing < good.commands().size(); ++failing) {
    SCOPED_TRACE(failing);
    JogScene scene;
    scene.instead = [&](const auto&, std::size_t index) {
      return index == failing
                 ? std::optional<Result<std::int32_t>>(tl::unexpected(error_with("no answer")))
                 : std::nullopt;
    };
    scene.run();
    scene.expect_rest();
    EXPECT_TRUE(scene.drive.report().fault || !scene.drive.report().unrestored.empty());
  }
}

TEST(JogDrive, SaysThatItsAxisStandsShort) {
  JogScene scene;
  scene.axes[0].stands_short = true;
  scene.run();
  ASSERT_TRUE(scene.drive.report().fault);
  EXPECT_EQ(scene.drive.report().fault->kind, FaultKind::no_end);
  scene.expect_rest();
}

}  // namespace
}  // namespace tmcl::plan
