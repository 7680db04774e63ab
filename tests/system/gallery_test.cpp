// docs/gallery: what the programs do, drawn from real runs of them. Without TMCL_DRAW all of it is
// run and must be as the pictures say; TMCL_DRAW=1 draws them anew as well.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>

#include <fmt/format.h>

#include "plot/picture.hpp"
#include "plot/plane.hpp"
#include "plot/svg_plot.hpp"
#include "system/gallery_recording.hpp"
#include "system/tmclctl_bench.hpp"
#include "system/tmcld_fixture.hpp"

namespace tmcl::test {
namespace {

namespace fs = std::filesystem;
namespace plot = tmclctl::plot;
using testing::HasSubstr;

constexpr std::uintmax_t largest_picture = 60'000;

fs::path docs() { return fs::path(TMCL_SOURCE_DIR) / "docs"; }
fs::path gallery() { return docs() / "gallery"; }
std::string page() { return contents(gallery() / "README.md"); }
bool is_drawing() { return std::getenv("TMCL_DRAW") != nullptr; }

/// Where a scene leaves its pictures: in the gallery only if that was asked for.
class Easel {
 public:
  Easel() {
    std::string name = fs::temp_directory_path() / "gallery-XXXXXX";
    folder_ = ::mkdtemp(name.data());
  }
  ~Easel() { fs::remove_all(folder_); }
  Easel(const Easel&) = delete;
  Easel& operator=(const Easel&) = delete;

  std::string file(const std::string& name) const { return folder_ / name; }
  void hang(const std::string& picture) const {
    EXPECT_LT(fs::file_size(file(picture)), largest_picture) << picture;
    if (is_drawing() && !testing::Test::HasFailure())
      fs::copy_file(file(picture), gallery() / picture, fs::copy_options::overwrite_existing);
  }
  void hang(const std::string& picture, const std::string& svg) const {
    std::ofstream(file(picture)) << svg;
    hang(picture);
  }

 private:
  fs::path folder_;
};

/// Runs tmclctl with the words that the page shows; `{}` stands for the picture.
boost::json::object run_as_shown(const Words& how, const std::string& words,
                                 const std::string& picture, const Easel& easel) {
  const std::string link = how.empty() ? "" : "--direct serial:/tmp/gallery ";
  const auto shown = fmt::format(fmt::runtime(words), picture);
  EXPECT_THAT(page(), HasSubstr("tmclctl " + link + shown + "\n"));
  std::string line = "exec '" TMCL_BIN_DIR "/tmclctl' --json";
  for (const auto& word : how) line += " '" + word + "'";
  const auto drawn = fmt::format(fmt::runtime(words), "'" + easel.file(picture) + "'");
  const auto ran = run_program({"/bin/sh", "-c", line + " " + drawn});
  EXPECT_EQ(ran.status, 0) << ran.output;
  boost::system::error_code problem;
  auto document = boost::json::parse(ran.output, problem);
  return document.is_object() ? document.as_object() : boost::json::object{};
}

double number(const boost::json::object& document, const char* key) {
  return document.at(key).to_number<double>();
}

// Application note AN00115-001. Its second example is computed with 12 units where it says 20.
TEST(GallerySolve, ProfilesOfTheApplicationNote) {
  struct Example {
    const char* words;
    const char* picture;
    double speed;
    double acceleration;
    double total_time;
  };
  for (const auto& [words, picture, speed, acceleration, total_time] : {
           Example{"profile solve speed=8mm/s acceleration=16mm/s2 deceleration=16mm/s2 "
                   "distance=12mm --svg {}",
                   "solve-trapezoid.svg", 8, 16, 2},
           Example{"profile solve distance=20mm total_time=600ms thirds --svg {}",
                   "solve-thirds.svg", 50, 250, 0.6},
           Example{"profile solve distance=200mm total_time=1s speed=250mm/s symmetric --svg {}",
                   "solve-exercise.svg", 250, 1250, 1},
       }) {
    const Easel easel;
    const auto solved = run_as_shown({}, words, picture, easel);
    ASSERT_FALSE(solved.empty());
    EXPECT_NEAR(number(solved, "speed"), speed, 1e-9) << words;
    EXPECT_NEAR(number(solved, "acceleration"), acceleration, 1e-9) << words;
    EXPECT_NEAR(number(solved, "total_time"), total_time, 1e-9) << words;
    easel.hang(picture);
    EXPECT_TRUE(contents(easel.file(picture)) == contents(gallery() / picture))
        << picture << " is not what tmclctl draws now; TMCL_DRAW=1 draws it anew";
  }
}

// One module of each kind of ramp generator, and a move beside what was foreseen of it.
TEST(GalleryPlan, AxesMoveAsPlanned) {
  const Easel easel;
  const auto pty = easel.file("bus");
  Program simulator({"tmclsim", "--module", "TMCM-1110@1", "--module", "TMCM-142@2", "--module",
                     "TMCM-6212@3", "--pty", pty});
  ASSERT_TRUE(simulator.wait_for("ready")) << simulator.output();
  const Words direct{"--direct", "serial:" + pty};
  // As many microsteps as an axis makes in 2 ms: a busy machine may look that much later.
  constexpr double bound = 150;
  struct Scene {
    std::vector<const char*> settings;
    const char* move;
    const char* picture;
  };
  for (const auto& [settings, move, picture] : {
           Scene{{"set 1/0 max_acceleration 8"},
                 "plot 1/0 --by 100000 --compare --svg {}",
                 "plan-tmc429.svg"},
           Scene{{"set 2/0 max_acceleration 3000", "set 2/0 max_bow 1"},
                 "plot 2/0 --by 100000 --compare --svg {}",
                 "plan-tmc457.svg"},
           Scene{{}, "plot 3/0 --by 100000 --compare --svg {}", "plan-sixpoint.svg"},
       }) {
    for (const auto* setting : settings) run_as_shown(direct, setting, "", easel);
    const auto recorded = run_as_shown(direct, move, picture, easel);
    ASSERT_FALSE(recorded.empty()) << picture;
    EXPECT_EQ(recorded.at("position_microsteps").as_array().back(), 100'000) << picture;
    EXPECT_GT(recorded.at("time_s").as_array().size(), 20U) << picture;
    const auto& comparison = recorded.at("comparison").as_object();
    EXPECT_LT(number(comparison, "largest_difference_microsteps"), bound) << picture;
    easel.hang(picture);
  }
}

class GalleryLine : public TmcldTest {
 protected:
  struct Scene {
    std::string words;
    std::array<std::string, 2> axes;
    std::array<json::object, 2> read_position;
    LineTargets targets;
    std::string picture;
    std::string picture_over_time;
  };
  struct Seen {
    json::object line;
    std::vector<PointOfLine> points;

    /// As a part of the longer way.
    double largest(const Scene& scene) const {
      double largest = 0;
      for (const auto& point : points) largest = std::max(largest, std::abs(point.off_line));
      return largest / std::abs(static_cast<double>(scene.targets.x));
    }
    std::size_t count_on_the_way(const Scene& scene) const {
      const double doubtful = std::abs(static_cast<double>(scene.targets.x)) / 100;
      return static_cast<std::size_t>(std::ranges::count_if(points, [&](const PointOfLine& point) {
        return point.y != 0 && point.y != scene.targets.y && point.doubt < doubtful;
      }));
    }
  };

  void SetUp() override {
    start_simulator_on_pty();
    write_config(pty_link());
    start_daemon();
    client = std::make_unique<RpcClient>(socket());
    for (const auto* axis : {"x", "y", "z"})
      client->result("parameter.set",
                     {{"axis", axis}, {"parameter", "max_acceleration"}, {"value", 8}});
  }

  static json::object position_of(int address, int motor) {
    return {
        {"bus", "bench"}, {"address", address}, {"command", "GAP"}, {"type", 1}, {"motor", motor}};
  }

  // Both axes in turn, as fast as the daemon answers, from before the start until both stand.
  Seen record(const Scene& scene) {
    Program tmclctl(words_of(scene));
    std::array<Readings, 2> readings;
    const auto begin = std::chrono::steady_clock::now();
    const auto now = [&] {
      return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    };
    int both_there = 0;
    while (both_there < 100 && now() < 30) {
      for (std::size_t i = 0; i < 2; ++i) {
        const double before = now();
        const auto position =
            client->result("module.execute", scene.read_position[i]).at("value").as_int64();
        readings[i].push_back({before, now(), position});
      }
      if (readings[0].back().position == scene.targets.x &&
          readings[1].back().position == scene.targets.y)
        ++both_there;
    }
    EXPECT_EQ(tmclctl.wait(), 0) << tmclctl.output();
    return {json::parse(tmclctl.output()).as_object(),
            points_of_line(readings[0], readings[1], scene.targets)};
  }

  void go_back(const Scene& scene) {
    for (const auto& axis : scene.axes) {
      client->result("axis.move_to", {{"axis", axis}, {"position_microsteps", 0}});
      client->result("axis.wait", {{"axis", axis}, {"timeout_ms", 30'000}});
    }
  }

  Words words_of(const Scene& scene) const {
    EXPECT_THAT(page(), HasSubstr("tmclctl " + scene.words + "\n"));
    Words words{"tmclctl", "--json", "--socket", socket()};
    std::istringstream in(scene.words);
    for (std::string word; in >> word;) words.push_back(word);
    return words;
  }

  void draw(const Scene& scene, const Seen& seen, const std::string& title) const {
    const Easel easel;
    const auto points = thinned(scene, seen.points);
    const auto gap = std::ranges::adjacent_find(points, [](const auto& point, const auto& next) {
      return next.time_s > point.time_s + longest_gap_s;
    });
    ASSERT_TRUE(!is_drawing() || gap == points.end()) << "too busy a machine for a good picture";
    plot::Plane plane{
        title, scene.axes[0] + " [microsteps]", scene.axes[1] + " [microsteps]", {}, {}};
    plane.planned = {{0, static_cast<double>(scene.targets.x)},
                     {0, static_cast<double>(scene.targets.y)}};
    plot::Curve x{"position", "microsteps of " + scene.axes[0], {}, {}, {}};
    plot::Curve y{
        "position", "microsteps of " + scene.axes[1] + "; dashed: on the line", {}, {}, {}};
    plot::Curve off{"difference", "microsteps of " + scene.axes[1] + " off the line", {}, {}, {}};
    for (const auto& point : points) {
      plane.seen.x.push_back(point.x);
      plane.seen.y.push_back(static_cast<double>(point.y));
      for (auto* curve : {&x, &y, &off}) curve->times.push_back(point.time_s);
      x.values.push_back(point.x);
      y.values.push_back(static_cast<double>(point.y));
      y.planned.push_back(point.y_on_line);
      off.values.push_back(point.off_line);
    }
    easel.hang(scene.picture, plot::to_svg(plane));
    easel.hang(scene.picture_over_time, plot::to_svg(plot::Picture{title, "s", {x, y, off}, {}}));
  }

  static constexpr double longest_gap_s = 0.1;
  /// How far off the line the registers may make them, as a part of the longer way.
  static constexpr double most_foreseen = 0.012;

  std::unique_ptr<RpcClient> client;

 private:
  // The way, and a little before and after: of the points that are near each other in time the one
  // that is known best.
  static std::vector<PointOfLine> thinned(const Scene& scene,
                                          const std::vector<PointOfLine>& points) {
    constexpr double apart_s = 0.015;
    constexpr double rest_s = 0.03;
    const auto moves = [](const PointOfLine& point) { return point.y != 0 || point.x != 0; };
    const auto arrived = [&](const PointOfLine& point) { return point.y == scene.targets.y; };
    const double begin = std::ranges::find_if(points, moves)->time_s - rest_s;
    const double end = std::ranges::find_if(points, arrived)->time_s + rest_s;
    std::map<int, PointOfLine> best;
    for (const auto& point : points) {
      if (point.time_s < begin || point.time_s > end) continue;
      const auto [known, is_first] =
          best.try_emplace(static_cast<int>((point.time_s - begin) / apart_s), point);
      if (!is_first && point.doubt < known->second.doubt) known->second = point;
    }
    std::vector<PointOfLine> kept;
    for (auto [_, point] : best) {
      point.time_s -= best.begin()->second.time_s;
      kept.push_back(point);
    }
    return kept;
  }
};

std::string on_the_line(double seen, double foreseen) {
  return fmt::format("{:.2f} % off the line at most, where {:.2f} % were foreseen", 100 * seen,
                     100 * foreseen);
}

TEST_F(GalleryLine, MotorsOfOneModule) {
  const Scene scene{"line y=100000 z=-40000",
                    {"y", "z"},
                    {position_of(2, 0), position_of(2, 1)},
                    {100'000, -40'000},
                    "line-one-module.svg",
                    "line-one-module-over-time.svg"};
  const auto seen = record(scene);
  const double foreseen = number(seen.line, "deviation");
  EXPECT_TRUE(seen.line.at("one_command").as_bool());
  EXPECT_GT(seen.count_on_the_way(scene), 20U);
  EXPECT_LT(foreseen, most_foreseen);
  EXPECT_LT(seen.largest(scene), foreseen + 0.002);
  draw(scene, seen,
       "Two motors of a TMCM-3110, started by one command; " +
           on_the_line(seen.largest(scene), foreseen));
}

// A machine that is busy between the two starts makes a worse line: then once more.
TEST_F(GalleryLine, MotorsOfTwoModules) {
  constexpr int most_attempts = 6;
  const Scene scene{"line x=100000 y=70000",
                    {"x", "y"},
                    {position_of(1, 0), position_of(2, 0)},
                    {100'000, 70'000},
                    "line-two-modules.svg",
                    "line-two-modules-over-time.svg"};
  const auto most = [](const Seen& seen) { return number(seen.line, "deviation") + 0.005; };
  Seen seen;
  for (int attempt = 0; attempt < most_attempts; ++attempt) {
    if (attempt > 0) go_back(scene);
    seen = record(scene);
    if (seen.largest(scene) < most(seen) && seen.count_on_the_way(scene) > 20) break;
  }
  EXPECT_FALSE(seen.line.at("one_command").as_bool());
  EXPECT_GT(seen.count_on_the_way(scene), 20U);
  EXPECT_LT(number(seen.line, "deviation"), most_foreseen);
  EXPECT_LT(seen.largest(scene), most(seen));
  draw(scene, seen,
       fmt::format("Motors of a TMCM-1110 and a TMCM-3110, started {:.1f} ms apart; ",
                   1e3 * number(seen.line, "skew_s")) +
           on_the_line(seen.largest(scene), number(seen.line, "deviation")));
}

std::set<std::string> pictures_on_the_page() {
  std::set<std::string> names;
  const auto text = page();
  for (auto at = text.find("!["); at != std::string::npos; at = text.find("![", at + 1)) {
    const auto begin = text.find("](", at) + 2;
    names.insert(text.substr(begin, text.find(')', begin) - begin));
  }
  return names;
}

TEST(GalleryPage, ShowsEveryPictureThatThereIs) {
  std::set<std::string> there;
  for (const auto& file : fs::directory_iterator(gallery())) {
    if (file.path().extension() != ".svg") continue;
    there.insert(file.path().filename());
    EXPECT_LT(file.file_size(), largest_picture) << file.path();
    EXPECT_THAT(contents(file.path()), HasSubstr("</svg>")) << file.path();
  }
  for (const auto& file : fs::directory_iterator(docs() / "ramps"))
    there.insert("../ramps/" + file.path().filename().string());
  EXPECT_EQ(pictures_on_the_page(), there);
}

}  // namespace
}  // namespace tmcl::test
