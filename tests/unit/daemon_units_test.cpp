// What the daemon makes of the velocities that modules count in units of their own.
#include <gmock/gmock.h>

#include "unit/daemon_fixture.hpp"

namespace tmcld::test {
namespace {

using testing::HasSubstr;
using tmcl::Command;

class DaemonUnits : public testing::Test {
 protected:
  void serve(std::uint16_t model) {
    daemon.wire().model = model;
    daemon.start();
    client = std::make_unique<RpcClient>(daemon.socket());
  }
  void hold(std::uint8_t parameter, std::int32_t value) {
    daemon.on_reactor([&] { return daemon.wire().modules.at(1).parameter(0, parameter) = value; });
  }
  double velocity_pps() {
    return client->result("axis.get_state", {{"axis", "x"}}).at("velocity_pps").to_number<double>();
  }
  std::size_t reads_of(std::uint8_t parameter) {
    return daemon.on_reactor([&] {
      return static_cast<std::size_t>(std::ranges::count_if(daemon.wire().seen, [&](auto& request) {
        return request.command == Command::GAP && request.type == parameter;
      }));
    });
  }

  TestDaemon daemon;
  std::unique_ptr<RpcClient> client;
};

TEST_F(DaemonUnits, DividersScaleTheVelocitiesOfATmc429) {
  serve(6110);
  hold(153, 3);
  hold(3, -1000);
  hold(154, 2);
  EXPECT_NEAR(velocity_pps(), -61'035.2, 0.1);
  hold(154, 14);  // no module has that
  client->result("parameter.set", {{"axis", "x"}, {"parameter", "pulse_divisor"}, {"value", 3}});
  EXPECT_NEAR(velocity_pps(), -30'517.6, 0.1);
}

TEST_F(DaemonUnits, TheUnitModeScalesTheVelocitiesOfATmc457) {
  serve(142);
  hold(3, 1 << 26);
  hold(255, 0);
  EXPECT_DOUBLE_EQ(velocity_pps(), 1'000'000);
  client->result("parameter.set", {{"axis", "x"}, {"parameter", "unit_mode"}, {"value", 1}});
  hold(3, -4'321);
  EXPECT_DOUBLE_EQ(velocity_pps(), -4'321);
}

TEST_F(DaemonUnits, TheUnitModeScalesTheVelocitiesOfASixPointChip) {
  serve(6212);
  hold(3, -1 << 20);
  hold(255, 1);
  EXPECT_DOUBLE_EQ(velocity_pps(), -1 << 20);
  client->result("parameter.set", {{"axis", "x"}, {"parameter", 255}, {"value", 0}});
  EXPECT_DOUBLE_EQ(velocity_pps(), -1'000'000);
}

TEST_F(DaemonUnits, TheUnitIsAskedForOnceUntilItMayHaveChanged) {
  serve(6212);
  hold(255, 1);
  for (int i = 0; i < 5; ++i) velocity_pps();
  EXPECT_EQ(reads_of(255), 1U);
  client->result("parameter.set", {{"axis", "x"}, {"parameter", 4}, {"value", 1000}});
  velocity_pps();
  EXPECT_EQ(reads_of(255), 1U);
  client->result("parameter.set", {{"axis", "x"}, {"parameter", 255}, {"value", 1}});
  velocity_pps();
  EXPECT_EQ(reads_of(255), 2U);
}

TEST_F(DaemonUnits, AUnitThatNoModuleHasGivesNoVelocity) {
  serve(6212);
  hold(255, 2);
  EXPECT_TRUE(client->result("axis.get_state", {{"axis", "x"}}).at("velocity_pps").is_null());
}

// Which range applies depends on the unit mode, so the module is the judge.
TEST_F(DaemonUnits, LeaveTheRangeOfWhatTheyScaleToTheModule) {
  serve(142);
  EXPECT_EQ(client
                ->result("parameter.set",
                         {{"axis", "x"}, {"parameter", "acceleration"}, {"value", 900'000'000}})
                .at("number"),
            16);
  const auto error =
      client->error("parameter.set", {{"axis", "x"}, {"parameter", "max_bow"}, {"value", 19}});
  EXPECT_THAT(text(error.at("message")), HasSubstr("outside 0..18"));
}

std::string spindle() {
  return std::string(bench_bus) +
         axis_section("x", 0, "unit = \"mm\"\nunits_per_revolution = 5.0\n") +
         axis_section("back", 1, R"(
unit = "deg"
units_per_revolution = 360
reverse = true
full_steps = 400
microsteps = 16
)") + axis_section("plain", 2);
}

class DaemonScale : public testing::Test {
 protected:
  explicit DaemonScale(const std::string& axes = spindle()) : daemon(axes) {
    daemon.wire().model = 3110;
    daemon.start();
    client = std::make_unique<RpcClient>(daemon.socket());
    hold(0, 140, 8);
    for (const std::uint8_t motor : {std::uint8_t{0}, std::uint8_t{1}, std::uint8_t{2}}) {
      hold(motor, 153, 3);
      hold(motor, 154, 2);
    }
  }
  void hold(std::uint8_t motor, std::uint8_t parameter, std::int32_t value) {
    daemon.on_reactor(
        [&] { return daemon.wire().modules.at(1).parameter(motor, parameter) = value; });
  }
  tmcl::Request last(Command command) {
    return daemon.on_reactor([&] {
      const auto& seen = daemon.wire().seen;
      const auto found = std::ranges::find(seen.rbegin(), seen.rend(), command,
                                           [](const auto& request) { return request.command; });
      return found == seen.rend() ? tmcl::Request{} : *found;
    });
  }
  std::string refusal(std::string_view method, json::object params) {
    const auto error = client->error(method, std::move(params));
    EXPECT_EQ(error.at("code"), -32602);
    return text(error.at("message"));
  }

  TestDaemon daemon;
  std::unique_ptr<RpcClient> client;
};

TEST_F(DaemonScale, StatesAreToldInTheUnitBesideMicrosteps) {
  hold(0, 1, 102'400);
  hold(0, 0, -51'200);
  hold(0, 3, 1000);
  const auto state = client->result("axis.get_state", {{"axis", "x"}});
  EXPECT_EQ(state.at("position_microsteps"), 102'400);
  EXPECT_EQ(state.at("unit"), "mm");
  EXPECT_EQ(state.at("position").to_number<double>(), 10);
  EXPECT_EQ(state.at("target").to_number<double>(), -5);
  EXPECT_NEAR(state.at("velocity").to_number<double>(), 61'035.156 / 10'240, 1e-6);
  hold(1, 1, 3'200);
  hold(1, 0, 0);
  hold(1, 3, -1000);
  const auto back = client->result("axis.get_state", {{"axis", "back"}});
  EXPECT_EQ(back.at("position").to_number<double>(), -180);
  EXPECT_GT(back.at("velocity").to_number<double>(), 0);
  const auto plain = client->result("axis.get_state", {{"axis", "plain"}});
  for (const auto* key : {"unit", "position", "target", "velocity"}) {
    EXPECT_TRUE(plain.at(key).is_null()) << key;
  }
}

TEST_F(DaemonScale, TheMicrostepsOfTheModuleAreReadAgainWhenTheyMayHaveChanged) {
  hold(0, 1, 51'200);
  const auto position = [&] {
    return client->result("axis.get_state", {{"axis", "x"}}).at("position").to_number<double>();
  };
  EXPECT_EQ(position(), 5);
  EXPECT_EQ(position(), 5);
  client->result("parameter.set", {{"axis", "x"}, {"parameter", 140}, {"value", 6}});
  EXPECT_EQ(position(), 20);
  hold(0, 140, 99);
  client->result("parameter.set", {{"axis", "x"}, {"parameter", 154}, {"value", 3}});
  EXPECT_TRUE(client->result("axis.get_state", {{"axis", "x"}}).at("position").is_null())
      << "no module has that";
}

TEST_F(DaemonScale, MovesAreTakenInTheUnit) {
  EXPECT_EQ(
      client->result("axis.move_to", {{"axis", "x"}, {"position", 2.5}}).at("target_microsteps"),
      25'600);
  EXPECT_EQ(last(Command::MVP).value, 25'600);
  EXPECT_EQ(
      client->result("axis.move_by", {{"axis", "x"}, {"distance", -1}}).at("target_microsteps"),
      15'360);
  client->result("axis.rotate", {{"axis", "x"}, {"velocity", -5}});
  EXPECT_EQ(last(Command::ROL).value, 839);
  client->result("axis.move_to", {{"axis", "back"}, {"position", 90}});
  EXPECT_EQ(last(Command::MVP).value, -1'600);
  client->result("axis.rotate", {{"axis", "back"}, {"velocity", -3600}});
  EXPECT_EQ(last(Command::ROR).value, 1'049);
}

TEST_F(DaemonScale, NothingIsSentForWhatDoesNotFit) {
  EXPECT_THAT(refusal("axis.move_to", {{"axis", "x"}, {"position", 1000}}),
              HasSubstr("1000 mm is too far; the nearest possible value is 819.199"));
  EXPECT_THAT(refusal("axis.move_to", {{"axis", "x"}, {"position", 1e300}}), HasSubstr("too far"));
  EXPECT_THAT(refusal("axis.rotate", {{"axis", "x"}, {"velocity", 50}}),
              HasSubstr("mm/s is too fast"));
  EXPECT_THAT(refusal("axis.move_to", {{"axis", "plain"}, {"position", 1}}),
              HasSubstr("axis 'plain' has no unit"));
  EXPECT_THAT(refusal("axis.rotate", {{"axis", "plain"}, {"velocity", 1}}), HasSubstr("no unit"));
  EXPECT_THAT(refusal("axis.move_to", {{"axis", "x"}}), HasSubstr("'position_microsteps' or"));
  EXPECT_THAT(refusal("axis.move_by", {{"axis", "x"}, {"distance", 1}, {"distance_microsteps", 1}}),
              HasSubstr("not both"));
  EXPECT_THAT(refusal("axis.rotate", {{"axis", "x"}}), HasSubstr("'velocity_internal' or"));
  hold(0, 140, 99);
  client->result("parameter.set", {{"axis", "x"}, {"parameter", 154}, {"value", 2}});
  EXPECT_THAT(refusal("axis.move_to", {{"axis", "x"}, {"position", 1}}),
              HasSubstr("microstep resolution"));
  EXPECT_EQ(daemon.requests_seen(Command::MVP) + daemon.requests_seen(Command::ROR), 0U);
}

TEST_F(DaemonScale, UnitsSayWhatAnAxisCountsIn) {
  const auto x = client->result("axis.get_units", {{"axis", "x"}});
  EXPECT_EQ(x.at("model"), "TMCM-3110");
  EXPECT_EQ(x.at("unit"), "mm");
  EXPECT_EQ(x.at("units_per_revolution").to_number<double>(), 5);
  EXPECT_EQ(x.at("reverse"), false);
  EXPECT_EQ(x.at("microsteps_per_revolution"), 51'200);
  EXPECT_EQ(x.at("full_steps"), 200);
  EXPECT_EQ(x.at("velocity_unit_pps").to_number<double>(), 61.03515625);
  EXPECT_NEAR(x.at("acceleration_unit_pps2").to_number<double>(), 14'901.16, 0.01);
  const auto back = client->result("axis.get_units", {{"axis", "back"}});
  EXPECT_EQ(back.at("microsteps_per_revolution"), 6'400);
  EXPECT_EQ(back.at("reverse"), true);
  hold(2, 140, -1);
  hold(2, 153, 99);
  const auto plain = client->result("axis.get_units", {{"axis", "plain"}});
  for (const auto* key :
       {"unit", "units_per_revolution", "reverse", "microsteps_per_revolution", "velocity_unit_pps",
        "gear_ratio", "soft_limit_minimum", "encoder_counts_per_unit"}) {
    EXPECT_TRUE(plain.at(key).is_null()) << key;
  }
}

std::string mechanics() {
  return std::string(bench_bus) + axis_section("screw", 0, R"(
unit = "mm"
screw_pitch = 7.3
gear_ratio = 3.71
microsteps = 16
soft_limits = [-2.5, 120]
encoder_lines = 1000
)") + axis_section("table", 1, R"(
unit = "deg"
units_per_revolution = 360
reverse = true
microsteps = 16
soft_limits = [-90, 180]
)") + axis_section("free", 2, "unit = \"mm\"\nscrew_pitch = 7.3\ngear_ratio = 3.71\n");
}

class DaemonMechanics : public DaemonScale {
 protected:
  explicit DaemonMechanics(const std::string& axes = mechanics()) : DaemonScale(axes) {
    hold(2, 140, 4);
    for (const std::uint8_t motor : {std::uint8_t{0}, std::uint8_t{1}, std::uint8_t{2}})
      hold(motor, 1, 0);
  }
  std::int64_t target_of(std::string_view method, json::object params) {
    return client->result(method, std::move(params)).at("target_microsteps").as_int64();
  }
  json::object beyond(std::string_view method, json::object params) {
    auto error = client->error(method, std::move(params));
    EXPECT_EQ(error.at("code"), -32602);
    EXPECT_EQ(error.at("data").at("name"), "beyond_soft_limit") << error;
    EXPECT_EQ(error.at("data").at("outcome"), "not_sent");
    return error;
  }
  void expect_nothing_sent() {
    for (const auto command : {Command::MVP, Command::ROR, Command::ROL, Command::SAP})
      EXPECT_EQ(daemon.requests_seen(command), 0U) << name_of(command);
  }
};

TEST_F(DaemonMechanics, UnitsTellOfGearLimitsAndEncoder) {
  const auto units = client->result("axis.get_units", {{"axis", "screw"}});
  EXPECT_EQ(units.at("gear_ratio"), 3.71);
  EXPECT_EQ(units.at("units_per_output_revolution"), 7.3);
  EXPECT_DOUBLE_EQ(units.at("units_per_revolution").to_number<double>(), 7.3 / 3.71);
  EXPECT_EQ(units.at("soft_limit_minimum").to_number<double>(), -2.5);
  EXPECT_EQ(units.at("soft_limit_maximum").to_number<double>(), 120);
  EXPECT_DOUBLE_EQ(units.at("encoder_counts_per_unit").to_number<double>(), 4000 * 3.71 / 7.3);
  const auto free = client->result("axis.get_units", {{"axis", "free"}});
  EXPECT_TRUE(free.at("soft_limit_minimum").is_null());
  EXPECT_TRUE(free.at("encoder_counts_per_unit").is_null());
}

TEST_F(DaemonMechanics, AThousandTenthsOfAMillimetreAreAHundred) {
  const auto by = [&](double distance) {
    return target_of("axis.move_by",
                     {{"axis", "screw"}, {"distance", distance}, {"predict", false}});
  };
  const auto hundred = target_of("axis.move_to", {{"axis", "screw"}, {"position", 100}});
  client->result("axis.move_to", {{"axis", "screw"}, {"position", 0}});
  const auto tenth = by(0.1);
  std::int64_t there = tenth;
  for (int i = 1; i < 1000; ++i) there = by(0.1);
  EXPECT_EQ(there, hundred);
  EXPECT_NE(1000 * tenth, hundred) << "the scale is one where it matters";
  for (int i = 0; i < 1000; ++i) there = by(-0.1);
  EXPECT_EQ(there, 0);
}

TEST_F(DaemonMechanics, ADistanceCountsFromWhereTheAxisReallyIs) {
  client->result("axis.move_to", {{"axis", "free"}, {"position", 10.0003}});
  hold(2, 1, 500);  // somebody stopped it
  const auto expected = std::lround(500 + 0.1 * 3200 * 3.71 / 7.3);
  EXPECT_EQ(target_of("axis.move_by", {{"axis", "free"}, {"distance", 0.1}}), expected);
  client->result("axis.move_to", {{"axis", "free"}, {"position", 0.0003}});
  client->result("parameter.set", {{"axis", "free"}, {"parameter", 1}, {"value", 0}});
  EXPECT_EQ(target_of("axis.move_by", {{"axis", "free"}, {"distance", 1}}),
            std::lround(3200 * 3.71 / 7.3));
}

TEST_F(DaemonMechanics, ADistanceThatTheModuleCannotHoldIsRefused) {
  EXPECT_THAT(refusal("axis.move_by", {{"axis", "free"}, {"distance", 1e6}}),
              HasSubstr("1e+06 mm is too far"));
  expect_nothing_sent();
}

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

TEST_F(DaemonScale, MovesAndStandsAreToldInTheUnit) {
  const auto moved = client->result("axis.move_to", {{"axis", "x"}, {"position", 2.5}});
  EXPECT_EQ(moved.at("unit"), "mm");
  EXPECT_EQ(moved.at("target").to_number<double>(), 2.5);
  hold(0, 1, 25'600);
  hold(0, 3, 0);
  const auto stands = client->result("axis.wait", {{"axis", "x"}, {"timeout_ms", 1000}});
  EXPECT_EQ(stands.at("unit"), "mm");
  EXPECT_EQ(stands.at("position").to_number<double>(), 2.5);
  const auto turns = client->result("axis.rotate", {{"axis", "back"}, {"velocity", -3600}});
  EXPECT_EQ(turns.at("velocity_internal"), 1'049);
  EXPECT_NEAR(turns.at("velocity").to_number<double>(), -3601.4, 0.1);
  const auto plain =
      client->result("axis.move_by", {{"axis", "plain"}, {"distance_microsteps", 1}});
  EXPECT_TRUE(plain.at("unit").is_null());
  EXPECT_TRUE(plain.at("target").is_null());
  const auto axes = client->result("axis.list").at("axes").as_array();
  EXPECT_EQ(axes.at(0).at("unit"), "mm");
  EXPECT_TRUE(axes.at(2).at("unit").is_null());
}

TEST_F(DaemonScale, CoordinatesAreTakenAndToldInTheUnit) {
  client->result("coordinate.set", {{"axis", "x"}, {"number", 3}, {"position", -2.5}});
  const auto place = client->result("coordinate.get", {{"axis", "x"}, {"number", 3}});
  EXPECT_EQ(place.at("position_microsteps"), -25'600);
  EXPECT_EQ(place.at("position").to_number<double>(), -2.5);
  EXPECT_EQ(place.at("unit"), "mm");
  EXPECT_THAT(refusal("coordinate.set", {{"axis", "x"}, {"number", 3}}), HasSubstr("is needed"));
  EXPECT_THAT(refusal("coordinate.set", {{"axis", "plain"}, {"number", 3}, {"position", 1}}),
              HasSubstr("no unit"));
}

TEST_F(DaemonScale, ParametersAreTakenAndToldInTheUnit) {
  const auto get = [&](const char* axis, json::value parameter) {
    return client->result("parameter.get", {{"axis", axis}, {"parameter", std::move(parameter)}});
  };
  hold(0, 4, 1000);
  const auto velocity = get("x", "max_velocity");
  EXPECT_EQ(velocity.at("value"), 1000);
  EXPECT_EQ(velocity.at("unit"), "mm/s");
  EXPECT_NEAR(velocity.at("value_in_unit").to_number<double>(), 5.96, 0.001);
  hold(0, 5, 100);
  EXPECT_EQ(get("x", "max_acceleration").at("unit"), "mm/s^2");
  hold(1, 1, 1'600);
  EXPECT_EQ(get("back", "actual_position").at("value_in_unit").to_number<double>(), -90);
  for (const auto& none : {get("x", "max_current"), get("x", 250), get("plain", "max_velocity")}) {
    EXPECT_TRUE(none.at("unit").is_null()) << none;
    EXPECT_TRUE(none.at("value_in_unit").is_null()) << none;
  }
  const auto set = [&](const char* axis, const char* parameter, double value) {
    return client->result("parameter.set",
                          {{"axis", axis}, {"parameter", parameter}, {"value_in_unit", value}});
  };
  EXPECT_EQ(set("x", "max_velocity", 5).at("value"), 839);
  EXPECT_EQ(last(Command::SAP).value, 839);
  EXPECT_EQ(set("x", "target_position", -2.5).at("value"), -25'600);
  EXPECT_EQ(set("back", "target_position", 90).at("value"), -1'600);
  EXPECT_EQ(set("back", "max_velocity", 3600).at("value"), 1'049) << "a limit has no direction";
}

TEST_F(DaemonScale, NothingIsSetToWhatDoesNotFit) {
  const auto refused = [&](json::object params) {
    return refusal("parameter.set", std::move(params));
  };
  EXPECT_THAT(refused({{"axis", "x"}, {"parameter", "max_velocity"}, {"value_in_unit", 50}}),
              HasSubstr("50 mm/s is too fast; the nearest possible value is 12.2"));
  EXPECT_THAT(refused({{"axis", "x"}, {"parameter", "max_current"}, {"value_in_unit", 1}}),
              HasSubstr("'max_current' is not known to be a position"));
  EXPECT_THAT(refused({{"axis", "x"}, {"parameter", 250}, {"value_in_unit", 1}}),
              HasSubstr("'250' is not known"));
  EXPECT_THAT(refused({{"axis", "plain"}, {"parameter", "max_velocity"}, {"value_in_unit", 1}}),
              HasSubstr("has no unit"));
  EXPECT_THAT(refused({{"axis", "x"}, {"parameter", "max_velocity"}}), HasSubstr("is needed"));
  EXPECT_THAT(
      refused({{"axis", "x"}, {"parameter", "max_velocity"}, {"value", 1}, {"value_in_unit", 1}}),
      HasSubstr("not both"));
  EXPECT_THAT(refused({{"axis", "x"}, {"parameter", "actual_velocity"}, {"value_in_unit", 1}}),
              HasSubstr("can only be read"));
  EXPECT_EQ(daemon.requests_seen(Command::SAP), 0U);
}

TEST_F(DaemonScale, ListsOfParametersSayTheirUnits) {
  const auto unit_of = [&](const char* axis, std::int64_t number) -> json::value {
    const auto rows = client->result("parameter.list", {{"axis", axis}}).at("parameters");
    for (const auto& row : rows.as_array()) {
      if (row.at("number") == number) return row.at("axis_unit");
    }
    return "no such row";
  };
  EXPECT_EQ(unit_of("x", 0), "mm");
  EXPECT_EQ(unit_of("x", 4), "mm/s");
  EXPECT_EQ(unit_of("x", 5), "mm/s^2");
  EXPECT_TRUE(unit_of("x", 6).is_null());
  EXPECT_TRUE(unit_of("plain", 0).is_null());
}

// Those of application note AN00115, in counts of an encoder; a screw with a sixteenth of its turn
// for a mm, on which tenths of a mm end between two steps; and one that comes out at nothing even.
std::string scales() {
  return std::string(bench_bus) +
         axis_section("note", 0,
                      "unit = \"deg\"\nunits_per_revolution = 360\nfull_steps = 4000\n"
                      "microsteps = 1\nreverse = true\n") +
         axis_section("even", 1, "unit = \"mm\"\nscrew_pitch = 16\nmicrosteps = 1\n") +
         axis_section("odd", 2,
                      "unit = \"mm\"\nscrew_pitch = 7.3\ngear_ratio = 3.71\n"
                      "microsteps = 4\n");
}

class DaemonRounding : public DaemonScale {
 protected:
  explicit DaemonRounding(const std::string& axes = scales()) : DaemonScale(axes) {
    for (const std::uint8_t motor : {std::uint8_t{0}, std::uint8_t{1}, std::uint8_t{2}})
      hold(motor, 1, 0);
  }
  std::int64_t move(std::string_view method, const std::string& axis, double way) {
    const auto* key = method == "axis.move_by" ? "distance" : "position";
    json::object params{{"axis", axis}, {"predict", false}};
    params[key] = way;
    return client->result(method, std::move(params)).at("target_microsteps").as_int64();
  }
  std::int64_t target_of(const std::string& axis, double position) {
    return move("axis.move_to", axis, position);
  }
  /// Ends where it began.
  void expect_no_drift(const std::string& axis) {
    constexpr int of_a_unit = 10;
    constexpr int moves = 1000;
    for (const int direction : {1, -1}) {
      target_of(axis, 0);
      std::vector<std::int64_t> there{0};
      for (int i = 0; i < moves; ++i) there.push_back(move("axis.move_by", axis, direction * 0.1));
      for (int i = of_a_unit; i <= moves; i += of_a_unit) {
        EXPECT_EQ(there.at(static_cast<std::size_t>(i)),
                  target_of(axis, direction * (i / of_a_unit)))
            << axis << ' ' << i << " moves";
      }
      target_of(axis, direction * 100);
      for (int i = 0; i < moves; ++i) there.back() = move("axis.move_by", axis, direction * -0.1);
      EXPECT_EQ(there.back(), 0) << axis;
    }
  }
};

TEST_F(DaemonRounding, TenthsThatAreNoWholeNumberOfMicrostepsDoNotAddUp) {
  for (const auto* axis : {"note", "even", "odd"}) expect_no_drift(axis);
}

TEST_F(DaemonRounding, TheScalesOfTheNoteAreExact) {
  EXPECT_EQ(target_of("note", 360), -4000);
  EXPECT_EQ(target_of("note", 90), -1000);
  EXPECT_EQ(target_of("note", 100), -1111);
  EXPECT_EQ(target_of("note", -0.09), 1);
  hold(0, 0, -4000);
  const auto state = client->result("axis.get_state", {{"axis", "note"}});
  EXPECT_EQ(state.at("target").to_number<double>(), 360);
}

// 1000 counts a mm of a linear encoder, and 1200 of one behind a gear of 3:1 and a pitch of 10 mm.
class DaemonNoteScale : public DaemonRounding {
 protected:
  DaemonNoteScale()
      : DaemonRounding(std::string(bench_bus) +
                       axis_section("linear", 0,
                                    "unit = \"mm\"\nscrew_pitch = 10\n"
                                    "full_steps = 10000\nmicrosteps = 1\n") +
                       axis_section("geared", 1,
                                    "unit = \"mm\"\nscrew_pitch = 10\n"
                                    "gear_ratio = 3\nfull_steps = 4000\n"
                                    "microsteps = 1\n") +
                       axis_section("third", 2)) {}
};

TEST_F(DaemonNoteScale, MillimetresAreWholeCounts) {
  EXPECT_EQ(target_of("linear", 1), 1000);
  EXPECT_EQ(target_of("linear", 0.0005), 1) << "ties go away from zero";
  EXPECT_EQ(target_of("linear", -123.456), -123'456);
  EXPECT_EQ(target_of("geared", 1), 1200);
  EXPECT_EQ(target_of("geared", 200), 240'000);
  EXPECT_EQ(target_of("geared", -0.1), -120);
  for (const auto* axis : {"linear", "geared"}) expect_no_drift(axis);
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
