// Who may move which motor of a bus.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gateway/authority/motors.hpp"

namespace tmcld::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using tmcl::AxisAddress;
using tmcl::Command;
using tmcl::Request;

constexpr tmcl::ModuleAddress one{1};
constexpr AxisAddress x{one, 0};
constexpr AxisAddress y{one, 1};
constexpr AxisAddress nobodys{one, 4};

constexpr Request move_x{one, Command::MVP, 0, 0, 5};
constexpr Request move_y{one, Command::MVP, 0, 1, 5};
constexpr Request move_nobodys{one, Command::ROR, 0, 4, 5};
constexpr Request move_both{one, Command::MVP, 2, 0x83, 1};
constexpr Request run_program{one, Command::RUN_APPLICATION, 0, 0, 0};
constexpr Request search_x{one, Command::RFS, 0, 0, 0};
constexpr Request end_search{one, Command::RFS, 1, 0, 0};
constexpr Request look_at_search{one, Command::RFS, 2, 0, 0};

class DaemonMotors : public testing::Test {
 protected:
  DaemonMotors() {
    motors.add(x, "x");
    motors.add(y, "y");
  }
  bool allows(const Request& request, Permit permit) const {
    return judged(request, permit).verdict.ruling == Ruling::allow;
  }
  Motors::Judgement judged(const Request& request, Permit permit) const {
    return motors.judge(request, permit, now);
  }
  void see(const Request& request, tmcl::Result<tmcl::Answer> answer) {
    motors.note(request, answer, motors.before(request, {}, nullptr));
  }
  static tmcl::Answer with_value(std::int32_t value) {
    tmcl::Answer answer;
    answer.reply.value = value;
    return answer;
  }
  static tmcl::Result<tmcl::Answer> failed(tmcl::Outcome outcome) {
    tmcl::Error error;
    error.outcome = outcome;
    return tl::unexpected(error);
  }

  const tmcl::TimePoint now{std::chrono::hours(1)};
  std::shared_ptr<Arrivals> arrivals = std::make_shared<Arrivals>();
  Motors motors{"bench", arrivals};
};

TEST_F(DaemonMotors, AStopEndsWhatWasAskedForBeforeIt) {
  const auto before = arrivals->admit();
  motors.stop(x);
  const auto behind = arrivals->admit();
  EXPECT_EQ(judged(move_x, before).verdict.because, Obstacle::stopped);
  EXPECT_EQ(motors.objection(x, before, now)->code, tmcl::Errc::superseded_by_stop);
  EXPECT_EQ(motors.objection(x, before, now)->outcome, tmcl::Outcome::not_sent);
  EXPECT_TRUE(allows(move_y, before));
  EXPECT_TRUE(allows(move_x, behind));
}

TEST_F(DaemonMotors, WhatMovesSeveralEndsWithTheStopOfOne) {
  const auto before = arrivals->admit();
  motors.stop(y);
  EXPECT_FALSE(allows(move_both, before));
  EXPECT_FALSE(allows(run_program, before));
  EXPECT_FALSE(allows({one, Command::RST, 0, 0, 0}, before));
  EXPECT_TRUE(allows({one, Command::MVP, 2, 0x85, 1}, before)) << "motors 0 and 2";
  EXPECT_TRUE(allows({tmcl::ModuleAddress{2}, Command::RUN_APPLICATION, 0, 0, 0}, before));
}

TEST_F(DaemonMotors, AMotorWithoutAnAxisIsStoppedAsWell) {
  const auto before = arrivals->admit();
  motors.stop(nobodys);
  EXPECT_FALSE(allows(move_nobodys, before));
  EXPECT_TRUE(allows(move_x, before));
}

TEST_F(DaemonMotors, StopsOfManyMotorsAreForgottenOnlyToTheSafeSide) {
  const auto before = arrivals->admit();
  motors.stop(nobodys);
  for (std::size_t i = 0; i < Motors::most_other_motors; ++i)
    motors.stop({tmcl::ModuleAddress{static_cast<std::uint16_t>(100 + i)}, 0});
  EXPECT_FALSE(allows(move_nobodys, before));
  EXPECT_FALSE(allows({tmcl::ModuleAddress{99}, Command::ROR, 0, 0, 1}, before));
  EXPECT_TRUE(allows(move_x, before));
  EXPECT_TRUE(allows(move_nobodys, arrivals->admit()));
}

TEST_F(DaemonMotors, AStopOfAllEndsEverythingThatWasAskedForBeforeIt) {
  const auto before = arrivals->admit();
  arrivals->stop_all();
  EXPECT_FALSE(allows(move_x, before));
  EXPECT_FALSE(allows(move_nobodys, before));
  EXPECT_TRUE(allows(move_x, arrivals->admit()));
}

TEST_F(DaemonMotors, NothingIsSetInMotionByNobodyOrAtTheEnd) {
  EXPECT_FALSE(allows(move_x, Permit{}));
  const auto call = arrivals->admit();
  arrivals->closing = true;
  EXPECT_EQ(judged(move_x, call).verdict.because, Obstacle::daemon_ends);
}

TEST_F(DaemonMotors, AClaimKeepsOthersAway) {
  const auto owner = arrivals->admit();
  const auto other = arrivals->admit();
  std::optional claim = motors.claim(y, {ClaimKind::line, owner});
  EXPECT_TRUE(allows(move_y, owner));
  EXPECT_FALSE(allows(move_y, other));
  EXPECT_FALSE(allows(move_both, other));
  EXPECT_FALSE(allows(run_program, other));
  EXPECT_TRUE(allows(move_x, other));
  EXPECT_EQ(motors.refusal(y, judged(move_y, other).verdict.because).message,
            "axis 'y' is on its way along a line");
  motors.release(y, other);
  EXPECT_FALSE(allows(move_y, other)) << "it is not theirs";
  std::optional elsewhere = std::move(claim);
  claim.reset();
  EXPECT_FALSE(allows(move_y, other)) << "it was handed on";
  elsewhere.reset();
  EXPECT_TRUE(allows(move_y, other));
}

TEST_F(DaemonMotors, AnswersTellWhenASearchIsOver) {
  const auto owner = arrivals->admit();
  const auto searches = [&] { return motors.claim_owner_of(x).by == ClaimKind::search; };
  const auto begin = [&] { motors.begin(search_x, owner); };
  begin();
  see(search_x, with_value(0));
  see(look_at_search, with_value(3));
  see(look_at_search, failed(tmcl::Outcome::unknown));
  see(search_x, failed(tmcl::Outcome::unknown));
  EXPECT_TRUE(searches());
  see(look_at_search, with_value(0));
  EXPECT_TRUE(searches()) << "whether it has found anything is to be seen first";
  see(end_search, with_value(0));
  EXPECT_FALSE(searches());
  begin();
  see(search_x, failed(tmcl::Outcome::refused));
  EXPECT_FALSE(searches());
}

TEST_F(DaemonMotors, AnAnswerFromBeforeTheSearchSaysNothingAboutIt) {
  const auto before = motors.before(look_at_search, {}, nullptr);
  motors.begin(search_x, arrivals->admit());
  motors.note(look_at_search, with_value(0), before);
  EXPECT_EQ(motors.claim_owner_of(x).by, ClaimKind::search);
}

TEST_F(DaemonMotors, KnowsWhatIsAboutToMoveBesidesTheAxes) {
  for (const auto& request : {move_x, move_nobodys, Request{one, Command::MVP, 2, 0x89, 1}})
    motors.begin(request, arrivals->admit());
  EXPECT_THAT(motors.others_that_may_move(), ElementsAre(AxisAddress{one, 3}, nobodys));
  motors.end(move_nobodys);
  motors.end({one, Command::MVP, 2, 0x89, 1});
  EXPECT_THAT(motors.others_that_may_move(), IsEmpty());
}

TEST_F(DaemonMotors, KnowsWhatHasMovedBesidesTheAxesUntilItIsStopped) {
  const Request stop_nobodys{nobodys.module, Command::MST, 0, nobodys.motor, 0};
  for (const auto& request : {move_x, move_nobodys}) see(request, with_value(0));
  EXPECT_THAT(motors.others_that_may_move(), ElementsAre(nobodys));
  see(stop_nobodys, failed(tmcl::Outcome::unknown));
  EXPECT_THAT(motors.others_that_may_move(), ElementsAre(nobodys));
  see(stop_nobodys, with_value(0));
  EXPECT_THAT(motors.others_that_may_move(), IsEmpty());
  see(move_nobodys, failed(tmcl::Outcome::not_sent));
  EXPECT_THAT(motors.others_that_may_move(), IsEmpty());
  see(move_nobodys, failed(tmcl::Outcome::unknown));
  motors.add(nobodys, "z");
  EXPECT_THAT(motors.others_that_may_move(), IsEmpty());
}

TEST_F(DaemonMotors, AnAxisThatIsAddedHasBeenStoppedWithTheOthers) {
  const auto before = arrivals->admit();
  for (std::uint8_t motor = 0; motor < 255; ++motor)
    for (const auto module : {std::uint16_t{10}, std::uint16_t{11}})
      motors.stop({tmcl::ModuleAddress{module}, motor});
  motors.add(nobodys, "z");
  EXPECT_TRUE(motors.objection(nobodys, before, now));
  EXPECT_FALSE(motors.objection(nobodys, arrivals->admit(), now));
}

}  // namespace
}  // namespace tmcld::test
