// Mint programs on axes that are played, in virtual time: each of their commands can be made to
// fail, and whatever fails, nothing goes on moving and nothing stays as the program had set it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tmcl/parameter_number.hpp"
#include "tmcl/plan/mint_drive.hpp"
#include "unit/drive_scene.hpp"

namespace tmcl::plan {
namespace {

using namespace test;
using testing::ElementsAre;

constexpr auto pulse_divisor = number_of("pulse_divisor");
constexpr std::int32_t own_divisor = 5;

std::vector<Setting> ramp(std::int32_t divisor, std::int32_t velocity) {
  return {{pulse_divisor, divisor}, {ap::max_velocity, velocity}, {ap::max_acceleration, 7}};
}

/// Axes 0 and 1 are of one module, 2 is of another. All go together, then 0 and 2.
class MintScene : public DriveScene {
 public:
  MintScene()
      : DriveScene(3),
        drive({{6,
                0.4,
                {{0, {9000}, ramp(3, 900)}, {1, {-5000}, ramp(3, 900)}, {2, {70}, ramp(9, 9)}}},
               {8, 0.4, {{0, {0}, ramp(7, 500)}, {2, {4000}, ramp(9, 9)}}}},
              {{0, 0}, {0, 1}, {1, 4}}) {
    for (auto& axis : axes) axis.settings[pulse_divisor] = own_divisor;
    own_settings = axes.front().settings;
  }

  void run() { DriveScene::run(drive); }
  std::size_t count(Kind kind) const { return commands(kind).size(); }

  std::map<std::uint8_t, std::int32_t> own_settings;
  MintDrive drive;
};

void expect_settings_back(const MintScene& scene) {
  auto expected = scene.axes;
  for (const auto& kept : scene.drive.report().unrestored)
    expected[kept.axis].settings[kept.before.parameter] = kept.before.value;
  for (const auto& axis : expected) EXPECT_EQ(axis.settings, scene.own_settings);
}

/// All have been stopped if any was told to start in the group that failed; nothing starts then.
void expect_safe_end(const MintScene& scene) {
  EXPECT_TRUE(scene.all_rest());
  expect_settings_back(scene);
  const auto& all = scene.commands();
  const auto stop = std::ranges::find(all, Kind::stop, &DriveCommand::kind);
  EXPECT_TRUE(std::none_of(stop, all.end(), starts));
  if (stop == all.end()) return;
  for (std::size_t axis = 0; axis < scene.axes.size(); ++axis) {
    EXPECT_TRUE(std::ranges::any_of(scene.commands(Kind::stop),
                                    [&](const auto& command) { return command.axis == axis; }));
  }
}

void at_each_command(const std::function<void(MintScene&, std::size_t at)>& check) {
  MintScene whole;
  whole.run();
  ASSERT_FALSE(whole.drive.report().fault);
  for (std::size_t at = 0; at < whole.commands().size(); ++at) {
    SCOPED_TRACE("command " + std::to_string(at));
    MintScene scene;
    check(scene, at);
  }
}

TEST(MintDrive, GroupAfterGroupAllArriveAndAreAsTheyWere) {
  MintScene scene;
  scene.run();
  const auto& report = scene.drive.report();
  EXPECT_FALSE(report.fault);
  EXPECT_EQ(scene.count(Kind::stop), 0U);
  EXPECT_EQ(scene.axes[0].position(scene.now()), 0);
  EXPECT_EQ(scene.axes[1].position(scene.now()), -5000);
  EXPECT_EQ(scene.axes[2].position(scene.now()), 4000);
  ASSERT_EQ(report.took.size(), 2U);
  for (const auto took : report.took) {
    EXPECT_GT(took, way_takes);
    EXPECT_LT(took, 2 * way_takes);
  }
  expect_safe_end(scene);
}

TEST(MintDrive, OneCommandStartsTheMotorsOfAModule) {
  MintScene scene;
  scene.run();
  std::vector<DriveCommand> started;
  std::ranges::copy_if(scene.commands(), std::back_inserter(started), starts);
  EXPECT_THAT(
      started,
      ElementsAre(DriveCommand{Kind::move_motors, 0, 0, 3}, DriveCommand{Kind::move_to, 2, 0, 70},
                  DriveCommand{Kind::move_to, 0, 0, 0}, DriveCommand{Kind::move_to, 2, 0, 4000}));
  EXPECT_THAT(scene.commands(Kind::set_coordinate),
              ElementsAre(DriveCommand{Kind::set_coordinate, 0, 0, 9000},
                          DriveCommand{Kind::set_coordinate, 1, 0, -5000}));
}

TEST(MintDrive, AModuleWithoutCoordinatesIsToldEachTarget) {
  MintScene scene;
  scene.instead = [](const DriveCommand& command,
                     std::size_t) -> std::optional<tmcl::Result<std::int32_t>> {
    if (command.kind != Kind::set_coordinate) return std::nullopt;
    auto refused = error_with("unknown command", Errc::refused_by_module);
    refused.outcome = Outcome::refused;
    return tl::unexpected(std::move(refused));
  };
  scene.run();
  EXPECT_FALSE(scene.drive.report().fault);
  EXPECT_EQ(scene.count(Kind::move_motors), 0U);
  EXPECT_EQ(scene.count(Kind::move_to), 5U);
  EXPECT_EQ(scene.axes[1].position(scene.now()), -5000);
}

// Whoever stops answering in between must not be left with a fast axis.
TEST(MintDrive, NoSpeedInBetweenIsFasterThanBeforeAndAfter) {
  MintScene scene;
  scene.run();
  std::vector<std::uint8_t> of_axis_0;
  for (const auto& set : scene.commands(Kind::set))
    if (set.axis == 0) of_axis_0.push_back(set.parameter);
  EXPECT_THAT(of_axis_0,
              ElementsAre(ap::max_velocity, ap::max_acceleration, pulse_divisor,    // 5 to 3
                          pulse_divisor, ap::max_velocity,                          // 3 to 7
                          ap::max_acceleration, ap::max_velocity, pulse_divisor));  // and to 5
}

TEST(MintDrive, WhateverIsRefusedAllStop) {
  at_each_command([](MintScene& scene, std::size_t at) {
    scene.instead = [&](const auto& command,
                        std::size_t index) -> std::optional<tmcl::Result<std::int32_t>> {
      if (index != at || command.may_wait) return std::nullopt;
      return tl::unexpected(error_with("refused"));
    };
    scene.run();
    if (scene.commands()[at].may_wait) return;
    const auto& fault = scene.drive.report().fault;
    ASSERT_TRUE(fault);
    EXPECT_EQ(fault->kind, FaultKind::refused);
    EXPECT_EQ(fault->axis, scene.commands()[at].axis);
    expect_safe_end(scene);
  });
}

// What has been carried out all the same is undone all the same.
TEST(MintDrive, WhicheverAnswerIsLostAllStop) {
  at_each_command([](MintScene& scene, std::size_t at) {
    bool lost = false;
    scene.instead = [&](const DriveCommand& command,
                        std::size_t index) -> std::optional<tmcl::Result<std::int32_t>> {
      if (index != at || command.may_wait) return std::nullopt;
      lost = true;
      auto& axis = scene.axes[command.axis];
      if (command.kind == Kind::set) axis.settings[command.parameter] = command.value;
      if (command.kind == Kind::move_to) axis.move_to(command.value, scene.now());
      return tl::unexpected(error_with("no answer"));
    };
    scene.run();
    if (!lost) return;
    ASSERT_TRUE(scene.drive.report().fault);
    expect_safe_end(scene);
  });
}

TEST(MintDrive, ALinkThatIsLostForGoodLeavesAReport) {
  at_each_command([](MintScene& scene, std::size_t at) {
    scene.instead = [&](const auto&,
                        std::size_t index) -> std::optional<tmcl::Result<std::int32_t>> {
      if (index < at) return std::nullopt;
      return tl::unexpected(error_with("lost", Errc::link_lost));
    };
    scene.run();
    const bool stopped = scene.count(Kind::stop) > 0;
    EXPECT_EQ(scene.drive.report().unstopped.size(), stopped ? scene.axes.size() : 0U);
    expect_settings_back(scene);
  });
}

TEST(MintDrive, WheneverSomebodyElseStopsOneAllStop) {
  at_each_command([](MintScene& scene, std::size_t at) {
    bool told = false;
    scene.every_step = [&] {
      if (told || scene.commands().size() <= at || scene.drive.report().took.size() == 2) return;
      told = true;
      scene.axes[2].stop(scene.now());
      scene.drive.stop({FaultKind::foreign, 2, "was stopped by another client", {}, {}});
    };
    scene.run();
    if (!told || (!scene.drive.report().fault && scene.drive.report().took.size() == 2)) return;
    ASSERT_TRUE(scene.drive.report().fault);
    EXPECT_EQ(scene.drive.report().fault->kind, FaultKind::foreign);
    expect_safe_end(scene);
  });
}

TEST(MintDrive, WhicheverStandsShortOrIsSentElsewhereAllStop) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    MintScene short_of_it;
    short_of_it.axes[axis].stands_short = true;
    short_of_it.run();
    ASSERT_TRUE(short_of_it.drive.report().fault);
    EXPECT_EQ(short_of_it.drive.report().fault->kind, FaultKind::no_end);
    EXPECT_EQ(short_of_it.drive.report().fault->axis, axis);
    expect_safe_end(short_of_it);

    MintScene elsewhere;
    bool sent = false;
    elsewhere.every_step = [&] {
      if (sent || !elsewhere.axes[axis].moves(elsewhere.now())) return;
      sent = true;
      elsewhere.axes[axis].move_to(-30'000, elsewhere.now());
    };
    elsewhere.run();
    ASSERT_TRUE(elsewhere.drive.report().fault);
    EXPECT_EQ(elsewhere.drive.report().fault->message, "was sent elsewhere");
    expect_safe_end(elsewhere);
  }
}

}  // namespace
}  // namespace tmcl::plan
