// Why an axis stands that was on its way: what is said of it, to whom, and when.
#include <gmock/gmock.h>

#include <string>

#include "sim/module/event_sink.hpp"
#include "support/no_events.hpp"
#include "tmcl/parameter_number.hpp"
#include "world/cable.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using tmcl::number_of;
using tmcl::sim::Stage;
using tmcl::sim::StageSwitch;

class StopCauses : public Cable {
 protected:
  explicit StopCauses(std::string_view model = "TMCM-6212") : Cable(cable_config, model) {}
  /// Somebody looks at it every tenth of a second.
  void watch_for(tmcl::Duration duration) {
    for (auto waited = tmcl::Duration(0); waited < duration; waited += 100ms) {
      call("axis.get_state", {{"axis", "x"}});
      time.run_for(100ms);
    }
  }
  void set_out() {
    EXPECT_TRUE(call("axis.move_to", {{"axis", "x"}, {"position", 700}}));
    watch_for(2s);
    EXPECT_TRUE(moves());
    EXPECT_EQ(cause(), nullptr);
  }
  json::value cause() { return call("axis.get_state", {{"axis", "x"}})->at("stop_cause"); }
  void at_stage(const std::function<void(Stage&)>& change) {
    module.at_stage(0, change);
    wire.touch();
  }
  /// Of a host that tmcld knows nothing of.
  void other_master_stops() {
    tmcl::test::NoEvents nobody;
    module.execute({tmcl::ModuleAddress{1}, tmcl::Command::MST, 0, 0, 0}, tmcl::sim::Medium::serial,
                   nobody);
    wire.touch();
  }
  void expect(const char* expected, int events_expected = 1) {
    watch_for(3s);
    EXPECT_FALSE(moves());
    EXPECT_EQ(cause(), expected);
    EXPECT_EQ(std::ranges::count(events, "axis_stopped"), events_expected) << expected;
  }
};

TEST_F(StopCauses, IsAStall) {
  call("parameter.set",
       {{"axis", "x"}, {"parameter", "smart_energy_stall_velocity"}, {"value", 1}});
  set_out();
  at_stage([](Stage& stage) { stage.set_load(1000); });
  expect("stall");
  EXPECT_THAT(stopped.front(), HasSubstr("stands short of its target"));
}

TEST_F(StopCauses, IsALimitSwitch) {
  set_out();
  at_stage([](Stage& stage) { stage.press(StageSwitch::right, true); });
  expect("right_limit");
}

TEST_F(StopCauses, IsTheOtherLimitSwitch) {
  EXPECT_TRUE(call("axis.move_to", {{"axis", "x"}, {"position", -900}}));
  watch_for(2s);
  at_stage([](Stage& stage) { stage.press(StageSwitch::left, true); });
  expect("left_limit");
}

TEST_F(StopCauses, IsNotKnownWhereTheModuleDoesNotSay) {
  set_out();
  other_master_stops();
  expect("unknown");
}

// It has a parameter for the mode of its ramp.
class StopCausesOfTmc429 : public StopCauses {
 protected:
  StopCausesOfTmc429() : StopCauses("TMCM-3110") {
    call("parameter.set", {{"axis", "x"}, {"parameter", 4}, {"value", 500}});
    call("parameter.set", {{"axis", "x"}, {"parameter", 5}, {"value", 500}});
  }
};

TEST_F(StopCausesOfTmc429, IsAnotherMaster) {
  set_out();
  other_master_stops();
  expect("velocity_mode");
}

TEST_F(StopCauses, IsWhoeverSentAStop) {
  set_out();
  call("axis.stop", {{"axis", "x"}});
  expect("client", 0);
  EXPECT_TRUE(call("axis.move_to", {{"axis", "x"}, {"position", 0}}));
  watch_for(1s);
  EXPECT_EQ(cause(), nullptr) << "it is on its way again";
}

TEST_F(StopCauses, IsALeaseThatNobodyRenewed) {
  const auto lease = call("lease.acquire", {{"axes", json::array{"x"}}, {"ttl_ms", 10'000}});
  ASSERT_TRUE(lease) << lease.error().message;
  set_out();
  time.run_for(9s);
  expect("lease_lost", 0);
}

TEST_F(StopCauses, IsToldToWhoeverWaits) {
  set_out();
  const auto waits = begin("axis.wait", {{"axis", "x"}});
  time.run_for(200ms);
  at_stage([](Stage& stage) { stage.press(StageSwitch::right, true); });
  const auto result = end(waits);
  ASSERT_FALSE(result);
  EXPECT_EQ(name_of_error(result), "move_interrupted");
  EXPECT_THAT(result.error().message, HasSubstr("cause: right_limit"));
  EXPECT_THAT(result.error().hint, HasSubstr("its right switch is closed; move to the other side"));
}

/// Waits for the target that the axis has now; somebody does something else with it meanwhile.
class WaitsForATarget : public StopCausesOfTmc429 {
 protected:
  void expect_interrupted(const std::function<void()>& meanwhile, const std::string& why) {
    set_out();
    const auto target = call("axis.get_state", {{"axis", "x"}})->at("target_microsteps");
    const auto waits = begin("axis.wait", {{"axis", "x"}, {"target_microsteps", target}});
    time.run_for(200ms);
    meanwhile();
    const auto result = end(waits);
    ASSERT_FALSE(result);
    EXPECT_EQ(name_of_error(result), "move_interrupted");
    EXPECT_THAT(result.error().message, HasSubstr(why));
  }
};

TEST_F(WaitsForATarget, EndsWhenTheAxisIsSentElsewhere) {
  expect_interrupted(
      [this] {
        EXPECT_TRUE(call("axis.move_to", {{"axis", "x"}, {"position_microsteps", 0}}));
      },
      "was sent to 0 instead");
}

TEST_F(WaitsForATarget, EndsWhenTheAxisTurnsByVelocity) {
  const json::object turn{{"axis", "x"}, {"velocity_internal", 100}, {"unattended", true}};
  expect_interrupted([&] { EXPECT_TRUE(call("axis.rotate", turn)); }, "turned by velocity");
}

TEST_F(WaitsForATarget, EndsWhenAnotherMasterStopsTheAxis) {
  expect_interrupted([this] { other_master_stops(); }, "cause: velocity_mode");
}

TEST_F(WaitsForATarget, IsOverAtOnceWhereTheAxisStandsThere) {
  EXPECT_TRUE(call("axis.move_to", {{"axis", "x"}, {"position_microsteps", 100}}));
  EXPECT_TRUE(call("axis.wait", {{"axis", "x"}, {"target_microsteps", 100}}));
  const auto elsewhere =
      call("axis.wait", {{"axis", "x"}, {"target_microsteps", 5}, {"timeout_ms", 5000}});
  ASSERT_FALSE(elsewhere) << "it was never sent there";
  EXPECT_EQ(name_of_error(elsewhere), "move_interrupted");
}

}  // namespace
}  // namespace tmcld::test
