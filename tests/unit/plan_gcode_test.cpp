// What CAM programs write: planes, coordinate systems, feeds, stored points, and words that are not
// carried out.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "tmcl/plan/path_file.hpp"

namespace tmcl::plan::path_file {
namespace {

using std::numbers::pi;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

Path read(std::string_view text, const Point& start = {}, const GcodeSetup& setup = {}) {
  const auto path = read_gcode(text, start, setup);
  EXPECT_TRUE(path) << describe(path.error().front(), "text");
  return path.value_or(Path{});
}
Path read_lenient(std::string_view text) { return read(text, {}, {Unknowns::skipped}); }

std::vector<std::string> told(const TextProblems& problems) {
  std::vector<std::string> all;
  for (const auto& problem : problems) all.push_back(describe(problem, "text"));
  return all;
}
std::vector<std::string> complaints(std::string_view text, Unknowns unknowns = Unknowns::refused) {
  const auto path = read_gcode(text, {}, {unknowns});
  return path ? std::vector<std::string>{} : told(path.error());
}
std::string complaint(std::string_view text) {
  const auto all = complaints(text);
  EXPECT_FALSE(all.empty()) << text;
  return all.empty() ? "" : all.front();
}

/// Where the elements end, but for pauses.
std::vector<Point> ends(const Path& path) {
  std::vector<Point> all;
  for (const auto& element : path.elements) {
    if (const auto* line = std::get_if<LineTo>(&element)) all.push_back(line->target);
    if (const auto* arc = std::get_if<ArcTo>(&element)) all.push_back(arc->target);
  }
  return all;
}
std::vector<double> feeds(const Path& path) {
  std::vector<double> all;
  for (const auto& element : path.elements) {
    if (const auto* line = std::get_if<LineTo>(&element)) all.push_back(line->feed.value_or(0));
    if (const auto* arc = std::get_if<ArcTo>(&element)) all.push_back(arc->feed);
  }
  return all;
}
const ArcTo& arc(const Path& path, std::size_t i) { return std::get<ArcTo>(path.elements.at(i)); }
std::size_t pauses(const Path& path) {
  return static_cast<std::size_t>(std::ranges::count_if(path.elements, [](const Element& element) {
    return std::holds_alternative<Dwell>(element);
  }));
}

TEST(PlanGcode, WhatProgramsOfCamBeginWithIsTaken) {
  const auto path = read(
      "%\nO1001 (part)\nN10 G90 G94 G17 G91.1\nN20 G21 G40 G49 G80\nG54 G64 P0.01\n"
      "T1 M6\nS5000 M3\nM8\nG43 H0 G0 Z5\nG53 G0 Z0\nG0 X1 Y1\nG1 Z-1 F60\nG80\nM5 "
      "M9\nM30\n%\nG77\n");
  EXPECT_THAT(path.axes, ElementsAre("X", "Y", "Z"));
  EXPECT_THAT(told(path.remarks),
              ElementsAre("text:5:5: P of G64 is not carried out; the tolerance holds",
                          "text:6:1: T is not carried out", "text:6:4: M6 is not carried out",
                          "text:7:1: S is not carried out", "text:7:7: M3 is not carried out",
                          "text:8:1: M8 is not carried out", "text:14:1: M5 is not carried out",
                          "text:14:4: M9 is not carried out"));
}

// ---- Planes

TEST(PlanGcode, ArcsInEachPlaneTurnAsSeenFromItsThirdAxis) {
  const auto xy = read("F60 G17 G3 X0 Y10 I-10 J0\n", {10});
  EXPECT_EQ(arc(xy, 0).plane, (std::array<std::size_t, 2>{0, 1}));
  EXPECT_NEAR(arc(xy, 0).sweep, pi / 2, 1e-12);
  // From Z to X.
  const auto zx = read("F60 G18 G3 X10 Z0 I0 K-10\n", {0, 0, 10});
  EXPECT_THAT(zx.axes, ElementsAre("X", "Z"));
  EXPECT_EQ(arc(zx, 0).plane, (std::array<std::size_t, 2>{1, 0}));
  EXPECT_EQ(arc(zx, 0).centre, (std::array<double, 2>{0, 0}));
  EXPECT_NEAR(arc(zx, 0).sweep, pi / 2, 1e-12);
  const auto yz = read("F60 G19 G2 Y0 Z10 J-10 K0\n", {0, 10});
  EXPECT_THAT(yz.axes, ElementsAre("Y", "Z"));
  EXPECT_EQ(arc(yz, 0).plane, (std::array<std::size_t, 2>{0, 1}));
  EXPECT_NEAR(arc(yz, 0).sweep, -3 * pi / 2, 1e-12);
}

TEST(PlanGcode, AHelixLeadsAlongTheThirdAxisOfItsPlane) {
  const auto path = read("F60 G18 G2 X0 Z0 Y6 I-5 K0\nG17\n");
  EXPECT_THAT(path.axes, ElementsAre("X", "Y", "Z"));
  const auto flat = flatten(path, 0.001);
  ASSERT_TRUE(flat);
  const auto all = ends(*flat);
  EXPECT_EQ(all.back(), (Point{0, 6, 0}));
  // Half way it is on the other side, and half way up. From +Y, clockwise, X = 0 goes to Z first.
  const auto& half = all.at(all.size() / 2 - 1);
  EXPECT_NEAR(half[0], -10, 0.2);
  EXPECT_NEAR(half[1], 3, 0.1);
  EXPECT_GT(all.at(all.size() / 4)[2], 4);
}

TEST(PlanGcode, PIsANumberOfTurns) {
  EXPECT_NEAR(arc(read("F60 G3 X0 Y10 I-10 P3\n", {10}), 0).sweep, 4 * pi + pi / 2, 1e-12);
  EXPECT_NEAR(arc(read("F60 G2 I-10 P2 Z1\n", {10}), 0).sweep, -4 * pi, 1e-12);
  EXPECT_NEAR(arc(read("F60 G3 X0 Y10 R10 P2\n", {10}), 0).sweep, 2 * pi + pi / 2, 1e-12);
  const auto flat = flatten(read("F60 G2 I-10 P2 Z1\n", {10}), 0.01);
  EXPECT_EQ(ends(*flat).back(), (Point{10, 0, 1}));
  for (const std::string turns : {"0", "1.5", "-1", "1001"})
    EXPECT_EQ(complaint("F60 G2 I-10 P" + turns),
              "text:1:13: P of an arc is a whole number of turns, 1 to 1000");
  EXPECT_EQ(complaint("F60 G64 G2 I-10 P2"), "text:1:17: it is not clear what P belongs to");
}

TEST(PlanGcode, CentresMayBePositions) {
  const auto path = read("F60 G90.1 G3 X0 Y10 I0 J0\n", {10});
  EXPECT_EQ(arc(path, 0).centre, (std::array<double, 2>{0, 0}));
  EXPECT_NEAR(arc(path, 0).sweep, pi / 2, 1e-12);
  const auto shifted = read("F60 G90.1 G92 X0\nG3 X-10 Y10 I-10 J0\nG91.1 G3 X-20 Y0 J-10\n", {10});
  EXPECT_EQ(arc(shifted, 0).centre, (std::array<double, 2>{0, 0}));
  EXPECT_EQ(arc(shifted, 1).centre, (std::array<double, 2>{0, 0}));
  EXPECT_EQ(complaint("F60 G90.1 G3 X1 I0"), "text:1:17: G3 needs I and J, or R");
}

TEST(PlanGcode, ArcsNeedTheLettersOfTheirPlane) {
  read("F60 G2 X2 I1 K0\n");
  EXPECT_EQ(complaint("F60 G2 X2 I1 K1"), "text:1:14: K is no part of the plane of this arc");
  EXPECT_EQ(complaint("F60 G18 G2 X2 J1"), "text:1:15: J is no part of the plane of this arc");
  EXPECT_EQ(complaint("F60 G18 G2 X2"), "text:1:12: G2 needs I and K, or R");
  EXPECT_EQ(complaint("F60 G19 G3 Y2"), "text:1:12: G3 needs J and K, or R");
  EXPECT_EQ(complaint("F60 G2 K0"), "text:1:8: the centre is where the arc begins");
}

// ---- Where positions count from

TEST(PlanGcode, CoordinateSystemsAreSetAndShifted) {
  EXPECT_THAT(ends(read("G10 L2 P2 X100\nG55 G0 X1\nG54 X1\nG53 X7\n")),
              ElementsAre(Point{101}, Point{1}, Point{7}));
  EXPECT_THAT(ends(read("G10 L20 P0 X0\nG0 X1\nG91 X1\nG53 X3\n", {10})),
              ElementsAre(Point{11}, Point{12}, Point{3}));
  EXPECT_THAT(ends(read("G92 X0\nG0 X1\nG92.2 X1\nG92.3 X2\nG92.1 X1\n", {10})),
              ElementsAre(Point{11}, Point{1}, Point{12}, Point{1}));
  EXPECT_THAT(ends(read("G52 X5\nG0 X1\nG52 X0\nX2\n")), ElementsAre(Point{6}, Point{2}));
  EXPECT_THAT(ends(read("G20 G10 L2 P1 X1 A5\nG21 G0 X1 A1\n")), ElementsAre(Point{26.4, 6}));
  // What is said of an axis that does not move makes it no axis of the path.
  EXPECT_THAT(read("G92 X0 Y0 Z0\nG0 X1\n", {1, 2, 3}).axes, ElementsAre("X"));
}

TEST(PlanGcode, ACoordinateSystemThatWasNotSetIsTold) {
  EXPECT_THAT(told(read("G54 G0 X1\nG56 X2\nG56\n").remarks),
              ElementsAre("text:2:1: G56 was not set here; it counts from the zero of the axes"));
  EXPECT_THAT(read("G10 L2 P3 X0\nG56 G0 X2\n").remarks, IsEmpty());
}

GcodeSetup with_stored_origins() {
  GcodeSetup setup;
  setup.origins[0] = Point{10, 0, 0, 90};
  setup.origins[2] = Point{100};
  return setup;
}

TEST(PlanGcode, StoredOriginsHoldFromTheBegin) {
  const auto stored = with_stored_origins();
  EXPECT_THAT(ends(read("G0 X1 A0\nG56 X1\nG55 X1\nG53 X7\n", {}, stored)),
              ElementsAre(Point{11, 90}, Point{101, 90}, Point{1, 90}, Point{7, 90}));
  EXPECT_THAT(told(read("G54 G0 X1\nG56 X1\nG57 X2\n", {}, stored).remarks),
              ElementsAre("text:3:1: G57 was not set here; it counts from the zero of the axes"));
  // What G10 sets, G92 shifts and G28 remembers.
  EXPECT_THAT(ends(read("G10 L2 P1 X20\nG0 X1\n", {}, stored)), ElementsAre(Point{21}));
  EXPECT_THAT(ends(read("G10 L20 P3 X0\nG56 G0 X1\n", {5}, stored)), ElementsAre(Point{6}));
  EXPECT_THAT(ends(read("G92 X0\nG0 X1\nG56 X1\n", {5}, stored)), ElementsAre(Point{6}, Point{96}));
  EXPECT_THAT(ends(read("G28 X1\n", {}, stored)), ElementsAre(Point{11}, Point{0}));
  EXPECT_THAT(ends(read("G91 G0 X1\n", {}, stored)), ElementsAre(Point{1}));
}

// ---- Lengths of tools

GcodeSetup with_tools() {
  GcodeSetup setup;
  setup.tools = {{1, 12.5}, {2, -3}};
  return setup;
}

TEST(PlanGcode, ToolsAreAsLongAsTheirTableSays) {
  const auto tools = with_tools();
  EXPECT_THAT(ends(read("G43 H1 G0 Z5\nX1\nG43 H2 Z5\nG49 Z5\nG43 H1\nG43 H0 Z6\n", {}, tools)),
              ElementsAre(Point{0, 17.5}, Point{1, 17.5}, Point{1, 2}, Point{1, 5}, Point{1, 6}));
  EXPECT_THAT(ends(read("G43 H1\nG53 G0 Z0.5\nG91 Z1\nG90 Z0\n", {}, tools)),
              ElementsAre(Point{0.5}, Point{1.5}, Point{12.5}));
  // What stands there has this position, whichever tool it is.
  EXPECT_THAT(ends(read("G43 H1\nG92 Z0\nG0 Z1\nG49 Z1\n", {0, 0, 20}, tools)),
              ElementsAre(Point{21}, Point{8.5}));
  EXPECT_THAT(ends(read("G43 H1\nG10 L20 P1 Z0\nG0 Z1\n", {0, 0, 20}, tools)),
              ElementsAre(Point{21}));
}

TEST(PlanGcode, WithoutHItIsTheToolThatWasChangedTo) {
  EXPECT_THAT(ends(read("T1 M6\nT2\nG43 G0 Z5\nM6\nG43 Z5\n", {}, with_tools())),
              ElementsAre(Point{17.5}, Point{2}));
  const auto without = [](std::string_view text) {
    const auto path = read_gcode(text, {}, with_tools());
    return path ? std::string() : describe(path.error().front(), "text");
  };
  EXPECT_EQ(without("T1 G43"),
            "text:1:4: G43 needs H, the number of a tool, or M6 with T before it");
  EXPECT_EQ(
      without("T7 M6\nG43 G0 Z1"),
      "text:2:1: the length of tool 7 is not known: 'tools' of [path] in the configuration of "
      "tmcld says lengths");
  for (const std::string tool : {"3", "1.5", "-1", "99999999999"})
    EXPECT_THAT(without("G43 H" + tool), HasSubstr("text:1:5: the length of tool " + tool)) << tool;
}

TEST(PlanGcode, G43_1SaysLengthsItself) {
  EXPECT_THAT(ends(read("G20 G43.1 Z1\nG21 G0 Z5\nG43.1 X2\nX1 Z1\nG49 X1 Z1\n")),
              ElementsAre(Point{0, 30.4}, Point{3, 26.4}, Point{1, 1}));
  EXPECT_THAT(ends(read("G0 Z5\nG43.1 Z1\nZ5\n")), ElementsAre(Point{5}, Point{6}));
  EXPECT_THAT(read("G43.1 Z1\nG0 X1\n").axes, ElementsAre("X"));
  EXPECT_EQ(complaint("G43.1"), "text:1:1: G43.1 needs an axis, and its length");
  EXPECT_EQ(complaint("G43.1 G0 Z1"), "text:1:7: G43.1 and a movement exclude each other");
  EXPECT_EQ(complaint("G43.1 G92 Z1"), "text:1:7: G43.1 and G92 exclude each other");
  EXPECT_EQ(complaint("G43.1 G43 H0 Z1"), "text:1:7: G43.1 and G43 exclude each other");
  EXPECT_EQ(complaint("G43.1 Z1 H1"), "text:1:10: H belongs to G43");
  EXPECT_EQ(complaint("G43.2 H1"),
            "text:1:1: G43.2 is not known here: one length of a tool holds at a time");
}

TEST(PlanGcode, WhatSetsPositionsMayBeWrong) {
  EXPECT_EQ(complaint("G10 L1 P1 X1"), "text:1:1: G10 is known with L2 and L20 only");
  EXPECT_THAT(complaint("G10 L2 P7 X1"), HasSubstr("text:1:8: G10 needs P: 1 to 6"));
  EXPECT_THAT(complaint("G10 L2 X1"), HasSubstr("text:1:1: G10 needs P: 1 to 6"));
  EXPECT_EQ(complaint("G10 L2 P1 R45"),
            "text:1:11: coordinates that are turned are not known here");
  EXPECT_EQ(complaint("G92"), "text:1:1: G92 needs an axis");
  EXPECT_EQ(complaint("G92 G0 X1"), "text:1:5: G92 and a movement exclude each other");
  EXPECT_EQ(complaint("G0 X1 L2"), "text:1:7: L belongs to G10");
  EXPECT_EQ(complaint("F60 G53 G2 X1 I1"), "text:1:5: G53 needs G0 or G1");
}

TEST(PlanGcode, G28LeadsByThePointOfItsLineToTheStoredOne) {
  const auto path = read("G0 X3 Y4 Z5\nG28 G91 Z0\nG90 G28 Z9\n", {1, 1, 1});
  EXPECT_THAT(ends(path),
              ElementsAre(Point{3, 4, 5}, Point{3, 4, 0}, Point{3, 4, 9}, Point{3, 4, 0}));
  EXPECT_THAT(feeds(path), ElementsAre(0, 0, 0, 0));
  // Without axes all that the program moves.
  EXPECT_THAT(ends(read("G0 X3 Y4\nG28\n", {1, 1, 1})), ElementsAre(Point{3, 4}, Point{0, 0}));
  EXPECT_THAT(ends(read("G28\n", {1, 1, 1})), ElementsAre(Point{0}));
  EXPECT_THAT(ends(read("G28.1\nG0 X3\nG30.1\nX5\nG28\nG30 X4\n", {1})),
              ElementsAre(Point{3}, Point{5}, Point{1}, Point{4}, Point{3}));
  EXPECT_EQ(complaint("G28 G0 X1"), "text:1:5: G28 and a movement exclude each other");
  EXPECT_EQ(complaint("G28 G30 X1"), "text:1:5: G28 and G30 exclude each other");
}

// ---- Feeds

TEST(PlanGcode, InverseTimeIsSaidOnEachLine) {
  // Half a minute; 3 and 4 make 5.
  EXPECT_THAT(feeds(read("G93 G1 X3 Y4 F2\nG0 X0\n")), ElementsAre(5.0 / 30, 0));
  EXPECT_THAT(feeds(read("G93 G1 A90 F1\nX60 A0 F1\n")), ElementsAre(1.5, 1));
  EXPECT_NEAR(feeds(read("G93 G2 I5 F1 P2\n")).front(), 20 * pi / 60, 1e-12);
  EXPECT_NEAR(feeds(read("G93 G2 X10 I5 Z1 F1\n")).front(), std::hypot(5 * pi, 1) / 60, 1e-12);
  EXPECT_EQ(complaint("G93 G1 X3 F2\nX4"), "text:2:1: G1 needs F on its line, as G93 holds");
}

TEST(PlanGcode, FeedsOfATurnNeedASpindleSpeed) {
  EXPECT_THAT(feeds(read("G95 F0.5 S120\nG1 X1\nS240 X2\n")), ElementsAre(1, 2));
  EXPECT_THAT(feeds(read("G20 G95 F0.5 S120\nG1 X1\n")), ElementsAre(25.4));
  EXPECT_EQ(complaint("G95 G1 X3 F2"), "text:1:8: G1 needs S above 0, as G95 holds");
}

TEST(PlanGcode, AnotherKindOfFeedNeedsAnotherF) {
  EXPECT_THAT(feeds(read("F60\nG94 G1 X1\n")), ElementsAre(1));
  EXPECT_EQ(complaint("F60\nG95 S60\nG1 X1\n"), "text:3:4: G1 needs F, which was not said yet");
  EXPECT_EQ(complaint("G93\nF60\nG94 G1 X1\n"), "text:3:8: G1 needs F, which was not said yet");
}

// ---- Stops and the end

TEST(PlanGcode, ExactStopsStandBetweenMovements) {
  EXPECT_EQ(pauses(read("G61.1 G0 X1\nX2\nX3\n")), 2U);
  EXPECT_EQ(pauses(read("G61 G0 X1\nX2\nY3\n")), 1U);
  EXPECT_EQ(pauses(read("G61 G0 X1\nX0\n")), 1U);
  EXPECT_EQ(pauses(read("G61 F60 G1 X1\nG2 X3 I1\nG64 G1 X5\n")), 1U);
  EXPECT_EQ(pauses(read("G61 G0 X1\nG4 P1\nY1\n")), 1U);
  EXPECT_EQ(pauses(read("G64 G0 X1\nY2\nX3\n")), 0U);
}

TEST(PlanGcode, M0WaitsM1StandsAndM30Ends) {
  const auto path = read("G0 X1 M0\nX2\nM1\nX3\nM30\nnonsense\n");
  EXPECT_THAT(path.elements, ElementsAre(Element(LineTo{{1}, {}, {}, 1}), Element(Dwell{0, 1, 0}),
                                         Element(LineTo{{2}, {}, {}, 2}), Element(Dwell{0, 3}),
                                         Element(LineTo{{3}, {}, {}, 4})));
  EXPECT_THAT(told(path.remarks),
              ElementsAre("text:3:1: M1 does not wait: the axes stand and go on"));
}

// ---- What is switched

GcodeSetup carrying_out(std::initializer_list<std::size_t> words) {
  GcodeSetup setup;
  for (const auto word : words) setup.words.set(word);
  return setup;
}
/// The M words of the dwells, and "-" for what moves.
std::string order_of(const Path& path) {
  std::string order;
  for (const auto& element : path.elements) {
    const auto* dwell = std::get_if<Dwell>(&element);
    order += dwell == nullptr ? "- "
             : dwell->word    ? "M" + std::to_string(*dwell->word) + " "
                              : "G4 ";
  }
  return order;
}

TEST(PlanGcode, WordsThatAreCarriedOutComeBeforeTheMovementOfTheirLine) {
  const auto all = carrying_out({3, 4, 5, 7, 8, 9});
  EXPECT_EQ(order_of(read("G0 X1 M3\nG4 P1 M8\nX2 M5 M9\nX3\n", {}, all)), "M3 - M8 G4 M5 M9 - - ");
  EXPECT_EQ(order_of(read("M4 M7\nG0 X1\nM0 M5 X2\nM9\n", {}, all)), "M4 M7 - M5 - M0 M9 ");
  const auto path = read("G0 X1\nM3\nM5\n", {}, all);
  EXPECT_EQ(std::get<Dwell>(path.elements.at(1)), (Dwell{0, 2, 3}));
  EXPECT_THAT(path.remarks, IsEmpty());
}

TEST(PlanGcode, WordsThatAreNotCarriedOutAreToldAndTheAxesGoOn) {
  const auto path = read("M3\nG0 X1 M8\nM6\nX2 M5\n", {}, carrying_out({3}));
  EXPECT_EQ(order_of(path), "M3 - - ");
  EXPECT_THAT(told(path.remarks),
              ElementsAre("text:2:7: M8 is not carried out", "text:3:1: M6 is not carried out",
                          "text:4:4: M5 is not carried out"));
}

TEST(PlanGcode, WhatIsStillOnIsSwitchedOffAtTheEnd) {
  const auto all = carrying_out({3, 4, 5, 7, 8, 9});
  const auto path = read("M3 M8\nG0 X1\nM30\nX2\n", {}, all);
  EXPECT_EQ(order_of(path), "M3 M8 - M5 M9 ");
  EXPECT_EQ(std::get<Dwell>(path.elements.back()), (Dwell{0, 3, 9}));
  EXPECT_EQ(order_of(read("M4\nM7\nM9\nG0 X1\n", {}, all)), "M4 M7 M9 - M5 ");
  EXPECT_EQ(order_of(read("M5 M9 G0 X1\n", {}, all)), "M5 M9 - ");
  EXPECT_EQ(order_of(read("M3 G0 X1\n", {}, carrying_out({3}))), "M3 - ");
  EXPECT_EQ(order_of(read("M3 G0 X1\n", {}, carrying_out({5}))), "- ");
}

TEST(PlanGcode, TheSecondTapeMarkEndsIt) {
  EXPECT_THAT(ends(read("%\nG0 X1\n %\t\nnonsense\n")), SizeIs(1));
  EXPECT_THAT(ends(read("G0 X1\n%\n")), SizeIs(1));
}

TEST(PlanGcode, G80EndsMovements) {
  EXPECT_THAT(complaint("G0 X1\nG80\nX2\n"), HasSubstr("text:3:1: G0, G1, G2 or G3 must come"));
  EXPECT_THAT(ends(read("G80 G0 X1\nX2\n")), SizeIs(2));
}

TEST(PlanGcode, CodesOfOneKindExcludeEachOther) {
  EXPECT_EQ(complaint("G90 G91"), "text:1:5: G90 and G91 exclude each other");
  EXPECT_EQ(complaint("G54 G17 G55"), "text:1:9: G54 and G55 exclude each other");
  EXPECT_THAT(complaints("G90 G90\nG54 G54\n"), IsEmpty());
}

// ---- What is refused, and may be skipped

TEST(PlanGcode, WhatIsRefusedSaysWhy) {
  EXPECT_EQ(complaint("G41 D1"),
            "text:1:1: G41 is not known here: the radius of a tool is not known");
  EXPECT_EQ(
      complaint("G43 H1"),
      "text:1:5: the length of tool 1 is not known: 'tools' of [path] in the configuration of "
      "tmcld says lengths");
  EXPECT_EQ(complaint("G83 X1"), "text:1:1: G83 is not known here: drilling cycles are not read");
  EXPECT_EQ(complaint("G33 K1"), "text:1:1: G33 is not known here: no spindle leads the axes");
  EXPECT_EQ(complaint("G5 X1"), "text:1:1: G5 is not known here: splines are not read");
  EXPECT_EQ(complaint("O100 sub"), "text:1:1: O words that call, repeat or decide are not read");
  EXPECT_EQ(complaint("o<a> call"), "text:1:1: O words that call, repeat or decide are not read");
  EXPECT_EQ(complaint("G0 X1 H1"), "text:1:7: H belongs to G43");
  EXPECT_EQ(complaint("G0 X1 Q1"), "text:1:7: Q belongs to G64");
}

// Compensation and lengths of tools change no way of the program itself.
TEST(PlanGcode, ProblemsBehindToolsAreToldAtOnce) {
  EXPECT_THAT(complaints("F60 G41 D1 G1 X1\nG43 H2 Z5\nG2 X5 I1\nM48\nG5 X1\n"),
              ElementsAre(HasSubstr("text:1:5: G41"), HasSubstr("text:1:9: 'D1'"),
                          HasSubstr("text:2:5: the length of tool 2"),
                          HasSubstr("text:3:7: the arc begins"), HasSubstr("text:4:1: M48"),
                          HasSubstr("text:5:1: G5")));
}

TEST(PlanGcode, UnknownWordsMayBeSkipped) {
  const auto path = read_lenient("F60 G41 D1 G1 X1 E5\nG43 H2 Z5 E6\nM48\nM98 P100 L2\nG0 X2\n");
  EXPECT_THAT(ends(path), ElementsAre(Point{1, 0}, Point{1, 5}, Point{2, 5}));
  EXPECT_THAT(
      told(path.remarks),
      ElementsAre(
          "text:1:5: G41 is not known here: the radius of a tool is not known; skipped",
          "text:1:9: 'D1' is not known here; skipped", "text:1:18: 'E5' is not known here; skipped",
          HasSubstr("text:2:5: the length of tool 2 is not known"),
          "text:3:1: M48 is not known here; skipped", "text:4:1: M98 is not known here; skipped"));
}

TEST(PlanGcode, WhatSkippedWordsWouldMoveIsSkipped) {
  EXPECT_THAT(ends(read_lenient("G0 Z5\nG81 X1 Y2 Z-5 R2\nX3 Y4\nG80\nG0 X9\n")),
              ElementsAre(Point{0, 5}, Point{9, 5}));
  EXPECT_THAT(ends(read_lenient("G0 X1\nG68 X5 Y5 R45\nX2\nM92 X80\n")),
              ElementsAre(Point{1}, Point{2}));
  EXPECT_THAT(ends(read_lenient("G187 P1 G0 X1\n")), ElementsAre(Point{1}));
  EXPECT_THAT(ends(read_lenient("F60 G1 G41 X1 P2\n")), ElementsAre(Point{1}));
  EXPECT_THAT(read_lenient("G1 F60 X1\nG81 X5 Z2 R1\n").axes, ElementsAre("X"));
}

TEST(PlanGcode, WhatIsNoWordIsNeverSkipped) {
  EXPECT_THAT(
      complaints("#1=5\nG0 X#1\nG0 X[1]\no100 sub\n$H\nG0 X1 (\nG1 X5\n", Unknowns::skipped),
      ElementsAre(HasSubstr("text:1:1: '#1=5'"), HasSubstr("text:3:4: a number is missing"),
                  HasSubstr("text:4:1: O words"), HasSubstr("text:5:1: '$H'"),
                  HasSubstr("text:6:7: ')' is missing")));
  EXPECT_THAT(complaints("G1 X5\n", Unknowns::skipped), SizeIs(1));
}

TEST(PlanGcode, RemarksAreBounded) {
  std::string text;
  for (int i = 100; i < 900; ++i) text += "M" + std::to_string(i) + "\n";
  EXPECT_THAT(read_lenient(text).remarks, SizeIs(most_remarks));
}

TEST(PlanGcode, ChordsKeepRemarks) {
  const auto path = read("S5 F60 G2 I5\n");
  EXPECT_EQ(flatten(path, 0.1)->remarks, path.remarks);
}

}  // namespace
}  // namespace tmcl::plan::path_file
