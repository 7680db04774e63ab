// Units on the command line, and the verbs that are about them.
#include <algorithm>

#include <gmock/gmock.h>

#include "axis/quantity_text.hpp"
#include "axis/typed.hpp"
#include "sim/module/module.hpp"
#include "unit/ctl_bench.hpp"

namespace tmclctl::test {
namespace {

using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

class CtlUnits : public testing::Test, public CtlBench {
 protected:
  explicit CtlUnits(const std::string& toml = axis_in_mm, const char* model = "TMCM-1110")
      : CtlBench(toml, model) {}
  std::string refusal(const std::vector<std::string>& words, ExitCode exit = ExitCode::usage) {
    EXPECT_EQ(run(words), exit) << out << err;
    return err;
  }
};

struct CtlWithoutUnit : CtlUnits {
  CtlWithoutUnit() : CtlUnits(plain_axis) {}
};

TEST_F(CtlUnits, WhatIsTypedIsHandedOnInOneCall) {
  const auto expect = [&](const std::vector<std::string>& words, const char* what) {
    calls.clear();
    EXPECT_EQ(run(words), ExitCode::done) << err;
    EXPECT_THAT(calls, ElementsAre(HasSubstr(what))) << "nothing is asked before";
  };
  expect({"move", "x", "12.50 mm"}, R"("position":"12.50 mm",)");
  expect({"move", "x", "-1.5rev", "--by"}, R"("distance":"-1.5rev",)");
  expect({"move", "x", "51200", "--internal"}, R"("position_microsteps":51200,)");
  expect({"rotate", "x", "-60rpm", "--unattended"}, R"("velocity":"-60rpm",)");
  expect({"rotate", "x", "-500", "--internal", "--unattended"}, R"("velocity_internal":-500,)");
  expect({"set", "x", "max_velocity", "20000pps"},
         R"("parameter":"max_velocity","value_in_unit":"20000pps")");
}

TEST(CtlTyped, IsATextUnlessItIsBareAndInternal) {
  const auto text = [](const Typed& typed) {
    return typed.amount() ? std::get<std::string>(typed.amount()->said) : "none";
  };
  EXPECT_EQ(text({"12.5mm"}), "12.5mm");
  EXPECT_EQ(text({"12"}), "12");
  EXPECT_EQ(text({"-12", true}), "none");
  EXPECT_EQ(Typed({"-12", true}).counted(), -12);
  EXPECT_EQ(text({"12.5mm", true}), "12.5mm");
  EXPECT_EQ(text({"12.5", true}), "12.5");
  EXPECT_EQ(text({""}), "none");
}

TEST_F(CtlUnits, ADistanceCountsFromWhereTheAxisIs) {
  run({"move", "x", "100", "--internal", "--wait"});
  EXPECT_EQ(run({"move", "x", "-1mm", "--by"}), ExitCode::done);
  EXPECT_EQ(get("target_position"), -10'140);
}

TEST_F(CtlUnits, WhatIsWrongWithAQuantityIsToldWithItsCodeAndHint) {
  EXPECT_THAT(refusal({"move", "x", "1revs"}), HasSubstr("Did you mean 'rev'?"));
  EXPECT_THAT(refusal({"move", "x", "12,5mm"}), HasSubstr("12.5mm"));
  const auto document = json({"rotate", "x", "10mm"}, ExitCode::usage);
  EXPECT_EQ(document.at("error").at("name"), "wrong_unit");
  EXPECT_EQ(get("target_position"), 0);
  EXPECT_EQ(get("target_velocity"), 0);
}

void hold_examples(CtlBench& ctl) {
  ctl.place(25'600);
  ctl.set("max_velocity", 1000);
  ctl.set("max_acceleration", 100);
  ctl.set("encoder_position", -1200);
}

std::string in_units(CtlBench& ctl, const char* parameter) {
  EXPECT_EQ(ctl.run({"get", "x", parameter, "--in-units"}), ExitCode::done) << ctl.err;
  return ctl.out;
}

TEST(CtlInUnits, GetPrintsInTheUnitOfTheAxis) {
  CtlBench ctl(axis_in_mm + "reverse = true\n");
  hold_examples(ctl);
  ctl.run({"get", "x", "actual_position"});
  EXPECT_EQ(ctl.out, "25600\n");
  EXPECT_EQ(in_units(ctl, "actual_position"), "-2.5mm\n");
  EXPECT_EQ(in_units(ctl, "max_velocity"), "5.96046447754mm/s\n") << "a limit has no direction";
  EXPECT_THAT(in_units(ctl, "max_acceleration"), HasSubstr("mm/s^2\n"));
  EXPECT_EQ(in_units(ctl, "209"), "0.1171875mm\n") << "in microsteps";
  const auto document = ctl.json({"get", "x", "actual_position", "--in-units"});
  EXPECT_EQ(document.at("value"), 25'600);
  EXPECT_EQ(document.at("value_in_unit"), -2.5);
  EXPECT_EQ(document.at("unit"), "mm");
  EXPECT_EQ(ctl.run({"get", "x", "max_current", "--in-units"}), ExitCode::usage);
  EXPECT_THAT(ctl.err, HasSubstr("is neither"));
}

TEST(CtlInUnits, AnEncoderHasCounts) {
  CtlBench ctl(axis_in_mm + "reverse = true\nencoder_counts_per_unit = 1200\n");
  hold_examples(ctl);
  EXPECT_EQ(in_units(ctl, "209"), "1mm\n");
}

TEST(CtlInUnits, AreTurnsWhereTheAxisHasNone) {
  CtlBench ctl(plain_axis + "reverse = true\n");
  hold_examples(ctl);
  EXPECT_EQ(in_units(ctl, "actual_position"), "-0.5rev\n");
}

TEST_F(CtlUnits, WatchAndPlotAreInTheUnitOfTheAxis) {
  place(128'000);
  run({"watch", "x", "--for", "0.01"});
  EXPECT_THAT(out, HasSubstr("x  position 12.5 mm  velocity 0 mm/s  target 12.5 mm  "));
  run({"watch", "x", "--for", "0.01", "--internal"});
  EXPECT_THAT(out, HasSubstr("x  position 128000  velocity 0  target 128000  "));
  place(0);
  run({"plot", "x", "--by", "1mm"});
  EXPECT_THAT(out, HasSubstr("x went from 0 to 1 mm in 0.26 s, fastest velocity 5.96 mm/s"));
  EXPECT_THAT(out, HasSubstr("position [mm]"));
  EXPECT_THAT(out, HasSubstr("velocity [mm/s]"));
  run({"plot", "x", "--by", "-10240", "--internal"});
  EXPECT_THAT(out, HasSubstr("x went from 10240 to 0 microsteps"));
  const auto document = json({"plot", "x", "--by", "1mm"});
  EXPECT_EQ(document.at("unit"), "mm");
  EXPECT_EQ(document.at("position").as_array().back().to_number<double>(), 1);
  EXPECT_EQ(document.at("position_microsteps").as_array().back(), 10'240);
  run({"plot", "x", "--by", "1mm", "--csv", "-"});
  EXPECT_THAT(out, HasSubstr("\ntime_s,position_microsteps,velocity_internal,position_mm,"
                             "velocity_mm_per_s,utc\n0.000000,10240,"));
  EXPECT_THAT(out, HasSubstr(",20480,0,2,0,1970-01-01T01:"));
}

TEST_F(CtlWithoutUnit, PlotIsInMicrosteps) {
  EXPECT_TRUE(json({"plot", "x", "--by", "-10240"}).at("unit").is_null());
}

TEST_F(CtlWithoutUnit, StateShowsNone) {
  EXPECT_EQ(run({"state", "x"}), ExitCode::done);
  EXPECT_THAT(out, Not(HasSubstr("mm")));
  EXPECT_TRUE(json({"state", "x"}).at("unit").is_null());
}

TEST_F(CtlUnits, StateShowsTheUnitOfTheAxis) {
  place(128'000);
  run({"move", "x", "-3mm"});
  pass(std::chrono::milliseconds(50));
  run({"state", "x"});
  EXPECT_THAT(out, ContainsRegex("position  12\\.[0-9]+ mm = 12[0-9]+ microsteps"));
  EXPECT_THAT(out, HasSubstr("target    -3 mm = -30720 microsteps"));
  EXPECT_THAT(out, ContainsRegex("velocity  -[0-9.]+ mm/s = -[0-9]+ "));
  const auto document = json({"state", "x"});
  EXPECT_EQ(document.at("unit"), "mm");
  EXPECT_EQ(document.at("position"),
            document.at("position_microsteps").to_number<double>() / 10'240);
  EXPECT_EQ(document.at("target"), -3);
  EXPECT_NEAR(document.at("velocity").to_number<double>(),
              document.at("velocity_pps").to_number<double>() / 10'240, 1e-6);
}

TEST_F(CtlWithoutUnit, AxesAndStateTellNothingOfIt) {
  EXPECT_TRUE(json({"state", "x"}).at("microsteps_per_unit").is_null());
  EXPECT_TRUE(json({"axes"}).at("axes").at(0).at("microsteps_per_unit").is_null());
  run({"axes"});
  EXPECT_THAT(out, Not(HasSubstr("/UNIT")));
}

TEST_F(CtlUnits, AxesAndStateTellWhatAUnitIs) {
  EXPECT_EQ(json({"state", "x"}).at("microsteps_per_unit"), 10240);
  EXPECT_TRUE(json({"axes"}).at("axes").at(0).at("encoder_counts_per_unit").is_null());
  run({"state", "x"});
  EXPECT_THAT(out, HasSubstr("unit      mm: 10240 microsteps\n"));
  module().power_off();
  CtlBench silent(axis_in_mm);
  silent.module().power_off();
  EXPECT_TRUE(silent.json({"axes"}).at("axes").at(0).at("microsteps_per_unit").is_null())
      << "what the module does not tell";
}

TEST(CtlEncoderUnits, AreToldByAxesAndState) {
  CtlBench ctl(axis_in_mm + "encoder_counts_per_unit = 1200\n");
  ctl.run({"state", "x"});
  EXPECT_THAT(ctl.out, HasSubstr("unit      mm: 10240 microsteps, 1200 counts of its encoder\n"));
  ctl.run({"axes"});
  EXPECT_THAT(ctl.out, ContainsRegex("UNIT +MICROSTEPS/UNIT +COUNTS/UNIT\n"));
  EXPECT_THAT(ctl.out, ContainsRegex("mm +10240 +1200\n"));
  EXPECT_EQ(ctl.json({"axes"}).at("axes").at(0).at("encoder_counts_per_unit"), 1200);
}

TEST(CtlShown, HasTheDigitsThatOneMicrostepMakes) {
  EXPECT_EQ(shown(InUnit{10, "mm"}, 102'400), "10 mm");
  EXPECT_EQ(shown(InUnit{1 / 10'240.0, "mm"}, 1), "0.0001 mm");
  EXPECT_EQ(shown(InUnit{102'401 / 10'240.0, "mm"}, 102'401), "10.0001 mm");
  EXPECT_EQ(shown(InUnit{-33.333333, "deg"}, 4741), "-33.333 deg");
  EXPECT_EQ(shown(InUnit{1e-7, "mm"}, 1000), "0.0000001 mm");
  EXPECT_EQ(shown(InUnit{1234567, "um"}, 2), "1234567 um");
  EXPECT_EQ(shown(InUnit{0, "mm"}, 0), "0 mm");
  EXPECT_EQ(shown(InUnit{-0.0, "mm"}, 0), "0 mm");
  EXPECT_EQ(shown(std::nullopt, -17), "-17");
}

TEST_F(CtlUnits, MovesAreToldInTheUnitOfTheAxis) {
  run({"move", "x", "10mm"});
  EXPECT_THAT(out, StartsWith("x moves to 10 mm in 1."));
  run({"move", "x", "102400", "--internal"});
  EXPECT_THAT(out, StartsWith("x moves to 102400 in 1."));
  run({"move", "x", "10mm", "--wait"});
  EXPECT_EQ(out, "x stands at 10 mm\n");
  run({"move", "x", "10mm", "--wait", "--internal"});
  EXPECT_EQ(out, "x stands at 102400\n");
  const auto document = json({"move", "x", "10mm", "--wait"});
  EXPECT_EQ(document.at("target_microsteps"), 102'400);
  EXPECT_EQ(document.at("position_microsteps"), 102'400);
  EXPECT_EQ(document.at("unit"), "mm");
  EXPECT_EQ(document.at("target"), 10);
  EXPECT_EQ(document.at("position"), 10);
}

TEST_F(CtlUnits, WhereAMoveEndedEarlyIsToldInTheUnitOfTheAxis) {
  const auto stopped = [&](const std::vector<std::string>& more) {
    other_after(std::chrono::milliseconds(300), "axis.stop", {{"axis", "x"}});
    std::vector<std::string> words{"move", "x", "10mm", "--wait"};
    words.insert(words.end(), more.begin(), more.end());
    EXPECT_EQ(run(words), ExitCode::not_reached);
    return more == std::vector<std::string>{"--json"} ? out : err;
  };
  EXPECT_THAT(stopped({}), ContainsRegex("at 1\\.[0-9]+ mm, on its way to 10 mm"));
  EXPECT_THAT(stopped({"--internal"}), ContainsRegex("at [0-9]+, on its way to 102400"));
  const auto error = boost::json::parse(stopped({"--json"})).at("error");
  EXPECT_EQ(error.at("unit"), "mm");
  EXPECT_EQ(error.at("position"), error.at("position_microsteps").to_number<double>() / 10'240);
  EXPECT_EQ(error.at("target"), 10);
}

TEST_F(CtlUnits, TurnsAreToldInTheUnitOfTheAxis) {
  run({"rotate", "x", "--unattended", "5mm/s"});
  EXPECT_THAT(out, HasSubstr("x turns with velocity 5.001 mm/s. "));
  run({"rotate", "x", "--unattended", "839", "--internal"});
  EXPECT_THAT(out, HasSubstr("x turns with velocity 839. "));
  const auto document = json({"rotate", "x", "--unattended", "5mm/s"});
  EXPECT_EQ(document.at("velocity_internal"), 839);
  EXPECT_EQ(document.at("unit"), "mm");
  EXPECT_NEAR(document.at("velocity").to_number<double>(), 5.0008, 1e-4);
}

TEST_F(CtlWithoutUnit, TurnsAreToldAsTheModuleCounts) {
  EXPECT_TRUE(json({"rotate", "x", "--unattended", "839"}).at("velocity").is_null());
}

TEST_F(CtlUnits, StateShowsOnlyWhatTheModuleCountsIfAsked) {
  place(128'000);
  run({"state", "x", "--internal"});
  EXPECT_THAT(out, HasSubstr("position  128000 microsteps"));
  EXPECT_THAT(out, Not(HasSubstr("mm")));
}

TEST_F(CtlWithoutUnit, ParametersHaveNoColumnForIt) {
  run({"params", "x", "--values"});
  EXPECT_THAT(out, Not(HasSubstr("IN UNIT")));
}

TEST_F(CtlUnits, ParametersHaveAColumnInTheUnitOfTheAxis) {
  set("max_velocity", 839);
  run({"params", "x", "--values"});
  EXPECT_THAT(out, ContainsRegex("VALUE +IN UNIT"));
  EXPECT_THAT(out, ContainsRegex("839 +5.001 mm/s"));
  run({"params", "x", "--values", "--internal"});
  EXPECT_THAT(out, Not(HasSubstr("mm/s")));
  const auto rows = json({"params", "x", "--values"}).at("parameters").as_array();
  const auto row =
      std::ranges::find(rows, 4, [](const auto& one) { return one.at("number").as_int64(); });
  ASSERT_NE(row, rows.end());
  EXPECT_EQ(row->at("value"), 839);
  EXPECT_NEAR(row->at("value_in_unit").to_number<double>(), 5.0008, 1e-4);
  EXPECT_EQ(row->at("axis_unit"), "mm/s");
  run({"get", "x", "4"});
  EXPECT_EQ(out, "839\n") << "scripts rely on that";
  EXPECT_EQ(json({"get", "x", "4"}).at("value_in_unit"), row->at("value_in_unit"));
}

tmcl::sim::StageSettings between_two_switches() {
  tmcl::sim::StageSettings stage;
  stage.left_switch = -51'200;
  stage.right_switch = 51'200;
  return stage;
}

TEST_F(CtlUnits, SearchesAreToldInTheUnitOfTheAxis) {
  module().mount(0, between_two_switches());
  run({"home", "x", "--mode", "right-left"});
  EXPECT_THAT(out, ContainsRegex("zero was at -?[0-9.]+ mm before\n1?[09][0-9.]* mm between the "
                                 "end switches\n"))
      << err;
  run({"home", "x", "--mode", "right-left", "--internal"});
  EXPECT_THAT(out, ContainsRegex("zero was at -?[0-9]+ microsteps before\n10[0-9]+ microsteps "
                                 "between"));
}

TEST_F(CtlWithoutUnit, SearchesAreToldInMicrosteps) {
  module().mount(0, between_two_switches());
  run({"home", "x", "--mode", "left"});
  EXPECT_THAT(out, ContainsRegex("zero was at -?[0-9]+ microsteps before")) << err;
}

TEST_F(CtlUnits, CoordinatesAreInTheUnitOfTheAxis) {
  run({"coordinate", "set", "x", "3", "-700", "--internal"});
  run({"coordinate", "get", "x", "3", "--internal"});
  EXPECT_EQ(out, "-700\n");
  run({"coordinate", "set", "x", "3", "2.5mm"});
  run({"coordinate", "get", "x", "3"});
  EXPECT_EQ(out, "2.5mm\n") << "as it can be typed";
  place(25'600);
  run({"coordinate", "capture", "x", "3", "--internal"});
  EXPECT_EQ(out, "25600\n");
}

TEST_F(CtlWithoutUnit, CoordinatesAreInMicrosteps) {
  run({"coordinate", "set", "x", "3", "25600"});
  run({"coordinate", "get", "x", "3"});
  EXPECT_EQ(out, "25600\n");
}

class CtlRamp : public CtlUnits {
 protected:
  explicit CtlRamp(const char* model = "TMCM-1110") : CtlUnits(axis_in_mm, model) {}
  std::vector<std::string> ramp(std::vector<std::string> more = {}) {
    std::vector<std::string> words{"ramp",           "x",          "--velocity", "50000pps",
                                   "--acceleration", "200000pps/s"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
};

struct CtlRampOfA142 : CtlRamp {
  CtlRampOfA142() : CtlRamp("TMCM-142") {}
};
struct CtlRampOfA6212 : CtlRamp {
  CtlRampOfA6212() : CtlRamp("TMCM-6212") {}
};

TEST_F(CtlRampOfA142, IsOneCall) {
  EXPECT_EQ(run(ramp({"--deceleration", "5mm/s2", "--jerk", "max"})), ExitCode::done) << err;
  EXPECT_THAT(calls,
              ElementsAre(R"(axis.set_ramp {"axis":"x","velocity":"50000pps",)"
                          R"("acceleration":"200000pps/s","deceleration":"5mm/s2","jerk":"max"})"));
  calls.clear();
  run({"ramp", "x", "--velocity", "1000", "--acceleration", "100", "--jerk", "7", "--internal",
       "--dry-run"});
  EXPECT_THAT(calls, ElementsAre(R"(axis.plan_ramp {"axis":"x","velocity_internal":1000,)"
                                 R"("acceleration_internal":100,"bow":7})"));
}

TEST_F(CtlRamp, ShowsWhatIsSetAndWhatThatGives) {
  run(ramp());
  EXPECT_EQ(out,
            "pulse_divisor      3\n"
            "ramp_divisor       8\n"
            "max_velocity       1638\n"
            "max_acceleration   859\n"
            "minimum_velocity   20\n"
            "gives 4.88162 mm/s, 19.5314 mm/s^2; up to speed in 0.2499 s and 6247 microsteps\n"
            "it holds until the module loses power: --store keeps it\n");
  EXPECT_EQ(get("max_velocity"), 1638);
  EXPECT_EQ(get("pulse_divisor"), 3);
  run(ramp({"--deceleration", "5mm/s2"}));
  EXPECT_EQ(err, "tmclctl: warning: the deceleration is 19.5314 mm/s2, not 5 mm/s2\n");
  run(ramp({"--internal", "--dry-run"}));
  EXPECT_THAT(out, HasSubstr("gives 49987.79297 pps, 200001.5229 pps/s; up to"));
  EXPECT_THAT(out, HasSubstr("; nothing was written\n"));
}

TEST_F(CtlRampOfA142, ShowsDecelerationAndJerk) {
  run(ramp({"--deceleration", "10mm/s2", "--jerk", "max"}));
  EXPECT_THAT(out, ContainsRegex(" mm/s\\^2, [0-9.]+ mm/s\\^2, [0-9.]+ mm/s\\^3;")) << err;
}

TEST_F(CtlRamp, TellsAllOfItInJson) {
  const auto document = json(ramp({"--dry-run", "--deceleration", "5mm/s2"}));
  EXPECT_EQ(document.at("written"), false);
  EXPECT_EQ(get("pulse_divisor"), 2);
  EXPECT_EQ(document.at("model"), "TMCM-1110");
  EXPECT_EQ(document.at("parameters").at("pulse_divisor"), 3);
  EXPECT_FALSE(document.contains("settings"));
  EXPECT_EQ(document.at("remarks").as_array().size(), 1U);
  EXPECT_EQ(json(ramp()).at("written"), true);
}

TEST_F(CtlRampOfA142, ComparesByOneCall) {
  EXPECT_EQ(run(ramp({"--compare", "--distance", "10mm", "--resonance", "12Hz", "--tolerance",
                      "0.01mm"})),
            ExitCode::done)
      << err;
  EXPECT_THAT(calls, ElementsAre(R"(ramp.compare {"axis":"x","velocity":"50000pps",)"
                                 R"("acceleration":"200000pps/s","distance":"10mm",)"
                                 R"("resonance_hz":1.2E1,"tolerance":"0.01mm"})"));
  EXPECT_THAT(out, ContainsRegex("max_bow 8 +2.2997 +0.24828 +0.0020928 +2.2997\n"));
  EXPECT_THAT(out, ContainsRegex("max_bow 18 +swings for ever +0.39072 +- +-\n"));
  EXPECT_THAT(out, HasSubstr("the load stands first with max_bow 0, after 2.29 s\n"));
  EXPECT_EQ(json(ramp({"--compare", "--distance", "10mm", "--resonance", "12Hz", "--tolerance",
                       "0.01mm"}))
                .at("proposed"),
            0);
}

TEST_F(CtlRamp, ComparesOnlyWhatIsSaid) {
  EXPECT_THAT(refusal(ramp({"--compare"})), HasSubstr("--compare needs --distance"));
  EXPECT_THAT(refusal(ramp({"--distance", "1mm"})), HasSubstr("--distance needs --compare"));
  EXPECT_THAT(refusal(ramp({"--resonance", "12Hz"})), HasSubstr("--resonance needs --compare"));
  EXPECT_THAT(refusal(ramp({"--compare", "--distance", "1mm", "--damping", "0.1"})),
              HasSubstr("--damping needs --resonance"));
  EXPECT_THAT(refusal(ramp({"--compare", "--distance", "1mm", "--resonance", "12kHz"})),
              HasSubstr("'12k' is no number"));
  EXPECT_THAT(calls, IsEmpty());
}

TEST_F(CtlRampOfA6212, SeeksOnAnAxis) {
  EXPECT_EQ(run({"ramp", "x", "--time", "3s", "--distance", "10mm", "--velocity", "5mm/s"}),
            ExitCode::done)
      << err;
  EXPECT_THAT(out, ContainsRegex("max_velocity       [0-9]+\n"));
  EXPECT_THAT(out, ContainsRegex("nothing was written\nthe move takes [23][0-9.]* s and gets to "
                                 "[45][0-9.]* mm/s"));
  EXPECT_EQ(run({"ramp", "x", "--fastest", "--distance", "10mm", "--inertia", "2000",
                 "--corner-speed", "600", "--margin", "50%"}),
            ExitCode::done)
      << err;
  EXPECT_THAT(out, ContainsRegex("asks for 34.0 % of the torque at most, at [0-9]+ pps\n"));
  EXPECT_THAT(
      calls,
      ElementsAre(R"(ramp.find {"axis":"x","distance":"10mm","time_s":3E0,"velocity":"5mm/s"})",
                  R"(ramp.find {"axis":"x","distance":"10mm","load":0E0,"load_per_velocity":0E0,)"
                  R"("inertia":2E3,"corner_speed":6E2,"margin":5E-1})"));
}

TEST_F(CtlRamp, SeeksOnlyWhatIsSaid) {
  EXPECT_THAT(refusal({"ramp", "x"}), HasSubstr("give --velocity and --acceleration, or --time"));
  EXPECT_THAT(refusal({"ramp", "x", "--time", "1s"}), HasSubstr("need --distance"));
  EXPECT_THAT(refusal({"ramp", "x", "--time", "1s", "--fastest", "--distance", "1mm"}),
              HasSubstr("exclude each other"));
  EXPECT_THAT(refusal({"ramp", "x", "--fastest", "--distance", "1mm"}),
              HasSubstr("--fastest needs --load, --friction or --inertia"));
  EXPECT_THAT(
      refusal({"ramp", "x", "--fastest", "--distance", "1mm", "--load", "5", "--margin", "30"}),
      HasSubstr("30 is a part above 1: give 30%, or a part"));
  EXPECT_THAT(refusal({"ramp", "x", "--time", "1mm", "--distance", "1mm"}),
              HasSubstr("'1mm' is no time in s or ms"));
  EXPECT_THAT(refusal({"ramp", "x", "--time", "0s", "--distance", "1mm"}), HasSubstr("not within"));
  EXPECT_THAT(refusal(ramp({"--inertia", "5"})), HasSubstr("need --fastest or --time"));
  EXPECT_THAT(refusal(ramp({"--time", "1s", "--distance", "1mm"})),
              HasSubstr("find the acceleration"));
  EXPECT_THAT(calls, IsEmpty());
}

// ---- without a module

TEST_F(CtlRamp, OfAModelIsTheGentlestInTime) {
  const std::vector<std::string> words{"ramp",   "--model", "TMCM-6212",  "--screw-pitch", "5",
                                       "--time", "1s",      "--distance", "20mm"};
  const auto document = json(words);
  EXPECT_THAT(calls, IsEmpty());
  EXPECT_LE(document.at("move_s").to_number<double>(), 1);
  // 4 s / t^2, and 2 s / t.
  EXPECT_NEAR(document.at("acceleration").to_number<double>(), 80, 0.5);
  EXPECT_NEAR(document.at("top_speed").to_number<double>(), 40, 0.5);
  auto as_sap = words;
  as_sap.insert(as_sap.end(), {"--as", "sap"});
  EXPECT_EQ(run(as_sap), ExitCode::done) << err;
  EXPECT_THAT(out, HasSubstr("// max_acceleration\n"));
  auto too_quick = words;
  too_quick[6] = "1ms";
  EXPECT_THAT(refusal(too_quick), HasSubstr("s at best"));
}

// The load alone leaves 1000 / 1.3 - 100; a corner at 600 full steps a second is 153600 pps.
TEST_F(CtlRamp, OfAModelIsTheQuickestWithinTheTorque) {
  const std::vector<std::string> words{
      "ramp",   "--model", "TMCM-6212", "--fastest", "--distance",     "200000microsteps",
      "--load", "100",     "--inertia", "20000",     "--corner-speed", "600"};
  const auto document = json(words);
  EXPECT_LE(document.at("torque_share").to_number<double>(), 1 / 1.3);
  EXPECT_GT(document.at("torque_share").to_number<double>(), 0.97 / 1.3);
  auto with_more = words;
  with_more.insert(with_more.end(), {"--margin", "200%"});
  EXPECT_GT(json(with_more).at("move_s").to_number<double>(),
            document.at("move_s").to_number<double>());
  auto too_heavy = words;
  too_heavy[7] = "900";
  EXPECT_THAT(refusal(too_heavy), HasSubstr("less torque than the margin wants"));
}

TEST_F(CtlRamp, OfAModelComparesAllBows) {
  const auto document = json({"ramp", "--model", "TMCM-142", "--screw-pitch", "5", "--velocity",
                              "20mm/s", "--acceleration", "200mm/s^2", "--compare", "--distance",
                              "10mm", "--resonance", "12", "--tolerance", "0.01mm"});
  EXPECT_THAT(calls, IsEmpty());
  const auto& ramps = document.at("ramps").as_array();
  ASSERT_EQ(ramps.size(), 19U);
  const auto& proposed = ramps.at(static_cast<std::size_t>(document.at("proposed").as_int64()));
  for (const auto& other : ramps) {
    if (other.at("settled_s").is_null()) continue;
    EXPECT_GE(other.at("settled_s").to_number<double>(),
              proposed.at("settled_s").to_number<double>());
  }
  EXPECT_EQ(json({"ramp", "--model", "TMCM-6212", "--velocity", "50000pps", "--acceleration",
                  "500000pps/s", "--compare", "--distance", "40000microsteps"})
                .at("ramps")
                .as_array()
                .size(),
            25U);
  EXPECT_THAT(refusal({"ramp", "--model", "TMCM-1021", "--velocity", "50000pps", "--acceleration",
                       "500000pps/s", "--compare", "--distance", "40000microsteps"}),
              HasSubstr("is not described"));
}

TEST_F(CtlRamp, OfAModelNeedsNoModule) {
  const auto document = json({"ramp", "--model", "TMCM-142", "--screw-pitch", "5", "--velocity",
                              "20mm/s", "--acceleration", "500mm/s^2", "--jerk", "max"});
  EXPECT_THAT(calls, IsEmpty());
  EXPECT_EQ(document.at("model"), "TMCM-142");
  EXPECT_EQ(document.at("unit"), "mm");
  EXPECT_EQ(document.at("written"), false);
  EXPECT_FALSE(document.contains("axis"));
  // 204800 pps and 5120000 pps/s by f / 2^30 and f^2 / 2^42; 15/16 of the deceleration is used.
  EXPECT_EQ(document.at("registers").at("v_max"), 13'743'895);
  EXPECT_EQ(document.at("registers").at("a_max"), 87'961);
  EXPECT_EQ(document.at("registers").at("d_max"), 93'825);
  EXPECT_EQ(document.at("parameters").at("max_velocity"), 13'743'895);
  EXPECT_EQ(document.at("parameters").at("max_bow"), 16);
  EXPECT_NEAR(document.at("velocity").to_number<double>(), 20, 1e-5);
  EXPECT_NEAR(document.at("deviation").at("velocity").to_number<double>(), 0, 1e-7);
  EXPECT_NE(document.at("deviation").at("acceleration").to_number<double>(), 0);
}

TEST_F(CtlRamp, OfAModelShowsRegistersBesideParameters) {
  EXPECT_EQ(run({"ramp", "--model", "TMCM-6212", "--screw-pitch", "5", "--velocity", "20mm/s",
                 "--acceleration", "500mm/s^2"}),
            ExitCode::done)
      << err;
  EXPECT_THAT(out, ContainsRegex("max_velocity +4 +204800 +vmax +214748\n"));
  EXPECT_THAT(out, ContainsRegex("max_acceleration +5 +5120000 +amax +43980\n"));
  EXPECT_THAT(out, HasSubstr("gives 20 mm/s, 500 mm/s^2; up to speed in 0.04 s"));
  EXPECT_THAT(out, HasSubstr("off the wish: velocity +0.000 %, acceleration +0.000 %"));
}

/// What it chooses is what a gateway chooses for an axis that is like that.
TEST_F(CtlRamp, OfAModelIsThatOfEveryFamily) {
  for (const auto* model : {"TMCM-1110", "TMCM-142", "TMCM-6212", "TMCM-1111", "TMCM-1021"}) {
    const auto document =
        json({"ramp", "--model", model, "--units-per-revolution", "360", "--unit", "deg",
              "--gear-ratio", "3", "--velocity", "90deg/s", "--acceleration", "2rps/s"});
    EXPECT_NEAR(document.at("velocity").to_number<double>(), 90, 0.1) << model;
    EXPECT_NEAR(document.at("acceleration").to_number<double>(), 240, 2) << model;
  }
}

TEST_F(CtlRamp, OfAModelIsRefusedAsOnAnAxis) {
  const std::vector<std::string> ramp{"ramp", "--model",    "TMCM-6212", "--screw-pitch",
                                      "5",    "--velocity", "20mm/s"};
  const auto said = [&](std::vector<std::string> more) {
    more.insert(more.begin(), ramp.begin(), ramp.end());
    return refusal(more);
  };
  EXPECT_THAT(said({"--acceleration", "800mm/s^2"}),
              HasSubstr("800 mm/s^2 is too large; the nearest possible value is 745.0"));
  EXPECT_THAT(err, HasSubstr("parameter 140 set to 7"));
  EXPECT_THAT(said({"--acceleration", "500mm/s^2", "--jerk", "1mm/s^3"}),
              HasSubstr("a TMCM-6212 has no bow"));
  EXPECT_THAT(said({"--acceleration", "500mm/s"}), HasSubstr("is no acceleration"));
  EXPECT_THAT(said({"--acceleration", "500mm/s^2", "--unit", "rev"}), HasSubstr("is one that"));
  EXPECT_THAT(refusal({"ramp", "--velocity", "1pps", "--acceleration", "1pps/s"}),
              HasSubstr("name an axis, or say --model MODEL"));
  EXPECT_THAT(refusal({"ramp", "x", "--screw-pitch", "5", "--velocity", "1pps", "--acceleration",
                       "1pps/s"}),
              HasSubstr("needs --model"));
}

class CtlConvert : public CtlUnits {
 protected:
  using Words = std::vector<std::string>;
};

TEST_F(CtlConvert, ShowsAVelocityInEveryUnit) {
  const auto document = json({"convert", "--model", "TMCM-1110", "61035pps"});
  EXPECT_EQ(document.at("model"), "TMCM-1110");
  EXPECT_FALSE(document.contains("position"));
  const auto& velocity = document.at("velocity").as_object();
  EXPECT_EQ(velocity.at("internal"), 1000);
  EXPECT_NEAR(velocity.at("pps").to_number<double>(), 61'035.16, 0.01);
  EXPECT_NEAR(velocity.at("rps").to_number<double>(), 1.192, 0.001);
  EXPECT_NEAR(velocity.at("rpm").to_number<double>(), 71.53, 0.01);
  EXPECT_NEAR(velocity.at("full_steps_per_second").to_number<double>(), 238.4, 0.1);
  EXPECT_EQ(run({"convert", "--model", "1110", "61035pps"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr("61035.15625 pps\n"));
  EXPECT_THAT(calls, IsEmpty()) << "no module is needed";
}

// The note's v[FS] and a[FS]: by the microsteps of a full step.
TEST_F(CtlConvert, ShowsFullStepsASecondAsMicrostepsDivided) {
  for (const int microsteps : {1, 16, 256}) {
    const auto of = [&](const char* quantity) {
      return json({"convert", "--model", "TMCM-6212", "--microsteps", std::to_string(microsteps),
                   quantity});
    };
    const auto full = [](const boost::json::object& document, const char* what, const char* key) {
      return document.at(what).at(key).to_number<double>();
    };
    EXPECT_NEAR(full(of("51200pps"), "velocity", "full_steps_per_second"), 51'200.0 / microsteps,
                1e-9);
    EXPECT_NEAR(full(of("51200pps/s"), "acceleration", "full_steps_per_second2"),
                51'200.0 / microsteps, 1e-9);
    EXPECT_NEAR(full(of("51200microsteps"), "position", "full_steps"), 51'200.0 / microsteps, 1e-9);
  }
}

TEST_F(CtlConvert, ABareNumberIsShownAsEverythingThatItMayMean) {
  const auto document = json({"convert", "--model", "TMCM-3110", "--pulse-div", "2", "--ramp-div",
                              "3", "--microsteps", "64", "500"});
  EXPECT_EQ(document.at("position").at("full_steps").to_number<double>(), 7.8125);
  EXPECT_NEAR(document.at("velocity").at("pps").to_number<double>(), 30'517.6, 0.1);
  EXPECT_NEAR(document.at("acceleration").at("pps2").to_number<double>(), 7.45e6, 1e4);
  // But not as what no register can hold.
  EXPECT_TRUE(json({"convert", "--model", "TMCM-142", "16777213"}).contains("acceleration"));
  EXPECT_FALSE(json({"convert", "--model", "TMCM-142", "16777214"}).contains("acceleration"));
  EXPECT_FALSE(json({"convert", "--model", "TMCM-142", "2147418113"}).contains("velocity"));
  EXPECT_FALSE(json({"convert", "--model", "TMCM-142", "--", "-5"}).contains("acceleration"));
}

TEST_F(CtlConvert, WhatNoRegisterHoldsIsRefusedWithTheGreatest) {
  EXPECT_EQ(run({"convert", "--model", "TMCM-142", "16777214"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr("no acceleration: max_acceleration (5) holds 0 to 16777213\n"));
  EXPECT_THAT(refusal({"convert", "--model", "TMCM-142", "2147483648"}),
              HasSubstr("no register of a TMCM-142 holds 2147483648: it is no position: "
                        "target_position (0) holds -2147483648 to 2147483647, no velocity: "
                        "target_velocity (2) holds -2147418112 to 2147418112"));
  EXPECT_THAT(refusal({"convert", "--model", "TMCM-1110", "1e300"}), HasSubstr("to 8388607"));
  // In the unit of the moment.
  const Words in_pps{"convert", "--model", "TMCM-142", "--unit-mode", "1"};
  const auto bare = [&](const char* number) {
    auto words = in_pps;
    words.emplace_back(number);
    return json(words);
  };
  EXPECT_TRUE(bare("31999023").contains("velocity"));
  EXPECT_FALSE(bare("31999024").contains("velocity"));
  EXPECT_THAT(refusal({"convert", "--model", "TMCM-6212", "--microsteps", "256", "1000rps"}),
              HasSubstr("nearest possible value"));
}

TEST_F(CtlConvert, KnowsUnitModesAndTurns) {
  EXPECT_EQ(
      json({"convert", "--model", "TMCM-6212", "--microsteps", "64", "--full-steps", "400", "2rps"})
          .at("velocity")
          .at("internal"),
      51'200);
  EXPECT_EQ(json({"convert", "--model", "TMCM-6212", "--unit-mode", "0", "1000000pps"})
                .at("velocity")
                .at("internal"),
            1 << 20);
  EXPECT_EQ(json({"convert", "--model", "TMCM-142", "1.5rev"}).at("position").at("microsteps"),
            76'800);
}

// A motor of 200 full steps, 16 microsteps and 3 turns a second.
TEST_F(CtlConvert, HasTheStepRateOfAn035) {
  const auto document = json({"convert", "--model", "TMCM-6212", "--microsteps", "16", "3rps"});
  EXPECT_EQ(document.at("velocity").at("pps").to_number<double>(), 9600);
}

TEST_F(CtlConvert, SaysWhatABowIs) {
  const auto document = json({"convert", "--model", "TMCM-142", "--bow", "11"});
  const auto& jerk = document.at("jerk").as_object();
  EXPECT_EQ(jerk.at("bow_value").to_number<double>(), 1024);
  EXPECT_NEAR(jerk.at("pps3").to_number<double>(), 931'322'574.6, 0.1);
  EXPECT_GT(jerk.at("full_acceleration_s").to_number<double>(), 0);
  const auto back = json({"convert", "--model", "TMCM-142", "931322575pps/s2"});
  EXPECT_EQ(back.at("jerk").at("bow").to_number<double>(), 11);
  for (const auto* jerk : {"1pps/s2", "100pps/s2", "900000pps/s2"}) {
    EXPECT_THAT(
        refusal({"convert", "--model", "TMCM-142", jerk}),
        HasSubstr("below the jerk of the smallest bow; the nearest possible value is 909494"));
  }
  EXPECT_THAT(refusal({"convert", "--model", "TMCM-142", "0.01rps/s2"}),
              HasSubstr("0.01 rps/s2 is below the jerk of the smallest bow; the nearest possible "
                        "value is 17.7"));
  EXPECT_THAT(refusal({"convert", "--model", "TMCM-6212", "--bow", "11"}),
              HasSubstr("--bow means nothing to a TMCM-6212"));
}

TEST_F(CtlConvert, ABowOfNothingIsATrapezoid) {
  const auto document = json({"convert", "--model", "TMCM-142", "--bow", "0"});
  EXPECT_EQ(document.at("jerk").at("bow_value"), 0);
  EXPECT_EQ(document.at("jerk").at("full_acceleration_s"), 0);
  EXPECT_FALSE(document.at("jerk").as_object().contains("pps3"));
  EXPECT_EQ(run({"convert", "--model", "TMCM-142", "--bow", "0"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr("no bow, so ramps are trapezoids"));
  const Words ramp{"convert", "--model", "TMCM-142", "40000pps", "--acceleration", "400000pps/s"};
  auto with_none = ramp;
  with_none.insert(with_none.end(), {"--bow", "0"});
  EXPECT_EQ(json(with_none), json(ramp));
}

// "The resulting bow_value must not exceed A_MAX or D_MAX setting."
TEST_F(CtlConvert, ABowAboveTheAccelerationIsAWarning) {
  const auto warned = [this](const Words& more) {
    Words words{"convert", "--model", "TMCM-142", "40000pps"};
    words.insert(words.end(), more.begin(), more.end());
    EXPECT_EQ(run(words), ExitCode::done) << err;
    return err;
  };
  EXPECT_THAT(
      warned({"--bow", "18", "--acceleration", "400000pps/s"}),
      HasSubstr("max_bow 18 is 131072 and so exceeds acceleration 6872: the motor oscillates"));
  EXPECT_THAT(warned({"--bow", "13", "--acceleration", "400000pps/s"}),
              HasSubstr("no less than half of acceleration 6872: the motor may oscillate"));
  EXPECT_EQ(warned({"--bow", "12", "--acceleration", "400000pps/s"}), "");
  EXPECT_THAT(warned({"--unit-mode", "1", "--bow", "18", "--acceleration", "400000"}),
              HasSubstr("exceeds acceleration 400000 pps/s"));
}

TEST_F(CtlConvert, RefusesWhatMakesNoSense) {
  EXPECT_THAT(refusal({"convert", "--model", "TMCM-1111x", "2rps"}), HasSubstr("no model"));
  EXPECT_THAT(refusal({"convert", "--model", "TMCM-6212", "--pulse-div", "2", "2rps"}),
              HasSubstr("--pulse-div means nothing to a TMCM-6212"));
  EXPECT_THAT(refusal({"convert", "--model", "TMCM-1110", "--unit-mode", "1", "2rps"}),
              HasSubstr("--unit-mode means nothing"));
  EXPECT_THAT(refusal({"convert", "--model", "TMCM-1110", "1e6pps"}),
              HasSubstr("nearest possible value is 124938.9 pps"));
  EXPECT_THAT(refusal({"convert", "--model", "TMCM-1110", "10mm"}),
              HasSubstr("axis of a TMCM-1110 has no unit 'mm'"));
}

}  // namespace
}  // namespace tmclctl::test
