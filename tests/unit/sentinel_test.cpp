// What a tick timer, or a user variable, says about whether its module has started again.
#include "gateway/sentinel.hpp"

#include <gtest/gtest.h>

#include "support/random.hpp"
#include "support/rounds.hpp"
#include "support/seed.hpp"

namespace tmcld {
namespace {

using namespace std::chrono_literals;
using Verdict = Sentinel::Verdict;
using tmcl::Duration;
using tmcl::TimePoint;

constexpr SentinelConfig tick{SentinelConfig::Kind::tick, 0};
constexpr std::int64_t wraps_at = std::int64_t{1} << 31;

Sentinel::Reading at(Duration asked, std::int64_t value, Duration took = 2ms) {
  return {static_cast<std::int32_t>(value % wraps_at), TimePoint(asked), TimePoint(asked + took)};
}

TEST(Sentinel, FindsNothingWhereTheTimerGoesOnAsItShould) {
  Sentinel sentinel(tick);
  EXPECT_EQ(sentinel.take(at(1000ms, 5000)), Verdict::same);
  EXPECT_EQ(sentinel.take(at(2000ms, 6001)), Verdict::same);
  EXPECT_EQ(sentinel.take(at(3000ms, 6980)), Verdict::same) << "20 ms late";
  EXPECT_EQ(sentinel.take(at(1003000ms, 996'990)), Verdict::same) << "one part in a hundred slow";
}

TEST(Sentinel, FindsARestartByATimerThatIsBehind) {
  Sentinel sentinel(tick);
  sentinel.take(at(1000ms, 5000));
  EXPECT_EQ(sentinel.take(at(1200ms, 100)), Verdict::restarted);
  EXPECT_EQ(sentinel.take(at(1202ms, 102)), Verdict::restarted) << "until that is understood";
  sentinel.forget();
  EXPECT_EQ(sentinel.take(at(1204ms, 104)), Verdict::same);
}

TEST(Sentinel, FindsARestartOfAModuleThatHadJustBeenSwitchedOn) {
  Sentinel sentinel(tick);
  sentinel.take(at(1000ms, 100));
  EXPECT_EQ(sentinel.take(at(1102ms, 100)), Verdict::restarted);
}

TEST(Sentinel, LetsTheTimerWrapAround) {
  Sentinel sentinel(tick);
  sentinel.take(at(0ms, wraps_at - 500));
  EXPECT_EQ(sentinel.take(at(1000ms, 500)), Verdict::same);
  sentinel.forget();
  sentinel.take(at(0ms, wraps_at - 500));
  EXPECT_EQ(sentinel.take(at(490ms, 2)), Verdict::same) << "it is a little ahead";
  sentinel.forget();
  sentinel.take(at(0ms, wraps_at - 500));
  EXPECT_EQ(sentinel.take(at(510ms, wraps_at - 1)), Verdict::same) << "it is a little behind";
}

TEST(Sentinel, FindsARestartAfterFifteenDays) {
  Sentinel sentinel(tick);
  const auto days = std::chrono::milliseconds(24h * 15);
  sentinel.take(at(0ms, days.count()));
  EXPECT_EQ(sentinel.take(at(300ms, 100)), Verdict::restarted);
}

TEST(Sentinel, TakesAComputerThatHasSleptForNoRestart) {
  Sentinel sentinel(tick);
  sentinel.take(at(1000ms, 5000));
  EXPECT_EQ(sentinel.take(at(2000ms, 3'606'000)), Verdict::ahead);
}

TEST(Sentinel, HoldsNothingAgainstAModuleWhoseAnswerTookLong) {
  Sentinel sentinel(tick);
  sentinel.take(at(1000ms, 5000, 900ms));
  EXPECT_EQ(sentinel.take(at(1901ms, 5010, 900ms)), Verdict::same);
}

TEST(Sentinel, TellsAtRandomWhatItsBoundsSay) {
  const auto seed = tmcl::test::seed();
  tmcl::test::Random<std::int64_t> random(seed);
  for (int round = 0; round < tmcl::test::rounds(20'000) && !testing::Test::HasFailure(); ++round) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed) + ", round " + std::to_string(round));
    Sentinel sentinel(tick);
    const auto was_on = random.any_size(wraps_at - 1);
    const auto passed = random.any_size(10'000'000);
    const auto delay = random.between(0, 100);
    const auto wrong = passed * random.between(-10, 10) / 1000;
    sentinel.take(at(0ms, was_on, std::chrono::milliseconds(delay)));
    const Duration later = std::chrono::milliseconds(delay + passed);
    const auto fair = was_on + random.between(0, delay) + passed + wrong;
    EXPECT_EQ(sentinel.take(at(later, std::max<std::int64_t>(fair, 0))), Verdict::same);

    Sentinel other(tick);
    other.take(at(0ms, was_on, std::chrono::milliseconds(delay)));
    const auto tolerance = 20 + (passed + delay + 2) / 100 + 2 * delay + 2;
    const bool wraps = was_on + passed + delay + tolerance >= wraps_at;
    if (wraps || was_on <= tolerance) continue;
    EXPECT_EQ(other.take(at(later, random.between(0, passed))), Verdict::restarted);
  }
}

TEST(Sentinel, FindsARestartByAVariableThatHasAnotherValue) {
  Sentinel sentinel({SentinelConfig::Kind::variable, 255});
  EXPECT_EQ(sentinel.name(), "variable:255");
  EXPECT_EQ(sentinel.take(at(0ms, 0)), Verdict::same);
  EXPECT_TRUE(sentinel.wants_mark());
  sentinel.forget();
  EXPECT_EQ(sentinel.take(at(1ms, 4711)), Verdict::same);
  EXPECT_FALSE(sentinel.wants_mark());
  EXPECT_EQ(sentinel.take(at(3600'000ms, 4711)), Verdict::same);
  EXPECT_EQ(sentinel.take(at(3600'010ms, 0)), Verdict::restarted);
}

}  // namespace
}  // namespace tmcld
