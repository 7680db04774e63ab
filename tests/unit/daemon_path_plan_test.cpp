// path.plan, and path.run of what it has planned, on simulated modules in virtual time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "api/path_rehearsal.hpp"
#include "tmcl/plan/path_preparation.hpp"
#include "unit/journey_bench.hpp"

namespace tmcld::test {
namespace {

using testing::HasSubstr;
using tmcl::Command;

constexpr double microsteps_per_mm = 51'200 / 5.0;

class DaemonPathPlan : public testing::Test {
 protected:
  json::object plan(const std::string& text, json::object more = {}) {
    more["text"] = text;
    return bench.call("path.plan", std::move(more)).value();
  }
  static json::object run(const json::object& plan, bool to_start = true) {
    return {{"plan", plan.at("plan")}, {"to_start", to_start}};
  }
  static std::string name_of(const Result<boost::json::object>& result) {
    return result.error().name;
  }
  double mm(std::string_view axis) {
    return static_cast<double>(bench.position(axis)) / microsteps_per_mm;
  }
  bool has_moved() const {
    for (const auto command : {Command::MVP, Command::ROR, Command::ROL, Command::SAP})
      if (!bench.sent(command).empty()) return true;
    return false;
  }

  JourneyBench bench{"TMCM-6212", "unit = \"mm\"\nunits_per_revolution = 5\n"};
};

const std::string corner = "G1 X8 Y4 F1200\nG1 X9 Y2\n";

TEST_F(DaemonPathPlan, WhatWasSaidOfAPathIsWhatIsRun) {
  const auto planned =
      plan(corner, {{"axes", {"z", "y"}}, {"file_axes", {"X", "Y"}}, {"points", 4}});
  EXPECT_FALSE(has_moved());
  EXPECT_EQ(json::serialize(planned.at("axes")), R"(["z","y"])");
  const auto& course = planned.at("course").as_object();
  EXPECT_EQ(course.at("legs"), 2);
  EXPECT_EQ(course.at("axes").at(1).at("greatest").to_number<double>(), 4);
  const auto& curve = planned.at("curve").at("positions").as_array();
  ASSERT_EQ(curve.size(), 5U);
  EXPECT_NEAR(curve[4].at(0).to_number<double>(), 9, 1e-9);
  const auto ended = bench.call("path.run", run(planned));
  ASSERT_TRUE(ended) << ended.error().message;
  EXPECT_EQ(mm("z"), 9);
  EXPECT_EQ(mm("y"), 2);
  EXPECT_EQ(bench.news.front().at("duration_s"), course.at("duration_s"));
  // Once.
  EXPECT_EQ(name_of(bench.call("path.run", run(planned))), "no_plan");
}

// What was asked for first; a path is passed as it was foreseen.
TEST_F(DaemonPathPlan, WhatEachModeMakesOfAPathIsToldBeforeItIsRun) {
  const auto planned = plan(corner, {{"mode", "segments"}});
  EXPECT_FALSE(has_moved());
  const auto& expected = planned.at("expected").as_array();
  ASSERT_EQ(expected.size(), 3U);
  EXPECT_EQ(expected[0].at("mode"), "segments");
  EXPECT_EQ(expected[1].at("mode"), "velocity");
  EXPECT_EQ(expected[2].at("mode"), "position");
  const auto& course = planned.at("course").as_object();
  for (const auto& mode : expected) {
    EXPECT_TRUE(mode.at("refused").is_null());
    EXPECT_TRUE(mode.at("keeps_tolerance").as_bool());
    EXPECT_GT(mode.at("off_path").to_number<double>(), 0);
    EXPECT_LT(mode.at("off_path_at_s").to_number<double>(),
              course.at("duration_s").to_number<double>());
    EXPECT_EQ(mode.at("off_path_at").as_array().size(), 2U);
  }
  EXPECT_TRUE(planned.at("warnings").as_array().empty());
  const auto ended = bench.call("path.run", run(planned));
  ASSERT_TRUE(ended) << ended.error().message;
  // Between two readings it may have been farther off.
  EXPECT_LT(ended->at("off_path").to_number<double>(),
            expected[0].at("off_path").to_number<double>() + 0.01);
  EXPECT_EQ(ended->at("off_path_at").as_array().size(), 2U);
}

TEST_F(DaemonPathPlan, APathThatWasNotPlannedIsRehearsedToo) {
  const json::object path{{"axes", json::array{"z", "y"}}, {"text", corner}, {"mode", "segments"}};
  const auto ended = bench.call("path.run", path);
  ASSERT_TRUE(ended) << ended.error().message;
  const auto& expected = ended->at("expected").as_array();
  ASSERT_EQ(expected.size(), 3U);
  EXPECT_EQ(expected[0].at("mode"), "segments");
  EXPECT_TRUE(expected[0].at("keeps_tolerance").as_bool());
  EXPECT_LT(ended->at("off_path").to_number<double>(),
            expected[0].at("off_path").to_number<double>() + 0.01);
  EXPECT_TRUE(ended->at("warnings").as_array().empty());
}

TEST_F(DaemonPathPlan, APathThatWasNotPlannedIsWarnedOf) {
  const json::object path{
      {"axes", json::array{"z", "y"}}, {"text", corner}, {"tolerance", 1e-6}, {"deviation", 1}};
  const auto ended = bench.call("path.run", path);
  ASSERT_TRUE(ended) << ended.error().message;
  EXPECT_FALSE(ended->at("expected").at(0).at("keeps_tolerance").as_bool());
  EXPECT_THAT(json::serialize(ended->at("warnings")),
              HasSubstr("mode velocity is expected to leave the path by"));
}

// A whole swing of 10 Hz longer; its corner is cut, which the rehearsal counts.
TEST_F(DaemonPathPlan, AShaperLetsLoadsHardlySwing) {
  const auto plain = plan(corner);
  EXPECT_TRUE(plain.at("shaping").is_null());
  const auto shaped = plan(corner, {{"shaper", "zvd"}, {"resonance_hz", 10}, {"damping", 0}});
  const auto& shaping = shaped.at("shaping").as_object();
  EXPECT_NEAR(shaping.at("longer_s").to_number<double>(), 0.1, 1e-9);
  EXPECT_NEAR(shaped.at("course").at("duration_s").to_number<double>(),
              plain.at("course").at("duration_s").to_number<double>() + 0.1, 1e-9);
  const auto& x = shaping.at("axes").at(0);
  EXPECT_LT(x.at("swing").to_number<double>(), 0.01 * x.at("unshaped_swing").to_number<double>());
  const double off = shaping.at("off_path").to_number<double>();
  EXPECT_GT(off, 0.005);
  EXPECT_GT(shaped.at("expected").at(0).at("off_path").to_number<double>(), 0.9 * off);
  const auto ended = bench.call("path.run", run(shaped));
  ASSERT_TRUE(ended) << ended.error().message;
  EXPECT_EQ(mm("x"), 9);
  EXPECT_GT(ended->at("off_path").to_number<double>(), 0.8 * off);
}

TEST_F(DaemonPathPlan, AShaperThatCannotBeIsRefused) {
  const auto refused = [&](json::object more) {
    more["text"] = corner;
    const auto error = bench.call("path.plan", std::move(more)).error();
    return error.name + ": " + error.message;
  };
  EXPECT_EQ(refused({{"shaper", "zvdd"}, {"resonance_hz", 10}}),
            "bad_argument: 'shaper' must be 'zv', 'zvd' or 'ei'");
  EXPECT_EQ(refused({{"shaper", "zv"}}), "bad_argument: 'shaper' needs 'resonance_hz'");
  EXPECT_THAT(refused({{"shaper", "zv"}, {"resonance_hz", 0}}), HasSubstr("out_of_range"));
  EXPECT_THAT(refused({{"shaper", "zv"}, {"resonance_hz", 9}, {"damping", 1}}),
              HasSubstr("out_of_range"));
  EXPECT_EQ(refused({{"shaper", "zv"}, {"resonance_hz", 9}, {"mode", "position"}}),
            "bad_argument: position mode cannot shape a path");
  EXPECT_FALSE(has_moved());
}

// Its corner is not cut.
TEST_F(DaemonPathPlan, AJerkLetsLoadsSwingLess) {
  const auto plain = plan(corner);
  EXPECT_TRUE(plain.at("jerk").is_null());
  EXPECT_TRUE(plan(corner, {{"jerk", 2000}}).at("jerk").at("axes").as_array().empty());
  const auto smooth = plan(corner, {{"jerk", "2000mm/s^3"}, {"resonance_hz", 10}});
  const auto& limit = smooth.at("jerk").as_object();
  EXPECT_NEAR(limit.at("jerk").to_number<double>(), 2000, 1e-6);
  EXPECT_EQ(limit.at("resonance_hz").to_number<double>(), 10);
  EXPECT_NEAR(smooth.at("course").at("duration_s").to_number<double>(),
              plain.at("course").at("duration_s").to_number<double>() +
                  limit.at("longer_s").to_number<double>(),
              1e-9);
  EXPECT_TRUE(smooth.at("expected").at(0).at("keeps_tolerance").as_bool());
  const auto ended = bench.call("path.run", run(smooth));
  ASSERT_TRUE(ended) << ended.error().message;
  EXPECT_EQ(mm("x"), 9);
  EXPECT_LT(ended->at("off_path").to_number<double>(), 0.05);
}

TEST_F(DaemonPathPlan, AJerkThatCannotBeIsRefused) {
  const auto refused = [&](json::object more) {
    more["text"] = corner;
    const auto error = bench.call("path.plan", std::move(more)).error();
    return error.name + ": " + error.message;
  };
  EXPECT_EQ(refused({{"jerk", 0}}), "out_of_range: 'jerk' is outside 1e-9..1e9");
  EXPECT_THAT(refused({{"jerk", "20mm/s"}}), HasSubstr("wrong_unit"));
  EXPECT_EQ(refused({{"jerk", 2000}, {"mode", "position"}}),
            "bad_argument: position mode cannot limit a jerk");
  EXPECT_FALSE(has_moved());
}

TEST_F(DaemonPathPlan, WhatWasExpectedOfAPlanIsToldOnce) {
  const auto ended = bench.call("path.run", run(plan(corner, {})));
  ASSERT_TRUE(ended) << ended.error().message;
  EXPECT_TRUE(ended->at("expected").as_array().empty());
}

TEST_F(DaemonPathPlan, AModeThatLeavesThePathIsWarnedOfBeforeItIsRun) {
  const auto planned = plan(corner, {{"tolerance", 1e-6}, {"deviation", 1}});
  EXPECT_FALSE(planned.at("expected").at(0).at("keeps_tolerance").as_bool());
  EXPECT_THAT(json::serialize(planned.at("warnings")),
              HasSubstr("mode velocity is expected to leave the path by"));
}

// A microstep is 98 nm.
TEST_F(DaemonPathPlan, AModeThatCannotPassNamesTheAxisForWhich) {
  const auto planned = plan(corner, {{"tolerance", 1e-6}});
  const auto& expected = planned.at("expected").at(0);
  EXPECT_THAT(std::string(expected.at("refused").as_string()),
              testing::ContainsRegex("^[xy] is 0[.0-9]+ off the path, at "));
  EXPECT_THAT(json::serialize(planned.at("warnings")),
              testing::ContainsRegex("mode velocity cannot pass this path: [xy] is 0"));
}

TEST(PathWarning, NamesAModeThatKeepsTheToleranceIfThereIsOne) {
  const auto mode = [](std::string name, double off, bool kept) {
    tmcl::api::path::Expected expected;
    expected.mode = std::move(name);
    expected.off_path = off;
    expected.off_path_at_s = 2.5;
    expected.keeps_tolerance = kept;
    return expected;
  };
  const auto good = mode("velocity", 0.01, true), bad = mode("segments", 0.2, false);
  auto refused = mode("position", 0, false);
  refused.refused = "line 1 is too short";
  EXPECT_EQ(warning_of({}, 0.05), "");
  EXPECT_EQ(warning_of({good, bad}, 0.05), "");
  EXPECT_EQ(warning_of({bad, good}, 0.05),
            "mode segments is expected to leave the path by 0.2 at 2.5 s, more than the tolerance "
            "of 0.05; mode velocity is expected to stay within 0.01");
  EXPECT_EQ(warning_of({refused, bad}, 0.05),
            "mode position cannot pass this path: line 1 is too short; a lower velocity, "
            "acceleration or corner_jump keeps nearer to the path");
}

// A right angle at 20 mm/s.
TEST_F(DaemonPathPlan, ACornerChangesNoSpeedByMoreThanItsAxisMay) {
  const std::string right_angle = "G1 X8 F1200\nG1 Y8\n";
  const auto slowest = [&](json::object more) {
    more["tolerance"] = 1;
    const auto planned = plan(right_angle, std::move(more));
    return planned.at("course").at("slowest_corners").at(0).at("speed").to_number<double>();
  };
  EXPECT_GT(slowest({}), 1.5);
  EXPECT_NEAR(slowest({{"corner_jump", 1}}), 1, 1e-9);
  EXPECT_NEAR(slowest({{"corner_jump", "1mm/s"}}), 1, 1e-3);
  const auto wrong = bench.call("path.plan", {{"text", right_angle}, {"corner_jump", "3mm"}});
  EXPECT_EQ(name_of(wrong), "wrong_unit");
  JourneyBench limited("TMCM-6212",
                       "unit = \"mm\"\nunits_per_revolution = 5\nmax_corner_jump = 0.5\n");
  const auto planned = limited.call("path.plan", {{"text", right_angle}, {"tolerance", 1}});
  ASSERT_TRUE(planned) << planned.error().message;
  EXPECT_NEAR(planned->at("course").at("slowest_corners").at(0).at("speed").to_number<double>(),
              0.5, 1e-9);
}

TEST_F(DaemonPathPlan, ItBeginsWhereAnAxisWasReadTwiceWithAnotherCommandBetween) {
  plan(corner);
  bench.requests.clear();
  plan(corner);
  for (std::uint8_t motor = 0; motor < 2; ++motor) {
    std::string read;
    for (const auto& request : bench.requests) {
      const bool is_position = request.command == Command::GAP && request.type == 1;
      if (request.command != Command::GAP) read += '.';
      if (is_position && request.motor == motor) read += 'p';
    }
    EXPECT_THAT(read, testing::ContainsRegex("p\\.+p")) << int{motor};
  }
}

TEST_F(DaemonPathPlan, XIsTheAxisOfThisName) {
  EXPECT_EQ(json::serialize(plan(corner).at("axes")), R"(["x","y"])");
  EXPECT_EQ(
      json::serialize(plan(corner, {{"axes", {"z"}}, {"file_axes", json::array{"Y"}}}).at("axes")),
      R"(["x","z"])");
  const auto missing = bench.call("path.plan", {{"text", "G1 X1 A5 F600\n"}});
  ASSERT_FALSE(missing);
  EXPECT_EQ(name_of(missing), "missing_axis");
  EXPECT_EQ(missing.error().subject.at("file_axis"), "A");
  const auto run_needs_axes = bench.call("path.run", {{"text", corner}});
  EXPECT_EQ(name_of(run_needs_axes), "bad_argument");
}

TEST_F(DaemonPathPlan, OneThatCannotBeIsFoundOutBefore) {
  const std::pair<std::string, std::string> cases[] = {
      {"G99\n", "bad_path"}, {"M2\n", "bad_path"}, {"G1 X9999999 F600\n", "out_of_range"}};
  for (const auto& [text, name] : cases) {
    const auto result = bench.call("path.plan", {{"text", text}});
    ASSERT_FALSE(result) << name;
    EXPECT_EQ(name_of(result), name);
  }
  EXPECT_EQ(name_of(bench.call("path.run", {{"plan", 1}})), "no_plan");
  EXPECT_EQ(name_of(bench.call("path.run", {{"plan", 1}, {"text", corner}})), "bad_argument");
  EXPECT_FALSE(has_moved());
}

// A turn is 5 mm.
TEST_F(DaemonPathPlan, LimitsMayHaveTheirUnits) {
  const std::string far = "G1 X80 Y40 F60000\n";
  const auto duration = [&](json::object limits) {
    return plan(far, std::move(limits)).at("course").at("duration_s").to_number<double>();
  };
  const double by_velocity = duration({{"velocity", 2}});
  for (const auto* same : {"2mm/s", "0.2 cm/s", "24rpm", "0.4rps"})
    EXPECT_NEAR(duration({{"velocity", same}}), by_velocity, 1e-9) << same;
  const double by_acceleration = duration({{"acceleration", 5}});
  for (const auto* same : {"5mm/s2", "5000um/s^2", "1rps/s"})
    EXPECT_NEAR(duration({{"acceleration", same}}), by_acceleration, 1e-9) << same;
  const double by_feed = duration({{"feed", 3}});
  EXPECT_NEAR(duration({{"feed", "3mm/s"}}), by_feed, 1e-9);
  EXPECT_LT(by_velocity - 40 / (1 - tmcl::plan::spare_velocity), 1);
  EXPECT_GT(by_feed, 29);
}

TEST_F(DaemonPathPlan, LimitsInUnitsThatMakeNoSenseAreRefused) {
  struct Case {
    const char* param;
    const char* text;
    const char* name;
  };
  for (const auto& [param, said, name] :
       {Case{"velocity", "20", "bare_number"}, Case{"velocity", "20mm", "wrong_unit"},
        Case{"velocity", "20deg/s", "unknown_unit"}, Case{"velocity", "-20mm/s", "out_of_range"},
        Case{"acceleration", "20mm/s", "wrong_unit"},
        Case{"acceleration", "0mm/s2", "out_of_range"}, Case{"feed", "fast", "bad_quantity"},
        Case{"feed", "1,5mm/s", "decimal_comma"}}) {
    const auto result = bench.call("path.plan", {{"text", corner}, {param, said}});
    ASSERT_FALSE(result) << said;
    EXPECT_EQ(name_of(result), name) << said;
    EXPECT_EQ(result.error().subject.at("param"), param) << said;
  }
  EXPECT_FALSE(has_moved());
}

TEST_F(DaemonPathPlan, AFeedMustMeanTheSameForAllAxes) {
  ASSERT_TRUE(bench.call("parameter.set",
                         {{"axis", "far"}, {"parameter", "microstep_resolution"}, {"value", 4}}));
  json::object params{{"text", corner}, {"axes", {"x", "far"}}, {"feed", "3mm/s"}};
  EXPECT_TRUE(bench.call("path.plan", params));
  params["feed"] = "20000pps";
  const auto result = bench.call("path.plan", params);
  ASSERT_FALSE(result);
  EXPECT_EQ(name_of(result), "wrong_unit");
  EXPECT_THAT(result.error().message, HasSubstr("in the unit of"));
}

TEST_F(DaemonPathPlan, AxesAreBroughtToTheStartIfThatIsAskedFor) {
  const std::string table = "x,y\n3,-2\n6,0\n";
  EXPECT_EQ(name_of(bench.call("path.run", run(plan(table), false))), "not_at_start");
  EXPECT_FALSE(has_moved());
  for (const std::string mode : {"velocity", "position"}) {
    const auto planned = plan(table, {{"mode", mode}});
    bench.requests.clear();
    const auto ended = bench.call("path.run", run(planned));
    ASSERT_TRUE(ended) << mode << ": " << ended.error().message;
    EXPECT_EQ(mm("x"), 6);
    EXPECT_EQ(mm("y"), 0);
    const auto moves = bench.sent(Command::MVP);
    ASSERT_GE(moves.size(), 2U);
    EXPECT_EQ(moves[0].value, 3 * 51'200 / 5);
    EXPECT_EQ(moves[1].value, -2 * 51'200 / 5);
  }
}

TEST_F(DaemonPathPlan, AStopOnTheWayToTheStartStopsAll) {
  const auto planned = plan("x,y\n300,-200\n301,-200\n");
  const auto pending = bench.begin("path.run", run(planned));
  bench.time.run_for(std::chrono::milliseconds(500));
  EXPECT_EQ(bench.news.back().at("phase"), "approaching");
  ASSERT_TRUE(bench.call("path.stop", {{"axes", {"x"}}}));
  const auto ended = bench.end_of(pending);
  ASSERT_FALSE(ended);
  EXPECT_EQ(name_of(ended), "stopped");
  EXPECT_LT(mm("x"), 300);
  EXPECT_EQ(bench.get("x", 3), 0);
  EXPECT_EQ(bench.get("y", 3), 0);
}

// A plan keeps less of its path than planning has read.
TEST_F(DaemonPathPlan, EveryKindOfPathIsRunAsItWasPlanned) {
  const std::string timed = "t,x,y\n0,0,0\n2,1,1\n4,2,2\n";
  const std::vector<std::string> by_legs{"velocity", "segments", "position"};
  const std::vector<std::string> by_time{"velocity"};
  struct Kind {
    std::string text;
    json::object more;
    std::vector<std::string> modes;
  };
  const Kind kinds[] = {
      {timed, {}, by_time},
      {timed, {{"velocity", 4}}, by_time},
      {"x,y\n0,0\n2,2\n", {}, by_legs},
      {"x,y,speed\n0,0,1\n2,2,1\n", {}, by_legs},
      {"G1 X2 Y2 F600\n", {{"velocity", 4}, {"acceleration", 50}}, by_legs},
      {"G2 X2 Y2 I1 J1 F600\n", {{"feed", 5}}, by_legs},
      {"G1 X2 Y2 F600\n", {{"jerk", 500}}, by_time},
      {"G1 X2 Y2 F600\n", {{"shaper", "zvd"}, {"resonance_hz", 12}}, by_time},
  };
  for (const auto& [text, more, modes] : kinds) {
    for (const auto& mode : modes) {
      SCOPED_TRACE(mode + ", " + json::serialize(more) + ", " + text);
      auto wish = more;
      wish["mode"] = mode;
      wish["text"] = text;
      const auto planned = bench.call("path.plan", std::move(wish));
      ASSERT_TRUE(planned) << planned.error().message;
      const auto ended = bench.call("path.run", run(*planned));
      ASSERT_TRUE(ended) << ended.error().message;
      EXPECT_NEAR(mm("x"), 2, 0.001);
      EXPECT_NEAR(mm("y"), 2, 0.001);
      for (const auto* axis : {"x", "y"}) {
        ASSERT_TRUE(bench.call("axis.move_to", {{"axis", axis}, {"position", 0}}));
        ASSERT_TRUE(bench.call("axis.wait", {{"axis", axis}}));
      }
    }
  }
}

TEST_F(DaemonPathPlan, SettingsThatHaveChangedMakeAPlanUseless) {
  const auto planned = plan(corner);
  ASSERT_TRUE(bench.call("parameter.set", {{"axis", "y"}, {"parameter", 4}, {"value", 1000}}));
  bench.requests.clear();
  const auto refused = bench.call("path.run", run(planned));
  ASSERT_FALSE(refused);
  EXPECT_EQ(name_of(refused), "no_plan");
  EXPECT_THAT(refused.error().message, HasSubstr("settings of y have changed"));
  EXPECT_FALSE(has_moved());
}

}  // namespace
}  // namespace tmcld::test
