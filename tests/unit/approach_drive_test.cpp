// Moves that come to their target from one side, on an axis that is played, in virtual time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/random.hpp"
#include "support/seed.hpp"
#include "tmcl/plan/approach_drive.hpp"
#include "unit/drive_scene.hpp"

namespace tmcl::plan {
namespace {

using namespace test;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

constexpr Approach from_below{true, 50, {-1000, 1000}};

TEST(FirstStop, IsBeyondATargetThatItWouldComeToFromTheWrongSide) {
  const Approach from_above{false, 50, {-1000, 1000}};
  const auto stop = [](const auto& how, std::int32_t position, std::int32_t velocity,
                       std::int32_t target) {
    return first_stop(how, {position}, InternalVelocity{velocity}, {target}).value;
  };
  EXPECT_EQ(stop(from_below, 0, 0, 100), 100);
  EXPECT_EQ(stop(from_below, 200, 0, 100), 50);
  EXPECT_EQ(stop(from_below, 100, 0, 100), 100) << "it stands there";
  EXPECT_EQ(stop(from_below, 0, 7, 100), 50) << "it may be too fast to stop there";
  EXPECT_EQ(stop(from_below, 0, 0, -980), -1000) << "as far as it may go";
  EXPECT_EQ(stop(from_above, 0, 0, 100), 150);
  EXPECT_EQ(stop(from_above, 200, 0, 100), 100);
  EXPECT_EQ(stop(from_above, 0, 0, 980), 1000);
}

class ApproachScene : public DriveScene {
 public:
  ApproachScene() : DriveScene(1) { wish(-400); }
  void wish(std::int32_t target) { last_wish = drive.wish({target}).value_or(0); }
  void run() { DriveScene::run(drive); }
  std::vector<std::int32_t> targets() const {
    std::vector<std::int32_t> all;
    for (const auto& command : commands(Kind::move_to)) all.push_back(command.value);
    return all;
  }

  ApproachDrive drive{from_below};
  std::uint64_t last_wish = 0;
};

TEST(ApproachDrive, EndsAtItsTarget) {
  ApproachScene scene;
  scene.run();
  EXPECT_FALSE(scene.drive.report().fault);
  EXPECT_THAT(scene.targets(), ElementsAre(-450, -400));
  EXPECT_EQ(scene.axes[0].position(scene.now()), -400);
  EXPECT_EQ(scene.drive.done(), scene.last_wish);
  EXPECT_THAT(scene.commands(Kind::stop), IsEmpty());
  EXPECT_FALSE(scene.drive.wish({7})) << "it takes none any more";
}

TEST(ApproachDrive, TheLastWishCounts) {
  ApproachScene scene;
  scene.every_step = [&] {
    if (scene.now() > TimePoint(milliseconds(1100)) && scene.last_wish == 1) scene.wish(500);
  };
  scene.run();
  EXPECT_FALSE(scene.drive.report().fault);
  EXPECT_THAT(scene.targets(), ElementsAre(-450, 450, 500));
  EXPECT_EQ(scene.drive.done(), 2U);
}

TEST(ApproachDrive, StopsWhereverItIsToStop) {
  ApproachScene good;
  good.run();
  for (auto at = TimePoint(seconds(1)); at < good.now(); at += milliseconds(7)) {
    ApproachScene scene;
    scene.every_step = [&] {
      if (scene.now() >= at) scene.drive.stop();
    };
    scene.run();
    EXPECT_TRUE(scene.all_rest());
    ASSERT_TRUE(scene.drive.report().fault);
    EXPECT_EQ(scene.drive.report().fault->kind, FaultKind::asked);
    const auto& commands = scene.commands();
    const auto is_stop = [](const auto& one) { return one.kind == Kind::stop; };
    const auto stop = std::ranges::find_if(commands, is_stop);
    EXPECT_TRUE(std::none_of(stop, commands.end(), starts));
  }
}

TEST(ApproachDrive, WhicheverCommandFailsItStands) {
  ApproachScene good;
  good.run();
  for (std::size_t failing = 0; failing < good.commands().size(); ++failing) {
    SCOPED_TRACE(failing);
    ApproachScene scene;
    scene.instead = [&](const auto&, std::size_t index) {
      return index == failing
                 ? std::optional<Result<std::int32_t>>(tl::unexpected(error_with("no answer")))
                 : std::nullopt;
    };
    scene.run();
    EXPECT_TRUE(scene.all_rest());
    EXPECT_TRUE(scene.drive.report().fault);
  }
}

TEST(ApproachDrive, SaysThatItsAxisStandsShort) {
  ApproachScene scene;
  scene.axes[0].stands_short = true;
  scene.run();
  ASSERT_TRUE(scene.drive.report().fault);
  EXPECT_EQ(scene.drive.report().fault->kind, FaultKind::no_end);
  EXPECT_TRUE(scene.all_rest());
}

// Whatever is wished when: the last stretch goes upwards, and nothing is beyond the range.
TEST(ApproachDrive, AlwaysComesFromItsSide) {
  tmcl::test::Random<> random(tmcl::test::seed());
  for (int round = 0; round < 300; ++round) {
    SCOPED_TRACE(round);
    ApproachScene scene;
    auto wishes = random.between(0, 5);
    auto next = scene.now() + milliseconds(random.between(1, 900));
    std::int32_t target = -400;
    scene.every_step = [&] {
      if (scene.now() < next || wishes == 0) return;
      --wishes;
      next = scene.now() + milliseconds(random.between(1, 900));
      const auto wished = static_cast<std::int32_t>(random.between(-1000, 1000));
      if (scene.drive.wish({wished})) target = wished;
    };
    scene.run();
    EXPECT_FALSE(scene.drive.report().fault);
    EXPECT_EQ(scene.axes[0].position(scene.now()), target);
    const auto sent = scene.targets();
    for (const auto place : sent) EXPECT_TRUE(place >= -1000 && place <= 1000) << place;
    const bool has_room = target > from_below.range.least;
    if (has_room && sent.size() > 1) {
      EXPECT_LE(sent[sent.size() - 2], target);
    }
  }
}

}  // namespace
}  // namespace tmcl::plan
