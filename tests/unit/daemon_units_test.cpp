// What the daemon makes of units: those that modules count in, and those of axes.
#include <gmock/gmock.h>

#include "unit/daemon_scale_fixture.hpp"

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
  client->result("parameter.set", {{"axis", "x"}, {"parameter", 6}, {"value", 100}});
  velocity_pps();
  EXPECT_EQ(reads_of(255), 1U);
  client->result("parameter.set", {{"axis", "x"}, {"parameter", 255}, {"value", 1}});
  velocity_pps();
  EXPECT_EQ(reads_of(255), 3U) << "for its units, and for what its ramp does";
}

/// A parameter that units depend on, and what they are before and after it comes from the EEPROM.
struct Restored {
  std::uint16_t model;
  std::uint8_t parameter;
  std::int32_t before;
  std::int32_t after;
  const char* figure;  ///< Of axis.get_units.
  double ratio;        ///< What is there afterwards to what was there before.
};

class DaemonRestored : public DaemonUnits, public testing::WithParamInterface<Restored> {};

TEST_P(DaemonRestored, IsReadAgain) {
  const auto& [model, parameter, before, after, figure, ratio] = GetParam();
  serve(model);
  for (const auto& [number, value] : {std::pair{140, 8}, {153, 3}, {154, 2}, {255, 0}})
    hold(static_cast<std::uint8_t>(number), value);
  hold(parameter, before);
  const auto told = [&] {
    return client->result("axis.get_units", {{"axis", "x"}}).at(figure).to_number<double>();
  };
  const double first = told();
  daemon.on_reactor([&] {
    daemon.wire().modules.at(1).before = [&, number = parameter, value = after](
                                             FakeModule& self, const tmcl::Request& request) {
      if (request.command == Command::RSAP) self.parameter(0, number) = value;
    };
    return 0;
  });
  EXPECT_EQ(told(), first);
  client->result("parameter.restore", {{"axis", "x"}, {"parameter", parameter}});
  EXPECT_NEAR(told() / first, ratio, 1e-9);
}

// A microstep resolution of n means 2^n microsteps; a divisor of n divides by 2^n, a ramp divisor
// the acceleration. A TMCM-6212 counts in units of its chip (0), 2^24 / 16 MHz of a second, or in
// microsteps (1).
INSTANTIATE_TEST_SUITE_P(
    Parameters, DaemonRestored,
    testing::Values(Restored{3110, 140, 8, 5, "microsteps_per_revolution", 1.0 / 8},
                    Restored{3110, 154, 2, 4, "velocity_unit_pps", 1.0 / 4},
                    Restored{3110, 153, 3, 2, "acceleration_unit_pps2", 2.0},
                    Restored{6212, 255, 0, 1, "velocity_unit_pps", 0x1p24 / 16e6}),
    [](const auto& parameter) { return "Parameter" + std::to_string(parameter.param.parameter); });

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

// 102,400 microsteps are 10 mm of 256 to the full step (8), and 40 mm of 64 (6).
TEST_F(DaemonScale, MicrostepsThatMayHaveBeenSetAreReadAgain) {
  hold(0, 1, 102'400);
  const auto position = [&] {
    return client->result("axis.get_state", {{"axis", "x"}}).at("position").to_number<double>();
  };
  ASSERT_EQ(position(), 10);
  const json::object set{{"axis", "x"}, {"parameter", 140}, {"value", 6}};
  // The module has executed it, and every answer is lost, also to the question what came of it.
  daemon.on_reactor([&] {
    daemon.wire().loses = [](const tmcl::Request& request) { return request.type == 140; };
    return 0;
  });
  const auto lost = client->error("parameter.set", set);
  EXPECT_EQ(text(lost.at("data").at("outcome")), "unknown") << lost;
  daemon.on_reactor([&] { return daemon.wire().loses = {}, 0; });
  EXPECT_EQ(position(), 40);
}

// And where a stop comes before that question, so that the module counts as one that answers.
TEST_F(DaemonScale, MicrostepsThatMayHaveBeenSetBeforeAStopAreReadAgain) {
  hold(0, 1, 102'400);
  const auto position = [&] {
    return client->result("axis.get_state", {{"axis", "x"}}).at("position").to_number<double>();
  };
  ASSERT_EQ(position(), 10);
  daemon.on_reactor([&] {
    daemon.wire().loses = [](const tmcl::Request& request) {
      return request.command == Command::SAP;
    };
    return 0;
  });
  const auto set = client->send("parameter.set", {{"axis", "x"}, {"parameter", 140}, {"value", 6}});
  ASSERT_TRUE(daemon.eventually([&] { return daemon.wire().count(Command::SAP) == 1; }));
  client->result("axis.stop", {{"axis", "x"}});
  const auto answer = client->answer_to(set);
  EXPECT_EQ(text(answer.at("error").at("data").at("name")), "superseded_by_stop");
  EXPECT_EQ(position(), 40);
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

TEST_F(DaemonScale, MovesAreTakenAsTextsWithUnits) {
  const auto target_of = [&](const char* axis, const char* position) {
    return client->result("axis.move_to", {{"axis", axis}, {"position", position}})
        .at("target_microsteps");
  };
  EXPECT_EQ(target_of("x", "2.5mm"), 25'600);
  EXPECT_EQ(target_of("x", "100 um"), 1'024);
  EXPECT_EQ(target_of("x", "-0.5rev"), -25'600);
  EXPECT_EQ(target_of("x", "7microsteps"), 7);
  EXPECT_EQ(target_of("x", "0"), 0) << "the same in every unit";
  EXPECT_EQ(target_of("back", "3.141592653589793rad"), -3'200);
  EXPECT_EQ(target_of("plain", "51200"), 51'200) << "it has no unit";
  EXPECT_EQ(
      client->result("axis.move_by", {{"axis", "x"}, {"distance", "-1mm"}}).at("target_microsteps"),
      -10'240);
  const auto turned = client->result("axis.rotate", {{"axis", "x"}, {"velocity", "-60 rpm"}});
  EXPECT_EQ(turned.at("velocity_internal"), -839);
  EXPECT_NEAR(turned.at("velocity").to_number<double>(), -5, 0.001);
  EXPECT_EQ(last(Command::ROL).value, 839);
  client->result("axis.rotate", {{"axis", "plain"}, {"velocity", "-500"}});
  EXPECT_EQ(last(Command::ROL).value, 500);
}

TEST_F(DaemonScale, ATextOfTheAxisItselfIsRoundedOnce) {
  hold(0, 1, 0);
  for (int i = 0; i < 3; ++i) {
    client->result("axis.move_by", {{"axis", "x"}, {"distance", "10um"}});
    hold(0, 1, last(Command::MVP).value);
  }
  EXPECT_EQ(last(Command::MVP).value, 307) << "30 um, and not three times 102";
}

TEST_F(DaemonScale, AScaleIsReadOnceACall) {
  client->result("axis.move_to", {{"axis", "x"}, {"position", "1mm"}});
  EXPECT_EQ(daemon.on_reactor([&] {
    return std::ranges::count_if(daemon.wire().seen, [](const tmcl::Request& request) {
      return request.command == Command::GAP && request.type == 140 && request.motor == 0;
    });
  }),
            1);
}

TEST_F(DaemonScale, WhatIsWrongWithATextHasAnErrorOfItsOwn) {
  hold(2, 140, 8);
  const auto error_of = [&](json::value position, const char* axis = "x") {
    const auto error =
        client->error("axis.move_to", {{"axis", axis}, {"position", std::move(position)}});
    EXPECT_EQ(error.at("code"), -32602);
    EXPECT_EQ(error.at("data").at("param"), "position");
    return text(error.at("data").at("name"));
  };
  EXPECT_EQ(error_of("12"), "bare_number");
  EXPECT_EQ(error_of("12,5mm"), "decimal_comma");
  EXPECT_EQ(error_of("nan"), "not_finite");
  EXPECT_EQ(error_of("1mm 2um"), "two_units");
  EXPECT_EQ(error_of("ten"), "bad_quantity");
  EXPECT_EQ(error_of("1revs"), "unknown_unit");
  EXPECT_EQ(error_of("10pps"), "wrong_unit");
  EXPECT_EQ(error_of("10m"), "out_of_range");
  EXPECT_EQ(error_of(true), "bad_argument");
  EXPECT_EQ(error_of("1.5", "plain"), "bad_quantity");
  EXPECT_EQ(error_of("9000000", "plain"), "out_of_range");
  EXPECT_EQ(error_of("1mm", "plain"), "unknown_unit");
  const auto bare = client->error("axis.rotate", {{"axis", "x"}, {"velocity", "12"}});
  EXPECT_EQ(bare.at("data").at("hint"), "12mm/s or 12pps");
  EXPECT_EQ(daemon.requests_seen(Command::MVP) + daemon.requests_seen(Command::ROR), 0U);
}

TEST_F(DaemonScale, LimitsOfALineAreTakenAsTexts) {
  hold(2, 140, 8);
  const auto refused = [&](json::object params) {
    params["axes"] = {"x", "plain"};
    params["positions"] = {"1mm", "1000"};
    return text(client->error("line.move", std::move(params)).at("data").at("name"));
  };
  EXPECT_EQ(refused({{"velocity", "3mm"}}), "wrong_unit");
  EXPECT_EQ(refused({{"velocity", "3"}}), "bare_number");
  EXPECT_EQ(refused({{"velocity", "-2rps"}}), "out_of_range");
  EXPECT_EQ(refused({{"velocity", "1000rps"}}), "out_of_range");
  EXPECT_EQ(refused({{"acceleration", "3mm/s^2"}}), "unknown_unit") << "of plain";
  EXPECT_EQ(refused({{"velocity", 3}}), "bad_argument");
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
  client->result("coordinate.set", {{"axis", "x"}, {"number", 4}, {"position", "1cm"}});
  EXPECT_EQ(
      client->result("coordinate.get", {{"axis", "x"}, {"number", 4}}).at("position_microsteps"),
      102'400);
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
  const auto set = [&](const char* axis, const char* parameter, json::value value) {
    return client->result(
        "parameter.set",
        {{"axis", axis}, {"parameter", parameter}, {"value_in_unit", std::move(value)}});
  };
  EXPECT_EQ(set("x", "max_velocity", 5).at("value"), 839);
  EXPECT_EQ(last(Command::SAP).value, 839);
  EXPECT_EQ(set("x", "target_position", -2.5).at("value"), -25'600);
  EXPECT_EQ(set("back", "target_position", 90).at("value"), -1'600);
  EXPECT_EQ(set("back", "max_velocity", 3600).at("value"), 1'049) << "a limit has no direction";
  EXPECT_EQ(set("x", "max_velocity", "0.5 cm/s").at("value"), 839);
  hold(2, 140, 8);
  EXPECT_EQ(set("plain", "target_position", "1.5rev").at("value"), 76'800);
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

}  // namespace
}  // namespace tmcld::test
