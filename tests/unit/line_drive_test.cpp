// Lines on axes that are played, in virtual time: each of their commands can be made to fail, and
// whatever fails, nothing goes on moving and nothing stays as the line had set it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tmcl/plan/line_drive.hpp"
#include "unit/drive_scene.hpp"

namespace tmcl::plan {
namespace {

using namespace test;
using Phase = LineDrive::Phase;

/// Axes on one bus, or on one each.
struct Layout {
  std::string name;
  std::size_t axes;
  bool buses;        // one for each axis
  bool one_command;  // of one module
};
void PrintTo(const Layout& layout, std::ostream* out) { *out << layout.name; }

/// Carries out what a line says, one command of a bus at a time.
class LineScene : public DriveScene {
 public:
  explicit LineScene(const Layout& layout)
      : DriveScene(layout.axes), layout_(layout), drive(line(), drive_axes(), layout.one_command) {}

  void run() { DriveScene::run(drive); }
  bool have_arrived() const {
    for (std::size_t i = 0; i < axes.size(); ++i)
      if (axes[i].position(now()) != target_of(i)) return false;
    return true;
  }
  std::size_t most_under_way() const { return most_under_way_; }
  std::int32_t target_of(std::size_t axis) const {
    return 10'000 / static_cast<std::int32_t>(axis + 1);
  }

 private:
  std::size_t bus_of(std::size_t axis) const { return layout_.buses ? axis : 0; }

  Line line() const {
    Line line;
    const auto twin = *AxisTwin::of(*find_model("TMCM-3110"));
    for (std::size_t i = 0; i < layout_.axes; ++i) {
      const auto slower = static_cast<std::int32_t>(i + 1);
      line.axes.push_back({{{ap::max_velocity, own_velocity / slower},
                            {ap::max_acceleration, own_acceleration / 2 / slower}},
                           twin,
                           {},
                           way_takes});
      line.order.insert(line.order.begin(), i);
    }
    line.duration = way_takes;
    return line;
  }
  std::vector<LineDriveAxis> drive_axes() const {
    std::vector<LineDriveAxis> made;
    for (std::size_t i = 0; i < layout_.axes; ++i) {
      made.push_back({{target_of(i)},
                      {{ap::max_velocity, own_velocity}, {ap::max_acceleration, own_acceleration}},
                      bus_of(i),
                      static_cast<std::uint8_t>(i)});
    }
    return made;
  }

  void about_to_take(const DriveCommand& command) override {
    if (command.kind == Kind::move_to) {
      EXPECT_TRUE(std::ranges::none_of(under_way(), [&](const UnderWay& other) {
        return bus_of(other.command.axis) == bus_of(command.axis);
      })) << "starts of one bus go one after the other";
    }
    most_under_way_ = std::max(most_under_way_, under_way().size() + 1);
  }

  Layout layout_;
  std::size_t most_under_way_ = 0;

 public:
  LineDrive drive;
};

class LineDriveFaults : public testing::TestWithParam<Layout> {
 protected:
  static std::size_t index_of_stop(const LineScene& scene) {
    const auto& all = scene.commands();
    return static_cast<std::size_t>(std::ranges::find(all, Kind::stop, &DriveCommand::kind) -
                                    all.begin());
  }

  /// After the first stop nothing moves any more, and settings only become what they were.
  static void expect_nothing_set_off_after_the_stop(const LineScene& scene) {
    const auto& all = scene.commands();
    for (auto i = index_of_stop(scene); i < all.size(); ++i) {
      EXPECT_FALSE(starts(all[i]) || all[i].kind == Kind::set_coordinate);
      if (all[i].kind == Kind::set) {
        EXPECT_EQ(all[i].value, PlayedAxis{}.settings.at(all[i].parameter));
      }
    }
  }
  /// All have been stopped if any was told to start, each once.
  static void expect_stops(const LineScene& scene) {
    std::vector<std::size_t> stopped, every_axis;
    for (const auto& stop : scene.commands(Kind::stop)) stopped.push_back(stop.axis);
    for (std::size_t i = 0; i < scene.axes.size(); ++i) every_axis.push_back(i);
    if (scene.drive.report().fault && std::ranges::any_of(scene.commands(), starts)) {
      EXPECT_EQ(stopped, every_axis);
    } else {
      EXPECT_TRUE(stopped.empty());
    }
  }
  /// What was written has been written back in reverse, axis by axis, or is in the report.
  static void expect_settings_back(const LineScene& scene) {
    const auto sets = scene.commands(Kind::set);
    for (std::size_t axis = 0; axis < scene.axes.size(); ++axis) {
      std::vector<std::uint8_t> written, back;
      for (const auto& set : sets) {
        if (set.axis != axis) continue;
        const bool restores = set.may_wait;
        (restores ? back : written).push_back(set.parameter);
      }
      std::ranges::reverse(back);
      EXPECT_EQ(back, written) << "axis " << axis;
    }
    auto expected = scene.axes;
    for (const auto& kept : scene.drive.report().unrestored) {
      EXPECT_EQ(kept.before.value, PlayedAxis{}.settings.at(kept.before.parameter));
      expected[kept.axis].settings[kept.before.parameter] = kept.before.value;
    }
    for (const auto& axis : expected) EXPECT_EQ(axis.settings, PlayedAxis{}.settings);
  }
  static void expect_safe_end(const LineScene& scene) {
    EXPECT_EQ(scene.drive.phase(), Phase::ended);
    EXPECT_TRUE(scene.all_rest());
    expect_stops(scene);
    expect_nothing_set_off_after_the_stop(scene);
    expect_settings_back(scene);
  }
  /// How many commands a line takes that nothing happens to.
  static std::size_t commands_of_a_line() {
    LineScene scene(GetParam());
    scene.run();
    EXPECT_FALSE(scene.drive.report().fault);
    return scene.commands().size();
  }
  /// A scene for each command.
  static void at_each_command(const std::function<void(LineScene&, std::size_t at)>& check) {
    const auto all = commands_of_a_line();
    for (std::size_t at = 0; at < all; ++at) {
      SCOPED_TRACE("command " + std::to_string(at));
      LineScene scene(GetParam());
      check(scene, at);
    }
  }
};

TEST_P(LineDriveFaults, WithoutThemAllArriveAndAreAsTheyWere) {
  LineScene scene(GetParam());
  std::vector<Phase> phases;
  scene.every_step = [&] {
    if (phases.empty() || phases.back() != scene.drive.phase())
      phases.push_back(scene.drive.phase());
  };
  scene.run();
  EXPECT_FALSE(scene.drive.report().fault);
  EXPECT_TRUE(scene.commands(Kind::stop).empty());
  EXPECT_TRUE(scene.have_arrived());
  expect_settings_back(scene);
  EXPECT_EQ(phases, (std::vector{Phase::loading, Phase::starting, Phase::running, Phase::restoring,
                                 Phase::ended}));
}

TEST_P(LineDriveFaults, NothingStartsBeforeAllAreSet) {
  LineScene scene(GetParam());
  scene.run();
  const auto& all = scene.commands();
  const auto first = std::ranges::find_if(all, starts);
  EXPECT_TRUE(std::all_of(first, all.end(), [](const DriveCommand& command) {
    return command.kind != Kind::set || command.may_wait;
  }));
}

TEST_P(LineDriveFaults, BusesStartSideBySide) {
  LineScene scene(GetParam());
  scene.run();
  EXPECT_EQ(scene.most_under_way(), GetParam().buses ? GetParam().axes : 1);
  const auto skew = scene.drive.report().skew;
  if (GetParam().one_command) {
    EXPECT_EQ(skew, Duration{});
  } else if (GetParam().buses) {
    EXPECT_EQ(skew, exchange * static_cast<int>(GetParam().axes - 1) / 2);
  } else {
    EXPECT_GT(skew, exchange);
  }
}

TEST_P(LineDriveFaults, WhateverIsRefusedAllStop) {
  at_each_command([](LineScene& scene, std::size_t at) {
    scene.instead = [&](const auto& command,
                        std::size_t index) -> std::optional<tmcl::Result<std::int32_t>> {
      if (index != at || command.may_wait) return std::nullopt;
      return tl::unexpected(error_with("refused", Errc::refused_by_module));
    };
    scene.run();
    if (scene.commands()[at].may_wait) return;
    const auto& fault = scene.drive.report().fault;
    ASSERT_TRUE(fault);
    EXPECT_EQ(fault->kind, FaultKind::refused);
    EXPECT_EQ(fault->axis, scene.commands()[at].axis);
    EXPECT_EQ(fault->error->message, "refused");
    EXPECT_TRUE(scene.drive.report().unrestored.empty());
    expect_safe_end(scene);
  });
}

// What has been carried out all the same is undone all the same.
TEST_P(LineDriveFaults, WhicheverAnswerIsLostAllStop) {
  at_each_command([](LineScene& scene, std::size_t at) {
    const DriveCommand* lost = nullptr;
    scene.instead = [&](const DriveCommand& command,
                        std::size_t index) -> std::optional<tmcl::Result<std::int32_t>> {
      if (index != at || command.may_wait) return std::nullopt;
      lost = &command;
      auto& axis = scene.axes[command.axis];
      if (command.kind == Kind::set) axis.settings[command.parameter] = command.value;
      if (command.kind == Kind::move_to) axis.move_to(command.value, scene.now());
      return tl::unexpected(error_with("no answer"));
    };
    scene.run();
    if (lost == nullptr) return;
    ASSERT_TRUE(scene.drive.report().fault);
    expect_safe_end(scene);
  });
}

// Also one that is in the middle of its commands.
TEST_P(LineDriveFaults, AnAxisThatIsSilentFromThenOnKeepsNoneOfTheOthersMoving) {
  at_each_command([](LineScene& scene, std::size_t at) {
    constexpr std::size_t silent = 1;
    bool never_answers = false;
    scene.instead = [&](const DriveCommand& command,
                        std::size_t index) -> std::optional<tmcl::Result<std::int32_t>> {
      never_answers = never_answers || index >= at;
      if (!never_answers || command.axis != silent) return std::nullopt;
      return tl::unexpected(error_with("silent", Errc::module_silent));
    };
    scene.run();
    const auto& report = scene.drive.report();
    EXPECT_EQ(scene.drive.phase(), Phase::ended);
    expect_settings_back(scene);
    expect_nothing_set_off_after_the_stop(scene);
    for (std::size_t i = 0; i < scene.axes.size(); ++i) {
      if (i == silent) continue;
      EXPECT_FALSE(scene.axes[i].moves(scene.now()));
    }
    if (index_of_stop(scene) < scene.commands().size()) {
      ASSERT_EQ(report.unstopped.size(), 1U);
      EXPECT_EQ(report.unstopped.front().axis, silent);
      EXPECT_EQ(report.unstopped.front().why.message, "silent");
      EXPECT_EQ(report.unrestored.size(), 2U);
    }
  });
}

TEST_P(LineDriveFaults, ALinkThatIsLostForGoodLeavesAReport) {
  at_each_command([](LineScene& scene, std::size_t at) {
    bool lost = false;
    scene.instead = [&](const auto&,
                        std::size_t index) -> std::optional<tmcl::Result<std::int32_t>> {
      lost = lost || index >= at;
      if (!lost) return std::nullopt;
      return tl::unexpected(error_with("lost", Errc::link_lost));
    };
    scene.run();
    const auto& report = scene.drive.report();
    EXPECT_EQ(scene.drive.phase(), Phase::ended);
    expect_settings_back(scene);
    expect_stops(scene);
    EXPECT_EQ(report.unstopped.size(), scene.commands(Kind::stop).size());
  });
}

TEST_P(LineDriveFaults, WheneverSomebodyElseStopsOneAllStop) {
  at_each_command([](LineScene& scene, std::size_t at) {
    bool told = false, have_arrived = false;
    scene.every_step = [&] {
      if (told || scene.commands().size() <= at || scene.drive.phase() > Phase::running) return;
      told = true;
      have_arrived = scene.have_arrived();
      scene.axes[0].stop(scene.now());
      scene.drive.stop({FaultKind::foreign, 0, "was stopped by another client", {}, {}});
    };
    scene.run();
    if (!told || (have_arrived && !scene.drive.report().fault)) return;
    ASSERT_TRUE(scene.drive.report().fault);
    EXPECT_EQ(scene.drive.report().fault->kind, FaultKind::foreign);
    expect_safe_end(scene);
  });
}

TEST_P(LineDriveFaults, AStopIsHeededInTheMiddleOfAWait) {
  LineScene scene(GetParam());
  std::optional<TimePoint> asked;
  scene.every_step = [&] {
    if (asked || scene.drive.phase() != Phase::running) return;
    asked = scene.now();
    scene.drive.stop();
  };
  scene.run();
  const auto stop = index_of_stop(scene);
  ASSERT_LT(stop, scene.commands().size());
  EXPECT_EQ(scene.drive.report().fault->message, "stopped");
  expect_safe_end(scene);
}

TEST_P(LineDriveFaults, WhicheverIsSentElsewhereAllStop) {
  for (std::size_t axis = 0; axis < GetParam().axes; ++axis) {
    LineScene scene(GetParam());
    bool sent = false;
    scene.every_step = [&] {
      if (sent || scene.axes[axis].position(scene.now()) < scene.target_of(axis) / 2) return;
      sent = true;
      scene.axes[axis].move_to(-5000, scene.now());
    };
    scene.run();
    const auto& fault = scene.drive.report().fault;
    ASSERT_TRUE(fault);
    EXPECT_EQ(fault->kind, FaultKind::foreign);
    EXPECT_EQ(fault->axis, axis);
    EXPECT_EQ(fault->message, "was sent elsewhere");
    expect_safe_end(scene);
  }
}

TEST_P(LineDriveFaults, WhicheverStandsShortAllStop) {
  for (std::size_t axis = 0; axis < GetParam().axes; ++axis) {
    LineScene scene(GetParam());
    scene.axes[axis].stands_short = true;
    scene.run();
    const auto& fault = scene.drive.report().fault;
    ASSERT_TRUE(fault);
    EXPECT_EQ(fault->kind, FaultKind::no_end);
    EXPECT_EQ(fault->axis, axis);
    EXPECT_EQ(fault->stands_at, Microsteps{scene.target_of(axis) / 2});
    EXPECT_THAT(fault->message, testing::HasSubstr("short of its target"));
    EXPECT_LT(scene.now().time_since_epoch(), seconds(1) + way_takes) << "before others arrive";
  }
}

TEST_P(LineDriveFaults, WhicheverNeverArrivesAllStop) {
  for (std::size_t axis = 0; axis < GetParam().axes; ++axis) {
    LineScene scene(GetParam());
    scene.axes[axis].never_arrives = true;
    scene.run();
    const auto& fault = scene.drive.report().fault;
    ASSERT_TRUE(fault);
    EXPECT_EQ(fault->kind, FaultKind::no_end);
    EXPECT_EQ(fault->axis, axis);
    EXPECT_EQ(fault->message, "has not arrived when it should have");
    expect_safe_end(scene);
  }
}

TEST_P(LineDriveFaults, WhatIsReadOrSetBackAfterAStopMayWait) {
  LineScene scene(GetParam());
  scene.every_step = [&] {
    if (scene.drive.phase() == Phase::running) scene.drive.stop();
  };
  scene.run();
  const auto& all = scene.commands();
  const auto stop = index_of_stop(scene);
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(all[i].may_wait, i >= stop) << i;
}

INSTANTIATE_TEST_SUITE_P(Lines, LineDriveFaults,
                         testing::Values(Layout{"TwoOnOneBus", 2, false, false},
                                         Layout{"ThreeOnOneBus", 3, false, false},
                                         Layout{"TwoOnTwoBuses", 2, true, false},
                                         Layout{"ThreeOnThreeBuses", 3, true, false},
                                         Layout{"ThreeOfOneModule", 3, false, true}),
                         [](const auto& layout) { return layout.param.name; });

TEST(LineDrive, WithoutAWayThereIsNothingToDo) {
  LineDrive drive(Line{}, {}, false);
  EXPECT_TRUE(std::holds_alternative<DriveEnd>(drive.next({})));
  EXPECT_FALSE(drive.report().fault);
}

}  // namespace
}  // namespace tmcl::plan
