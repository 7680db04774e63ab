// What keys mean that are held down to jog axes, in virtual time.
#include <gmock/gmock.h>

#include "axis/jog_keys.hpp"
#include "unit/ctl_bench.hpp"

namespace tmclctl {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;
using Going = JogKeys::Going;
using Step = JogKeys::Step;

constexpr Key left{Key::Kind::left};
constexpr Key right{Key::Kind::right};
constexpr Key up{Key::Kind::up};
constexpr Key page_down{Key::Kind::page_down};
constexpr Key letter(char letter) { return {Key::Kind::letter, letter}; }

class HeldKeys : public testing::Test {
 protected:
  /// The keys are looked at every 10 ms.
  void pass(tmcl::Duration time) {
    for (const auto end = now + time; now < end;) {
      now += 10ms;
      keys.look({}, now);
      for (const auto& going : keys.take_going(now)) told_until = now + going.hold;
    }
  }
  void press(Key key) {
    keys.look({key}, now);
    for (const auto& going : keys.take_going(now)) told_until = now + going.hold;
  }
  std::vector<Going> going_with(Key key) {
    keys.look({key}, now);
    return keys.take_going(now);
  }

  JogKeys keys{3};
  tmcl::TimePoint now{1h};
  tmcl::TimePoint told_until{};
};

TEST_F(HeldKeys, APressHoldsUntilAKeyboardRepeatsIt) {
  EXPECT_THAT(going_with(right), ElementsAre(Going{0, 1, 100, 600ms}));
  EXPECT_THAT(keys.take_going(now), IsEmpty()) << "told once";
}

TEST_F(HeldKeys, ARepeatHoldsUntilTheNextOne) {
  press(right);
  const auto pressed = now;
  pass(500ms);
  for (int i = 0; i < 50; ++i) {
    press(right);
    ASSERT_GE(told_until, now) << "it never has to brake";
    ASSERT_LE(told_until, std::max(pressed + 600ms, now + 150ms));
    pass(30ms);
  }
  const auto last = told_until;
  pass(2s);
  EXPECT_EQ(told_until, last) << "nothing more is told when the key is released";
  EXPECT_LE(last, now - 2s + 150ms);
}

TEST_F(HeldKeys, AnotherDirectionIsAnotherPress) {
  press(right);
  pass(100ms);
  EXPECT_THAT(going_with(left), ElementsAre(Going{0, -1, 100, 600ms}));
}

TEST_F(HeldKeys, EachAxisHasItsOwn) {
  EXPECT_THAT(going_with(up), ElementsAre(Going{1, 1, 100, 600ms}));
  EXPECT_THAT(going_with(page_down), ElementsAre(Going{2, -1, 100, 600ms}));
}

TEST_F(HeldKeys, DigitsAreTheSpeed) {
  EXPECT_THAT(going_with(letter('3')), IsEmpty());
  EXPECT_THAT(going_with(right), ElementsAre(Going{0, 1, 30, 600ms}));
  EXPECT_THAT(going_with(letter('0')), ElementsAre(Going{0, 1, 100, 600ms})) << "also on the way";
  EXPECT_FALSE(keys.take_stop());
}

TEST_F(HeldKeys, AnyOtherKeyStopsAtOnce) {
  for (const auto key : {letter(' '), letter('x'), Key{}, letter('\x1b')}) {
    press(right);
    ASSERT_FALSE(keys.take_stop());
    EXPECT_THAT(going_with(key), IsEmpty());
    EXPECT_TRUE(keys.take_stop());
    EXPECT_FALSE(keys.take_stop()) << "once";
  }
  EXPECT_FALSE(keys.has_ended());
}

TEST_F(HeldKeys, AKeyOfNoAxisStops) {
  JogKeys one(1);
  one.look({right}, now);
  one.look({up}, now);
  EXPECT_TRUE(one.take_stop());
  EXPECT_THAT(one.take_going(now), IsEmpty());
}

TEST_F(HeldKeys, AKeyThatCameAfterAStopInOneLookMovesAgain) {
  keys.look({right, letter(' '), left}, now);
  EXPECT_TRUE(keys.take_stop()) << "first";
  EXPECT_THAT(keys.take_going(now), ElementsAre(Going{0, -1, 100, 600ms}));
}

TEST_F(HeldKeys, QEndsIt) {
  press(right);
  EXPECT_THAT(going_with(letter('q')), IsEmpty());
  EXPECT_TRUE(keys.take_stop());
  EXPECT_TRUE(keys.has_ended());
}

TEST_F(HeldKeys, ArrowsThatWaitedForALookMoveNothing) {
  pass(100ms);
  now += 2s;
  EXPECT_THAT(going_with(right), IsEmpty());
  EXPECT_THAT(going_with(right), ElementsAre(Going{0, 1, 100, 600ms}));
  now += 2s;
  EXPECT_THAT(going_with(letter(' ')), IsEmpty());
  EXPECT_TRUE(keys.take_stop()) << "a stop is never stale";
}

TEST_F(HeldKeys, StepsAreOneForEachPress) {
  keys.look({letter('\t'), letter('-'), letter('-')}, now);
  EXPECT_TRUE(keys.makes_steps());
  EXPECT_EQ(keys.step_power(), -2);
  press(right);
  pass(500ms);
  for (int i = 0; i < 20; ++i, pass(30ms)) press(right);
  EXPECT_THAT(keys.take_steps(), ElementsAre(Step{0, 1}));
  EXPECT_EQ(told_until, tmcl::TimePoint{}) << "nothing goes on";
  pass(1s);
  press(left);
  EXPECT_THAT(keys.take_steps(), ElementsAre(Step{0, -1}));
}

TEST_F(HeldKeys, StepsHaveBounds) {
  for (int i = 0; i < 20; ++i) press(letter('+'));
  EXPECT_EQ(keys.step_power(), 4);
  for (int i = 0; i < 20; ++i) press(letter('-'));
  EXPECT_EQ(keys.step_power(), -4);
}

Key release_of(Key key) {
  key.is_release = true;
  return key;
}

TEST_F(HeldKeys, AReleaseStopsItsAxisAtOnceAndNoOther) {
  press(right);
  press(up);
  pass(100ms);
  keys.look({release_of(right)}, now);
  EXPECT_THAT(keys.take_released(), ElementsAre(0U));
  EXPECT_THAT(keys.take_released(), IsEmpty()) << "once";
  EXPECT_FALSE(keys.take_stop());
  pass(400ms);
  EXPECT_THAT(going_with(up), ElementsAre(Going{1, 1, 100, 150ms})) << "a repeat: it goes on";
}

TEST_F(HeldKeys, APressBehindAReleaseIsANewOne) {
  press(right);
  pass(100ms);
  keys.look({release_of(right)}, now);
  EXPECT_THAT(going_with(right), ElementsAre(Going{0, 1, 100, 600ms}));
}

TEST_F(HeldKeys, TheReleaseOfAnotherKeyEndsNothing) {
  press(right);
  press(left);
  for (const auto key : {right, page_down, letter('x')}) keys.look({release_of(key)}, now);
  EXPECT_THAT(keys.take_released(), IsEmpty()) << "it turns to the left by now";
  EXPECT_FALSE(keys.take_stop());
}

TEST_F(HeldKeys, APressWhoseReleaseIsReadAlongWithItMovesNothing) {
  keys.look({right, release_of(right)}, now);
  EXPECT_THAT(keys.take_going(now), IsEmpty());
  EXPECT_THAT(keys.take_released(), IsEmpty());
}

TEST_F(HeldKeys, AReleaseIsNeverStale) {
  press(right);
  now += 2s;
  keys.look({release_of(right)}, now);
  EXPECT_THAT(keys.take_released(), ElementsAre(0U));
}

TEST_F(HeldKeys, EachPressIsAStepWhereReleasesAreReported) {
  press(letter('\t'));
  for (int i = 0; i < 3; ++i, pass(50ms)) keys.look({right, release_of(right)}, now);
  EXPECT_THAT(keys.take_steps(), ElementsAre(Step{0, 1}, Step{0, 1}, Step{0, 1}));
}

class CtlJog : public testing::Test, public test::CtlBench {};

TEST_F(CtlJog, NeedsATerminal) {
  EXPECT_EQ(run({"jog", "x"}), ExitCode::usage);
  EXPECT_THAT(err, testing::HasSubstr("needs a terminal"));
}

TEST_F(CtlJog, IsOfOneToThreeAxes) {
  EXPECT_EQ(run({"jog"}), ExitCode::usage);
  EXPECT_EQ(run({"jog", "x", "y", "z", "a"}), ExitCode::usage);
  EXPECT_THAT(err, testing::HasSubstr("one to three"));
}

}  // namespace
}  // namespace tmclctl
