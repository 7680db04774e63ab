// axis.get_state with an age: what somebody has just read is not read again, unless it may be
// wrong by now.
#include <gmock/gmock.h>

#include "unit/virtual_gateway.hpp"

namespace tmcld::test {
namespace {

using std::chrono::milliseconds;

class StateByAge : public testing::Test {
 protected:
  json::object state(std::int64_t max_age_ms) {
    return *gateway.call("axis.get_state", {{"axis", "x"}, {"max_age_ms", max_age_ms}});
  }
  /// How many requests there are while the function runs.
  template <class Function>
  std::size_t requests(Function function) {
    const auto before = gateway.wire.seen.size();
    function();
    return gateway.wire.seen.size() - before;
  }

  VirtualGateway gateway;
};

TEST_F(StateByAge, IsAnsweredWithoutTheBusWhileItIsYoung) {
  state(0);
  gateway.time.run_for(milliseconds(100));
  EXPECT_EQ(requests([&] { EXPECT_GE(state(200).at("age_ms").as_int64(), 100); }), 0U);
  EXPECT_GT(requests([&] { EXPECT_LT(state(50).at("age_ms").as_int64(), 50); }), 0U);
  EXPECT_GT(requests([&] { gateway.call("axis.get_state", {{"axis", "x"}}); }), 0U);
}

TEST_F(StateByAge, IsReadAnewBehindACommand) {
  state(0);
  gateway.call("axis.move_to", {{"axis", "x"}, {"position_microsteps", 77}, {"predict", false}});
  EXPECT_EQ(state(60'000).at("target_microsteps"), 77);
  gateway.call("axis.stop", {{"axis", "x"}});
  EXPECT_GT(requests([&] { state(60'000); }), 0U);
  EXPECT_EQ(requests([&] { state(60'000); }), 0U);
}

TEST_F(StateByAge, TellsOfEachStopAlsoOfAnAxisThatStands) {
  const auto last_stop = [&] { return state(0).at("last_stop").to_number<std::uint64_t>(); };
  const auto at_first = last_stop();
  gateway.call("axis.move_to", {{"axis", "x"}, {"position_microsteps", 77}, {"predict", false}});
  EXPECT_EQ(last_stop(), at_first);
  gateway.call("axis.stop", {{"axis", "x"}});
  const auto stopped = last_stop();
  EXPECT_GT(stopped, at_first);
  EXPECT_EQ(last_stop(), stopped);
  gateway.call("system.stop_all", {});
  EXPECT_GT(last_stop(), stopped);
}

TEST_F(StateByAge, IsReadAnewBehindALostLink) {
  state(0);
  gateway.wire.unplug();
  gateway.time.run_for(std::chrono::seconds(2));
  EXPECT_GT(requests([&] { state(60'000); }), 0U);
}

TEST_F(StateByAge, IsReadOnceForAllWhoAskAtOnce) {
  gateway.wire.modules.at(1).parameter(0, tmcl::axis_parameter::actual_velocity) = 0;
  const auto alone = requests([&] { state(0); });
  gateway.time.run_for(std::chrono::seconds(1));
  const auto together = requests([&] {
    const auto answers =
        gateway.call_together(100, "axis.get_state", {{"axis", "x"}, {"max_age_ms", 500}});
    for (const auto& answer : answers) EXPECT_TRUE(answer.has_value());
  });
  EXPECT_EQ(together, alone);
}

// Else one client who asks for all at once, and again, takes up the whole queue of a bus.
TEST_F(StateByAge, IsReadTwiceAtMostForAllWhoWantItAsItIsNow) {
  const auto alone = requests([&] { state(0); });
  gateway.time.run_for(std::chrono::seconds(1));
  const auto together = requests([&] {
    const auto answers = gateway.call_together(1000, "axis.get_state", {{"axis", "x"}});
    for (const auto& answer : answers) EXPECT_TRUE(answer.has_value());
  });
  EXPECT_LE(together, 2 * alone);
}

TEST_F(StateByAge, IsOfALookThatBeganAfterItWasAskedFor) {
  gateway.wire.delay = milliseconds(5);
  auto& position = gateway.wire.modules.at(1).parameter(0, tmcl::axis_parameter::actual_position);
  const auto before = position;
  std::vector<Result<boost::json::object>> first;
  gateway.begin_call("axis.get_state", {{"axis", "x"}}, first);
  const auto is_read = [&] {
    const auto& last = gateway.wire.seen.back();
    return last.command == tmcl::Command::GAP && last.type == tmcl::axis_parameter::actual_position;
  };
  ASSERT_TRUE(gateway.time.run_while_not(is_read, std::chrono::seconds(1)));
  gateway.time.run_for(milliseconds(6));
  ASSERT_TRUE(first.empty());
  ++position;
  EXPECT_EQ(state(0).at("position_microsteps"), before + 1);
  ASSERT_EQ(first.size(), 1U);
  EXPECT_EQ(first.front()->at("position_microsteps"), before);
}

}  // namespace
}  // namespace tmcld::test
