// watch, buses, and what top draws: on axes that move in virtual time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "axis/axis_rows.hpp"
#include "sim/module/module.hpp"
#include "unit/ctl_bench.hpp"

namespace tmclctl::test {
namespace {

using std::chrono::milliseconds;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

class CtlWatch : public testing::Test, public CtlBench {
 protected:
  explicit CtlWatch(const std::string& toml = plain_axis + axis_section("y", 1, 1))
      : CtlBench(toml, "TMCM-3110") {}
};

/// Whose own questions leave most of the time of its bus.
struct CtlBuses : CtlWatch {
  CtlBuses() : CtlWatch(plain_axis) {}
  /// In the row of the bus.
  static double load(const std::string& text) {
    const auto end = text.find(" %");
    return std::stod(text.substr(text.rfind(' ', end - 1)));
  }
};

TEST_F(CtlWatch, SeveralAxesAreWatchedAtOnce) {
  EXPECT_EQ(run({"watch", "x", "y", "--for", "1"}), ExitCode::done);
  EXPECT_THAT(out, AllOf(HasSubstr("s  x  position"), HasSubstr("s  y  position")));
  EXPECT_EQ(std::ranges::count(out, '\n'), 2) << "one for each state";
}

TEST_F(CtlWatch, ALineThatWouldBeTheSameIsLeftOut) {
  // A stop where it stands: only the count of stops grows.
  other_after(milliseconds(300), "axis.stop", {{"axis", "x"}});
  EXPECT_EQ(run({"watch", "x", "--for", "1"}), ExitCode::done);
  EXPECT_EQ(std::ranges::count(out, '\n'), 1) << out;
  other_after(milliseconds(300), "axis.stop", {{"axis", "x"}});
  EXPECT_EQ(run({"watch", "x", "--for", "1", "--json"}), ExitCode::done);
  EXPECT_EQ(std::ranges::count(out, '\n'), 2) << "documents have it: " << out;
}

TEST_F(CtlWatch, AllIsEveryAxisThatTmcldHas) {
  EXPECT_EQ(run({"watch", "--all", "--for", "1"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr("s  x  position"));
}

TEST_F(CtlWatch, FurtherParametersAreTold) {
  pass(std::chrono::seconds(1));
  EXPECT_EQ(run({"watch", "x", "--also", "load_value,max_current", "--for", "1"}), ExitCode::done);
  EXPECT_THAT(out, ContainsRegex("target 0  load_value [0-9]+  max_current 255  at target\n"));
  EXPECT_EQ(run({"watch", "x", "--also", "max_current", "--for", "1", "--json"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr(R"("samples":[{"parameter":"max_current","number":6,"value":255,)"));
}

TEST_F(CtlWatch, RowsAreWrittenAsTheyCome) {
  run({"move", "x", "100000"});
  EXPECT_EQ(run({"watch", "x", "y", "--also", "max_current", "--for", "1", "--csv", "-"}),
            ExitCode::done);
  EXPECT_TRUE(out.starts_with("# tmclctl "));
  EXPECT_THAT(
      out, HasSubstr("\ntime_s,axis,position_microsteps,velocity_internal,position_in_unit,"
                     "velocity_in_unit,max_current,max_current_in_unit,max_current_age_ms,utc\n"));
  EXPECT_THAT(out, ContainsRegex("\n0.0[0-9]+,x,[0-9]+,[0-9]+,,,255,,-?[0-9]+,1970"));
  EXPECT_THAT(out, ContainsRegex(",y,0,0,,,255,,-?[0-9]+,1970"));
  EXPECT_EQ(run({"watch", "x", "--json", "--csv", "-"}), ExitCode::usage);
  EXPECT_EQ(run({"watch", "x", "--csv", "/nowhere/at/all.csv"}), ExitCode::usage);
  EXPECT_EQ(out, "");
}

TEST_F(CtlWatch, EitherAxesOrAllAreNamed) {
  EXPECT_EQ(run({"watch"}), ExitCode::usage);
  EXPECT_EQ(run({"watch", "x", "--all"}), ExitCode::usage);
}

TEST_F(CtlWatch, StaysWhileTmcldStartsAgain) {
  lose_connection(5);
  EXPECT_EQ(run({"watch", "x", "--for", "20"}), ExitCode::done);
  EXPECT_THAT(out, AllOf(HasSubstr("s  tmcld has gone\n"), HasSubstr("s  tmcld is there again\n")));
  EXPECT_EQ(err, "");
  lose_connection(5);
  EXPECT_EQ(run({"watch", "x", "--for", "20", "--json"}), ExitCode::done);
  EXPECT_THAT(out,
              AllOf(HasSubstr(R"("away":{"name":"daemon_lost")"), HasSubstr(R"("away":null)")));
}

TEST_F(CtlWatch, EndsWhileTmcldIsAwayAsWell) {
  lose_connection(1'000'000);
  EXPECT_EQ(run({"watch", "x", "--for", "20"}), ExitCode::done);
  lose_connection(1'000'000);
  host.press_ctrl_c_after(milliseconds(5500));
  EXPECT_EQ(run({"watch", "x"}), ExitCode::done);
}

TEST_F(CtlWatch, SaysWhatBecomesOfModulesAndLinks) {
  run({"state", "x"});
  after(milliseconds(300), [&] { module().power_off(); });
  EXPECT_EQ(run({"watch", "x", "--for", "20"}), ExitCode::done);
  EXPECT_THAT(out, ContainsRegex("s  bench: .*module 1 "));
}

TEST_F(CtlWatch, ThatAnAxisHasArrivedIsSeenInItsState) {
  run({"arrivals", "1", "0", "--for", "0.1"});
  run({"move", "x", "1000"});
  EXPECT_EQ(run({"watch", "x", "--for", "1"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr("at target\n"));
  EXPECT_THAT(out, Not(HasSubstr("s  bench: ")));
}

TEST_F(CtlBuses, TellTheLoadOfALine) {
  EXPECT_EQ(run({"buses"}), ExitCode::done);
  EXPECT_THAT(out, ContainsRegex("bench +serial:/dev/none@115200 +open +[0-9.]+ % +[0-9]+ +0 +0 +0 "
                                 "+0 +[0-9]+"));
  const auto idle = load(out);
  // 64 exchanges of 18 bytes in a second are 11,520 of 115,200 bits.
  for (int i = 0; i < 64; ++i) {
    other_after(milliseconds(10 * (i + 1)), "parameter.get",
                {{"axis", "x"}, {"parameter", "max_current"}});
  }
  EXPECT_EQ(run({"buses"}), ExitCode::done);
  EXPECT_NEAR(load(out) - idle, 10, 0.5);
}

TEST(CtlBusesOnCan, TellTheLoadOfAControllerWhereItsRateIsKnown) {
  CtlBench ctl("[[bus]]\nname = \"bench\"\nlink = \"can:none\"\n" + axis_section("x", 1));
  const auto document = ctl.json({"buses", "--for", "2"});
  EXPECT_TRUE(document.at("buses").at(0).at("load_percent").is_null());
  EXPECT_EQ(document.at("buses").at(0).at("counters").at("timeouts"), 0);
}

// A frame of seven bytes has 90 bits that up to 22 are stuffed into, and 13 more: 125. 400
// exchanges in a second are 100,000 of a million bits.
TEST(CtlBusesOnCan, TellTheLoadOfAController) {
  CtlBench ctl("[[bus]]\nname = \"bench\"\nlink = \"can:none\"\n" + axis_section("x", 1));
  ctl.open();
  int requests = 0;
  ctl.amend("bus.list", [&](boost::json::object& told) {
    auto& bus = told.at("buses").at(0).as_object();
    bus["bit_rate"] = 1'000'000;
    requests += 400;
    bus.at("counters").as_object()["requests"] = requests;
    bus.at("counters").as_object()["replies"] = requests;
  });
  EXPECT_EQ(ctl.run({"buses"}), ExitCode::done);
  EXPECT_THAT(ctl.out, ContainsRegex("bench +can:none +open +10.0 % +800"));
}

TEST_F(CtlWatch, TopNeedsATerminal) {
  EXPECT_EQ(run({"top"}), ExitCode::usage);
  EXPECT_THAT(err, AllOf(HasSubstr("needs a terminal"), HasSubstr("watch --all")));
}

TEST(CtlErrors, ExitsWithOneWhereSomethingIsWrong) {
  CtlBench ctl;
  EXPECT_EQ(ctl.run({"errors", "x"}), ExitCode::done) << "an open load at standstill is none";
  ctl.module().at_stage(
      0, [](tmcl::sim::Stage& stage) { stage.set_fault(tmcl::sim::DriverFault::short_a, true); });
  EXPECT_EQ(ctl.run({"errors", "x"}), ExitCode::refused);
  EXPECT_THAT(ctl.out, HasSubstr("short_to_ground_a"));
  EXPECT_EQ(ctl.run({"errors", "x", "--json"}), ExitCode::refused);
  EXPECT_THAT(ctl.out, HasSubstr(R"("flags":["short_to_ground_a"])"));
}

TEST(AxisRows, PlacesAnAxisWithinItsLimits) {
  EXPECT_EQ(place_between(-10, 10, -10, 7), "[#....]");
  EXPECT_EQ(place_between(-10, 10, 0, 7), "[..#..]");
  EXPECT_EQ(place_between(-10, 10, 10, 7), "[....#]");
  EXPECT_EQ(place_between(-10, 10, -10.1, 7), "[<....]");
  EXPECT_EQ(place_between(-10, 10, 11, 7), "[....>]");
  EXPECT_EQ(place_between(0, 0, 0, 7), "[#....]");
}

TEST(AxisRows, SaysAllAboutAnAxisInOneLine) {
  AxisReading reading;
  reading.unit = "mm";
  reading.position = 5;
  reading.target = 10;
  reading.velocity = 2.5;
  reading.moving = true;
  reading.latched = true;
  reading.referenced = true;
  reading.stop_cause = "stall";
  reading.lease = 7;
  const std::vector<AxisLine> axes{
      {"x", "ready", reading, tmcl::SoftLimits{{0}, {10}}}, {"ghost", "silent"}, {"new", "ready"}};
  const auto lines = lines_of(axes, 100, false);
  ASSERT_THAT(lines, SizeIs(4));
  EXPECT_THAT(lines[0], ContainsRegex("AXIS +STATE +POSITION +LIMITS +VELOCITY +FLAGS"));
  EXPECT_THAT(lines[1],
              ContainsRegex(R"(x +moving +5 mm  \[\.+#\.+\] +2.5 mm/s  LATCHED, lease 7)"));
  EXPECT_THAT(lines[1], Not(HasSubstr("stall"))) << "it moves";
  EXPECT_THAT(lines[2], ContainsRegex("ghost +silent +- +-$"));
  EXPECT_THAT(lines[3], ContainsRegex(R"(new +\? +- )"));
}

TEST(AxisRows, SaysWhatIsWrongWithTheDriverFirst) {
  AxisReading reading;
  reading.faults = {"short_to_ground_a", "undervoltage"};
  reading.latched = true;
  const auto lines = lines_of({{"x", "ready", reading}}, 100, false);
  EXPECT_THAT(lines.at(1), HasSubstr("FAULT: short_to_ground_a, undervoltage, LATCHED"));
}

TEST(AxisRows, WhatAnAxisWithoutAUnitIsWithinIsInMicrosteps) {
  AxisReading reading;
  reading.position_microsteps = 100;
  reading.position_reached = true;
  const auto lines = lines_of({{"x", "ready", reading, tmcl::SoftLimits{{0}, {100}}}}, 60, false);
  EXPECT_THAT(lines[1], ContainsRegex(R"(x +at target +100  \[\.+#\] +0$)"));
}

}  // namespace
}  // namespace tmclctl::test
