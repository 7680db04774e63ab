// docs/gallery: what the programs do, drawn from real runs of them. Without TMCL_DRAW all of it is
// run and must be as the pictures say; TMCL_DRAW=1 draws them anew as well.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include <fmt/format.h>

#include "support/build_paths.hpp"
#include "system/gallery_easel.hpp"
#include "system/tmclctl_bench.hpp"

namespace tmcl::test {
namespace {

using testing::HasSubstr;

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
           Example{"profile solve speed=8mm/s acceleration=16mm/s^2 deceleration=16mm/s^2 "
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
                     "TMCM-6212@3", "--module", "TMCM-142@4", "--module", "TMCM-142@5", "--pty",
                     pty});
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
           Scene{{"set 4/0 max_bow 0", "ramp 4/0 --velocity 70000pps --acceleration 200000pps/s"},
                 "plot 4/0 --by 100000 --compare --svg {}",
                 "jerk-any.svg"},
           Scene{{"ramp 5/0 --velocity 70000pps --acceleration 200000pps/s --jerk 1000000pps/s2"},
                 "plot 5/0 --by 100000 --compare --svg {}",
                 "jerk-limited.svg"},
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
