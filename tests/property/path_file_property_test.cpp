// Programs of random shape: what the same movement is written as changes nothing, whatever rounding
// that leaves in the last bits.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "support/random.hpp"
#include "support/seed.hpp"
#include "tmcl/plan/course.hpp"
#include "tmcl/plan/path_file.hpp"

namespace tmcl::plan::path_file {
namespace {

constexpr double turn = 2 * std::numbers::pi;

/// Hundredths of a millimetre: 254 of them are 0.1 inch, so that both units say the same.
using Steps = std::int64_t;
constexpr Steps steps_of_an_inch = 2540;

/// Writes positions in the unit and mode of the moment, and changes those at random.
class Writer {
 public:
  explicit Writer(tmcl::test::Random<>& random) : random_(random) {}

  void change() {
    // A position that is no whole number of 0.0001 inch is written in mm.
    inches_ = random_.one_in(2) && x_ % 254 == 0 && y_ % 254 == 0;
    relative_ = random_.one_in(2);
    text_ += fmt::format("{} {} F{}\n", inches_ ? "G20" : "G21", relative_ ? "G91" : "G90",
                         inches_ ? 60 : 1524);
  }
  void line(Steps x, Steps y) {
    if (inches_) x -= x % 254, y -= y % 254;
    text_ += fmt::format("G1 X{} Y{}\n", word(x, x_), word(y, y_));
    length_ += std::hypot(static_cast<double>(x - x_), static_cast<double>(y - y_)) / 100;
    x_ = x;
    y_ = y;
  }
  void circle(Steps radius) {
    if (inches_) radius -= radius % 254;
    if (radius == 0) return;
    text_ += fmt::format("{} X{} Y{} {}{}\n", random_.one_in(2) ? "G2" : "G3", word(x_, x_),
                         word(y_, y_), random_.one_in(2) ? "I" : "J", number(radius));
    length_ += turn * static_cast<double>(std::abs(radius)) / 100;
  }
  const std::string& text() const { return text_; }
  double length() const { return length_; }

 private:
  std::string number(Steps steps) const {
    return inches_ ? fmt::format("{:.4f}", static_cast<double>(steps) / steps_of_an_inch)
                   : fmt::format("{:.2f}", static_cast<double>(steps) / 100);
  }
  std::string word(Steps to, Steps from) const { return number(relative_ ? to - from : to); }

  tmcl::test::Random<>& random_;
  std::string text_ = "F1000\n";
  Steps x_ = 0, y_ = 0;
  bool inches_ = false;
  bool relative_ = false;
  double length_ = 0;
};

PathLimits fast(std::size_t axes) {
  PathLimits limits;
  limits.axes = axes;
  limits.axis.fill({1e6, 1e9, 1e6});
  return limits;
}

double length_of(const Path& path) {
  const auto flat = flatten(path, 0.0001);
  EXPECT_TRUE(flat);
  const auto course = Course::of(*flat, fast(path.axes.size()));
  EXPECT_TRUE(course);
  return course ? course->length() : 0;
}

TEST(PathFileProperty, NoCircleAndNoMoveDependsOnTheLastBits) {
  tmcl::test::Random<> random(tmcl::test::seed());
  for (int round = 0; round < 300; ++round) {
    Writer writer(random);
    for (auto n = random.between(1, 30); n > 0; --n) {
      if (random.one_in(3)) writer.change();
      if (random.one_in(3)) {
        writer.circle(random.between(-20, 20) * 254);
      } else {
        writer.line(random.between(-30, 30) * 127, random.between(-30, 30) * 127);
      }
    }
    const auto path = read_gcode(writer.text());
    ASSERT_TRUE(path) << describe(path.error().front(), "text") << '\n' << writer.text();
    ASSERT_NEAR(length_of(*path), writer.length(), 0.001 * writer.length() + 1e-6) << writer.text();
    for (const auto& element : path->elements) {
      const auto* arc = std::get_if<ArcTo>(&element);
      if (arc == nullptr) continue;
      ASSERT_NEAR(std::abs(arc->sweep), turn, 1e-6) << writer.text();
    }
  }
}

// As RS274/NGC has it: F is of X Y Z if one of them moves, and what turns arrives with them.
TEST(PathFileProperty, WhatTurnsGoesAlongWithWhatMoves) {
  tmcl::test::Random<> random(tmcl::test::seed());
  for (int round = 0; round < 500; ++round) {
    const bool inches = random.one_in(2);
    const double unit = inches ? 25.4 : 1;
    const auto feed = static_cast<double>(random.between(1, 500));
    const auto x = static_cast<double>(random.between(-50, 50));
    const auto z = static_cast<double>(random.between(0, 50));
    const auto a = static_cast<double>(random.between(-3600, 3600));
    const bool arc = random.one_in(2) && x != 0;
    const auto text =
        fmt::format("{} F{}\n{} X{} Y0 Z{} A{}{}\n", inches ? "G20" : "G21", feed,
                    arc ? "G3" : "G1", x, z, a, arc ? fmt::format(" I{} J0", x / 2) : "");
    const auto path = read_gcode(text);
    ASSERT_TRUE(path) << text;
    const auto flat = flatten(*path, 1e-4);
    ASSERT_TRUE(flat);
    const double plane = arc ? std::numbers::pi * std::abs(x) / 2 : std::abs(x);
    const double way = std::hypot(plane, z) > 0 ? std::hypot(plane, z) * unit : std::abs(a);
    const double speed = feed / 60 * (std::hypot(plane, z) > 0 ? unit : 1);
    const auto course = Course::of(*flat, fast(path->axes.size()));
    if (way == 0) continue;
    ASSERT_TRUE(course) << course.error();
    ASSERT_NEAR(course->duration(), way / speed, 0.01 * way / speed + 1e-3) << text;
    const bool moves = std::hypot(plane, z) > 0;
    ASSERT_NEAR(course->length(), moves ? way : 0, 0.001 * way) << text;
  }
}

TEST(PathFileProperty, AxesThatTurnStayWithinTheirLimits) {
  const auto path = read_gcode("F60 G1 X5 A180\n");
  auto limits = fast(2);
  limits.axis[1].velocity = 9;
  EXPECT_NEAR(Course::of(*path, limits)->duration(), 20, 0.01);
  // A feed of the caller is about X, too.
  EXPECT_NEAR(Course::of(*path, fast(2), 0.5)->duration(), 10, 0.01);
}

// Ends and centres that were rounded to 0.01 mm or 0.001 inch are those of an arc.
TEST(PathFileProperty, ArcsMayBeRounded) {
  tmcl::test::Random<> random(tmcl::test::seed());
  for (int round = 0; round < 2000; ++round) {
    const bool inches = random.one_in(2);
    const auto any = [&](double most) {
      return static_cast<double>(random.between(-1'000'000, 1'000'000)) * most / 1e6;
    };
    const double radius = 0.5 + std::abs(any(inches ? 4 : 100));
    const double from = any(std::numbers::pi), to = from + 0.5 + std::abs(any(5));
    const double x = any(10), y = any(10);
    const auto text = inches ? fmt::format(
                                   "G20 F60 G0 X{:.3f} Y{:.3f}\nG3 X{:.3f} Y{:.3f} I{:.3f} "
                                   "J{:.3f}\n",
                                   x + radius * std::cos(from), y + radius * std::sin(from),
                                   x + radius * std::cos(to), y + radius * std::sin(to),
                                   -radius * std::cos(from), -radius * std::sin(from))
                             : fmt::format(
                                   "G21 F60 G0 X{:.2f} Y{:.2f}\nG3 X{:.2f} Y{:.2f} I{:.2f} "
                                   "J{:.2f}\n",
                                   x + radius * std::cos(from), y + radius * std::sin(from),
                                   x + radius * std::cos(to), y + radius * std::sin(to),
                                   -radius * std::cos(from), -radius * std::sin(from));
    const auto path = read_gcode(text);
    ASSERT_TRUE(path) << describe(path.error().front(), "text") << '\n' << text;
    const auto& arc = std::get<ArcTo>(path->elements.back());
    ASSERT_NEAR(arc.sweep, to - from, 0.1) << text;
  }
}

}  // namespace
}  // namespace tmcl::plan::path_file
