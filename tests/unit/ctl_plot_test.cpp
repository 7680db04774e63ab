// The renderers: what is drawn where.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <sstream>

#include "plot/canvas.hpp"
#include "plot/plane.hpp"
#include "plot/recording.hpp"
#include "plot/scale.hpp"
#include "plot/svg_plot.hpp"
#include "plot/text_plot.hpp"

namespace tmclctl::plot {
namespace {

using testing::HasSubstr;
using testing::Not;

// A trapezoid: up, along, down; its position is the sum.
Recording trapezoid(int samples = 201) {
  Recording recording{"x", {}};
  double position = 0;
  for (int i = 0; i < samples; ++i) {
    const double part = static_cast<double>(i) / (samples - 1);
    const double velocity = 1000 * std::min({1.0, part * 4, (1 - part) * 4});
    position += velocity;
    recording.samples.push_back(
        {part * 2, static_cast<std::int32_t>(position), static_cast<std::int32_t>(velocity)});
  }
  return recording;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

// In characters: everything here is one column wide.
std::size_t columns_of(const std::string& line) {
  return static_cast<std::size_t>(std::ranges::count_if(
      line, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

Screen screen(int width, bool utf8 = true, bool colour = false) {
  return {colour, colour, utf8, width};
}

TEST(CtlScale, TicksAreRoundAndWithin) {
  for (const auto& [low, high] : {std::pair{0.0, 51200.0},
                                  {-1134.0, 50066.0},
                                  {0.0, 0.58},
                                  {-2047.0, 2047.0},
                                  {99.0, 101.0},
                                  {-8388608.0, 8388607.0}}) {
    const std::array values{low, high};
    const Scale scale(values, 5);
    ASSERT_GE(scale.ticks().size(), 2U);
    EXPECT_LE(scale.ticks().size(), 7U);
    for (const double tick : scale.ticks()) {
      EXPECT_GE(scale.fraction(tick), -0.001);
      EXPECT_LE(scale.fraction(tick), 1.001);
      EXPECT_NEAR(std::stod(scale.label(tick)), tick, 1e-9) << "a label says what the tick is";
    }
  }
}

TEST(CtlScale, HasTwoTicksWhereTheFirstStepFindsOne) {
  EXPECT_EQ(Scale(std::array{-36.0, 46.0}, 2).ticks(), (std::vector<double>{-20, 0, 20, 40}));
  EXPECT_EQ(Scale(std::array{-0.4, 0.4}, 1).ticks().size(), 5U);
}

TEST(CtlScale, NothingAndOneValueHaveARange) {
  const std::array same{5.0, 5.0};
  EXPECT_LT(Scale({}, 4).low(), Scale({}, 4).high());
  EXPECT_NEAR(Scale(same, 4).fraction(5), 0.5, 1e-9);
}

TEST(CtlCanvas, DrawsEveryDotOfALine) {
  Canvas canvas(3, 2, true);
  canvas.line(0, 7, 5, 0);
  EXPECT_TRUE(canvas.dot(0, 7));
  EXPECT_TRUE(canvas.dot(5, 0));
  for (int y = 0; y < canvas.height(); ++y) {
    int dots = 0;
    for (int x = 0; x < canvas.width(); ++x) dots += canvas.dot(x, y) ? 1 : 0;
    EXPECT_GE(dots, 1) << "a gap in row " << y;
  }
}

TEST(CtlCanvas, LeavesOutWhatLiesOutside) {
  Canvas canvas(2, 2, true);
  canvas.line(-100, -100, 100, 100);
  EXPECT_TRUE(canvas.dot(0, 0));
}

TEST(CtlCanvas, BrailleAndAscii) {
  Canvas braille(1, 1, true);
  braille.line(0, 0, 0, 0);
  braille.line(1, 3, 1, 3);
  EXPECT_EQ(braille.row(0), "⢁");
  Canvas ascii(3, 1, false);
  ascii.line(0, 0, 0, 1);
  ascii.line(1, 0, 1, 0);
  ascii.line(2, 1, 2, 1);
  EXPECT_EQ(ascii.row(0), ":'.");
}

TEST(CtlTextPlot, LooksLikeThis) {
  Recording recording{"x", {{0, 0, 0}, {0.5, 100, 400}, {1.0, 300, 400}, {1.5, 400, 0}}};
  EXPECT_EQ(to_text(recording, screen(44, false)),
            "x went from 0 to 400 microsteps in 1.50 s, fastest velocity 400 [internal]\n"
            "\n"
            "     position [microsteps]\n"
            "400 +                                  ...''\n"
            "    |                           ...''''\n"
            "300 +                       ..''\n"
            "    |                     .'\n"
            "200 +                  .''\n"
            "    |               ..'\n"
            "100 +            ..'\n"
            "    |     ....'''\n"
            "  0 +..'''\n"
            "    ++------------+-----------+------------+\n"
            "     velocity [internal]\n"
            "400 +            .'''''''''''''.\n"
            "    |           :               :\n"
            "300 +         .'                 '.\n"
            "    |        :                     :\n"
            "200 +      .'                       '.\n"
            "    |     :                           :\n"
            "100 +   .'                             '.\n"
            "    |  :                                 :\n"
            "  0 +.'                                   '.\n"
            "    ++------------+-----------+------------+\n"
            "    0.0          0.5         1.0 s\n");
}

TEST(CtlTextPlot, FillsTheWidthAndNoMore) {
  for (const bool utf8 : {true, false}) {
    for (const int width : {40, 80, 100, 120}) {
      std::size_t widest = 0;
      for (const auto& line : lines_of(to_text(trapezoid(), screen(width, utf8)))) {
        if (line.starts_with("x went")) continue;
        widest = std::max(widest, columns_of(line));
      }
      EXPECT_EQ(widest, static_cast<std::size_t>(width));
    }
  }
  EXPECT_EQ(to_text(trapezoid(), screen(300)), to_text(trapezoid(), screen(widest_plot)));
}

TEST(CtlTextPlot, NoControlCodesWithoutColour) {
  for (const bool utf8 : {true, false}) {
    const auto text = to_text(trapezoid(), screen(80, utf8));
    EXPECT_THAT(text, Not(HasSubstr("\x1b")));
    EXPECT_THAT(text, Not(HasSubstr("\r")));
  }
  EXPECT_THAT(to_text(trapezoid(), screen(80, true, true)), HasSubstr("\x1b[36m"));
}

TEST(CtlTextPlot, AsciiIsAscii) {
  for (const char c : to_text(trapezoid(), screen(80, false)))
    EXPECT_LT(static_cast<unsigned char>(c), 0x80);
}

TEST(CtlTextPlot, ThePeakIsInTheRightColumn) {
  for (int peak = 0; peak <= 100; peak += 10) {
    Recording recording{"x", {}};
    for (int i = 0; i <= 100; ++i) recording.samples.push_back({i * 0.01, 0, i == peak ? 1000 : 0});
    const auto lines = lines_of(to_text(recording, screen(80, false)));
    // The topmost row of the lower panel.
    const auto heading = std::ranges::find_if(
        lines, [](const auto& line) { return line.ends_with("velocity [internal]"); });
    ASSERT_NE(heading, lines.end());
    const auto& top = *(heading + 1);
    const auto wall = top.find_first_of("|+");
    const auto column = top.find_first_of(":'.", wall) - wall - 1;
    const double columns = 80 - static_cast<double>(wall) - 1;
    EXPECT_NEAR(static_cast<double>(column), peak / 100.0 * (columns - 1), 1.01) << peak;
  }
}

TEST(CtlTextPlot, ARisingCurveRises) {
  const auto lines = lines_of(to_text(trapezoid(), screen(80, false)));
  std::size_t before = std::string::npos;
  // From the top of the upper panel down, the curve begins further and further to the left.
  for (std::size_t row = 3; row < 12; ++row) {
    const auto begin = lines[row].find_first_of(":'.", lines[row].find_first_of("|+") + 1);
    if (begin == std::string::npos) continue;
    EXPECT_LE(begin, before) << lines[row];
    before = begin;
  }
  EXPECT_NE(before, std::string::npos);
}

TEST(CtlTextPlot, SurvivesAnyRecording) {
  const Recording empty{"x", {}};
  const Recording one{"x", {{0, 5, 0}}};
  const Recording extreme{"x", {{0, INT32_MIN, INT32_MIN}, {1e6, INT32_MAX, INT32_MAX}}};
  for (const auto& recording : {empty, one, extreme}) {
    EXPECT_FALSE(to_text(recording, screen(40)).empty());
    EXPECT_THAT(to_svg(recording), HasSubstr("</svg>"));
  }
}

TEST(CtlSvg, HasBothCurvesAndStandsAlone) {
  const auto svg = to_svg(trapezoid());
  EXPECT_THAT(svg, HasSubstr("class=\"curve position\""));
  EXPECT_THAT(svg, HasSubstr("class=\"curve velocity\""));
  EXPECT_THAT(svg, HasSubstr("position [microsteps]"));
  EXPECT_THAT(svg, HasSubstr("time [s]"));
  EXPECT_THAT(svg, HasSubstr("<title>x went from"));
  EXPECT_THAT(svg, Not(HasSubstr("href")));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
}

Curve with_values(std::vector<double> times, std::vector<double> values) {
  return {"velocity", "mm/s", std::move(times), std::move(values)};
}

TEST(CtlDerivative, OfALineIsItsSlope) {
  std::vector<double> times, values;
  for (int i = 0; i <= 100; ++i) {
    times.push_back(i * 0.01);
    values.push_back(3 - 2 * times.back());
  }
  const auto slopes = derivative(with_values(times, values), "acceleration", "mm/s^2", {});
  EXPECT_EQ(slopes.times, times);
  for (const double slope : slopes.values) EXPECT_NEAR(slope, -2, 1e-9);
}

// Whether the value at a break is that before or that after the jump.
TEST(CtlDerivative, DoesNotSeeWhatJumpsAtABreak) {
  for (const bool early : {false, true}) {
    std::vector<double> times, values;
    for (int i = 0; i <= 100; ++i) {
      times.push_back(i * 0.01);
      const bool is_behind = early ? i >= 40 : i > 40;
      values.push_back(is_behind ? 7 - times.back() : times.back());
    }
    const auto slopes = derivative(with_values(times, values), "a", "", {0, 0.4});
    ASSERT_EQ(slopes.times.size(), slopes.values.size());
    for (std::size_t i = 0; i < slopes.times.size(); ++i) {
      if (slopes.times[i] != 0.4) {
        EXPECT_NEAR(slopes.values[i], slopes.times[i] < 0.4 ? 1 : -1, 1e-9) << slopes.times[i];
      }
    }
    EXPECT_EQ(std::ranges::count(slopes.times, 0.4), 2);
  }
}

TEST(CtlDerivative, OfFewPointsHasAsMany) {
  for (std::size_t count = 0; count < 6; ++count) {
    std::vector<double> times(count), values(count, 1);
    for (std::size_t i = 0; i < count; ++i) times[i] = static_cast<double>(i);
    for (const auto& breaks : {std::vector<double>{}, {0}, {0, 2}, {0, 1, 2, 3}, {-1, 9}}) {
      const auto slopes = derivative(with_values(times, values), "a", "", breaks);
      EXPECT_GE(slopes.values.size(), count);
      EXPECT_TRUE(std::ranges::is_sorted(slopes.times));
      EXPECT_THAT(slopes.values, testing::Each(0));
    }
  }
}

TEST(CtlTextPlot, PointsOutPhasesWhereThereIsRoom) {
  auto recording = trapezoid();
  recording.phases = {{0, "up"}, {0.5, "cruise"}, {1.49, "a long name"}, {1.5, "down"}};
  const auto lines = lines_of(to_text(recording, screen(60)));
  const auto found = std::ranges::find_if(
      lines, [](const std::string& line) { return line.find("╷up") != std::string::npos; });
  ASSERT_NE(found, lines.end());
  EXPECT_THAT(*found, HasSubstr("╷cruise"));
  EXPECT_THAT(*found, Not(HasSubstr("a long name")));
  EXPECT_THAT(*found, HasSubstr("down"));
  EXPECT_LE(columns_of(*found), 60U);
  EXPECT_THAT(to_text(recording, screen(60, false)), HasSubstr("|cruise"));
}

TEST(CtlSvg, OtherMovementsHaveColoursOfTheirOwn) {
  auto picture = picture_of(trapezoid());
  picture.curves.front().overlays = {{"bow_max=0", {0, 4}, {0, 9e6}}, {"<2>", {0, 1}, {0, 1}}};
  const auto svg = to_svg(picture);
  EXPECT_THAT(svg, HasSubstr(">bow_max=0</text>"));
  EXPECT_THAT(svg, HasSubstr(">&lt;2&gt;</text>"));
  EXPECT_THAT(svg, HasSubstr("stroke=\"#c8413b\""));
  EXPECT_THAT(svg, HasSubstr("stroke=\"#7a8b2a\""));
  EXPECT_THAT(svg, HasSubstr(">4.0</text>")) << "all of them have room";
}

TEST(CtlShown, ChangesOfAVelocityHaveItsUnit) {
  auto recording = trapezoid();
  EXPECT_EQ(acceleration_curve(recording).unit, "internal/s");
  EXPECT_EQ(jerk_curve(recording).unit, "internal/s^2");
  use({tmcl::microsteps_scale(), {}}, recording);
  EXPECT_EQ(acceleration_curve(recording).unit, "microsteps/s^2");
  EXPECT_EQ(jerk_curve(recording).unit, "microsteps/s^3");
  EXPECT_THAT(to_csv(recording, {Quantity::acceleration, Quantity::jerk}),
              HasSubstr(",acceleration_microsteps_per_s2,jerk_microsteps_per_s3\n"));
  const auto picture = picture_of(recording, {Quantity::jerk, Quantity::velocity});
  ASSERT_EQ(picture.curves.size(), 2U);
  EXPECT_EQ(picture.curves[0].name, "jerk");
  EXPECT_EQ(picture.curves[1].name, "velocity");
}

TEST(CtlSvg, NamesCannotBreakIt) {
  auto recording = trapezoid();
  recording.axis = "<x> & \"y\"\x01";
  EXPECT_THAT(to_svg(recording), HasSubstr("&lt;x&gt; &amp; &quot;y&quot; went"));
}

TEST(CtlCsv, OneLineForEachSample) {
  const Recording recording{"x", {{0, -5, 0}, {0.0125, 7, 100}}};
  EXPECT_EQ(to_csv(recording),
            "time_s,position_microsteps,velocity_internal\n0.000000,-5,0\n0.012500,7,100\n");
}

TEST(CtlCsv, TheTimeOfDayIsTheLastColumn) {
  Recording recording{"x", {{0, -5, 0}, {0.0125, 7, 100}}};
  recording.begin_utc = tmcl::UtcTime(std::chrono::microseconds(1'764'065'521'123'456));
  EXPECT_EQ(to_csv(recording),
            "time_s,position_microsteps,velocity_internal,utc\n"
            "0.000000,-5,0,2025-11-25T10:12:01.123456Z\n"
            "0.012500,7,100,2025-11-25T10:12:01.135956Z\n");
}

TEST(CtlSvg, ALongTitleThatSaysTwoThingsHasTwoLines) {
  Picture picture{"short; title", "s", {position_curve(trapezoid())}, {}};
  EXPECT_THAT(to_svg(picture), HasSubstr(">short; title</text>"));
  picture.title = std::string(60, 'a') + "; " + std::string(60, 'b');
  const auto svg = to_svg(picture);
  EXPECT_THAT(svg, HasSubstr(">" + std::string(60, 'a') + "</text>"));
  EXPECT_THAT(svg, HasSubstr(">" + std::string(60, 'b') + "</text>"));
}

TEST(CtlPlane, BothAxesHaveOneScale) {
  const auto svg = to_svg({"a line", "x [mm]", "y [mm]", {{0, 400}, {0, -100}}, {}});
  // 716 wide between the paddings, and a quarter of that high.
  EXPECT_THAT(svg, HasSubstr("points=\"106.0,82.0 822.0,261.0\""));
  EXPECT_THAT(svg, HasSubstr("width=\"744.0\" height=\"207.0\""));
  EXPECT_THAT(svg, HasSubstr(">x [mm]<"));
  EXPECT_THAT(svg, Not(HasSubstr(">seen<")));
  EXPECT_THAT(to_svg({"a tower", "x", "y", {}, {{0, 0}, {0, 1000}}}),
              HasSubstr("width=\"110.0\" height=\"520.0\""));
}

TEST(CtlPlane, DotsThatWouldHideEachOtherAreLeftOut) {
  Plane plane{"dense", "x", "y", {}, {}};
  for (int i = 0; i <= 10'000; ++i) {
    plane.seen.x.push_back(i);
    plane.seen.y.push_back(i);
  }
  const auto svg = to_svg(plane);
  EXPECT_LT(svg.size(), 8'000U);
  EXPECT_THAT(svg, HasSubstr(">seen<"));
  EXPECT_THAT(svg, Not(HasSubstr(">planned<")));
  const auto point = to_svg({"<nowhere>", "x", "y", {}, {{5, 5}, {7, 7}}});
  EXPECT_THAT(point, HasSubstr("&lt;nowhere&gt;"));
  for (const auto* wrong : {"nan", "inf"}) EXPECT_THAT(point + svg, Not(HasSubstr(wrong)));
}

TEST(CtlPlane, WhatWasOnlyPlannedIsNoDashedLine) {
  const auto plan = to_svg({"plan", "x", "y", {{0, 400}, {0, -100}}, {}});
  EXPECT_THAT(plan, HasSubstr("<polyline class=\"curve position\""));
  EXPECT_THAT(plan, Not(HasSubstr(">planned<")));
  const auto both = to_svg({"both", "x", "y", {{0, 400}, {0, -100}}, {{0, 400}, {0, -100}}});
  EXPECT_THAT(both, HasSubstr("<polyline class=\"curve planned\""));
  EXPECT_THAT(both, HasSubstr(">planned<"));
}

TEST(CtlPlane, WhatIsEnlargedIsALineWithinTheFrame) {
  Plane plane{"both", "x", "y", {{0, 300}, {0, 0}}, {{0, 300}, {0, 10}}};
  plane.enlarged = {{0, 400}, {0, -100}};
  plane.enlarged_name = "ten <times> off";
  const auto svg = to_svg(plane);
  EXPECT_THAT(svg, HasSubstr("<polyline class=\"curve difference\" points=\"106.0,"));
  EXPECT_THAT(svg, HasSubstr("ten &lt;times&gt; off"));
  EXPECT_THAT(svg, HasSubstr("width=\"744.0\" height=\"224.9\"")) << "400 wide, 110 high";
}

TEST(CtlPlane, IsAboveAPictureThatEndsWithTheDocument) {
  const Plane plane{"a line", "x", "y", {{0, 400}, {0, -100}}, {}};
  const Picture picture{"", "s", {position_curve(trapezoid()), velocity_curve(trapezoid())}, {}};
  const auto svg = to_svg(plane, picture);
  // The plane's picture is 331 high, that of two curves 540.
  EXPECT_THAT(to_svg(plane), HasSubstr("viewBox=\"0 0 860 331\""));
  EXPECT_THAT(to_svg(picture), HasSubstr("viewBox=\"0 0 860 540\""));
  EXPECT_THAT(svg, HasSubstr("viewBox=\"0 0 860 871\""));
  EXPECT_THAT(svg, HasSubstr("<svg y=\"331\""));
  EXPECT_THAT(svg, HasSubstr("width=\"744.0\" height=\"207.0\""));
}

}  // namespace
}  // namespace tmclctl::plot
