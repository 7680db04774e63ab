// watch, buses, and what top draws: on axes that move in virtual time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "axis/axis_rows.hpp"
#include "ctl_fixture.hpp"

namespace tmclctl::test {
namespace {

using std::chrono::milliseconds;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

class CtlWatch : public testing::Test, public Ctl {
 protected:
  static api::Event event(const std::string& kind, const std::string& text) {
    api::Event event;
    event.kind = kind;
    event.bus = "bench";
    event.address = 1;
    event.text = text;
    return event;
  }
  static boost::json::object bus(const std::string& link, boost::json::value bit_rate, int requests,
                                 int replies) {
    const boost::json::object counters{{"requests", requests}, {"replies", replies},
                                       {"timeouts", 3},        {"late_replies", 0},
                                       {"garbage_bytes", 7},   {"surplus", 2}};
    return {{"name", "bench"},
            {"link", link},
            {"state", "open"},
            {"bit_rate", std::move(bit_rate)},
            {"counters", counters}};
  }
  static boost::json::object list(boost::json::array buses) {
    return {{"buses", std::move(buses)}};
  }
};

TEST_F(CtlWatch, SeveralAxesAreWatchedAtOnce) {
  EXPECT_EQ(run({"watch", "x", "y", "--for", "1"}), ExitCode::done);
  EXPECT_THAT(out, AllOf(HasSubstr("s  x  position"), HasSubstr("s  y  position")));
  EXPECT_EQ(std::ranges::count(out, '\n'), 2) << "one for each state";
}

TEST_F(CtlWatch, ALineThatWouldBeTheSameIsLeftOut) {
  // A stop where it stands: only the count of stops grows.
  target.stopped_at = host.now() + milliseconds(300);
  EXPECT_EQ(run({"watch", "x", "--for", "1"}), ExitCode::done);
  EXPECT_EQ(std::ranges::count(out, '\n'), 1);
  target.stopped_at = host.now() + milliseconds(300);
  EXPECT_EQ(run({"watch", "x", "--for", "1", "--json"}), ExitCode::done);
  EXPECT_EQ(std::ranges::count(out, '\n'), 2) << "documents have it";
}

TEST_F(CtlWatch, AllIsEveryAxisThatTmcldHas) {
  EXPECT_EQ(run({"watch", "--all", "--for", "1"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr("s  x  position"));
}

TEST_F(CtlWatch, FurtherParametersAreTold) {
  target.values["load_value"] = 17;
  EXPECT_EQ(run({"watch", "x", "--also", "load_value,actual_current", "--for", "1"}),
            ExitCode::done);
  EXPECT_THAT(out, HasSubstr("target 0  load_value 17  actual_current 0  at target\n"));
  EXPECT_EQ(run({"watch", "x", "--also", "load_value", "--for", "1", "--json"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr(R"("samples":[{"parameter":"load_value","number":0,"value":17,)"));
}

TEST_F(CtlWatch, RowsAreWrittenAsTheyCome) {
  target.values["load_value"] = 17;
  target.move_to(1000);
  EXPECT_EQ(run({"watch", "x", "y", "--also", "load_value", "--for", "1", "--csv", "-"}),
            ExitCode::done);
  EXPECT_TRUE(out.starts_with("# tmclctl "));
  EXPECT_THAT(out,
              HasSubstr("\ntime_s,axis,position_microsteps,velocity_internal,position_in_unit,"
                        "velocity_in_unit,load_value,load_value_in_unit,load_value_age_ms,utc\n"
                        "0.000000,x,0,100,,,17,,5,1970"));
  EXPECT_THAT(out, HasSubstr(",y,1000,0,,,17,,5,1970"));
  EXPECT_EQ(run({"watch", "x", "--json", "--csv", "-"}), ExitCode::usage);
  EXPECT_EQ(run({"watch", "x", "--csv", "/nowhere/at/all.csv"}), ExitCode::usage);
  EXPECT_EQ(out, "");
}

TEST_F(CtlWatch, EitherAxesOrAllAreNamed) {
  EXPECT_EQ(run({"watch"}), ExitCode::usage);
  EXPECT_EQ(run({"watch", "x", "--all"}), ExitCode::usage);
}

TEST_F(CtlWatch, StaysWhileTmcldStartsAgain) {
  target.losses = 1;
  target.away_for = 5;
  EXPECT_EQ(run({"watch", "x", "--for", "20"}), ExitCode::done);
  EXPECT_THAT(out, AllOf(HasSubstr("s  tmcld has gone\n"), HasSubstr("s  tmcld is there again\n")));
  EXPECT_EQ(err, "");
  target.losses = 1;
  target.away_for = 5;
  EXPECT_EQ(run({"watch", "x", "--for", "20", "--json"}), ExitCode::done);
  EXPECT_THAT(out,
              AllOf(HasSubstr(R"("away":{"name":"daemon_lost")"), HasSubstr(R"("away":null)")));
}

TEST_F(CtlWatch, EndsWhileTmcldIsAwayAsWell) {
  target.losses = 1;
  target.away_for = 1'000'000;
  EXPECT_EQ(run({"watch", "x", "--for", "20"}), ExitCode::done);
  target.losses = 1;
  host.press_ctrl_c_after(milliseconds(5500));
  EXPECT_EQ(run({"watch", "x"}), ExitCode::done);
}

TEST_F(CtlWatch, SaysWhatBecomesOfModulesAndLinks) {
  target.events = {event("module_silent", "module 1 does not answer"), event("target_reached", "")};
  EXPECT_EQ(run({"watch", "x", "--for", "1"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr("s  bench: module 1 does not answer\n"));
  EXPECT_EQ(std::ranges::count(out, '\n'), 2) << "that it has arrived is seen in its state";
}

TEST_F(CtlWatch, BusesTellTheLoadOfALine) {
  // 64 exchanges of 18 bytes in a second are 11,520 of 115,200 bits.
  target.results = {list({bus("serial:/dev/ttyS0@115200", 115200, 100, 100)}),
                    list({bus("serial:/dev/ttyS0@115200", 115200, 164, 164)})};
  EXPECT_EQ(run({"buses"}), ExitCode::done);
  EXPECT_THAT(out, ContainsRegex("bench +serial:/dev/ttyS0@115200 +open +10.0 % +164 +3 +0 +7 +2"));
}

TEST_F(CtlWatch, BusesTellTheLoadOfAController) {
  // A frame of seven bytes has 90 bits that up to 22 are stuffed into, and 13 more: 125. 400
  // exchanges in a second are 100,000 of a million bits.
  target.results = {list({bus("can:can0", 1'000'000, 100, 100)}),
                    list({bus("can:can0", 1'000'000, 500, 500)})};
  EXPECT_EQ(run({"buses"}), ExitCode::done);
  EXPECT_THAT(out, ContainsRegex("bench +can:can0 +open +10.0 % +500"));
}

TEST_F(CtlWatch, BusesTellNoLoadThatNobodyKnows) {
  target.result = list({bus("can:vcan0", nullptr, 1, 1)});
  const auto document = json({"buses", "--for", "2"});
  EXPECT_TRUE(document.at("buses").at(0).at("load_percent").is_null());
  EXPECT_EQ(document.at("buses").at(0).at("counters").at("timeouts"), 3);
  // tmcld has started again in between.
  target.results = {list({bus("serial:/dev/ttyS0", 9600, 100, 100)}),
                    list({bus("serial:/dev/ttyS0", 9600, 1, 1)})};
  EXPECT_EQ(run({"buses"}), ExitCode::done);
  EXPECT_THAT(out, ContainsRegex("open +- +1 "));
}

TEST_F(CtlWatch, TopNeedsATerminal) {
  EXPECT_EQ(run({"top"}), ExitCode::usage);
  EXPECT_THAT(err, AllOf(HasSubstr("needs a terminal"), HasSubstr("watch --all")));
}

TEST_F(CtlWatch, ErrorsExitsWithOneWhereSomethingIsWrong) {
  const auto report = [](boost::json::array flags) {
    return boost::json::object{{"axis", "x"},
                               {"flags", std::move(flags)},
                               {"unproven", {"open_load_b"}},
                               {"switches", boost::json::array()},
                               {"stop_cause", nullptr},
                               {"supply_volts", 24.0},
                               {"temperature_celsius", nullptr}};
  };
  target.result = report({"short_to_ground_a", "undervoltage"});
  EXPECT_EQ(run({"errors", "x"}), ExitCode::refused);
  EXPECT_THAT(out, HasSubstr("short_to_ground_a, undervoltage"));
  EXPECT_EQ(run({"errors", "x", "--json"}), ExitCode::refused);
  EXPECT_THAT(out, HasSubstr(R"("flags":["short_to_ground_a","undervoltage"])"));
  target.result = report({});
  EXPECT_EQ(run({"errors", "x"}), ExitCode::done) << "an open load at standstill is none";
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
  UserReading{"mm", 5, 10, 2.5}.put_into(reading);
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
