// docs/gallery: several axes together. See gallery_test.cpp. tmclctl is run as the page shows it;
// the daemon and the modules are in virtual time, so that a busy computer spoils no picture.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <numbers>
#include <optional>
#include <sstream>

#include <fmt/format.h>

#include "plot/picture.hpp"
#include "plot/plane.hpp"
#include "plot/svg_plot.hpp"
#include "support/build_paths.hpp"
#include "system/gallery_easel.hpp"
#include "system/gallery_recording.hpp"
#include "unit/simulated_modules.hpp"

namespace tmcl::test {
namespace {

namespace plot = tmclctl::plot;
using std::chrono::milliseconds;
using testing::HasSubstr;

using tmcld::test::axis_section;
using tmcld::test::bench_bus;
using tmcld::test::SimulatedModules;
using tmcld::test::TestDaemon;
using tmcld::test::VirtualReactor;

class GalleryAxes : public testing::Test {
 protected:
  /// What tmclctl said when it was run as the page shows it, and what was seen meanwhile.
  struct Seen {
    Finished tmclctl;
    PointsSeen points;
  };
  explicit GalleryAxes(const std::string& axes) : daemon(std::string(bench_bus) + axes, reactor) {}

  void start() {
    daemon.start();
    client = std::make_unique<RpcClient>(daemon.socket());
  }
  Seen run_as_shown(const std::string& words, const std::array<Motor, 2>& motors,
                    milliseconds pause) {
    EXPECT_THAT(page(), HasSubstr("tmclctl " + words + "\n"));
    const std::string line = "cd '" + gallery().string() +
                             "' && exec '" TMCL_BIN_DIR "/tmclctl' --json --socket " +
                             daemon.socket().path + ' ' + words;
    auto running = std::async(std::launch::async, [&] {
      return run_program({"/bin/sh", "-c", line});
    });
    const auto is_over = [&] {
      return running.wait_for(milliseconds(0)) == std::future_status::ready;
    };
    auto points = observe(daemon, motors, is_over, pause);
    return {running.get(), std::move(points)};
  }

  void set(const std::string& axis, const std::string& parameter, int value) {
    client->result("parameter.set", {{"axis", axis}, {"parameter", parameter}, {"value", value}});
  }

  std::shared_ptr<VirtualReactor> reactor = std::make_shared<VirtualReactor>();
  SimulatedModules modules{reactor->clock};
  TestDaemon daemon;
  std::unique_ptr<RpcClient> client;
};

class GalleryLine : public GalleryAxes {
 protected:
  /// From (0, 0); x has the longer way.
  struct Scene {
    std::string words;
    std::array<std::string, 2> names;
    std::array<Motor, 2> motors;
    std::array<double, 2> targets;
    std::string picture;
    std::string picture_over_time;

    double slope() const { return targets[1] / targets[0]; }
    /// How far y is off the line, as far as it cannot come from the time that reading takes.
    double off_line(const PointSeen& point) const {
      const auto [least, greatest] =
          std::minmax({(point.x - point.doubt) * slope(), (point.x + point.doubt) * slope()});
      return point.y - std::clamp(point.y, least, greatest);
    }
    /// As a part of the longer way.
    double largest(const PointsSeen& points) const {
      double largest = 0;
      for (const auto& point : points) largest = std::max(largest, std::abs(off_line(point)));
      return largest / std::abs(targets[0]);
    }
    auto count_on_the_way(const PointsSeen& points) const {
      const double doubtful = std::abs(targets[0]) / 100;
      return std::ranges::count_if(points, [&](const PointSeen& point) {
        return point.y != 0 && point.y != targets[1] && point.doubt < doubtful;
      });
    }
  };

  GalleryLine()
      : GalleryAxes(axis_section("x", 0) + axis_section("y", 0, {}, 2) +
                    axis_section("z", 1, {}, 2)) {
    modules.add(daemon.wire(), "TMCM-1110", 1);
    modules.add(daemon.wire(), "TMCM-3110", 2);
    start();
    for (const auto* axis : {"x", "y", "z"}) set(axis, "max_acceleration", 8);
  }

  Seen record(const Scene& scene) {
    return run_as_shown(scene.words, scene.motors, milliseconds(0));
  }

  static void draw(const Scene& scene, const Seen& seen, const std::string& title) {
    const Easel easel;
    const auto points = thinned(seen.points, 0.015);
    ASSERT_FALSE(has_gap(points));
    plot::Plane plane{
        title, scene.names[0] + " [microsteps]", scene.names[1] + " [microsteps]", {}, {}};
    plane.planned = {{0, scene.targets[0]}, {0, scene.targets[1]}};
    plot::Curve x{"position", "microsteps of " + scene.names[0], {}, {}, {}};
    plot::Curve y{
        "position", "microsteps of " + scene.names[1] + "; dashed: on the line", {}, {}, {}};
    plot::Curve off{"difference", "microsteps of " + scene.names[1] + " off the line", {}, {}, {}};
    for (const auto& point : points) {
      plane.seen.x.push_back(point.x);
      plane.seen.y.push_back(point.y);
      for (auto* curve : {&x, &y, &off}) curve->times.push_back(point.time_s);
      x.values.push_back(point.x);
      y.values.push_back(point.y);
      y.planned.push_back(point.x * scene.slope());
      off.values.push_back(scene.off_line(point));
    }
    easel.hang(scene.picture, plot::to_svg(plane));
    easel.hang(scene.picture_over_time, plot::to_svg(plot::Picture{title, "s", {x, y, off}, {}}));
  }

  /// How far off the line the registers may make them, as a part of the longer way.
  static constexpr double most_foreseen = 0.012;
};

std::string on_the_line(double seen, double foreseen) {
  return fmt::format("{:.2f} % off the line at most, where {:.2f} % were foreseen", 100 * seen,
                     100 * foreseen);
}

boost::json::object said(const Finished& tmclctl) {
  boost::system::error_code problem;
  const auto document = boost::json::parse(tmclctl.output, problem);
  return document.is_object() ? document.as_object() : boost::json::object{};
}

TEST_F(GalleryLine, MotorsOfOneModule) {
  const Scene scene{"line y=100000 z=-40000 --wait",
                    {"y", "z"},
                    {{{2, 0}, {2, 1}}},
                    {100'000, -40'000},
                    "line-one-module.svg",
                    "line-one-module-over-time.svg"};
  const auto seen = record(scene);
  ASSERT_EQ(seen.tmclctl.status, 0) << seen.tmclctl.output;
  const auto line = said(seen.tmclctl);
  const double foreseen = number(line, "deviation");
  const double largest = scene.largest(seen.points);
  EXPECT_TRUE(line.at("one_command").as_bool());
  ASSERT_GT(scene.count_on_the_way(seen.points), 20);
  EXPECT_LT(foreseen, most_foreseen);
  EXPECT_LT(largest, foreseen + 0.002);
  draw(scene, seen,
       "Two motors of a TMCM-3110, started by one command; " + on_the_line(largest, foreseen));
}

TEST_F(GalleryLine, MotorsOfTwoModules) {
  const Scene scene{"line x=100000 y=70000 --wait",
                    {"x", "y"},
                    {{{1, 0}, {2, 0}}},
                    {100'000, 70'000},
                    "line-two-modules.svg",
                    "line-two-modules-over-time.svg"};
  const auto seen = record(scene);
  ASSERT_EQ(seen.tmclctl.status, 0) << seen.tmclctl.output;
  const auto line = said(seen.tmclctl);
  const double foreseen = number(line, "deviation");
  const double largest = scene.largest(seen.points);
  EXPECT_FALSE(line.at("one_command").as_bool());
  EXPECT_LT(foreseen, most_foreseen);
  EXPECT_LT(largest, foreseen + 0.005);
  ASSERT_GT(scene.count_on_the_way(seen.points), 20);
  draw(scene, seen,
       fmt::format("Motors of a TMCM-1110 and a TMCM-3110, started {:.1f} ms apart; ",
                   1e3 * number(line, "skew_s")) +
           on_the_line(largest, foreseen));
}

// docs/gallery/circle.ngc: from (0, 0) to (10, 0), once around (0, 0), and back.
class GalleryCircle : public GalleryAxes {
 protected:
  static constexpr const char* in_mm = "unit = \"mm\"\nunits_per_revolution = 5.0\n";
  static constexpr double radius = 10;
  static constexpr double microsteps_of_mm = 51'200 / 5.0;

  GalleryCircle() : GalleryAxes(axis_section("x", 0, in_mm) + axis_section("y", 1, in_mm)) {
    modules.add(daemon.wire(), "TMCM-6212", 1);
    start();
    for (const auto* axis : {"x", "y"}) {
      set(axis, "max_velocity", 200'000);
      set(axis, "max_acceleration", 2'000'000);
      set(axis, "max_deceleration", 2'000'000);
    }
  }

  /// In mm: to the nearest point of circle and line.
  static double off_path(double x, double y) {
    const double off_line = std::hypot(x - std::clamp(x, 0.0, radius), y);
    return std::min(std::abs(std::hypot(x, y) - radius), off_line);
  }
  /// As far as it cannot come from the time that reading takes.
  static double off_path(const PointSeen& point) {
    const double doubt = point.doubt / microsteps_of_mm;
    return std::max(0.0, off_path(point.x / microsteps_of_mm, point.y / microsteps_of_mm) - doubt);
  }
  static double largest(const PointsSeen& points) {
    double largest = 0;
    for (const auto& point : points) largest = std::max(largest, off_path(point));
    return largest;
  }
  static bool is_seen_all_around(const PointsSeen& points) {
    std::array<int, 8> octants{};
    for (const auto& point : points) {
      if (std::hypot(point.x, point.y) < 0.9 * radius * microsteps_of_mm) continue;
      const double turn = std::atan2(point.y, point.x) / (2 * std::numbers::pi) + 0.5;
      ++octants[static_cast<std::size_t>(turn * 8) % 8];
    }
    return std::ranges::all_of(octants, [](int count) { return count >= 5; });
  }

  static plot::Way circle() {
    constexpr int corners = 240;
    plot::Way way{{0}, {0}};
    for (int i = 0; i <= corners; ++i) {
      const double angle = 2 * std::numbers::pi * i / corners;
      way.x.push_back(radius * std::cos(angle));
      way.y.push_back(radius * std::sin(angle));
    }
    return way;
  }
};

TEST_F(GalleryCircle, OfGcode) {
  // What was asked for is 0.05.
  constexpr double bound_mm = 0.1;
  const auto seen = run_as_shown("path run circle.ngc --axis X=x --axis Y=y --mode position",
                                 {{{1, 0}, {1, 1}}}, milliseconds(5));
  ASSERT_EQ(seen.tmclctl.status, 0) << seen.tmclctl.output;
  EXPECT_LT(largest(seen.points), bound_mm);
  EXPECT_TRUE(is_seen_all_around(seen.points));
  const auto points = thinned(seen.points, 0.03);
  ASSERT_FALSE(has_gap(points));
  plot::Plane plane{fmt::format("G-code on two motors of a TMCM-6212; {:.3f} mm off the path at "
                                "most, where 0.05 were asked for",
                                largest(seen.points)),
                    "x [mm]",
                    "y [mm]",
                    circle(),
                    {}};
  for (const auto& point : points) {
    plane.seen.x.push_back(point.x / microsteps_of_mm);
    plane.seen.y.push_back(point.y / microsteps_of_mm);
  }
  Easel().hang("circle.svg", plot::to_svg(plane));
}

// Looked at in the modules themselves whenever one is asked something, which is each millisecond.
class GalleryModes : public GalleryCircle {
 protected:
  /// How far off the path the axes are, in micrometres; of each 20 ms the farthest.
  plot::Curve off_in_mode(const std::string& mode) {
    plot::Curve curve{"difference", "um off the path by " + mode, {}, {}, {}};
    std::optional<TimePoint> begin;
    modules.on_request = [&] {
      constexpr double apart_s = 0.02;
      const auto x = modules.get(1, 1, 0);
      if (!begin && x != 0) begin = reactor->clock.now();
      if (!begin) return;
      const double time = std::chrono::duration<double>(reactor->clock.now() - *begin).count();
      const double off =
          1e3 * off_path(x / microsteps_of_mm, modules.get(1, 1, 1) / microsteps_of_mm);
      if (curve.times.empty() || time > curve.times.back() + apart_s) {
        curve.times.push_back(time);
        curve.values.push_back(off);
      }
      curve.values.back() = std::max(curve.values.back(), off);
    };
    const auto seen = run_as_shown("path run circle.ngc --axis X=x --axis Y=y --mode " + mode,
                                   {{{1, 0}, {1, 1}}}, milliseconds(50));
    daemon.on_reactor([&] { return modules.on_request = {}, 0; });
    EXPECT_EQ(seen.tmclctl.status, 0) << seen.tmclctl.output;
    EXPECT_GT(curve.times.size(), 300U);
    return curve;
  }
};

TEST_F(GalleryModes, BesideEachOther) {
  constexpr double asked_for_um = 50;
  plot::Picture picture{"The same path in each mode", "s", {}, {}};
  for (const auto* mode : {"velocity", "segments", "position"}) {
    picture.curves.push_back(off_in_mode(mode));
    EXPECT_LT(std::ranges::max(picture.curves.back().values), asked_for_um) << mode;
  }
  Easel().hang("path-modes.svg", plot::to_svg(picture));
}

}  // namespace
}  // namespace tmcl::test
