// docs/two-axes.svg, the moving picture of README.md: two simulated axes follow a circle, until
// another client stops one of them. TMCL_DRAW=1 draws it anew.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "support/build_paths.hpp"
#include "unit/journey_bench.hpp"

namespace tmcld::test {
namespace {

using namespace std::chrono_literals;

constexpr auto of_axes = "unit = \"mm\"\nunits_per_revolution = 5\n";
constexpr auto circle = "G2 X0 Y0 I10 J0 F900\n";
constexpr double microsteps_of_mm = 51'200 / 5.0;
constexpr auto frame_time = 40ms;
constexpr std::size_t frames = 160;
constexpr std::size_t stopped_in_frame = 95;

/// What the motors did at one moment, in mm and mm/s.
struct Frame {
  double x = 0, y = 0, vx = 0, vy = 0;
};

/// Of the simulated motors themselves, not of what the gateway read.
class Film {
 public:
  std::vector<Frame> shoot() {
    const auto run = bench_.begin(
        "path.run", {{"axes", json::array{"x", "y"}}, {"text", circle}, {"mode", "velocity"}});
    std::vector<Frame> film;
    while (film.size() < frames) {
      if (film.size() == stopped_in_frame) bench_.begin("axis.stop", {{"axis", "x"}});
      film.push_back(look(film));
      bench_.time.run_for(frame_time);
    }
    EXPECT_EQ(bench_.end_of(run).error().name, "stopped_by_other");
    return film;
  }

 private:
  Frame look(const std::vector<Frame>& film) {
    Frame now{mm(0), mm(1), 0, 0};
    if (film.empty()) return now;
    const double seconds = std::chrono::duration<double>(frame_time).count();
    now.vx = (now.x - film.back().x) / seconds;
    now.vy = (now.y - film.back().y) / seconds;
    return now;
  }
  double mm(std::uint8_t motor) {
    constexpr std::uint8_t actual_position = 1;
    const auto& module = *bench_.wire.bench().modules().front();
    return module.axis(motor).get(actual_position).value() / microsteps_of_mm;
  }

  JourneyBench bench_{"TMCM-3110", of_axes};
};

// ---- the drawing -------------------------------------------------------------------------------

constexpr double film_seconds = frames * 0.04;

double left(const Frame& frame) { return 34 + 11 * frame.x; }
double top(const Frame& frame) { return 160 - 11 * frame.y; }
double time_left(std::size_t i) { return 330 + 500.0 * static_cast<double>(i) / frames; }
double velocity_top(double velocity) { return 160 - 6.5 * velocity; }

using ValueOf = std::function<double(std::size_t)>;

std::string values_of(const ValueOf& value) {
  std::string values;
  for (std::size_t i = 0; i < frames; ++i)
    values += fmt::format("{}{:.1f}", i == 0 ? "" : ";", value(i));
  return values;
}

std::string animated(std::string_view attribute, const ValueOf& value) {
  return fmt::format(
      "<animate attributeName=\"{}\" dur=\"{}s\" repeatCount=\"indefinite\" values=\"{}\"/>\n",
      attribute, film_seconds, values_of(value));
}

std::string curve(std::string_view css_class, const ValueOf& x, const ValueOf& y) {
  std::string points;
  for (std::size_t i = 0; i < frames; ++i) points += fmt::format("{:.1f},{:.1f} ", x(i), y(i));
  points.pop_back();
  return fmt::format("<polyline class=\"{}\" points=\"{}\"/>\n", css_class, points);
}

std::string shown_from_the_stop_on() {
  return fmt::format(
      "<animate attributeName=\"opacity\" dur=\"{}s\" repeatCount=\"indefinite\" "
      "calcMode=\"discrete\" keyTimes=\"0;{:.3f}\" values=\"0;1\"/>",
      film_seconds, static_cast<double>(stopped_in_frame) / frames);
}

constexpr auto head =
    R"(<svg xmlns="http://www.w3.org/2000/svg" width="860" height="330" viewBox="0 0 860 330" role="img">
<title>Two axes follow a circle until another program stops one of them; both stand</title>
<style>
text { font: 13px 'DejaVu Sans', 'Segoe UI', Helvetica, Arial, sans-serif; fill: #787878 }
.command { font-family: 'DejaVu Sans Mono', Menlo, Consolas, monospace; font-size: 15px }
.stop { fill: #d03030; font-weight: bold }
.plan, .zero { fill: none; stroke: #808080; stroke-opacity: .45 }
.x, .y, .way { fill: none; stroke-width: 2 }
.x { stroke: #2a7de1 }
.y { stroke: #e08a1e }
.way { stroke: #2f9e58 }
.cursor { stroke: #808080 }
.tool { fill: #2f9e58 }
</style>
)";

std::string draw(const std::vector<Frame>& film) {
  const auto at = [&](std::size_t i) { return film[i]; };
  const ValueOf x = [&](std::size_t i) { return left(at(i)); };
  const ValueOf y = [&](std::size_t i) { return top(at(i)); };
  std::string svg = head;
  svg += "<circle class=\"plan\" cx=\"144\" cy=\"160\" r=\"110\"/>\n";
  svg += curve("way", x, y);
  svg +=
      "<circle class=\"tool\" r=\"6\">\n" + animated("cx", x) + animated("cy", y) + "</circle>\n";
  svg += "<line class=\"zero\" x1=\"330\" x2=\"830\" y1=\"160\" y2=\"160\"/>\n";
  svg += curve("x", time_left, [&](std::size_t i) { return velocity_top(at(i).vx); });
  svg += curve("y", time_left, [&](std::size_t i) { return velocity_top(at(i).vy); });
  svg += "<line class=\"cursor\" y1=\"50\" y2=\"270\">\n" + animated("x1", time_left) +
         animated("x2", time_left) + "</line>\n";
  svg +=
      "<text x=\"330\" y=\"44\">velocity of <tspan fill=\"#2a7de1\">x</tspan> and <tspan "
      "fill=\"#e08a1e\">y</tspan></text>\n";
  svg += "<text class=\"command\" x=\"24\" y=\"310\">$ tmclctl path run circle.ngc</text>\n";
  svg += "<text class=\"command stop\" x=\"330\" y=\"310\">" + shown_from_the_stop_on() +
         "$ tmclctl stop x &#160; both stand</text>\n";
  return svg + "</svg>\n";
}

TEST(MovingPicture, IsWhatTheMotorsDid) {
  const auto film = Film().shoot();
  const auto last = film.back();
  EXPECT_EQ(last.vx, 0);
  EXPECT_EQ(last.vy, 0);
  for (std::size_t i = 0; i < stopped_in_frame; ++i)
    EXPECT_NEAR(std::hypot(film[i].x - 10, film[i].y), 10, 0.2) << i;
  const auto drawn = draw(film);
  const auto path = std::filesystem::path(TMCL_SOURCE_DIR) / "docs" / "two-axes.svg";
  if (std::getenv("TMCL_DRAW") != nullptr) std::ofstream(path) << drawn;
  std::ifstream file(path);
  const std::string kept{std::istreambuf_iterator<char>(file), {}};
  // Not EXPECT_EQ: it would print both pictures.
  EXPECT_TRUE(kept == drawn) << path << " is not what the motors do now; TMCL_DRAW=1 draws it anew";
}

}  // namespace
}  // namespace tmcld::test
