// The ramp of an axis, chosen and set by the gateway.
#include <gmock/gmock.h>

#include "tmcl/api/ramp.hpp"
#include "unit/journey_bench.hpp"

namespace tmcld::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr const char* in_mm = "unit = \"mm\"\nunits_per_revolution = 5\n";

struct DaemonRamp : testing::Test {
  explicit DaemonRamp(const char* model = "TMCM-1110") : bench(model, in_mm) {}

  Result<boost::json::object> call(const char* method, json::object more) {
    more["axis"] = "x";
    return bench.call(method, std::move(more));
  }
  static json::object ramp(const char* velocity, const char* acceleration) {
    return {{"velocity", velocity}, {"acceleration", acceleration}};
  }
  Result<boost::json::object> set(json::object params) {
    return call("axis.set_ramp", std::move(params));
  }
  json::object planned(json::object params) {
    const auto result = call("axis.plan_ramp", std::move(params));
    return result ? *result : json::object{{"error", result.error().message}};
  }
  /// "name: message (hint)" of a ramp that cannot be.
  std::string refusal(json::object params) {
    const auto result = call("axis.plan_ramp", std::move(params));
    if (result) return "none";
    const auto& error = result.error();
    return error.name + ": " + error.message + " (" + error.hint + ')';
  }
  void put(int parameter, int value) {
    const auto done =
        bench.call("parameter.set", {{"axis", "x"}, {"parameter", parameter}, {"value", value}});
    ASSERT_TRUE(done) << done.error().message;
    bench.requests.clear();
  }
  /// Such as "154=3".
  std::vector<std::string> written() const {
    std::vector<std::string> all;
    for (const auto& request : bench.sent(tmcl::Command::SAP))
      all.push_back(std::to_string(request.type) + '=' + std::to_string(request.value));
    return all;
  }
  static json::array warnings(const Result<boost::json::object>& result) {
    return result ? result->at("warnings").as_array() : json::array{result.error().message};
  }

  JourneyBench bench;
};

TEST_F(DaemonRamp, IsChosenAndWritten) {
  put(154, 2);
  const auto done = set(ramp("50000pps", "200000pps/s"));
  ASSERT_TRUE(done) << done.error().message;
  EXPECT_THAT(written(), ElementsAre("154=3", "153=8", "4=1638", "5=859", "130=20"));
  const auto ramp = api::from_json<api::axis::Ramp>(*done);
  EXPECT_EQ(ramp.model, "TMCM-1110");
  EXPECT_EQ(ramp.unit, "mm");
  EXPECT_NEAR(ramp.velocity_pps, 49'987.79297, 1e-5);
  EXPECT_NEAR(ramp.velocity.value(), 4.88162, 1e-5);
  EXPECT_NEAR(ramp.acceleration.value(), 19.5314, 1e-4);
  EXPECT_NEAR(ramp.ramp_s, 0.2499, 1e-4);
  EXPECT_NEAR(ramp.ramp_microsteps, 6247, 1);
  EXPECT_FALSE(ramp.jerk);
  EXPECT_EQ(ramp.settings.front().parameter, "pulse_divisor");
  EXPECT_EQ(bench.get("x", 4), 1638);
}

TEST_F(DaemonRamp, ALowerDividerIsWrittenAfterTheRegistersSoThatNothingIsFastInBetween) {
  put(154, 5);
  const auto done = set(ramp("50000pps", "200000pps/s"));
  ASSERT_TRUE(done) << done.error().message;
  EXPECT_THAT(written(), ElementsAre("4=1638", "5=859", "130=20", "154=3", "153=8"));
  EXPECT_EQ(done->at("settings").at(0).at("parameter"), "max_velocity") << "as it was written";
}

// Ramp ticks of 8 ms: each changes the speed by seven of its units.
TEST_F(DaemonRamp, IsWarnedOfWhereAMoveDoesNotArrive) {
  const auto swings = planned(ramp("125564.8pps", "102854.9pps/s"));
  EXPECT_THAT(json::serialize(swings.at("warnings")), HasSubstr("may not come to rest"));
  EXPECT_THAT(planned(ramp("125564.8pps", "100000pps/s")).at("warnings").as_array(), IsEmpty());
}

TEST_F(DaemonRamp, APlanWritesNothing) {
  const auto plan = planned(ramp("10mm/s", "100mm/s2"));
  EXPECT_THAT(written(), IsEmpty());
  EXPECT_EQ(plan.at("settings").at(0).at("value"), 2);
  EXPECT_NEAR(plan.at("velocity_pps").as_double(), 102'400, 31);
  EXPECT_NEAR(plan.at("acceleration_pps2").as_double(), 1'024'000, 500);
  const json::object numbers{{"velocity", 10}, {"acceleration", 100}};
  EXPECT_EQ(planned(numbers), plan) << "a number is in the unit of the axis";
}

TEST_F(DaemonRamp, IsNotChangedWhileTheAxisMoves) {
  bench.call("axis.rotate", {{"axis", "x"}, {"velocity_internal", 100}}).value();
  bench.time.run_for(std::chrono::seconds(1));
  bench.requests.clear();
  const auto refused = set(ramp("50000pps", "200000pps/s"));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::not_now);
  EXPECT_THAT(refused.error().message, HasSubstr("axis x moves"));
  EXPECT_THAT(written(), IsEmpty());
}

TEST_F(DaemonRamp, WhatCannotBeHadIsRefusedWithTheNearest) {
  EXPECT_THAT(refusal(ramp("600000pps", "1e6pps/s")), HasSubstr("499755.8 pps"));
  EXPECT_THAT(refusal(ramp("20rps", "1rps/s")), HasSubstr("20 rps is too fast"));
  EXPECT_THAT(refusal(ramp("400000pps", "1pps/s")), HasSubstr("too small an acceleration"));
  EXPECT_THAT(refusal(ramp("10pps", "1e9pps/s")), HasSubstr("too large an acceleration"));
  EXPECT_THAT(refusal(ramp("0pps", "1000pps/s")), HasSubstr("'velocity' must be greater than 0"));
  EXPECT_THAT(refusal(ramp("-5pps", "1000pps/s")), HasSubstr("greater than 0"));
  EXPECT_THAT(refusal(ramp("50000pps", "1000pps")), HasSubstr("no acceleration"));
  EXPECT_THAT(refusal(ramp("500", "1000pps/s")), HasSubstr("500mm/s or 500pps"));
  EXPECT_THAT(refusal({{"velocity", "5mm/s"}}), HasSubstr("'acceleration' is needed"));
  EXPECT_THAT(written(), IsEmpty());
}

TEST_F(DaemonRamp, CanBeSaidInWhatTheModuleCounts) {
  put(154, 3);
  const auto plan = planned({{"velocity_internal", 1000}, {"acceleration_internal", 100}});
  EXPECT_NEAR(plan.at("velocity_pps").as_double(), 30'517.578125, 1);
}

// What is refused in the middle leaves a module half set: it is said how far it came.
TEST_F(DaemonRamp, AFailureTellsWhatWasWrittenBefore) {
  put(154, 2);
  bench.wire.refuses = [&](const tmcl::Request& request) {
    return request.command == tmcl::Command::SAP && request.type == 153;
  };
  const auto failed = set(ramp("50000pps", "200000pps/s"));
  ASSERT_FALSE(failed);
  EXPECT_THAT(failed.error().message,
              HasSubstr("about ramp_divisor = 8, and these were written before: "
                        "pulse_divisor = 3"));
}

TEST_F(DaemonRamp, AStopEndsIt) {
  put(154, 2);
  bool has_stopped = false;
  bench.on_request = [&](const tmcl::Request& request) {
    if (request.command != tmcl::Command::SAP || std::exchange(has_stopped, true)) return;
    bench.begin("axis.stop", {{"axis", "x"}});
  };
  const auto ended = set(ramp("50000pps", "200000pps/s"));
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().name, "superseded_by_stop");
  EXPECT_THAT(written(), ElementsAre("154=3"));
}

TEST_F(DaemonRamp, AsItIsForeseesMovements) {
  put(4, 700);
  const auto held = api::from_json<api::axis::HeldRamp>(call("axis.get_ramp", {}).value());
  EXPECT_EQ(held.model, "TMCM-1110");
  auto twin = tmcl::plan::AxisTwin::of(*tmcl::find_model(held.model)).value();
  for (const auto& setting : held.settings)
    EXPECT_TRUE(twin.set({setting.number, setting.value})) << setting.parameter;
  twin.place({held.position_microsteps});
  twin.move_to({10'000});
  const auto foreseen = twin.time_to_arrival().value();
  const auto move =
      call("axis.move_to", {{"position_microsteps", 10'000}}).value().at("predicted_s").as_double();
  EXPECT_NEAR(std::chrono::duration<double>(foreseen).count(), move, 0.01);
  const auto moving = call("axis.get_ramp", {});
  ASSERT_FALSE(moving);
  EXPECT_EQ(moving.error().name, "not_foreseeable");
  EXPECT_THAT(moving.error().message, HasSubstr("it moves already"));
}

TEST_F(DaemonRamp, IsToldInMotionWhereThatIsWanted) {
  put(4, 700);
  const auto at_rest = call("axis.get_ramp", {}).value();
  ASSERT_TRUE(call("axis.move_to", {{"position_microsteps", 10'000}}));
  bench.time.run_for(std::chrono::milliseconds(200));
  const auto in_motion = call("axis.get_ramp", {{"in_motion", true}});
  ASSERT_TRUE(in_motion) << in_motion.error().message;
  EXPECT_EQ(in_motion->at("settings"), at_rest.at("settings"));
  EXPECT_GT(in_motion->at("position_microsteps").as_int64(), 0);
  EXPECT_LT(in_motion->at("position_microsteps").as_int64(), 10'000);
}

TEST(DaemonRampOfOthers, IsNotForeseenWhereNobodyHasDescribedIt) {
  JourneyBench bench("TMCM-1111");
  const auto refused = bench.call("axis.get_ramp", {{"axis", "x"}});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("the ramps of a TMCM-1111 are not described"));
}

struct DaemonBow : DaemonRamp {
  DaemonBow() : DaemonRamp("TMCM-142") {}
  static json::object with(json::object more) {
    auto params = ramp("40000pps", "400000pps/s");
    for (const auto& [name, value] : more) params[name] = value;
    return params;
  }
  /// What becomes of parameter 18; -1: nothing.
  int bow_for(json::object more) {
    const auto plan = planned(with(std::move(more)));
    for (const auto& setting : plan.at("settings").as_array())
      if (setting.at("number") == 18) return setting.at("value").to_number<int>();
    return -1;
  }
};

TEST_F(DaemonBow, IsLeftAsItIsUnlessAJerkIsAskedFor) {
  put(18, 11);
  EXPECT_EQ(bow_for({}), -1);
  EXPECT_NEAR(planned(with({})).at("jerk").as_double(), 90'949.47018, 1e-3) << "but told";
  put(18, 0);
  EXPECT_EQ(bow_for({}), -1);
  EXPECT_TRUE(planned(with({})).at("jerk").is_null());
  put(18, 18);
  EXPECT_THAT(json::serialize(planned(with({})).at("remarks")),
              HasSubstr("with its bow of 18 the motor may swing"));
}

TEST_F(DaemonBow, IsTheHighestThatTheJerkAllows) {
  // 931322575 pps/s2 is that of 11; a bow of 13 would swing at 6872 of the register.
  EXPECT_EQ(bow_for({{"jerk", "1e9pps/s2"}}), 11);
  EXPECT_THAT(json::serialize(planned(with({{"jerk", "1e9pps/s2"}})).at("remarks")),
              HasSubstr("the jerk is 931322575 pps/s2, not 1000000000 pps/s2"));
  EXPECT_EQ(bow_for({{"jerk", "max"}}), 12);
  EXPECT_EQ(bow_for({{"jerk", "1e9mm/s^3"}}), 12);
  EXPECT_EQ(bow_for({{"jerk", "90000mm/s3"}}), 10);
  EXPECT_EQ(bow_for({{"jerk", 90'000}}), 10);
  EXPECT_EQ(bow_for({{"bow", 7}}), 7);
}

TEST_F(DaemonBow, OfAJerkThatNoBowKeepsIsRefusedWithTheNearest) {
  for (const auto* jerk : {"1pps/s2", "100pps/s2", "909494pps/s2"})
    EXPECT_THAT(refusal(with({{"jerk", jerk}})), HasSubstr("value is 909494.8 pps/s2")) << jerk;
  EXPECT_THAT(refusal(with({{"jerk", "0.001mm/s3"}})),
              HasSubstr("0.001 mm/s3 is below the jerk of the smallest bow; the nearest possible "
                        "value is 88.81785 mm/s3"));
  EXPECT_THAT(refusal(with({{"jerk", 0.001}})), HasSubstr("value is 88.81785 mm/s^3"));
  EXPECT_EQ(bow_for({{"jerk", "909495pps/s2"}}), 1);
}

TEST_F(DaemonRamp, HasNoJerkWhereTheModuleHasNoBow) {
  for (const json::object& wish : {json::object{{"jerk", "1e9pps/s2"}}, json::object{{"bow", 7}}}) {
    auto params = ramp("1000pps", "1000pps/s");
    for (const auto& [name, value] : wish) params[name] = value;
    const auto refused = call("axis.plan_ramp", params);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("a TMCM-1110 has no bow"));
  }
}

TEST_F(DaemonBow, IsNoOtherQuantity) {
  for (const auto* wrong : {"5mm/s^2", "5pps/s", "5mm"})
    EXPECT_THAT(refusal(with({{"jerk", wrong}})), HasSubstr("is no jerk")) << wrong;
  EXPECT_THAT(refusal(with({{"jerk", "11"}})), HasSubstr("11mm/s^3 or 11pps/s^2"));
  EXPECT_THAT(refusal(with({{"jerk", "0pps/s2"}})), HasSubstr("greater than 0"));
  EXPECT_THAT(refusal(with({{"jerk", 5}, {"bow", 7}})), HasSubstr("not both"));
}

TEST_F(DaemonBow, AllAreComparedByTheLoadThatTheyShake) {
  const auto done = call(
      "ramp.compare",
      with(
          {{"distance", "10mm"}, {"resonance_hz", 5}, {"damping", 0.05}, {"tolerance", "0.01mm"}}));
  ASSERT_TRUE(done) << done.error().message;
  const auto comparison = api::from_json<api::ramp::Comparison>(*done);
  EXPECT_THAT(written(), IsEmpty());
  EXPECT_EQ(comparison.unit, "mm");
  EXPECT_NEAR(comparison.tolerance_microsteps.value(), 0.01 * 51'200 / 5, 1);
  ASSERT_EQ(comparison.ramps.size(), 19U);
  const auto best = static_cast<std::size_t>(comparison.proposed.value());
  const auto& proposed = comparison.ramps[best];
  EXPECT_EQ(proposed.settings.front().parameter, "max_bow");
  EXPECT_GT(best, 0U) << "the trapezoid shakes more";
  EXPECT_LT(proposed.swing.value(), comparison.ramps[0].swing.value());
  for (const auto& other : comparison.ramps)
    EXPECT_GE(other.settled_s.value_or(1e9), proposed.settled_s.value());
  EXPECT_FALSE(comparison.ramps.back().move_s) << "it swings around its target";
}

// A ramp up and a ramp down; the axis has its bow.
TEST_F(DaemonBow, TheGentlestRampInTimeIsFound) {
  put(18, 0);
  const auto done = call("ramp.find", {{"distance", "10mm"}, {"time_s", 1}});
  ASSERT_TRUE(done) << done.error().message;
  const auto found = api::from_json<api::ramp::Found>(*done);
  EXPECT_THAT(written(), IsEmpty());
  EXPECT_EQ(found.unit, "mm");
  EXPECT_EQ(found.distance_microsteps, 102'400);
  EXPECT_LE(found.move_s, 1);
  EXPECT_NEAR(found.acceleration.value(), 40, 0.4);
  EXPECT_NEAR(found.top_speed.value(), 20, 0.2);
  EXPECT_FALSE(found.torque_share);
  put(18, 4);
  const auto smooth = call("ramp.find", {{"distance", "10mm"}, {"time_s", 1}});
  ASSERT_TRUE(smooth) << smooth.error().message;
  EXPECT_GT(smooth->at("acceleration").to_number<double>(), 41) << "an S-curve needs more";
}

TEST_F(DaemonBow, WhatCannotBeFoundIsRefused) {
  const auto refused = [&](json::object params) {
    const auto done = call("ramp.find", std::move(params));
    return done ? "none" : done.error().name + ": " + done.error().message;
  };
  EXPECT_THAT(refused({{"time_s", 1}}), HasSubstr("distance"));
  EXPECT_THAT(refused({{"distance", "10mm"}, {"time_s", 0}}), HasSubstr("'time_s' is"));
  EXPECT_THAT(refused({{"distance", "10mm"}, {"time_s", 0.001}}), HasSubstr("s at best"));
  EXPECT_THAT(refused({{"distance", "0mm"}, {"time_s", 1}}),
              testing::Eq("not_foreseeable: 'distance' is 0: such a move has no ramp"));
  EXPECT_THAT(refused({{"distance", "10mm"}, {"load", 900}}), HasSubstr("less torque than"));
  EXPECT_THAT(refused({{"distance", "10mm"}, {"load", -1}}), HasSubstr("'load' is 0 to"));
}

TEST_F(DaemonBow, WhatCannotBeComparedIsRefused) {
  const auto refused = [&](json::object more) {
    const auto done = call("ramp.compare", with(std::move(more)));
    return done ? "none" : done.error().name + ": " + done.error().message;
  };
  EXPECT_THAT(refused({}), HasSubstr("distance"));
  EXPECT_THAT(refused({{"distance", "0mm"}}), HasSubstr("'distance' is 0"));
  EXPECT_THAT(refused({{"distance", "10mm"}, {"resonance_hz", 0}}),
              HasSubstr("'resonance_hz' is 0.01 to 100000, not 0"));
  EXPECT_THAT(refused({{"distance", "10mm"}, {"resonance_hz", 12}, {"damping", 1}}),
              HasSubstr("'damping' is 0 to 0.999, not 1"));
  EXPECT_THAT(refused({{"distance", "10mm"}}), testing::Eq("none"));
}

struct DaemonSixpointRamp : DaemonRamp {
  DaemonSixpointRamp() : DaemonRamp("TMCM-6212") {}
};

TEST_F(DaemonSixpointRamp, TheQuickestRampWithinTheTorqueIsFound) {
  const auto find = [&](double inertia) {
    const auto done = call("ramp.find", {{"distance_microsteps", 100'000},
                                         {"load", 100},
                                         {"inertia", inertia},
                                         {"corner_speed", 600}});
    return done ? api::from_json<api::ramp::Found>(*done) : api::ramp::Found{};
  };
  const auto light = find(5'000);
  const auto heavy = find(50'000);
  EXPECT_LT(light.move_s, heavy.move_s);
  for (const auto& found : {light, heavy}) {
    EXPECT_LE(found.torque_share.value(), 1 / 1.3);
    EXPECT_GT(found.torque_share.value(), 0.95 / 1.3);
  }
}

TEST_F(DaemonSixpointRamp, BrakesAsAsked) {
  auto params = ramp("50000pps", "200000pps/s");
  params["deceleration"] = "100000pps/s";
  const auto done = set(params);
  ASSERT_TRUE(done) << done.error().message;
  EXPECT_THAT(written(), ElementsAre("4=50000", "5=200000", "15=200000", "17=100000", "18=100000"));
  params["deceleration"] = "1e9pps/s";
  EXPECT_THAT(refusal(params), HasSubstr("1000000000 pps/s is too large"));
}

TEST_F(DaemonRamp, WhatItsModuleHasNotApartIsSaid) {
  auto params = ramp("50000pps", "20mm/s2");
  params["deceleration"] = "10mm/s2";
  EXPECT_THAT(json::serialize(planned(params).at("remarks")),
              testing::ContainsRegex("the deceleration is [12][09][.0-9]* mm/s2, not 10 mm/s2"));
}

// v / a + s / v seconds, whatever the resolution: the accelerations that are written count its
// microsteps, as the velocities do.
TEST_F(DaemonSixpointRamp, IsInMicrostepsOfTheSetResolution) {
  for (const int resolution : {8, 6, 4}) {
    SCOPED_TRACE(resolution);
    put(140, resolution);
    const int of_a_mm = 200 * (1 << resolution) / 5;
    const auto done = set(ramp("10mm/s", "100mm/s^2"));
    ASSERT_TRUE(done) << done.error().message;
    EXPECT_EQ(bench.get("x", 4), 10 * of_a_mm);
    EXPECT_EQ(done->at("acceleration_pps2").to_number<double>(), 100 * of_a_mm);
    EXPECT_NEAR(static_cast<double>(bench.get("x", 5)), 100 * of_a_mm, 120) << "rounded down";
    const auto before = bench.position("x");
    const auto moved = call("axis.move_by", {{"distance_microsteps", 5 * of_a_mm}});
    ASSERT_TRUE(moved) << moved.error().message;
    EXPECT_NEAR(moved->at("predicted_s").to_number<double>(), 10. / 100 + 5. / 10, 0.002);
    bench.time.run_for(std::chrono::seconds(1));
    EXPECT_EQ(bench.position("x") - before, 5 * of_a_mm);
  }
}

// 1/16 microsteps have sixteen times the range of accelerations.
TEST_F(DaemonSixpointRamp, BeyondTheRegisterTheMicrostepsThatWouldDoAreNamed) {
  const auto at_steepest = [&](const char* acceleration) {
    return refusal(ramp("10mm/s", acceleration));
  };
  // 7629278 pps/s with 10240 microsteps a mm.
  EXPECT_THAT(at_steepest("746mm/s^2"),
              HasSubstr("746 mm/s^2 is too large; the nearest possible value is 745.0"));
  EXPECT_THAT(at_steepest("746mm/s^2"),
              HasSubstr("With 128 microsteps a full step (parameter 140 set to 7) it can be had"));
  EXPECT_THAT(at_steepest("11900mm/s^2"), HasSubstr("parameter 140 set to 4)"));
  EXPECT_THAT(at_steepest("11921mm/s^2"), HasSubstr("parameter 140 set to 3)"));
  EXPECT_THAT(at_steepest("1e9mm/s^2"), Not(HasSubstr("parameter 140")));
  EXPECT_THAT(at_steepest("1e9pps/s"), Not(HasSubstr("parameter 140")));
  put(140, 4);
  EXPECT_THAT(refusal(ramp("10mm/s", "11900mm/s^2")), testing::Eq("none"));
  EXPECT_THAT(at_steepest("11921mm/s^2"), HasSubstr("parameter 140 set to 3)"));
}

}  // namespace
}  // namespace tmcld::test
