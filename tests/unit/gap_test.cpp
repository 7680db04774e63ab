// The reactor stands still for a while. What was asked for before the end of that moves nothing.
#include <gmock/gmock.h>

#include "gateway/authority/gaps.hpp"
#include "unit/virtual_gateway.hpp"

namespace tmcld::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr tmcl::Duration awake{};

TEST(Gaps, AreLongerThanASecond) {
  Gaps gaps;
  const auto begin = tmcl::TimePoint(seconds(100));
  gaps.look(begin, awake);
  gaps.look(begin + seconds(1), awake);
  EXPECT_FALSE(gaps.is_in_gap());
  EXPECT_LT(gaps.last_stale(), 1U);
  gaps.look(begin + seconds(2) + milliseconds(1), awake);
  EXPECT_TRUE(gaps.is_in_gap());
  EXPECT_GE(gaps.last_stale(), 1'000U);
  gaps.end(7);
  EXPECT_FALSE(gaps.is_in_gap());
  EXPECT_EQ(gaps.last_stale(), 7U);
  EXPECT_TRUE(gaps.is_stale(begin + seconds(2)));
  EXPECT_FALSE(gaps.is_stale(begin + seconds(2) + milliseconds(1)));
}

TEST(Gaps, DoNotBeginBeforeTheFirstLook) {
  Gaps gaps;
  gaps.look(tmcl::TimePoint(std::chrono::hours(1)), awake);
  EXPECT_FALSE(gaps.is_in_gap());
}

TEST(Gaps, AreSleepOfTheComputer) {
  Gaps gaps;
  const auto begin = tmcl::TimePoint(seconds(100));
  constexpr tmcl::Duration before = std::chrono::hours(7);
  gaps.look(begin, before);
  EXPECT_FALSE(gaps.is_in_gap());
  gaps.look(begin + milliseconds(200), before + milliseconds(800));
  EXPECT_FALSE(gaps.is_in_gap());
  gaps.look(begin + milliseconds(400), before + seconds(2));
  EXPECT_TRUE(gaps.is_in_gap());
  EXPECT_EQ(gaps.duration(), milliseconds(1'400));
}

class Gap : public testing::Test {
 protected:
  static json::object move(std::int64_t target) {
    return {{"axis", "x"}, {"position_microsteps", target}, {"predict", false}};
  }
  json::object sent_at(json::object params, tmcl::TimePoint at) const {
    const auto ms = std::chrono::floor<milliseconds>(at.time_since_epoch());
    params["sent_at_ms"] = ms.count();
    return params;
  }
  static std::string name_of_error(const Result<boost::json::object>& result) {
    return result ? "" : result.error().name;
  }
  std::size_t movements() const {
    return gateway.wire.count(tmcl::Command::MVP) + gateway.wire.count(tmcl::Command::ROR);
  }

  VirtualGateway gateway;
};

TEST_F(Gap, MakesStaleWhatComesInRightBehindIt) {
  gateway.time.freeze_for(seconds(2));
  const auto refused = gateway.call("axis.move_to", move(100));
  EXPECT_EQ(name_of_error(refused), "stale_request");
  EXPECT_EQ(refused.error().kind, ErrorKind::not_now);
  EXPECT_EQ(refused.error().outcome, tmcl::Outcome::not_sent);
  EXPECT_THAT(refused.error().message, testing::HasSubstr("stood still for 2."));
  EXPECT_EQ(movements(), 0U);
}

TEST_F(Gap, IsTheSleepOfTheComputer) {
  gateway.let_computer_sleep(std::chrono::hours(1));
  EXPECT_EQ(name_of_error(gateway.call("axis.move_to", move(100))), "stale_request");
  EXPECT_EQ(movements(), 0U);
  gateway.time.run_for(milliseconds(300));
  EXPECT_TRUE(gateway.call("axis.move_to", move(100)));
}

TEST_F(Gap, IsOverWhenThatHasBeenTakenIn) {
  gateway.time.freeze_for(seconds(2));
  gateway.time.run_for(milliseconds(100));
  EXPECT_TRUE(gateway.call("axis.move_to", move(100)));
  EXPECT_EQ(movements(), 1U);
}

TEST_F(Gap, HoldsNoStopAndNoReadingBack) {
  gateway.time.freeze_for(seconds(2));
  EXPECT_TRUE(gateway.call("axis.stop", {{"axis", "x"}}));
  EXPECT_TRUE(gateway.call("axis.get_state", {{"axis", "x"}}));
}

TEST_F(Gap, OfLessThanASecondIsNone) {
  gateway.time.freeze_for(milliseconds(700));
  EXPECT_TRUE(gateway.call("axis.move_to", move(100)));
}

TEST_F(Gap, MakesStaleWhatItsSenderSaysIsFromBefore) {
  const auto before = gateway.time.now();
  gateway.time.freeze_for(seconds(2));
  gateway.time.run_for(seconds(5));
  for (const auto* method : {"axis.move_to", "parameter.set"}) {
    auto params = sent_at(move(100), before);
    if (method == std::string("parameter.set"))
      params = sent_at({{"axis", "x"}, {"parameter", 5}, {"value", 1}}, before);
    EXPECT_EQ(name_of_error(gateway.call(method, params)), "stale_request");
  }
  EXPECT_EQ(movements(), 0U);
  EXPECT_TRUE(gateway.call("axis.stop", sent_at({{"axis", "x"}}, before)));
  EXPECT_TRUE(gateway.call("axis.get_state", sent_at({{"axis", "x"}}, before)));
}

TEST_F(Gap, OrNotADeadlineCountsFromWhenACallWasSent) {
  auto params = move(100);
  params["deadline_ms"] = 1000;
  const auto long_ago = gateway.time.now() - milliseconds(1001);
  EXPECT_EQ(name_of_error(gateway.call("axis.move_to", sent_at(params, long_ago))),
            "deadline_passed");
  const auto lately = gateway.time.now() - milliseconds(500);
  EXPECT_TRUE(gateway.call("axis.move_to", sent_at(params, lately)));
  // By a clock that is wrong.
  const auto later = gateway.time.now() + std::chrono::hours(1);
  EXPECT_TRUE(gateway.call("axis.move_to", sent_at(params, later)));
  EXPECT_EQ(movements(), 2U);
}

}  // namespace
}  // namespace tmcld::test
