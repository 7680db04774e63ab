// What a reference search has found, and what is sent to a position before one has.
#include <gmock/gmock.h>

#include <string>

#include "sim/module/event_sink.hpp"
#include "world/cable.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using tmcl::Command;
using tmcl::sim::StageSettings;

std::string required() {
  std::string config = cable_config;
  const std::string before = "motor = 0\n";
  return config.insert(config.find(before), "reference = \"required\"\n");
}

class References : public Cable, public testing::WithParamInterface<const char*> {
 protected:
  References() : Cable(required(), GetParam()) {
    module.mount(0, StageSettings{.left_switch = -30'000});
    wire.on_request = [this](const tmcl::Request& request) { last = request; };
  }
  static json::object x(json::object more = {}) {
    more["axis"] = "x";
    return more;
  }
  void other_master_stops() { other_master({tmcl::ModuleAddress{1}, Command::MST, 0, 0, 0}); }
  bool is_referenced() { return call("axis.get_state", x())->at("referenced").as_bool(); }
  std::string move() { return name_of_error(call("axis.move_to", x({{"position", 1}}))); }
  /// To where a search takes a while, whatever speed it has.
  void go_away() {
    EXPECT_TRUE(call("axis.move_by", x({{"distance", 20}})));
    EXPECT_TRUE(call("axis.wait", x()));
  }
  void expect_in_vain(const Result<boost::json::object>& homed) {
    ASSERT_FALSE(homed);
    EXPECT_EQ(name_of_error(homed), "move_interrupted");
    EXPECT_EQ(homed.error().outcome, tmcl::Outcome::done);
    EXPECT_THAT(homed.error().message, HasSubstr("has found no reference"));
    EXPECT_FALSE(is_referenced());
    EXPECT_EQ(move(), "latched");
  }

  tmcl::Request last{};
};

TEST_P(References, AreFoundBySearchesThatEndAtZero) {
  EXPECT_EQ(move(), "latched");
  const auto homed = call("axis.home", x());
  ASSERT_TRUE(homed) << homed.error().message;
  EXPECT_TRUE(is_referenced());
  EXPECT_EQ(move(), "none");
}

TEST_P(References, AreNotFoundBySearchesThatSomebodyElseStops) {
  go_away();
  const auto home = begin("axis.home", x());
  time.run_for(100ms);
  other_master_stops();
  expect_in_vain(end(home));
}

TEST_P(References, AreLostWhenAnotherSearchEndsInVain) {
  ASSERT_TRUE(call("axis.home", x()));
  go_away();
  const auto home = begin("axis.home", x());
  time.run_for(100ms);
  EXPECT_FALSE(is_referenced()) << "it may count from somewhere else already";
  other_master_stops();
  expect_in_vain(end(home));
}

TEST_P(References, AreFoundBySearchesThatNobodyWaitsFor) {
  ASSERT_TRUE(call("axis.start_home", x()));
  time.run_for(60s);
  EXPECT_EQ(move(), "none");
  EXPECT_TRUE(is_referenced());
}

TEST_P(References, AreNotFoundBySearchesThatAreStoppedAndNobodyWaitsFor) {
  go_away();
  ASSERT_TRUE(call("axis.start_home", x()));
  time.run_for(100ms);
  other_master_stops();
  time.run_for(1s);
  EXPECT_EQ(move(), "latched");
  EXPECT_EQ(name_of_error(call("axis.move_by", x({{"distance", 1}}))), "none");
  EXPECT_FALSE(is_referenced());
}

TEST_P(References, AreFoundForTheOneWhoWaitsAlsoIfAnotherMovesTheAxisAtOnce) {
  const auto home = begin("axis.home", x());
  auto moved = move();
  while (moved == "axis_claimed") {
    time.run_for(1ms);
    moved = move();
  }
  EXPECT_EQ(moved, "none");
  EXPECT_TRUE(end(home));
}

INSTANTIATE_TEST_SUITE_P(By, References, testing::Values("TMCM-6212", "TMCM-3110", "TMCM-6110"),
                         [](const auto& one) { return "Model" + std::string(one.param + 5); });

}  // namespace
}  // namespace tmcld::test
