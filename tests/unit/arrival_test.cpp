// When a move counts as arrived, and when as interrupted.
#include <gtest/gtest.h>

#include "tmcl/plan/arrival.hpp"

namespace tmcl::plan {
namespace {

using std::chrono::milliseconds;
using Verdict = Arrival::Verdict;

constexpr TimePoint start{std::chrono::seconds(100)};
constexpr Arrival::Patience patience{std::chrono::seconds(1), milliseconds(200)};

Arrival::Reading reading(milliseconds at, std::int32_t position, std::int32_t velocity,
                         std::int32_t target = 1000) {
  return {start + at, {position}, {target}, velocity == 0, position == target};
}

TEST(Arrival, IsWhereItStandsAtTheGoal) {
  Arrival arrival(Microsteps{1000}, start, patience);
  EXPECT_EQ(arrival.judge(reading(milliseconds(0), 0, 0)), Verdict::under_way);
  EXPECT_EQ(arrival.judge(reading(milliseconds(20), 500, 300)), Verdict::under_way);
  EXPECT_EQ(arrival.judge(reading(milliseconds(40), 1000, 300)), Verdict::under_way)
      << "only passing";
  EXPECT_EQ(arrival.judge(reading(milliseconds(60), 1000, 0)), Verdict::arrived);
}

TEST(Arrival, ReadingsFromBeforeTheMoveSayNothing) {
  Arrival arrival(Microsteps{1000}, start, patience);
  EXPECT_EQ(arrival.judge(reading(milliseconds(-1), 1000, 0)), Verdict::under_way);
  for (int ms = 0; ms < 150; ms += 50) {
    EXPECT_EQ(arrival.judge(reading(milliseconds(ms), 0, 0, 7)), Verdict::under_way)
        << "seems fresher than it is";
  }
  EXPECT_EQ(arrival.judge(reading(milliseconds(200), 100, 300)), Verdict::under_way);
}

TEST(Arrival, StandingStillElsewhereIsAnInterruption) {
  Arrival arrival(Microsteps{1000}, start, patience);
  auto verdict = Verdict::under_way;
  auto at = milliseconds(0);
  for (; verdict == Verdict::under_way && at < milliseconds(5000); at += milliseconds(20))
    verdict = arrival.judge(reading(at, 400, 0));
  EXPECT_EQ(verdict, Verdict::stands_elsewhere);
  EXPECT_EQ(at, milliseconds(1020));
}

TEST(Arrival, CreepingIsNotStanding) {
  Arrival arrival(Microsteps{1000}, start, patience);
  for (int ms = 0; ms < 5000; ms += 20) {
    EXPECT_EQ(arrival.judge(reading(milliseconds(ms), 1 + ms / 20, 0)), Verdict::under_way);
  }
}

TEST(Arrival, AnotherTargetIsAnInterruption) {
  Arrival arrival(Microsteps{1000}, start, patience);
  EXPECT_EQ(arrival.judge(reading(milliseconds(0), 400, 300, 5)), Verdict::under_way);
  EXPECT_EQ(arrival.judge(reading(milliseconds(200), 380, 300, 5)), Verdict::sent_elsewhere);
}

TEST(Arrival, AnAxisHasTimeToBegin) {
  Arrival arrival(Microsteps{1000}, start, {milliseconds(60), {}, milliseconds(200)});
  EXPECT_EQ(arrival.judge(reading(milliseconds(0), 0, 0, 7)), Verdict::under_way);
  EXPECT_EQ(arrival.judge(reading(milliseconds(199), 0, 0)), Verdict::under_way);
  EXPECT_EQ(arrival.judge(reading(milliseconds(200), 0, 0)), Verdict::under_way);
  EXPECT_EQ(arrival.judge(reading(milliseconds(260), 0, 0)), Verdict::stands_elsewhere);
}

TEST(Arrival, WithoutAGoalItIsAtWhateverTargetTheAxisHas) {
  Arrival arrival({}, start, patience);
  EXPECT_EQ(arrival.judge(reading(milliseconds(0), 400, 300, 5)), Verdict::under_way);
  EXPECT_EQ(arrival.judge(reading(milliseconds(20), 7, 0, 7)), Verdict::arrived);
}

}  // namespace
}  // namespace tmcl::plan
