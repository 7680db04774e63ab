// A driver that is off, or a supply that fails: who is told, and what an arrival is worth then.
#include <gmock/gmock.h>

#include <cmath>
#include <string>
#include <utility>

#include "fronts/metrics.hpp"
#include "world/cable.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using tmcl::sim::DriverFault;

class DriverFaults : public Cable, public testing::WithParamInterface<const char*> {
 protected:
  DriverFaults() : Cable(cable_config, GetParam()) {}
  void set(DriverFault fault, bool on = true) {
    module.at_stage(0, [&](tmcl::sim::Stage& stage) { stage.set_fault(fault, on); });
    wire.touch();
  }
  /// Some tenths of a turn in a second.
  void turn_slowly() {
    const auto speed = std::string_view(GetParam()) == "TMCM-6212" ? 5'000 : 20;
    call("parameter.set", {{"axis", "x"}, {"parameter", 4}, {"value", speed}});
  }
  /// Its state when it does.
  json::object turn_by(int velocity) {
    const auto turning = call("axis.rotate", {{"axis", "x"}, {"velocity_internal", velocity}});
    EXPECT_TRUE(turning) << turning.error().message;
    time.run_for(20s);
    auto state = call("axis.get_state", {{"axis", "x"}}).value();
    EXPECT_EQ(state.at("velocity_internal").as_int64(), velocity);
    return state;
  }
  Result<boost::json::object> move_and_wait() {
    position_ = position_ == 1 ? 2 : 1;
    EXPECT_TRUE(call("axis.move_to", {{"axis", "x"}, {"position", position_}}));
    return call("axis.wait", {{"axis", "x"}});
  }
  json::array faults() {
    time.run_for(1s);
    return call("axis.get_state", {{"axis", "x"}})->at("faults").as_array();
  }
  void expect_fault(const std::string& name, const std::string& words) {
    const auto arrived = move_and_wait();
    ASSERT_FALSE(arrived) << name;
    EXPECT_EQ(name_of_error(arrived), "driver_fault");
    EXPECT_THAT(arrived.error().message, HasSubstr("by its counter"));
    EXPECT_THAT(arrived.error().message, HasSubstr(words));
    EXPECT_EQ(arrived.error().outcome, tmcl::Outcome::done);
    EXPECT_EQ(arrived.error().subject.at("faults").as_array().at(0), json::value(name));
    EXPECT_EQ(faults().at(0), json::value(name));
    const auto listed = call("axis.list", {})->at("axes").as_array();
    EXPECT_EQ(listed.at(0).at("faults").as_array().at(0), json::value(name));
    EXPECT_THAT(events, testing::Contains("axis_fault"));
    const auto errors = call("axis.get_errors", {{"axis", "x"}});
    EXPECT_THAT(json::serialize(errors->at("flags")), HasSubstr(name));
    EXPECT_THAT(metrics(), HasSubstr("tmcl_axis_fault{axis=\"x\",bus=\"bench\"} 1\n"));
    EXPECT_THAT(metrics(), HasSubstr("tmcl_axis_fault{axis=\"y\",bus=\"bench\"} 0\n"));
  }

  std::string metrics() { return metrics_text(gateway(), {}, {}, 0); }

 private:
  int position_ = 0;
};

TEST_P(DriverFaults, AreNoneWhereAllIsWell) {
  EXPECT_TRUE(move_and_wait());
  EXPECT_TRUE(faults().empty());
  EXPECT_THAT(events, testing::Not(testing::Contains("axis_fault")));
  EXPECT_THAT(metrics(), HasSubstr("tmcl_axis_fault{axis=\"x\",bus=\"bench\"} 0\n"));
}

TEST_P(DriverFaults, EndAWaitWithTheirName) {
  set(DriverFault::short_a);
  expect_fault("short_to_ground_a", "short to ground of coil A");
}

TEST_P(DriverFaults, OfACoilThatIsNotConnectedDoSoToo) {
  turn_slowly();
  set(DriverFault::open_load_b);
  expect_fault("open_load_b", "coil B is not connected");
  set(DriverFault::open_load_b, false);
  EXPECT_TRUE(faults().empty());
  EXPECT_TRUE(move_and_wait());
}

void expect_doubt(const Result<boost::json::object>& arrived) {
  ASSERT_TRUE(arrived) << arrived.error().message;
  EXPECT_THAT(json::serialize(arrived->at("warnings")), HasSubstr("coil B is not connected"));
  EXPECT_THAT(json::serialize(arrived->at("warnings")), HasSubstr("turns slowly"));
}

TEST_P(DriverFaults, AreNoneWhereAnOpenLoadIsSeenAtStandstillOnly) {
  turn_slowly();
  for (int i = 0; i < 3; ++i) {
    set(DriverFault::open_load_b, false);
    EXPECT_TRUE(call("axis.move_to", {{"axis", "x"}, {"position", i}}));
    time.run_for(20s);
    set(DriverFault::open_load_b);
    expect_doubt(call("axis.wait", {{"axis", "x"}}));
    EXPECT_TRUE(faults().empty());
  }
  const auto errors = call("axis.get_errors", {{"axis", "x"}});
  EXPECT_EQ(json::serialize(errors->at("flags")), "[]");
  EXPECT_EQ(json::serialize(errors->at("unproven")), R"(["open_load_b"])");
  EXPECT_THAT(events, testing::Not(testing::Contains("axis_fault")));
}

/// From 4 full steps a second on, and up to 400: at the speeds of the module that are nearest.
TEST_P(DriverFaults, OfACoilThatIsNotConnectedAreBelievedAtSlowSpeedsOnly) {
  constexpr int resolution = 4;
  call("parameter.set", {{"axis", "x"}, {"parameter", 140}, {"value", resolution}});
  const auto state = turn_by(100);
  const double full_step = std::exp2(resolution) *
                           state.at("velocity_internal").to_number<double>() /
                           state.at("velocity_pps").to_number<double>();
  const auto slowest = static_cast<int>(std::ceil(4 * full_step));
  const auto fastest = static_cast<int>(std::floor(400 * full_step));
  for (const auto& [velocity, is_told] :
       {std::pair(slowest - 1, false), {slowest, true}, {fastest, true}, {fastest + 1, false}}) {
    for (const int way : {1, -1}) {
      turn_by(way * velocity);
      set(DriverFault::open_load_b);
      faults();
      faults();
      EXPECT_EQ(!faults().empty(), is_told) << way * velocity << ", of " << full_step;
      set(DriverFault::open_load_b, false);
      EXPECT_TRUE(faults().empty());
    }
  }
}

TEST_P(DriverFaults, OfTheSupplyDoSoToo) {
  module.set_supply(60);
  expect_fault("undervoltage", "its supply is too low");
  module.set_supply(240);
  EXPECT_TRUE(faults().empty()) << "it is back";
  EXPECT_GE(std::ranges::count(events, "axis_fault"), 2);
  EXPECT_TRUE(move_and_wait());
}

TEST_P(DriverFaults, ThatAreOnlyNearAreAWarning) {
  set(DriverFault::overtemperature_warning);
  const auto arrived = move_and_wait();
  ASSERT_TRUE(arrived) << arrived.error().message;
  EXPECT_THAT(json::serialize(arrived->at("warnings")), HasSubstr("nearly too hot"));
}

TEST_P(DriverFaults, AreSeenByWhoLooksAtAnAxisThatStands) {
  EXPECT_TRUE(faults().empty());
  set(DriverFault::short_b);
  EXPECT_EQ(faults().at(0), "short_to_ground_b");
}

INSTANTIATE_TEST_SUITE_P(Of, DriverFaults, testing::Values("TMCM-6212", "TMCM-3110", "TMCM-1140"),
                         [](const auto& one) { return "Model" + std::string(one.param + 5); });

}  // namespace
}  // namespace tmcld::test
