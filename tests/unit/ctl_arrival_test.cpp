// When a move counts as arrived, and when as interrupted.
#include <gtest/gtest.h>

#include "arrival.hpp"

namespace tmclctl {
namespace {

using std::chrono::milliseconds;
using Verdict = Arrival::Verdict;

constexpr tmcl::TimePoint start{std::chrono::seconds(100)};

AxisReading reading(milliseconds at, std::int32_t position, std::int32_t velocity,
                    std::int32_t target = 1000) {
  AxisReading made;
  made.position = {position};
  made.velocity = {velocity};
  made.target = {target};
  made.taken_at = start + at;
  return made;
}

TEST(CtlArrival, ArrivesWhereItStandsAtTheGoal) {
  Arrival arrival({1000}, start);
  EXPECT_EQ(arrival.judge(reading(milliseconds(0), 0, 0)), Verdict::under_way);
  EXPECT_EQ(arrival.judge(reading(milliseconds(20), 500, 300)), Verdict::under_way);
  EXPECT_EQ(arrival.judge(reading(milliseconds(40), 1000, 300)), Verdict::under_way)
      << "only passing";
  EXPECT_EQ(arrival.judge(reading(milliseconds(60), 1000, 0)), Verdict::arrived);
}

TEST(CtlArrival, ReadingsFromBeforeTheMoveSayNothing) {
  Arrival arrival({1000}, start);
  EXPECT_EQ(arrival.judge(reading(milliseconds(-1), 1000, 0)), Verdict::under_way);
  for (int ms = 0; ms < 150; ms += 50) {
    EXPECT_EQ(arrival.judge(reading(milliseconds(ms), 0, 0, 7)), Verdict::under_way)
        << "seems fresher than it is";
  }
  EXPECT_EQ(arrival.judge(reading(milliseconds(200), 100, 300)), Verdict::under_way);
}

TEST(CtlArrival, StandingStillElsewhereIsAnInterruption) {
  Arrival arrival({1000}, start);
  auto verdict = Verdict::under_way;
  auto at = milliseconds(0);
  for (; verdict == Verdict::under_way && at < milliseconds(5000); at += milliseconds(20)) {
    verdict = arrival.judge(reading(at, 400, 0));
  }
  EXPECT_EQ(verdict, Verdict::stands_elsewhere);
  EXPECT_NEAR(static_cast<double>(at.count()), 1040, 25);
}

TEST(CtlArrival, CreepingIsNotStanding) {
  Arrival arrival({1000}, start);
  for (int ms = 0; ms < 5000; ms += 20) {
    EXPECT_EQ(arrival.judge(reading(milliseconds(ms), ms / 20, 0)), Verdict::under_way);
  }
}

TEST(CtlArrival, AnotherTargetIsAnInterruption) {
  Arrival arrival({1000}, start);
  EXPECT_EQ(arrival.judge(reading(milliseconds(0), 400, 300, 5)), Verdict::under_way);
  EXPECT_EQ(arrival.judge(reading(milliseconds(200), 380, 300, 5)), Verdict::sent_elsewhere);
}

}  // namespace
}  // namespace tmclctl
