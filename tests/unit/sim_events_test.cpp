#include <gmock/gmock.h>

#include "sim_fixture.hpp"

namespace tmcl::sim {
namespace {

using SimEvents = SimTest;
using testing::IsEmpty;

constexpr auto arm = Command::TARGET_REACHED_EVENT;

MATCHER_P(IsEventFor, motors, "") {
  return arg && arg->status == Status::delayed && arg->command == arm && arg->value == motors;
}

TEST_F(SimEvents, TellsOnceThatTheNextMoveHasEnded) {
  auto& module = add(1110);
  EXPECT_EQ(ask(arm, 0, 0, 1), (Reply{2, 1, Status::ok, arm, 1}));
  ask(Command::MVP, 0, 0, 10'000);
  pass(milliseconds(100));
  EXPECT_THAT(heard(), IsEmpty());
  pass(milliseconds(400));
  EXPECT_THAT(reply_in(heard()), IsEventFor(1));
  EXPECT_EQ(module.axis(0).get(axis_parameter::actual_position), 10'000);
  ask(Command::MVP, 0, 0, 0);
  pass(milliseconds(500));
  EXPECT_THAT(heard(), IsEmpty());
}

TEST_F(SimEvents, ComesInTheMomentOfTheArrival) {
  auto& module = add(1110);
  ask(arm, 0, 0, 1);
  ask(Command::MVP, 0, 0, 10'000);
  const auto arrival = bench.next_due();
  ASSERT_LT(arrival, TimePoint(std::chrono::seconds(1)));
  heard();
  clock.advance_to(arrival - Duration(1));
  bench.run_due();
  EXPECT_THAT(heard(), IsEmpty());
  clock.advance_to(arrival);
  bench.run_due();
  EXPECT_THAT(reply_in(heard()), IsEventFor(1));
  EXPECT_EQ(module.axis(0).get(axis_parameter::actual_position), 10'000);
  EXPECT_EQ(module.axis(0).get(axis_parameter::actual_velocity), 0);
  EXPECT_EQ(bench.next_due(), never);
}

TEST_F(SimEvents, TellsOfEveryMoveUntilItIsToldNotTo) {
  add(1110);
  ask(arm, 1, 0, 1);
  for (const std::int32_t target : {100, 200, 300}) {
    ask(Command::MVP, 0, 0, target);
    pass(milliseconds(300));
    EXPECT_THAT(reply_in(heard()), IsEventFor(1));
  }
  ask(arm, 1, 0, 0);
  ask(Command::MVP, 0, 0, 0);
  pass(milliseconds(300));
  EXPECT_THAT(heard(), IsEmpty());
}

TEST_F(SimEvents, FollowsTheReplyWhenTheMotorIsThereAlready) {
  add(1110);
  ask(arm, 0, 0, 1);
  EXPECT_EQ(ask(Command::MVP, 0, 0, 0)->status, Status::ok);
  pass(milliseconds(1));
  EXPECT_THAT(reply_in(heard()), IsEventFor(1));
}

TEST_F(SimEvents, NamesTheMotorsThatWereAskedFor) {
  add(3110);
  ask(arm, 1, 0, 0b110);
  ask(Command::MVP, 0, 0, 100);
  ask(Command::MVP, 0, 1, 100);
  pass(milliseconds(300));
  EXPECT_THAT(reply_in(heard()), IsEventFor(0b010));
  ask(Command::MVP, 0, 2, 100);
  pass(milliseconds(300));
  EXPECT_THAT(reply_in(heard()), IsEventFor(0b100));
}

TEST_F(SimEvents, SharesAReportWhenMotorsArriveTogether) {
  add(3110);
  ask(arm, 0, 0, 0b011);
  ask(Command::MVP, 0, 0, 100);
  ask(Command::MVP, 0, 1, 100);
  pass(milliseconds(300));
  EXPECT_THAT(reply_in(heard()), IsEventFor(0b011));
}

TEST_F(SimEvents, WaitsForTheNewTargetWhenTheMoveIsRedirected) {
  add(1110);
  ask(arm, 0, 0, 1);
  ask(Command::MVP, 0, 0, 10'000);
  pass(milliseconds(50));
  ask(Command::MVP, 0, 0, -10'000);
  pass(milliseconds(150));
  EXPECT_THAT(heard(), IsEmpty());
  pass(milliseconds(500));
  EXPECT_THAT(reply_in(heard()), IsEventFor(1));
}

TEST_F(SimEvents, SaysNothingOfAMoveThatWasStopped) {
  add(1110);
  ask(arm, 0, 0, 1);
  ask(Command::MVP, 0, 0, 10'000);
  pass(milliseconds(50));
  ask(Command::MST, 0, 0);
  pass(milliseconds(500));
  EXPECT_THAT(heard(), IsEmpty());
}

TEST_F(SimEvents, GoesToThePortThatAskedForIt) {
  add(1110);
  Bytes elsewhere;
  SerialLine other(
      bench, [&](auto bytes) { elsewhere.insert(elsewhere.end(), bytes.begin(), bytes.end()); });
  other.receive(encode_serial(Request{ModuleAddress{1}, arm, 0, 0, 1}));
  elsewhere.clear();
  ask(Command::MVP, 0, 0, 100);
  pass(milliseconds(300));
  EXPECT_THAT(heard(), IsEmpty());
  EXPECT_THAT(reply_in(elsewhere), IsEventFor(1));
}

TEST_F(SimEvents, IsForgottenWithThePortThatAskedForIt) {
  add(1110);
  {
    SerialLine other(bench, [](auto) { FAIL(); });
    can.receive(encode_can(Request{ModuleAddress{1}, arm, 0, 0, 1}));
    SerialLine third(bench, [](auto) {});
    third.receive(encode_serial(Request{ModuleAddress{1}, arm, 1, 0, 1}));
  }
  frames();
  ask(Command::MVP, 0, 0, 100);
  pass(milliseconds(300));
  EXPECT_THAT(heard(), IsEmpty());
  EXPECT_THAT(frames(), IsEmpty());
}

TEST_F(SimEvents, ComesOnCanInTheFormatOfTheRequest) {
  add(1110, 5);
  auto request = encode_can(Request{ModuleAddress{5}, arm, 0, 0, 1}, true);
  request.length = 8;
  can.receive(request);
  frames();
  ask({ModuleAddress{5}, Command::MVP, 0, 0, 100});
  pass(milliseconds(300));
  const auto events = frames();
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0], encode_can(Reply{2, 5, Status::delayed, arm, 1}, 2, true, 8));
}

}  // namespace
}  // namespace tmcl::sim
