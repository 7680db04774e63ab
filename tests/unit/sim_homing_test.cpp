// The reference search, first as a state machine alone, then on a module with a stage.
#include "sim/module/homing.hpp"

#include <gmock/gmock.h>

#include <array>
#include <ostream>
#include <string>

#include "sim_fixture.hpp"
#include "support/no_events.hpp"

namespace tmcl::sim {
namespace {

using OrderKind = Homing::Order::Kind;

MATCHER_P2(Turns, kind, direction, "") { return arg.kind == kind && arg.direction == direction; }

SearchMode mode(std::int32_t value) { return *SearchMode::of(Family::tmc429, value); }

TEST(SearchMode, KnowsTheModesOfTheManuals) {
  for (const int value : {1, 4, 5, 8, 65, 68, 133, 136}) {
    EXPECT_TRUE(SearchMode::of(Family::sixpoint, value)) << value;
  }
  for (const int value : {0, 9, 64, 69, 129, 132, 137, 197, -1}) {
    EXPECT_FALSE(SearchMode::of(Family::sixpoint, value)) << value;
  }
  EXPECT_TRUE(SearchMode::of(Family::tmc457, 3));
  EXPECT_FALSE(SearchMode::of(Family::tmc457, 4));
  EXPECT_EQ(mode(1).direction, -1);
  EXPECT_EQ(mode(65).direction, 1);
  EXPECT_EQ(mode(7).direction, 1);
  EXPECT_EQ(mode(8).direction, -1);
  EXPECT_TRUE(mode(7).ignores_ends);
  EXPECT_TRUE(mode(133).home_inverted);
}

TEST(Homing, BacksOffAndComesBackSlowly) {
  Homing homing;
  EXPECT_THAT(homing.start(mode(1), {}, 0), Turns(OrderKind::search, -1));
  EXPECT_EQ(homing.see({.right = true, .home = true}, -10).kind, OrderKind::go_on);
  EXPECT_THAT(homing.see({.left = true}, -100), Turns(OrderKind::switching, 1));
  EXPECT_THAT(homing.see({}, -95), Turns(OrderKind::switching, -1));
  const auto back = homing.see({.left = true}, -99);
  EXPECT_EQ(back.kind, OrderKind::drive_to);
  EXPECT_EQ(back.position, -99);
  EXPECT_TRUE(homing.returns());
  const auto end = homing.arrived();
  EXPECT_EQ(end.kind, OrderKind::finish);
  EXPECT_EQ(end.position, -99);
  EXPECT_FALSE(homing.active());
  EXPECT_EQ(homing.step(), 0);
}

TEST(Homing, BacksOffFirstWhereTheSwitchIsActiveAlready) {
  Homing homing;
  EXPECT_THAT(homing.start(mode(1), {.left = true}, 0), Turns(OrderKind::switching, 1));
}

TEST(Homing, MeasuresTheOtherEndFirst) {
  Homing homing;
  EXPECT_THAT(homing.start(mode(2), {}, 0), Turns(OrderKind::search, 1));
  EXPECT_THAT(homing.see({.right = true}, 500), Turns(OrderKind::search, -1));
  EXPECT_THAT(homing.see({.left = true}, -400), Turns(OrderKind::switching, 1));
  EXPECT_EQ(homing.other_end(), 500);
}

TEST(Homing, FromBothSidesTheReferenceIsHalfWay) {
  Homing homing;
  homing.start(mode(4), {.left = true}, 0);
  homing.see({}, 20);
  EXPECT_EQ(homing.see({.left = true}, 10).position, 15);
}

TEST(Homing, SwapsSides) {
  Homing homing;
  EXPECT_THAT(homing.start(mode(66), {}, 0), Turns(OrderKind::search, -1));
  EXPECT_THAT(homing.see({.left = true}, -500), Turns(OrderKind::search, 1));
  EXPECT_THAT(homing.see({.right = true}, 500), Turns(OrderKind::switching, -1));
}

TEST(Homing, TurnsRoundAtTheEndOfTheWay) {
  Homing homing;
  EXPECT_THAT(homing.start(mode(5), {}, 0), Turns(OrderKind::search, -1));
  EXPECT_THAT(homing.see({.left = true}, -500), Turns(OrderKind::search, 1));
  EXPECT_THAT(homing.see({.home = true}, 100), Turns(OrderKind::switching, 1));
  EXPECT_THAT(homing.see({}, 120), Turns(OrderKind::switching, -1));
  EXPECT_EQ(homing.see({.home = true}, 119).position, 119);
}

TEST(Homing, InvertsTheHomeSwitch) {
  Homing homing;
  EXPECT_THAT(homing.start(mode(7 + 128), {.home = true}, 0), Turns(OrderKind::search, 1));
  EXPECT_TRUE(homing.ignores_ends());
  EXPECT_THAT(homing.see({}, 100), Turns(OrderKind::switching, -1));
}

TEST(Homing, IsNotActiveOnceItIsAborted) {
  Homing homing;
  homing.start(mode(1), {}, 0);
  EXPECT_EQ(homing.step(), 2);
  homing.abort();
  EXPECT_EQ(homing.step(), 0);
  EXPECT_EQ(homing.see({.left = true}, 0).kind, OrderKind::go_on);
}

// ---- On a module

namespace ap = axis_parameter;
using std::chrono::seconds;

constexpr std::uint8_t start = 0;
constexpr std::uint8_t cancel = 1;
constexpr std::uint8_t status = 2;

class SimHoming : public SimTest {
 protected:
  std::int32_t step() { return ask(Command::RFS, status, 0)->value; }
  void begin() { EXPECT_EQ(status_of(Command::RFS, start, 0), Status::ok); }
  // Where on the stage it stands.
  Place place() { return bench.modules().front()->stage(0).position(); }
};

TEST_F(SimHoming, FindsTheLeftSwitchAndCallsItZero) {
  add(1110, StageSettings{.left_switch = -30'000, .switch_tolerance = 40});
  EXPECT_EQ(step(), 0);
  begin();
  EXPECT_GT(step(), 0);
  pass(seconds(10));
  EXPECT_EQ(step(), 0);
  EXPECT_EQ(get(ap::actual_position), 0);
  EXPECT_EQ(get(ap::position_reached), 1);
  EXPECT_EQ(place(), -30'000);
  EXPECT_EQ(bench.next_due(), never);
  ask(Command::MVP, 0, 0, 12'345);
  pass(seconds(10));
  EXPECT_EQ(place(), -30'000 + 12'345);
}

TEST_F(SimHoming, DoesTheSameOnEveryFamily) {
  for (const auto model : std::to_array<std::uint16_t>({142, 6212})) {
    SCOPED_TRACE(model);
    Bench other(clock);
    auto& module = other.add(*find_model(model), ModuleAddress{1});
    module.mount(0, StageSettings{.left_switch = -30'000});
    test::NoEvents nobody;
    const Request search{ModuleAddress{1}, Command::RFS, start, 0, 0};
    EXPECT_EQ(module.execute(search, Medium::serial, nobody).status, Status::ok);
    for (int due = 0; other.next_due() != never && due < 1000; ++due) {
      clock.advance_to(other.next_due());
      other.run_due();
    }
    EXPECT_EQ(module.axis(0).search_step(), 0);
    EXPECT_EQ(module.axis(0).get(ap::actual_position), 0);
    EXPECT_NEAR(static_cast<double>(module.stage(0).position()), -30'000, 1);
  }
}

// What a search on the same stage leaves: where zero is, and how far the ends are apart.
struct Search {
  std::int32_t mode;
  double zero;
  std::int32_t distance;
};
void PrintTo(const Search& search, std::ostream* out) { *out << "mode " << search.mode; }

class SimHomingModes : public SimHoming, public testing::WithParamInterface<Search> {};

// A tolerance of 40 makes 20 between a reference from one side and one from both.
TEST_P(SimHomingModes, EndAtTheirReference) {
  const auto& search = GetParam();
  add(1110, StageSettings{.position = 500,
                          .left_switch = -30'000,
                          .right_switch = 50'000,
                          .home = Interval{10'000, 11'000},
                          .switch_tolerance = 40});
  ask(Command::MST, 0, 0);
  ask(Command::SAP, ap::actual_position, 0, 7'000);
  EXPECT_EQ(status_of(Command::SAP, 193, 0, search.mode), Status::ok);
  ask(Command::SAP, 194, 0, 300);
  ask(Command::SAP, 195, 0, 20);
  begin();
  pass(seconds(60));
  EXPECT_EQ(step(), 0);
  EXPECT_EQ(get(ap::actual_position), 0);
  EXPECT_EQ(get(ap::actual_velocity), 0);
  EXPECT_NEAR(static_cast<double>(place()), search.zero, 1);
  EXPECT_NEAR(get(197), search.zero + 6'500, 1);
  EXPECT_NEAR(get(196), search.distance, 2);
}

INSTANTIATE_TEST_SUITE_P(All, SimHomingModes,
                         testing::Values(Search{1, -30'000, 0}, Search{2, -30'000, 80'000},
                                         Search{3, -29'980, 79'980}, Search{4, -29'980, 0},
                                         Search{65, 50'000, 0}, Search{66, 50'000, 80'000},
                                         Search{67, 49'980, 79'980}, Search{68, 49'980, 0},
                                         Search{5, 11'000, 0}, Search{6, 10'000, 0},
                                         Search{7, 10'000, 0}, Search{5 + 128, 9'959, 0}),
                         [](const auto& test) { return std::to_string(test.param.mode); });

TEST_F(SimHoming, IgnoresEndSwitchesWhereTheModeSaysSo) {
  add(1110, StageSettings{.right_switch = 5'000, .home = Interval{10'000, 11'000}});
  ask(Command::SAP, 193, 0, 7);
  begin();
  pass(seconds(60));
  EXPECT_EQ(step(), 0);
  EXPECT_NEAR(static_cast<double>(place()), 10'000, 1);
  // From now on they bar the way again.
  ask(Command::ROR, 0, 0, 100);
  pass(seconds(5));
  EXPECT_NEAR(static_cast<double>(place()), 10'000, 1);
}

TEST_F(SimHoming, TakesItsSpeedsFromTheParameters) {
  add(1110);
  ask(Command::SAP, 194, 0, 123);
  begin();
  pass(seconds(1));
  EXPECT_EQ(get(ap::actual_velocity), -123);
}

TEST_F(SimHoming, SetsTheEncoderToZeroAsWell) {
  add(3110, StageSettings{.left_switch = -30'000, .encoder = EncoderSettings{1024, false}});
  ask(Command::SAP, 212, 0, 2'000);
  begin();
  pass(seconds(60));
  EXPECT_EQ(step(), 0);
  EXPECT_EQ(get(209), 0);
  EXPECT_EQ(get(207), 0);
}

TEST_F(SimHoming, SetsTheExternalEncoderToZeroToo) {
  constexpr std::uint8_t external_position = 216;
  constexpr std::uint8_t external_most_deviation = 218;
  add(1140, StageSettings{.left_switch = -30'000, .encoder = EncoderSettings{1024, false}});
  ask(Command::SAP, external_most_deviation, 0, 2'000);
  begin();
  pass(seconds(60));
  EXPECT_EQ(step(), 0);
  EXPECT_EQ(get(ap::actual_position), 0);
  EXPECT_EQ(get(external_position), 0);
  EXPECT_EQ(get(207), 0);
}

TEST_F(SimHoming, TheStageStaysWhereItIsWhenTheModuleRestarts) {
  add(1110, StageSettings{.left_switch = -30'000});
  ask(Command::MVP, 0, 0, 9'000);
  pass(seconds(5));
  ask(Command::SOFTWARE_RESET, 0, 0, 1234);
  pass(seconds(5));
  EXPECT_EQ(get(ap::actual_position), 0);
  EXPECT_EQ(place(), 9'000);
  begin();
  pass(seconds(60));
  EXPECT_EQ(place(), -30'000);
}

TEST_F(SimHoming, LooksForASwitchThatIsNotThereUntilItIsStopped) {
  add(1110);
  begin();
  pass(seconds(100));
  EXPECT_EQ(step(), 2);
  EXPECT_NE(get(ap::actual_velocity), 0);
  ask(Command::RFS, cancel, 0);
  pass(seconds(1));
  EXPECT_EQ(step(), 0);
  EXPECT_EQ(get(ap::actual_velocity), 0);
}

TEST_F(SimHoming, EndsWithEveryMotionCommand) {
  add(1110);
  for (const auto command : {Command::MST, Command::ROR, Command::ROL, Command::MVP}) {
    begin();
    pass(milliseconds(50));
    EXPECT_GT(step(), 0);
    EXPECT_EQ(status_of(command, 0, 0, 100), Status::ok);
    EXPECT_EQ(step(), 0);
  }
}

TEST_F(SimHoming, RefusesWhatItDoesNotKnow) {
  add(1110);
  EXPECT_EQ(status_of(Command::RFS, 3, 0), Status::wrong_type);
  EXPECT_EQ(status_of(Command::RFS, start, 1), Status::invalid_value);
}

}  // namespace
}  // namespace tmcl::sim
