// What a tick timer, or a user variable, says about whether its module has started again.
#include "gateway/module/sentinel.hpp"

#include <gtest/gtest.h>

#include "support/random.hpp"
#include "support/rounds.hpp"
#include "support/seed.hpp"

namespace tmcld {
namespace {

using namespace std::chrono_literals;
using Verdict = Sentinel::Verdict;
using tmcl::Duration;
using tmcl::Outcome;
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

tmcl::Request sent(tmcl::Command command, std::uint8_t type, std::uint8_t motor, int value) {
  return {tmcl::ModuleAddress{1}, command, type, motor, value};
}

class SentinelBySettings : public testing::Test {
 protected:
  SentinelBySettings() { sentinel.note_programs(false); }
  void send(const tmcl::Request& request, Outcome outcome = Outcome::done) {
    sentinel.note_sending(request);
    sentinel.note_sent(request, outcome);
  }
  void move(std::uint8_t motor, int target, Outcome outcome = Outcome::done) {
    send(sent(tmcl::Command::MVP, 0, motor, target), outcome);
  }
  Verdict read(std::uint8_t motor, int value) {
    time += 1ms;
    return sentinel.take({value, TimePoint(time), TimePoint(time), motor});
  }

  Sentinel sentinel{{SentinelConfig::Kind::settings, 0}};
  Duration time = 1s;
};

TEST_F(SentinelBySettings, FindsARestartByATargetThatIsZero) {
  EXPECT_FALSE(sentinel.watches());
  move(1, 500);
  EXPECT_TRUE(sentinel.watches());
  EXPECT_EQ(sentinel.question(tmcl::ModuleAddress{1}), sent(tmcl::Command::GAP, 0, 1, 0));
  EXPECT_EQ(read(1, 500), Verdict::same);
  EXPECT_EQ(read(1, 700), Verdict::same) << "another master";
  EXPECT_EQ(read(1, 0), Verdict::restarted);
}

TEST_F(SentinelBySettings, IsInDoubtWhenSomebodyElseHasReadWhatDoesNotFit) {
  const auto overhear = [this](const tmcl::Request& question, int value) {
    tmcl::Answer answer;
    answer.reply.value = value;
    sentinel.overhear(question, answer);
    return sentinel.in_doubt();
  };
  using tmcl::Command;
  move(1, 500);
  read(1, 500);
  const auto counted = sentinel.counts_until(500ms);
  EXPECT_FALSE(overhear(sent(Command::GAP, 0, 1, 0), 500));
  EXPECT_FALSE(overhear(sent(Command::GAP, 1, 1, 0), 0)) << "the actual position";
  EXPECT_FALSE(overhear(sent(Command::GAP, 0, 0, 0), 0)) << "a motor that nobody has moved";
  EXPECT_EQ(sentinel.counts_until(500ms), counted);
  EXPECT_TRUE(overhear(sent(Command::GAP, 0, 1, 0), 0));
  EXPECT_EQ(read(1, 500), Verdict::same) << "a late answer, perhaps";
  EXPECT_EQ(sentinel.counts_until(500ms), TimePoint{}) << "until that is proven";
  sentinel.end_doubt();
  EXPECT_GT(sentinel.counts_until(500ms), counted);
}

TEST_F(SentinelBySettings, HoldsNothingAgainstATargetThatMayBeZero) {
  using tmcl::Command;
  for (const auto& request :
       {sent(Command::MVP, 0, 1, 0), sent(Command::MVP, 2, 1, 5), sent(Command::RFS, 0, 1, 0),
        sent(Command::SAP, 0, 1, 0), sent(Command::SAP, 1, 1, 5), sent(Command::MVP, 2, 0x42, 5)}) {
    SCOPED_TRACE(describe(request));
    move(1, 500);
    sentinel.note_sending(request);
    EXPECT_EQ(read(1, 0), Verdict::same);
    move(1, 600);
    EXPECT_FALSE(sentinel.watches()) << "which of the two is executed last is not known";
    sentinel.note_sent(request, Outcome::done);
    EXPECT_FALSE(sentinel.watches());
  }
}

TEST_F(SentinelBySettings, KeepsWhatItKnewOfATargetIfNothingHasReachedTheMotor) {
  const auto search = sent(tmcl::Command::RFS, 0, 1, 0);
  move(1, 500);
  for (const auto outcome : {Outcome::not_sent, Outcome::refused}) {
    sentinel.note_sending(search);
    EXPECT_EQ(read(1, 0), Verdict::same) << "it may have begun";
    sentinel.note_sent(search, outcome);
    EXPECT_EQ(read(1, 0), Verdict::restarted);
  }
  send(search, Outcome::unknown);
  EXPECT_FALSE(sentinel.watches());
}

TEST_F(SentinelBySettings, DoesNotCountAMovementThatWasPerhapsNotExecuted) {
  move(1, 500, Outcome::unknown);
  EXPECT_FALSE(sentinel.watches());
  move(1, 500);
  move(1, 600, Outcome::unknown);
  EXPECT_EQ(read(1, 0), Verdict::restarted) << "neither is zero";
}

TEST_F(SentinelBySettings, SaysNothingWhileAProgramMaySendTheMotors) {
  move(1, 500);
  send(sent(tmcl::Command::RUN_APPLICATION, 0, 0, 0));
  EXPECT_FALSE(sentinel.watches());
  sentinel.forget();
  EXPECT_TRUE(sentinel.wants_to_know_programs());
  sentinel.note_programs(true);
  move(1, 500);
  EXPECT_FALSE(sentinel.watches());
}

TEST_F(SentinelBySettings, SaysNothingOnlyWhileAProgramThatDoesNotBeginIsOnItsWay) {
  const auto run = sent(tmcl::Command::RUN_APPLICATION, 0, 0, 0);
  move(1, 500);
  for (const auto outcome : {Outcome::not_sent, Outcome::refused}) {
    sentinel.note_sending(run);
    sentinel.note_sending(run);
    sentinel.note_sent(run, outcome);
    EXPECT_FALSE(sentinel.watches()) << "the other one";
    sentinel.note_sent(run, outcome);
    EXPECT_TRUE(sentinel.watches());
  }
  send(run, Outcome::unknown);
  EXPECT_FALSE(sentinel.watches());
}

TEST_F(SentinelBySettings, IsWhatIsLeftOfAModuleWithoutATimer) {
  Sentinel other(tick);
  other.give_up();
  EXPECT_EQ(other.name(), "none");
  other.note_programs(false);
  other.note_sent(sent(tmcl::Command::MVP, 0, 2, 9), Outcome::done);
  EXPECT_EQ(other.name(), "settings");
  EXPECT_FALSE(other.last()) << "another run of the gateway cannot compare it";
}

}  // namespace
}  // namespace tmcld
