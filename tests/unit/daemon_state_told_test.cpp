// What a subscription tells of an axis that stands: also what tmcld alone knows of it.
#include <gmock/gmock.h>

#include "unit/journey_bench.hpp"

namespace tmcld::test {
namespace {

using testing::SizeIs;

struct StateTold : testing::Test {
  StateTold() {
    for (const auto* axes : {"x", "y"})
      bench.call("subscribe", {{"axes", json::array{axes}}, {"interval_ms", 100}}).value();
    told();
  }
  /// Of x, which has stood.
  std::vector<json::object> told() {
    bench.time.run_for(std::chrono::seconds(2));
    auto states = bench.states();
    std::erase_if(states, [](const json::object& state) { return state.at("axis") != "x"; });
    return states;
  }
  json::object do_and_hear(const char* method, json::object params) {
    const auto done = bench.call(method, std::move(params));
    EXPECT_TRUE(done) << method << ": " << done.error().message;
    auto states = told();
    EXPECT_THAT(states, SizeIs(1)) << method;
    return states.empty() ? json::object{} : states.back();
  }

  JourneyBench bench;
};

TEST_F(StateTold, IsNotToldAgainWhereNothingChanges) { EXPECT_THAT(told(), SizeIs(0)); }

TEST_F(StateTold, OfItsLease) {
  const auto lease =
      bench.call("lease.acquire", {{"axes", json::array{"x"}}, {"ttl_ms", 60'000}}).value();
  const auto held = told();
  ASSERT_THAT(held, SizeIs(1));
  EXPECT_EQ(held[0].at("lease"), lease.at("lease"));
  const auto free =
      do_and_hear("lease.release", {{"lease", lease.at("lease")}, {"epoch", lease.at("epoch")}});
  EXPECT_TRUE(free.at("lease").is_null());
  EXPECT_EQ(free.at("seq").to_number<int>(), held[0].at("seq").to_number<int>() + 1);
}

TEST_F(StateTold, OfAStopWhereItStands) {
  const auto first = do_and_hear("axis.stop", {{"axis", "x"}}).at("last_stop").to_number<int>();
  EXPECT_GT(do_and_hear("axis.stop", {{"axis", "x"}}).at("last_stop").to_number<int>(), first);
}

TEST_F(StateTold, OfAModuleThatHasStartedAgain) {
  EXPECT_EQ(do_and_hear("module.reset", {{"bus", "line"}, {"address", 1}}).at("latched"), true);
  EXPECT_EQ(do_and_hear("axis.recover", {{"axis", "x"}}).at("latched"), false);
}

TEST_F(StateTold, OfItsReference) {
  const auto there =
      do_and_hear("parameter.set", {{"axis", "x"}, {"parameter", "actual_position"}, {"value", 0}});
  EXPECT_EQ(there.at("referenced"), true);
}

}  // namespace
}  // namespace tmcld::test
