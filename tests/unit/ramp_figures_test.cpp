// The figures of the application notes and of the data sheet page, as the generators draw them:
// kept in docs/ramps/, to be laid beside the originals. TMCL_DRAW=1 draws them anew.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "plot/svg_plot.hpp"
#include "support/build_paths.hpp"
#include "tmcl/ramp/mc1451a.hpp"
#include "tmcl/ramp/sixpoint.hpp"
#include "tmcl/ramp/tmc429.hpp"
#include "tmcl/ramp/tmc4361.hpp"
#include "tmcl/ramp/tmc457.hpp"

namespace tmcl::ramp {
namespace {

namespace plot = tmclctl::plot;

/// Jerk, where a figure shows it: by the name of the phase and the value of the register.
using JerkOf = std::function<double(std::string_view phase)>;

struct Figure {
  std::string title;
  std::string time_unit = "s";
  JerkOf jerk = nullptr;
  bool acceleration = true;
};

/// What a curve shows at one instant.
struct Point {
  double time;
  Motion motion;
  double jerk;
};

template <Generator G>
class Drawing {
 public:
  Drawing(Figure figure, G axis) : figure_(std::move(figure)), axis_(std::move(axis)) {}

  std::string svg() {
    const auto end = arrival(axis_, last_tick).value();
    const Tick margin = end / 40;
    follow(end + margin, (end + margin) / 300 + 1);
    plot::Picture picture{figure_.title, figure_.time_unit, {}, std::move(marks_)};
    picture.curves.push_back(
        curve("velocity", [](const Point& p) { return static_cast<double>(p.motion.velocity); }));
    picture.curves.push_back(curve(
        "acceleration", [](const Point& p) { return static_cast<double>(p.motion.acceleration); }));
    if (figure_.jerk)
      picture.curves.push_back(curve("jerk", [](const Point& p) { return p.jerk; }));
    return plot::to_svg(picture);
  }

 private:
  // Both sides of every change of phase, and evenly spread points in between.
  void follow(Tick end, Tick spacing) {
    look();
    mark();
    while (axis_.tick() < end) {
      const auto change = axis_.next_change();
      while (axis_.tick() + spacing < std::min(change, end)) {
        axis_.advance_to(axis_.tick() + spacing);
        look();
      }
      if (change > end) return;
      axis_.advance_to(change - 1);
      look();
      axis_.advance_to(change);
      look();
      if (axis_.phase() != phase_) mark();
    }
  }

  double now() const { return static_cast<double>(axis_.tick()) / G::ticks_per_second(16e6); }
  void look() {
    points_.push_back({now(), axis_.motion(), figure_.jerk ? figure_.jerk(axis_.phase()) : 0});
  }
  void mark() {
    // Where the phase is that of the tick that has passed, one tick of rest goes before a start.
    if (phase_ == "rest" && axis_.tick() == 1) marks_.clear();
    phase_ = axis_.phase();
    marks_.push_back({now(), std::string(phase_)});
  }

  template <class Value>
  plot::Curve curve(std::string name, Value value) const {
    plot::Curve curve{std::move(name), "register", {}, {}};
    for (const auto& point : points_) {
      curve.times.push_back(point.time);
      curve.values.push_back(value(point));
    }
    return curve;
  }

  Figure figure_;
  G axis_;
  std::string_view phase_;
  std::vector<Point> points_;
  std::vector<plot::Mark> marks_;
};

template <Generator G>
G with(std::initializer_list<std::pair<typename G::Register, std::int64_t>> values) {
  G axis;
  for (const auto& [name, value] : values) EXPECT_TRUE(axis.write(name, value));
  return axis;
}

template <Generator G>
void expect_drawn(const std::string& name, Figure figure, const G& axis) {
  const auto drawn = Drawing<G>(std::move(figure), axis).svg();
  const auto path = std::filesystem::path(TMCL_SOURCE_DIR) / "docs" / "ramps" / (name + ".svg");
  if (std::getenv("TMCL_DRAW") != nullptr) {
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path) << drawn;
  }
  std::ifstream file(path);
  const std::string kept{std::istreambuf_iterator<char>(file), {}};
  // Not EXPECT_EQ: it would print both pictures.
  EXPECT_TRUE(drawn == kept) << path
                             << " is not what the generator draws now; TMCL_DRAW=1 draws it anew";
}

using T429 = Tmc429::Register;

Tmc429 tmc429(std::int64_t x_target, Tmc429::Mode mode = Tmc429::Mode::ramp) {
  auto axis = with<Tmc429>({{T429::pulse_div, 5},
                            {T429::ramp_div, 6},
                            {T429::v_min, 250},
                            {T429::v_max, 1000},
                            {T429::a_max, 150},
                            {T429::x_target, x_target}});
  axis.write(mode);
  return axis;
}

TEST(RampFigures, Tmc429A) {
  expect_drawn("tmc429-a",
               {"TMC429, figure 4 a: trapezoid, stopped from v_min", "s", nullptr, false},
               tmc429(4'000));
}
TEST(RampFigures, Tmc429B) {
  expect_drawn("tmc429-b",
               {"TMC429, figure 4 b: triangle over a short distance", "s", nullptr, false},
               tmc429(500));
}
TEST(RampFigures, Tmc429C) {
  auto axis = tmc429(4'000, Tmc429::Mode::soft);
  axis.write(T429::v_min, 40);
  expect_drawn("tmc429-c",
               {"TMC429, figure 4 c: SOFT_MODE slows down exponentially", "s", nullptr, false},
               axis);
}

using T457 = Tmc457::Register;

Tmc457 tmc457(int bow_index) {
  return with<Tmc457>({{T457::v_max, 5'000'000},
                       {T457::a_max, 24'624},
                       {T457::d_max, 24'624},
                       {T457::bow_max, bow_index},
                       {T457::x_target, 10'000}});
}

JerkOf jerk_of(double jerk) {
  return [jerk](std::string_view phase) {
    if (phase == "I" || phase == "VII") return jerk;
    return phase == "III" || phase == "V" ? -jerk : 0;
  };
}

TEST(RampFigures, Tmc457Trapezoid) {
  expect_drawn("tmc457-trapezoid", {"TMC457, figure 2: bow_max = 0"}, tmc457(0));
}
TEST(RampFigures, Tmc457SShaped) {
  expect_drawn("tmc457-s-shaped", {"TMC457, figure 3: bow_max = 7", "s", jerk_of(64)}, tmc457(7));
}

using T4361 = Tmc4361::Register;

TEST(RampFigures, Tmc4361FourBows) {
  const auto axis = with<Tmc4361>({{T4361::vmax, 25'600'000},
                                   {T4361::amax, 800'000},
                                   {T4361::dmax, 400'000},
                                   {T4361::bow1, 1'000'000},
                                   {T4361::bow2, 2'000'000},
                                   {T4361::bow3, 500'000},
                                   {T4361::bow4, 400'000},
                                   {T4361::xtarget, 150'000}});
  const auto jerk = [](std::string_view phase) {
    return phase == "B1"   ? 1e6
           : phase == "B2" ? -2e6
           : phase == "B3" ? -5e5
           : phase == "B4" ? 4e5
                           : 0;
  };
  expect_drawn("tmc4361-four-bows", {"TMC4361: S-shaped ramp with four bows", "s", jerk}, axis);
}

using M1451 = Mc1451a::Register;

Mc1451a mc1451a(std::int64_t acceleration) {
  return with<Mc1451a>({{M1451::velocity, 65'536},
                        {M1451::acceleration, acceleration},
                        {M1451::jerk, 42'950'000},
                        {M1451::position, 100}});
}

TEST(RampFigures, Mc1451aSevenPhases) {
  expect_drawn("mc1451a-seven-phases", {"MC1451A: S-curve profile", "cycles", jerk_of(42'950'000)},
               mc1451a(4'000));
}
TEST(RampFigures, Mc1451aWithoutConstantAcceleration) {
  expect_drawn("mc1451a-five-phases",
               {"MC1451A: S-curve that does not reach the maximum acceleration", "cycles",
                jerk_of(42'950'000)},
               mc1451a(16'384));
}

using S6 = SixPoint::Register;

TEST(RampFigures, SixPointTrapezoid) {
  expect_drawn("sixpoint-trapezoid", {"AN-035, figure 2: trapezoid from VSTART to VSTOP"},
               with<SixPoint>({{S6::vstart, 30'000},
                               {S6::vstop, 60'000},
                               {S6::vmax, 268'435},
                               {S6::amax, 3'000},
                               {S6::dmax, 3'000},
                               {S6::xtarget, 300'000}}));
}
TEST(RampFigures, SixPoint) {
  expect_drawn("sixpoint-six-points", {"AN-035: the six points of the TMC5xxx"},
               with<SixPoint>({{S6::vstart, 10'000},
                               {S6::a1, 4'000},
                               {S6::v1, 130'000},
                               {S6::amax, 1'500},
                               {S6::vmax, 268'435},
                               {S6::dmax, 2'000},
                               {S6::d1, 5'000},
                               {S6::vstop, 20'000},
                               {S6::xtarget, 300'000}}));
}

}  // namespace
}  // namespace tmcl::ramp
