// A cable that is out for a while as axes are on their way along a path or a line: whatever could
// not be stopped is when the cable is back, and nobody is told otherwise.
#include <gmock/gmock.h>

#include <string>
#include <vector>

#include <boost/json/serialize.hpp>

#include "support/random.hpp"
#include "support/rounds.hpp"
#include "support/seed.hpp"
#include "world/cable.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

TEST_F(Cable, OutForTwoSecondsOnAPathStopsItsAxesWhenItIsBack) {
  const auto path = begin_path();
  wire.is_cut = true;
  const auto back = time.now() + 2s;
  const auto result = end(path);
  ASSERT_LT(time.now(), back) << "who asked is not kept waiting";
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().outcome, tmcl::Outcome::unknown) << result.error().message;
  EXPECT_EQ(json::serialize(result.error().subject.at("unstopped")), R"(["x","y"])");
  EXPECT_THAT(result.error().message, HasSubstr("may still move"));
  EXPECT_THAT(json::serialize(to_json(result.error())), Not(HasSubstr("were stopped")));
  time.run_until(back);
  EXPECT_TRUE(moves());
  EXPECT_TRUE(stopped.empty());
  wire.is_cut = false;
  EXPECT_LT(time_to_stand(), 1200ms);
  time.run_for(1s);
  EXPECT_THAT(stopped, testing::UnorderedElementsAre(testing::StartsWith("axis 'x' stands now"),
                                                     testing::StartsWith("axis 'y' stands now")));
  EXPECT_TRUE(call("axis.move_to", {{"axis", "x"}, {"position_microsteps", 0}}));
}

TEST_F(Cable, OutForAMinuteKeepsOthersFromMovingTheAxesUntilTheyStand) {
  const auto path = begin_path();
  wire.is_cut = true;
  end(path);
  time.run_for(60s);
  wire.is_cut = false;
  // The module answers again before its axes have been stopped.
  ASSERT_TRUE(time.run_while_not([&] { return !stopped.empty() || !moves(); }, 10s));
  std::vector<std::string> errors;
  while (stopped.size() < 2) {
    const std::size_t before = stopped.size();
    const auto move = call("axis.move_to", {{"axis", "y"}, {"position_microsteps", 0}});
    if (stopped.size() == before && before == 0) errors.push_back(name_of_error(move));
    time.run_for(1ms);
  }
  for (const auto& error : errors)
    EXPECT_THAT(error, testing::AnyOf("axis_claimed", "module_silent"));
}

TEST_F(Cable, WhateverIsSaidOfAxesThatWereStoppedIsTrue) {
  const auto seed = tmcl::test::seed();
  tmcl::test::Random<int> random(seed);
  for (int round = 0; round < tmcl::test::rounds(4) && !HasFailure(); ++round) {
    SCOPED_TRACE("TMCL_SEED=" + std::to_string(seed) + ", round " + std::to_string(round));
    for (const char* axis : {"x", "y"})
      call("axis.move_to", {{"axis", axis}, {"position_microsteps", 0}});
    time.run_for(100s);
    stopped.clear();
    const auto path = begin_path();
    time.run_for(std::chrono::microseconds(random.between(0, 20'000)));
    wire.is_cut = true;
    const auto back = time.now() + std::chrono::milliseconds(random.any_size(3'000));
    const auto look = [&] {
      if (time.now() >= back) wire.is_cut = false;
      return path->has_value();
    };
    while (!look()) time.run_for(1ms);
    const auto& result = **path;
    // A moment that nobody noticed.
    if (result) {
      EXPECT_FALSE(moves());
      continue;
    }
    const bool all_stand = !result.error().subject.contains("unstopped");
    EXPECT_FALSE(all_stand && moves()) << json::serialize(result.error().subject);
    EXPECT_EQ(result.error().outcome, all_stand ? tmcl::Outcome::done : tmcl::Outcome::unknown);
    time.run_until(back);
    wire.is_cut = false;
    EXPECT_LT(time_to_stand(), 1200ms);
    time.run_for(2s);
    EXPECT_EQ(stopped.size(),
              all_stand ? 0U : result.error().subject.at("unstopped").as_array().size());
  }
}

// What a stop has kept from turning must not take the next one's client away.
TEST_F(Cable, WhatTurnsAfterAStopStillStopsWhenItsClientLeaves) {
  const json::object turning{{"axis", "x"}, {"velocity", 5}};
  time.run_for(1s);
  wire.is_cut = true;
  const auto first = begin("axis.rotate", turning);
  time.run_for(10ms);
  wire.is_cut = false;
  const auto stop = begin("axis.stop", {{"axis", "x"}});
  const auto second = begin("axis.rotate", turning);
  EXPECT_EQ(name_of_error(end(first)), "superseded_by_stop");
  EXPECT_TRUE(end(stop));
  EXPECT_TRUE(end(second));
  time.run_for(1s);
  EXPECT_TRUE(moves());
  client_leaves();
  time.run_for(1s);
  EXPECT_FALSE(moves());
}

}  // namespace
}  // namespace tmcld::test
