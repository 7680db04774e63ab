// Paths from tables and from G-code: what they become, and where a text is wrong.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <span>
#include <string>
#include <string_view>

#include "support/random.hpp"
#include "support/seed.hpp"
#include "tmcl/plan/path_file.hpp"

namespace tmcl::plan::path_file {
namespace {

using std::numbers::pi;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using Reader = tl::expected<Path, TextProblems>;

Path good(const Reader& path) {
  EXPECT_TRUE(path) << describe(path.error().front(), "text");
  return path.value_or(Path{});
}
Path csv(std::string_view text) { return good(read_csv(text)); }
Path gcode(std::string_view text, const Point& start = {}) { return good(read_gcode(text, start)); }

std::string complaint(const Reader& path) {
  EXPECT_FALSE(path);
  return path ? "" : describe(path.error().front(), "text");
}
std::string csv_complaint(std::string_view text) { return complaint(read_csv(text)); }
std::string gcode_complaint(std::string_view text) { return complaint(read_gcode(text)); }

const LineTo& line(const Path& path, std::size_t i) {
  return std::get<LineTo>(path.elements.at(i));
}
const ArcTo& arc(const Path& path, std::size_t i) { return std::get<ArcTo>(path.elements.at(i)); }

// ---- Tables

TEST(PlanCsv, TimesAndPositions) {
  const auto path = csv("t,x,y\r\n1, 5, 6\r\n1.5,7,-8\r\n\r\n# a remark\r\n2.5 ,7,-8\r\n");
  EXPECT_THAT(path.axes, ElementsAre("x", "y"));
  EXPECT_EQ(path.start, (Point{5, 6}));
  ASSERT_THAT(path.elements, SizeIs(2));
  EXPECT_EQ(line(path, 0), (LineTo{{7, -8}, {}, 0.5, 3}));
  EXPECT_EQ(line(path, 1), (LineTo{{7, -8}, {}, 1.0, 6}));
}

TEST(PlanCsv, AByteOrderMarkIsNoPartOfAName) {
  EXPECT_THAT(csv("\xEF\xBB\xBFt,x\n0,0\n1,2\n").axes, ElementsAre("x"));
}

TEST(PlanCsv, OtherSignsBetweenColumnsAreNamed) {
  EXPECT_THAT(csv_complaint("t;x\n0;0\n"), HasSubstr("it has semicolons, and commas must stand"));
  EXPECT_EQ(csv_complaint("x\ty\n0\t0\n"),
            "text:1:1: 'x\\ty' is no name of a column; it has tabs, and commas must stand between "
            "the columns");
}

TEST(PlanCsv, CellsMayStandInQuotes) {
  const auto path = csv("\"t\", \"x\" ,y\r\n\"0\",\" 1 \",2\n1,\"-3.5\",\"4\"\n");
  EXPECT_THAT(path.axes, ElementsAre("x", "y"));
  EXPECT_EQ(path.start, (Point{1, 2}));
  EXPECT_EQ(line(path, 0).target, (Point{-3.5, 4}));
  EXPECT_EQ(csv_complaint("\"x\"\"\",y\n"), "text:1:1: 'x\"\"' is no name of a column");
  EXPECT_EQ(csv_complaint("\"x,y\n"), "text:1:1: '\"x' is no name of a column");
  EXPECT_EQ(csv_complaint("x,y\n\"1\"2,3\n"), "text:2:1: '\"1\"' is no number");
  EXPECT_EQ(csv_complaint("x,y\n\"1,5\",3\n"), "text:2:1: '1,5' is no number");
}

TEST(PlanCsv, TimeAndSpeedAreKnownByTheirCommonNames) {
  for (const std::string name : {"t", "T", "time", "Time", "TIME", "time_s", "t_s"}) {
    const auto path = csv(name + ",x\n0,0\n1,5\n");
    EXPECT_THAT(path.axes, ElementsAre("x")) << name;
    EXPECT_EQ(line(path, 0).duration, 1.0) << name;
  }
  EXPECT_EQ(line(csv("x,Speed\n0,\n1,2.5\n"), 0).feed, 2.5);
  EXPECT_EQ(csv_complaint("t,Time,x\n"), "text:1:3: there are two columns 't'");
}

TEST(PlanCsv, AColumnOfTimesOrSpeedsIsNoAxis) {
  for (const std::string name : {"timestamp", "time_ms", "Time-us", "t_ms", "seconds"})
    EXPECT_THAT(csv_complaint(name + ",x\n0,0\n"), HasSubstr("call a column of times t")) << name;
  for (const std::string name :
       {"velocity", "v", "V", "feed", "feed_rate", "Feedrate", "speed_mm_s"})
    EXPECT_THAT(csv_complaint("x," + name + "\n0,0\n"), HasSubstr("call a column of speeds speed"))
        << name;
  for (const std::string name : {"theta", "t1", "v2", "tilt", "vertical", "focus", "fine"})
    EXPECT_THAT(csv("x," + name + "\n0,0\n").axes, ElementsAre("x", name));
  EXPECT_THAT(csv("u,v\n0,0\n").axes, ElementsAre("u", "v"));
}

TEST(PlanCsv, RowsThatDifferByRoundingAreTheSame) {
  EXPECT_THAT(csv("x,y\n0.3,0\n0.30000000000000004,0\n1,0\n").elements, SizeIs(1));
  // Rows that creep go somewhere at last.
  EXPECT_THAT(csv("x\n0\n6e-10\n1.2e-9\n").elements, SizeIs(1));
}

TEST(PlanPathFile, LinesEndAsAnySystemEndsThem) {
  for (const std::string end : {"\n", "\r\n", "\r\r\n", "\r"}) {
    EXPECT_THAT(csv("x" + end + "0" + end + "1" + end).elements, SizeIs(1));
    EXPECT_THAT(gcode("G0 X1" + end + "X2" + end).elements, SizeIs(2));
  }
  EXPECT_THAT(gcode("\fG0\vX1\r Y2\f\n").elements, SizeIs(1));
  EXPECT_THAT(csv("x ,\fy\n0\v,0\f\n1,1\n").elements, SizeIs(1));
}

TEST(PlanPathFile, WhatCannotBeShownIsNamed) {
  EXPECT_EQ(gcode_complaint("\x01"), "text:1:1: '<U+0001>' is not known here");
  EXPECT_EQ(gcode_complaint("\xC2\xA0G0"), "text:1:1: '<U+00A0>G0' is not known here");
  EXPECT_EQ(gcode_complaint("G0 X\xE2\x88\x92"
                            "5"),
            "text:1:4: a number is missing behind X; '<U+2212>5' is none");
  EXPECT_EQ(csv_complaint("\xFFx\n"), "text:1:1: '\\xFFx' is no name of a column");
  for (const std::string_view text :
       {std::string_view("\xFF\xFEx\0\n\0", 6), std::string_view("\xFE\xFF\0x", 4),
        std::string_view("x\0,\0y\0", 6), std::string_view("\0G\0000", 4)}) {
    EXPECT_EQ(csv_complaint(text), "text:1: the text is in UTF-16 or UTF-32; save it as UTF-8");
    EXPECT_EQ(gcode_complaint(text), "text:1: the text is in UTF-16 or UTF-32; save it as UTF-8");
  }
}

TEST(PlanCsv, TimeMayStandInAnyColumn) {
  const auto path = csv("left,t\n1,0\n2,4");
  EXPECT_THAT(path.axes, ElementsAre("left"));
  EXPECT_EQ(line(path, 0).duration, 4.0);
}

TEST(PlanCsv, CornersOfAPolyline) {
  const auto path = csv("x,y\n0,0\n1,0\n1,0\n1,1\n");
  ASSERT_THAT(path.elements, SizeIs(2));
  EXPECT_EQ(line(path, 0), (LineTo{{1, 0}, {}, {}, 3}));
  EXPECT_EQ(line(path, 1), (LineTo{{1, 1}, {}, {}, 5}));
}

TEST(PlanCsv, SpeedsAreThoseOfTheWayToARow) {
  const auto path = csv("x,speed\n0,\n1,2.5\n");
  EXPECT_EQ(line(path, 0).feed, 2.5);
  EXPECT_EQ(line(csv("x,speed\n0,0\n1,2.5\n"), 0).feed, 2.5);
}

TEST(PlanCsv, OnlyAStartIsAPathThatGoesNowhere) {
  const auto path = csv("x\n3\n");
  EXPECT_EQ(path.start, (Point{3}));
  EXPECT_THAT(path.elements, IsEmpty());
}

TEST(PlanCsv, WhatIsWrongHasAPlace) {
  EXPECT_EQ(csv_complaint(""), "text:1: there is no row of names");
  EXPECT_EQ(csv_complaint("x\n"), "text:2: there is no row of numbers");
  EXPECT_EQ(csv_complaint("x,,y\n"), "text:1:3: '' is no name of a column");
  EXPECT_EQ(csv_complaint("1,x [mm]\n"), "text:1:3: 'x [mm]' is no name of a column");
  EXPECT_EQ(csv_complaint("x,x\n"), "text:1:3: there are two columns 'x'");
  EXPECT_EQ(csv_complaint("t\n1\n"), "text:1: no column is an axis");
  EXPECT_EQ(csv_complaint("a,b,c,d,e,f,g\n"), "text:1: there are 7 axes; 6 at most");
  EXPECT_EQ(csv_complaint("t,x,speed\n"), "text:1: t and speed exclude each other");
  EXPECT_EQ(csv_complaint("x,y\n1\n"), "text:2: the row has 1 of 2 cells");
  EXPECT_EQ(csv_complaint("x,y\n1,2,3\n"), "text:2:5: there are more than 2 cells");
  EXPECT_EQ(csv_complaint("x\n1 2\n"), "text:2:1: '1 2' is no number");
  EXPECT_EQ(csv_complaint("x,y\n1, nan\n"), "text:2:4: 'nan' is no number");
  EXPECT_EQ(csv_complaint("x\ninf\n"), "text:2:1: 'inf' is no number");
  EXPECT_EQ(csv_complaint("x\n1e999\n"), "text:2:1: '1e999' is no number");
  EXPECT_EQ(csv_complaint("x,y\n1,\n"), "text:2:3: '' is no number");
  EXPECT_EQ(csv_complaint("t,x\n1,0\n1,1\n"), "text:3:1: t does not ascend");
  EXPECT_EQ(csv_complaint("t,x\n-1e308,0\n1e308,1\n"), "text:3:1: t leaps too far");
  EXPECT_EQ(csv_complaint("x,speed\n0,1\n1,0\n"), "text:3:3: speed must be above 0");
  EXPECT_EQ(csv_complaint("x,speed\n0,1\n1,\n"), "text:3:3: '' is no number");
}

TEST(PlanCsv, AllProblemsAreToldUpToABound) {
  EXPECT_THAT(read_csv("x\na\n1\nb\n").error(), SizeIs(2));
  std::string many = "x\n";
  for (int i = 0; i < 100; ++i) many += "a\n";
  EXPECT_THAT(read_csv(many).error(), SizeIs(most_text_problems));
}

TEST(PlanCsv, LinesAreBounded) {
  EXPECT_THAT(csv_complaint("x\n" + std::string(most_text_line_bytes + 1, '1')),
              HasSubstr("too long"));
  EXPECT_THAT(csv_complaint(std::string(most_text_lines + 1, '\n')), HasSubstr("too many lines"));
}

// ---- G-code

TEST(PlanGcode, LinesAreRapidOrHaveAFeed) {
  const auto path = gcode("G0 X10\nG1 Y5 F120\nX0 Y0\n");
  EXPECT_THAT(path.axes, ElementsAre("X", "Y"));
  ASSERT_THAT(path.elements, SizeIs(3));
  EXPECT_EQ(line(path, 0), (LineTo{{10, 0}, {}, {}, 1}));
  EXPECT_EQ(line(path, 1), (LineTo{{10, 5}, 2.0, {}, 2}));
  EXPECT_EQ(line(path, 2), (LineTo{{0, 0}, 2.0, {}, 3}));
}

TEST(PlanGcode, WritingIsFree) {
  const auto path =
      gcode("%\nn10 g01x-.5y+1.F60 (to the left) ; and on\n\n( nothing )\n  N20 G 1 X 0\n%\n");
  ASSERT_THAT(path.elements, SizeIs(2));
  EXPECT_EQ(line(path, 0), (LineTo{{-0.5, 1}, 1.0, {}, 2}));
  EXPECT_EQ(line(path, 1), (LineTo{{0, 1}, 1.0, {}, 5}));
}

TEST(PlanGcode, InchesBecomeMillimetresAndDegreesStay) {
  const auto path = gcode("G20 G1 X1 A90 F60\nA0\nG21 X1\n");
  EXPECT_THAT(path.axes, ElementsAre("X", "A"));
  EXPECT_EQ(line(path, 0), (LineTo{{25.4, 90}, 25.4, {}, 1}));
  // Only A moves: degrees a minute.
  EXPECT_EQ(line(path, 1), (LineTo{{25.4, 0}, 1.0, {}, 2}));
  EXPECT_EQ(line(path, 2).target[0], 1);
}

TEST(PlanGcode, RelativeWays) {
  const auto path = gcode("G91 G0 X1\nX1 Y1\nG90 X1\n", {10, 20});
  EXPECT_EQ(path.start, (Point{10, 20}));
  EXPECT_EQ(line(path, 0).target, (Point{11, 20}));
  EXPECT_EQ(line(path, 1).target, (Point{12, 21}));
  EXPECT_EQ(line(path, 2).target, (Point{1, 21}));
}

TEST(PlanGcode, OnlyTheAxesThatAreNamed) {
  const auto path = gcode("G0 Z5\n", {1, 2, 3, 4, 5, 6});
  EXPECT_THAT(path.axes, ElementsAre("Z"));
  EXPECT_EQ(path.start, (Point{3}));
  EXPECT_EQ(line(path, 0).target, (Point{5}));
  EXPECT_THAT(gcode("").axes, ElementsAre("X"));
}

TEST(PlanGcode, ArcsByCentre) {
  const auto path = gcode("F60\nG3 X0 Y10 I-10 J0\nG2 X10 Y0 J-10\nG2 I-10\n", {10, 0});
  ASSERT_THAT(path.elements, SizeIs(3));
  EXPECT_NEAR(arc(path, 0).sweep, pi / 2, 1e-12);
  EXPECT_EQ(arc(path, 0).centre[0], 0);
  EXPECT_NEAR(arc(path, 1).sweep, -pi / 2, 1e-12);
  EXPECT_EQ(arc(path, 1).centre[1], 0);
  EXPECT_NEAR(arc(path, 2).sweep, -2 * pi, 1e-12);
  EXPECT_EQ(arc(path, 2).feed, 1);
}

TEST(PlanGcode, ArcsByRadius) {
  const auto centre = [](const char* code) {
    const auto path = gcode(code, {10, 0});
    const auto& only = arc(path, 0);
    return std::array{std::round(only.centre[0]), std::round(only.centre[1]),
                      std::round(only.sweep / pi * 2)};
  };
  EXPECT_THAT(centre("G3 X0 Y10 R10 F1"), ElementsAre(0, 0, 1));
  EXPECT_THAT(centre("G2 X0 Y10 R10 F1"), ElementsAre(10, 10, -1));
  EXPECT_THAT(centre("G3 X0 Y10 R-10 F1"), ElementsAre(10, 10, 3));
  EXPECT_THAT(centre("G2 X0 Y10 R-10 F1"), ElementsAre(0, 0, -3));
  EXPECT_THAT(centre("G3 X-10 Y0 R10 F1"), ElementsAre(0, 0, 2));
}

TEST(PlanGcode, DwellsAndTheEnd) {
  const auto path = gcode("G4 P1.5\nG0 X1 M2\nnonsense\n");
  ASSERT_THAT(path.elements, SizeIs(2));
  EXPECT_EQ(std::get<Dwell>(path.elements[0]), (Dwell{1.5, 1}));
}

TEST(PlanGcode, WhatGoesNowhereIsLeftOut) {
  EXPECT_THAT(gcode("G0 X0\nG1 F5\nF7\nG1 X0 Y0\n").elements, IsEmpty());
}

TEST(PlanGcode, WhatIsWrongHasAPlace) {
  EXPECT_EQ(gcode_complaint("G0 X1\nD1 M48"), "text:2:1: 'D1' is not known here");
  EXPECT_EQ(gcode_complaint("G38.2 X1"), "text:1:1: G38.2 is not known here: there is no probe");
  EXPECT_EQ(gcode_complaint("G1.5 X1"), "text:1:1: G1.5 is not known here");
  EXPECT_EQ(gcode_complaint("M48"), "text:1:1: M48 is not known here");
  EXPECT_EQ(gcode_complaint("G0 X"), "text:1:4: a number is missing behind X");
  EXPECT_EQ(gcode_complaint("G0 Xnan"), "text:1:4: a number is missing behind X");
  EXPECT_EQ(gcode_complaint("G0 X1e3"), "text:1:6: 'e3' is not known here");
  EXPECT_EQ(gcode_complaint("G0 X1 X2"), "text:1:7: X stands twice on this line");
  EXPECT_EQ(gcode_complaint("G0 G1 X1"), "text:1:4: there are two movements on this line");
  EXPECT_EQ(gcode_complaint("G0 (X1"), "text:1:4: ')' is missing");
  EXPECT_EQ(gcode_complaint("X1"), "text:1:1: G0, G1, G2 or G3 must come first");
  EXPECT_EQ(gcode_complaint("G1 X1"), "text:1:4: G1 needs F, which was not said yet");
  EXPECT_EQ(gcode_complaint("G2 X1 R1"), "text:1:7: G2 needs F, which was not said yet");
  EXPECT_EQ(gcode_complaint("G1 X1 F0"), "text:1:7: F must be above 0");
  EXPECT_EQ(gcode_complaint("G1 X1 F-1"), "text:1:7: F must be above 0");
  EXPECT_EQ(gcode_complaint("F0." + std::string(323, '0') + "5"), "text:1:1: F must be above 0");
  EXPECT_EQ(gcode_complaint("G4"), "text:1:1: G4 needs P, in seconds");
  EXPECT_EQ(gcode_complaint("G4 P-1"), "text:1:4: P must not be below 0");
  EXPECT_EQ(gcode_complaint("G4 X1"), "text:1:4: G4 has P, and nothing else");
  EXPECT_EQ(gcode_complaint("G4 G0 P1"), "text:1:4: G4 and a movement exclude each other");
  EXPECT_EQ(gcode_complaint("G0 X1 P1"), "text:1:7: P belongs to G2, G3, G4, G10 and G64");
  EXPECT_EQ(gcode_complaint("G0 X1 I1"), "text:1:7: I, J, K and R belong to G2 and G3");
  EXPECT_EQ(gcode_complaint("F1 G2 X1"), "text:1:7: G2 needs I and J, or R");
  EXPECT_EQ(gcode_complaint("F1 G2 X1 I1 R1"), "text:1:13: R excludes I, J and K");
  EXPECT_EQ(gcode_complaint("F1 G2 X1 I0 J0"), "text:1:10: the centre is where the arc begins");
  EXPECT_EQ(gcode_complaint("F1 G2 X5 I1"),
            "text:1:10: the arc begins 1 mm from its centre and ends 4 mm from it");
  EXPECT_EQ(gcode_complaint("F1 G2 X5 R1"),
            "text:1:10: the radius is too small: the ends are 5 mm apart");
  EXPECT_EQ(gcode_complaint("F1 G2 R1"), "text:1:7: an arc to where it begins needs its centre");
  EXPECT_THAT(gcode_complaint("G0 (" + std::string(most_text_line_bytes, 'x')),
              HasSubstr("too long"));
}

std::vector<std::string> gcode_complaints(std::string_view text) {
  std::vector<std::string> all;
  const auto read = read_gcode(text);
  if (read) return all;
  for (const auto& problem : read.error()) all.push_back(describe(problem, "text"));
  return all;
}

TEST(PlanGcode, AllProblemsAreToldEachOnce) {
  EXPECT_THAT(gcode_complaints("G16 D1 E5000 M48\nD2 G16 M49\nG0 X1 E1\n#1=5\nM2\nH1\n"),
              ElementsAre(HasSubstr("text:1:1: G16 is not known here"),
                          HasSubstr("text:1:5: 'D1' is not known here"),
                          HasSubstr("text:1:8: 'E5000' is not known here"),
                          HasSubstr("text:1:14: M48 is not known here"),
                          HasSubstr("text:2:8: M49 is not known here"),
                          HasSubstr("text:4:1: '#1=5' is not known here")));
  EXPECT_THAT(
      gcode_complaints("G1 X1\nX2\nF60 G2 X9 I1\nG2 X5 I-1\nG1 X0 P1\n"),
      ElementsAre(HasSubstr("text:1:4: G1 needs F"), HasSubstr("text:3:11: the arc begins"),
                  HasSubstr("text:4:7: the arc begins"), HasSubstr("text:5:7: P belongs to")));
  EXPECT_THAT(gcode_complaints("G0 X#1 Y#2\nX[1+2]\n"),
              ElementsAre("text:1:4: a number is missing behind X; '#1' is none",
                          "text:2:1: a number is missing behind X; '[1+2]' is none"));
  EXPECT_THAT(gcode_complaints("G16 G81 G90 G38\nG81 G96\n"),
              ElementsAre(HasSubstr("text:1:1: G16"), HasSubstr("text:1:5: G81"),
                          HasSubstr("text:1:13: G38"), HasSubstr("text:2:5: G96")));
  std::string many;
  for (int i = 0; i < 100; ++i) many += "M" + std::to_string(i + 31) + "\n";
  EXPECT_THAT(gcode_complaints(many), SizeIs(most_text_problems));
}

TEST(PlanGcode, NothingThatMayFollowFromALineNotUnderstoodIsTold) {
  EXPECT_THAT(gcode_complaints("F60\nG68 R45\nG2 X10 Z3 I1\nG81 R2 X1\nX2\n"),
              ElementsAre(HasSubstr("G68 is not known"), HasSubstr("G81 is not known")));
}

// ---- Rounding

TEST(PlanGcode, AWholeTurnIsOneWhateverTheLastBitsAre) {
  const auto sweep = [](std::string_view text) {
    const auto path = gcode(text);
    return std::get<ArcTo>(path.elements.back()).sweep;
  };
  EXPECT_DOUBLE_EQ(sweep("G20 F30\nG1 X0.3\nG21 F900\nG3 X7.62 Y0 J5\n"), 2 * pi);
  EXPECT_DOUBLE_EQ(sweep("G20 F30\nG1 X0.3\nG21 F900\nG2 X7.62 Y0 J5\n"), -2 * pi);
  EXPECT_DOUBLE_EQ(sweep("G91 F600\nG1 Y0.1\nG1 Y0.2\nG90\nG3 X0 Y0.3 I1 J0\n"), 2 * pi);
  // A spiral's ends are in one direction, too.
  EXPECT_DOUBLE_EQ(sweep("F1 G2 X0.01 I5\n"), -2 * pi);
  // A short arc of a great radius is one.
  EXPECT_NEAR(sweep("F1 G3 X0.001 J5000\n"), 2e-7, 1e-9);
  EXPECT_NEAR(sweep("F1 G3 X0.001 R5000\n"), 2e-7, 1e-9);
  EXPECT_NEAR(sweep("F1 G2 X0.001 R-5000\n"), -2 * pi + 2e-7, 1e-9);
}

TEST(PlanGcode, AnArcByRadiusToWhereItBeginsIsNone) {
  EXPECT_EQ(gcode_complaint("G20 F30\nG1 X0.3\nG21 F900\nG3 X7.62 Y0 R-5\n"),
            "text:4:13: an arc to where it begins needs its centre");
}

TEST(PlanGcode, AMoveOfALastBitGoesNowhere) {
  EXPECT_THAT(gcode("G20 G0 X0.3\nG21 X7.62\n").elements, SizeIs(1));
  // Only A moves, so F is in degrees.
  const auto path = gcode("G20 G0 X0.3\nG21 G1 X7.62 A90 F60\n");
  EXPECT_EQ(line(path, 1).target[0], line(path, 0).target[0]);
}

TEST(PlanGcode, ArcsOfFewDecimalsAreTakenAsLinuxCncTakesThem) {
  // Rounded to 0.001 inch and 0.01 mm.
  gcode("G20 G90 F60\nG2 X0.2 Y0 I0.0995 J0\n");
  gcode("G21 G90 F60\nG2 X50 Y0 I24.987 J0\n");
  gcode("G21 F60 G2 X4000 I2000.9\n");
  EXPECT_EQ(gcode_complaint("G20 F60 G2 X0.2 I0.098\n"),
            "text:1:17: the arc begins 0.098 inches from its centre and ends 0.102 inches from it");
  EXPECT_THAT(gcode_complaint("G21 F60 G2 X50 I24.985\n"), HasSubstr("the arc begins 24.985 mm"));
  // 0.1 % of the radius, but more than anything that is rounding.
  EXPECT_THAT(gcode_complaint("G21 F60 G2 X6000 I2998.5\n"), HasSubstr("the arc begins"));
}

// ---- Feeds

TEST(PlanGcode, FIsOfXyzWhereOneOfThemMoves) {
  EXPECT_EQ(gcode("G1 X5 A180 F60\n").length_axes, 1U);
  EXPECT_EQ(gcode("G1 X5 Z1 A180 F60\n").length_axes, 2U);
  EXPECT_GE(gcode("G1 A180 B1 F60\n").length_axes, 2U);
  EXPECT_EQ(flatten(gcode("G2 I5 A180 F60\n"), 0.1)->length_axes, 2U);
}

// ---- Chords

double deviation(const Point& a, const Point& b, double x, double y, double radius) {
  // The middle of a chord is farthest from its circle.
  return std::abs(radius - std::hypot((a[0] + b[0]) / 2 - x, (a[1] + b[1]) / 2 - y));
}

TEST(PlanFlatten, ChordsStayWithinTheToleranceAndAreFew) {
  test::Random<> random(test::seed());
  for (int i = 0; i < 2000; ++i) {
    const auto number = [&](std::int64_t most) {
      return static_cast<double>(random.between(-most, most)) / 1000;
    };
    const double radius = 0.01 + std::abs(number(100'000));
    const double begin = number(3141);
    const double centre_x = number(100'000);
    const double centre_y = number(100'000);
    ArcTo wanted;
    wanted.sweep = number(6283);
    if (wanted.sweep == 0) continue;
    wanted.centre = {centre_x, centre_y};
    wanted.feed = 3;
    wanted.target = {centre_x + radius * std::cos(begin + wanted.sweep),
                     centre_y + radius * std::sin(begin + wanted.sweep), 7};
    const Path path{{"X", "Y", "Z"},
                    {centre_x + radius * std::cos(begin), centre_y + radius * std::sin(begin), 0},
                    {wanted}};
    const double tolerance = radius * std::pow(10, -1 - random.between(0, 5));
    const auto flat = flatten(path, tolerance);
    ASSERT_TRUE(flat) << flat.error();
    auto at = path.start;
    double height = 0;
    double worst = 0;
    for (std::size_t k = 0; k < flat->elements.size(); ++k) {
      const auto& chord = line(*flat, k);
      worst = std::max(worst, deviation(at, chord.target, centre_x, centre_y, radius));
      ASSERT_NEAR(std::hypot(chord.target[0] - centre_x, chord.target[1] - centre_y), radius, 1e-9);
      ASSERT_GT(chord.target[2], height);
      ASSERT_EQ(chord.feed, 3);
      height = chord.target[2];
      at = chord.target;
    }
    ASSERT_LE(worst, tolerance * (1 + 1e-6) + 1e-9);
    ASSERT_EQ(at, wanted.target);
    // One chord less would not do.
    const auto count = static_cast<double>(flat->elements.size());
    if (count > 4) {
      ASSERT_GT(radius * (1 - std::cos(wanted.sweep / (count - 1) / 2)), tolerance * (1 - 1e-3));
    }
  }
}

TEST(PlanFlatten, EverythingElseStays) {
  const auto path = gcode("G0 X1\nG4 P1\nG1 F60 X2 Y1\n");
  EXPECT_EQ(flatten(path, 0.1), path);
}

TEST(PlanFlatten, AWholeCircleIsNoLine) {
  const auto flat = flatten(gcode("F60 G2 I5\n"), 1000);
  ASSERT_TRUE(flat);
  EXPECT_THAT(flat->elements, SizeIs(4));
}

TEST(PlanFlatten, BoundsAndBadTolerances) {
  const auto path = gcode("F60 G2 I5\n");
  EXPECT_THAT(flatten(path, 1e-15).error(), HasSubstr("line 1: an arc of so many chords"));
  for (const double bad : {0.0, -1.0, std::nan("")})
    EXPECT_THAT(flatten(path, bad).error(), HasSubstr("the tolerance must be"));
}

// ---- Anything

std::string pieces_in_any_order(test::Random<>& random, std::span<const std::string_view> pieces) {
  std::string text;
  for (auto n = random.any_size(40); n > 0; --n)
    text += pieces[static_cast<std::size_t>(
        random.between(0, static_cast<std::int64_t>(pieces.size()) - 1))];
  return text;
}

void expect_finite(const Path& path, const std::string& text) {
  ASSERT_GE(path.axes.size(), 1U) << text;
  ASSERT_LE(path.axes.size(), most_axes) << text;
  const auto flat = flatten(path, 0.01);
  if (!flat) return;
  for (const auto& element : flat->elements) {
    const auto* only = std::get_if<LineTo>(&element);
    if (only == nullptr) continue;
    for (const double value : only->target) ASSERT_TRUE(std::isfinite(value)) << text;
    ASSERT_GT(only->feed.value_or(1), 0) << text;
  }
}

TEST(PlanPathFile, SurvivesAnyText) {
  static constexpr std::string_view gcode_pieces[] = {
      "G0",         "G1",         "G2",  "G3",   "G4 P1", "G20", "G21", "G90",  "G91",
      "X1",         "Y-2",        "Z.5", "A90",  "B",     "C1.", "I1",  "J-1",  "R2",
      "R-5",        "F60",        "M2",  "N1",   "%",     "(c)", "(",   ";",    "\n",
      "\n",         "\n",         " ",   "\r\n", "1",     "-",   "e",   "\xff", "X9999999999",
      "G1 F9 X1\n", "G3 I1 F1\n", "G17", "G18",  "G19",   "K1",  "P2",  "G92",  "G10 L2 P1",
      "G28",        "G53",        "G55", "G93",  "G95",   "S9",  "M0",  "M3",   "G61",
      "G64 P1",     "G90.1",      "G80", "G81"};
  static constexpr std::string_view csv_pieces[] = {
      "t",    "x",   "y",   "speed", ",", ",",    ",",    "\n",    "\n",    "1",     "2",
      "-3.5", "1e9", "nan", "#",     " ", "\r\n", "\xff", "1,2\n", "3,4\n", "t,x\n", "x,speed\n"};
  test::Random<> random(test::seed());
  int read = 0;
  for (int i = 0; i < 30'000; ++i) {
    const bool table = random.one_in(2);
    const auto text =
        table ? pieces_in_any_order(random, csv_pieces) : pieces_in_any_order(random, gcode_pieces);
    const auto unknowns = random.one_in(2) ? Unknowns::skipped : Unknowns::refused;
    const auto path = table ? read_csv(text) : read_gcode(text, {}, {unknowns});
    read += path ? 1 : 0;
    if (path) {
      expect_finite(*path, text);
      if (HasFatalFailure()) return;
      continue;
    }
    for (const auto& problem : path.error()) {
      ASSERT_GE(problem.line, 1U) << text;
      ASSERT_LE(problem.column, text.size() + 1) << text;
    }
  }
  EXPECT_GT(read, 300);
}

}  // namespace
}  // namespace tmcl::plan::path_file
