// Soft limits: nothing that goes through the daemon moves an axis beyond them.
#include <gmock/gmock.h>

#include "unit/daemon_scale_fixture.hpp"

namespace tmcld::test {
namespace {

using testing::HasSubstr;
using tmcl::Command;

TEST_F(DaemonMechanics, NoMoveEndsBeyondASoftLimit) {
  EXPECT_THAT(text(beyond("axis.move_to", {{"axis", "screw"}, {"position", 120.5}}).at("message")),
              HasSubstr("axis 'screw': 120.5 mm is beyond the soft limit of 120 mm"));
  EXPECT_THAT(text(beyond("axis.move_to", {{"axis", "screw"}, {"position", -3}}).at("message")),
              HasSubstr("-3 mm is beyond the soft limit of -2.5 mm"));
  beyond("axis.move_to", {{"axis", "screw"}, {"position_microsteps", 1'000'000}});
  beyond("axis.move_by", {{"axis", "screw"}, {"distance", 121}});
  beyond("axis.move_by", {{"axis", "screw"}, {"distance_microsteps", -1'000'000}});
  EXPECT_THAT(text(beyond("axis.move_by", {{"axis", "table"}, {"distance", -91}}).at("message")),
              HasSubstr("-91 deg is beyond the soft limit of -90 deg"));
  beyond("parameter.set",
         {{"axis", "screw"}, {"parameter", "target_position"}, {"value", 999'999}});
  beyond("parameter.set",
         {{"axis", "screw"}, {"parameter", "target_position"}, {"value_in_unit", 121}});
  beyond("parameter.set", {{"axis", "screw"}, {"parameter", "target_velocity"}, {"value", 1}});
  EXPECT_THAT(text(beyond("axis.rotate", {{"axis", "screw"}, {"velocity", 1}}).at("message")),
              HasSubstr("without end"));
  beyond("axis.rotate", {{"axis", "screw"}, {"velocity_internal", -1}});
  beyond("line.move", {{"axes", {"screw", "table"}}, {"positions", {121, 0}}});
  expect_nothing_sent();
}

TEST_F(DaemonMechanics, EverythingWithinSoftLimitsGoes) {
  for (const double place : {-2.5, 120.0, 0.0})
    client->result("axis.move_to", {{"axis", "screw"}, {"position", place}});
  EXPECT_EQ(target_of("axis.move_to", {{"axis", "table"}, {"position", -90}}), 800);
  client->result("axis.rotate", {{"axis", "screw"}, {"velocity_internal", 0}});
  client->result("axis.rotate", {{"axis", "free"}, {"velocity", 1}});
  client->result("parameter.set",
                 {{"axis", "screw"}, {"parameter", "target_position"}, {"value", 5}});
  client->result("axis.start_home", {{"axis", "screw"}});
  client->result("axis.stop", {{"axis", "screw"}});
  client->result("module.execute",
                 {{"bus", "bench"}, {"address", 1}, {"command", "ROR"}, {"value", 5}});
}

TEST_F(DaemonMechanics, CoordinatesBeyondASoftLimitAreNotGoneTo) {
  const auto coordinate = [](const char* axis, int place) {
    return json::object{{"axis", axis}, {"number", 3}, {"position_microsteps", place}};
  };
  client->result("coordinate.set", coordinate("screw", 1'000'000));
  client->result("coordinate.set", coordinate("table", 800));
  client->result("coordinate.set", coordinate("free", 1'000'000));
  const json::object both{{"bus", "bench"}, {"address", 1}, {"number", 3}, {"motors", {0, 1}}};
  beyond("coordinate.move", {{"axis", "screw"}, {"number", 3}});
  EXPECT_THAT(text(beyond("coordinate.start", both).at("message")), HasSubstr("'screw'"));
  expect_nothing_sent();
  client->result("coordinate.move", {{"axis", "table"}, {"number", 3}});
  client->result("coordinate.move", {{"axis", "free"}, {"number", 3}});
  client->result("coordinate.set", coordinate("screw", 0));
  client->result("coordinate.start", both);
}

TEST_F(DaemonMechanics, SoftLimitsThatCannotBeKeptLetNothingMove) {
  TestDaemon other{std::string(bench_bus) +
                   axis_section("x", 0, "unit = \"mm\"\nscrew_pitch = 5\nsoft_limits = [0, 10]\n")};
  other.start();
  other.on_reactor([&] { return other.wire().modules.at(1).parameter(0, 140) = 99; });
  RpcClient caller(other.socket());
  for (const auto* method : {"axis.move_to", "axis.move_by"}) {
    json::object params{{"axis", "x"}};
    params[method == std::string("axis.move_to") ? "position_microsteps" : "distance_microsteps"] =
        1;
    EXPECT_THAT(text(caller.error(method, params).at("message")),
                HasSubstr("microstep resolution"));
  }
  EXPECT_EQ(other.requests_seen(Command::MVP), 0U);
}

std::string limited() {
  return std::string(bench_bus) + axis_section("screw", 0, R"(
unit = "mm"
screw_pitch = 5
microsteps = 256
soft_limits = [10, 120]
)") + axis_section("bare", 1, "soft_limits = [-1000, 2000]\nreverse = true\n") +
         axis_section("free", 2);
}

class DaemonLimits : public DaemonMechanics {
 protected:
  static constexpr std::uint8_t ramp_mode = 138;
  static constexpr std::int32_t twenty_mm = 204'800;

  DaemonLimits() : DaemonMechanics(limited()) {
    for (const std::uint8_t motor : {std::uint8_t{0}, std::uint8_t{1}, std::uint8_t{2}}) {
      for (const std::uint8_t parameter :
           {std::uint8_t{0}, std::uint8_t{1}, std::uint8_t{2}, std::uint8_t{3}})
        hold(motor, parameter, 0);
      hold(motor, ramp_mode, 0);
    }
    hold(0, 0, twenty_mm);
    hold(0, 1, twenty_mm);
  }
  json::object beyond_by_setting(const char* axis, json::value parameter, std::int32_t value) {
    return beyond("parameter.set",
                  {{"axis", axis}, {"parameter", std::move(parameter)}, {"value", value}});
  }
  void set(const char* axis, json::value parameter, std::int32_t value) {
    client->result("parameter.set",
                   {{"axis", axis}, {"parameter", std::move(parameter)}, {"value", value}});
  }
};

TEST_F(DaemonLimits, WithoutAUnitTheyAreInMicrosteps) {
  EXPECT_THAT(
      text(beyond("axis.move_to", {{"axis", "bare"}, {"position_microsteps", 2001}}).at("message")),
      HasSubstr("axis 'bare': 2001 microsteps is beyond the soft limit of 2000 microsteps"));
  EXPECT_THAT(
      text(
          beyond("axis.move_by", {{"axis", "bare"}, {"distance_microsteps", -1001}}).at("message")),
      HasSubstr("-1001 microsteps is beyond the soft limit of -1000 microsteps"));
  beyond("axis.rotate", {{"axis", "bare"}, {"velocity_internal", 5}});
  beyond("line.move", {{"axes", {"bare", "free"}}, {"positions_microsteps", {2001, 5}}});
  expect_nothing_sent();
  for (const auto place : {-1000, 2000})
    EXPECT_EQ(target_of("axis.move_to", {{"axis", "bare"}, {"position_microsteps", place}}), place);
  hold(1, 140, 99);
  client->result("axis.move_to", {{"axis", "bare"}, {"position_microsteps", 5}});
}

TEST_F(DaemonLimits, UnitsTellThemInMicrostepsToo) {
  const auto bare = client->result("axis.get_units", {{"axis", "bare"}});
  EXPECT_TRUE(bare.at("soft_limit_minimum").is_null()) << "it has no unit";
  EXPECT_EQ(bare.at("soft_limit_minimum_microsteps"), -1000);
  EXPECT_EQ(bare.at("soft_limit_maximum_microsteps"), 2000);
  const auto screw = client->result("axis.get_units", {{"axis", "screw"}});
  EXPECT_EQ(screw.at("soft_limit_minimum").to_number<double>(), 10);
  EXPECT_EQ(screw.at("soft_limit_minimum_microsteps"), 102'400);
  EXPECT_EQ(screw.at("soft_limit_maximum_microsteps"), 1'228'800);
  const auto free = client->result("axis.get_units", {{"axis", "free"}});
  EXPECT_TRUE(free.at("soft_limit_minimum_microsteps").is_null());
  EXPECT_TRUE(free.at("soft_limit_maximum_microsteps").is_null());
}

TEST_F(DaemonLimits, ARampModeIsNotChangedWhereTheAxisWouldGoOnBeyond) {
  for (const int mode : {0, 1, 2}) set("screw", "ramp_mode", mode);
  hold(0, 2, -300);
  EXPECT_THAT(text(beyond_by_setting("screw", "ramp_mode", 2).at("message")),
              HasSubstr("its target_velocity is -300"));
  hold(0, 2, 0);
  hold(0, 0, 0);
  EXPECT_THAT(text(beyond_by_setting("screw", 138, 0).at("message")),
              HasSubstr("0 mm is beyond the soft limit of 10 mm, and it would go on to there"));
  hold(1, 2, 1);
  beyond_by_setting("bare", "RampMode", 2);
  hold(2, 2, 300);
  set("free", "ramp_mode", 2);
}

TEST_F(DaemonLimits, AnActualPositionIsNotSetWhereTheAxisWouldLeaveForATargetBeyond) {
  set("screw", "actual_position", 0);
  hold(0, 0, 0);
  const auto error = beyond_by_setting("screw", "actual_position", twenty_mm);
  EXPECT_THAT(text(error.at("message")), HasSubstr("target_position"));
  EXPECT_THAT(text(error.at("data").at("hint")), HasSubstr("within its limits"));
  set("screw", "actual_position", 0);
  hold(0, ramp_mode, 2);
  set("screw", "actual_position", twenty_mm);
  EXPECT_EQ(last(Command::SAP).value, twenty_mm) << "it stands by velocity";
}

TEST_F(DaemonLimits, NothingIsRestoredThatCouldMoveTheAxisNobodyKnowsWhereTo) {
  for (const auto* parameter :
       {"target_position", "actual_position", "target_velocity", "ramp_mode"}) {
    EXPECT_THAT(text(beyond("parameter.restore", {{"axis", "screw"}, {"parameter", parameter}})
                         .at("message")),
                HasSubstr("EEPROM"))
        << parameter;
  }
  EXPECT_EQ(daemon.requests_seen(Command::RSAP), 0U);
  client->result("parameter.restore", {{"axis", "screw"}, {"parameter", "max_velocity"}});
  client->result("parameter.restore", {{"axis", "free"}, {"parameter", "ramp_mode"}});
}

TEST_F(DaemonLimits, HoldAlsoForAModuleWhoseModelIsNotKnown) {
  TestDaemon other{limited()};
  other.wire().model = 9999;
  other.start();
  RpcClient caller(other.socket());
  const auto refused = [&](const char* method, json::object params) {
    EXPECT_EQ(caller.error(method, std::move(params)).at("data").at("name"), "beyond_soft_limit");
  };
  // Whatever is not said of a parameter of the fake module is a great number.
  for (const int parameter : {0, 2, 128, 138}) {
    refused("parameter.set", {{"axis", "bare"}, {"parameter", parameter}, {"value", 2001}});
    refused("parameter.restore", {{"axis", "bare"}, {"parameter", parameter}});
  }
  refused("parameter.set", {{"axis", "bare"}, {"parameter", 1}, {"value", 0}});
  EXPECT_EQ(other.requests_seen(Command::SAP), 0U);
}

}  // namespace
}  // namespace tmcld::test
