// How far axes are off their path, and how late on it.
#include <gtest/gtest.h>

#include <cmath>

#include "motion/drive/place_on_path.hpp"

namespace tmcl::plan {
namespace {

Course with_a_dwell() {
  path_file::Path path{{"X", "Y"}, {}, {}};
  path.elements.push_back(path_file::LineTo{{10, 0}, {}, {}, 1});
  path.elements.push_back(path_file::Dwell{0.5, 2});
  path.elements.push_back(path_file::LineTo{{10, 10}, {}, {}, 3});
  PathLimits limits;
  limits.axes = 2;
  limits.axis.fill({20, 400});
  return Course::of(path, limits).value();
}

TEST(PlaceOnPath, IsNeitherOffNorLateWhereItIsPlanned) {
  const auto course = with_a_dwell();
  PlaceFinder places(course);
  for (double time = 0; time < course.duration() + 0.2; time += 0.01) {
    const auto place = places.nearest(time, course.at(time).position, 0);
    EXPECT_NEAR(place.off, 0, 1e-6) << "at " << time;
    // Where it speeds up, a chord of the search is as near some ms earlier.
    EXPECT_NEAR(place.lag_s, 0, 0.006) << "at " << time;
  }
}

TEST(PlaceOnPath, IsTheSameWhateverWasSoughtBefore) {
  const auto course = with_a_dwell();
  PlaceFinder places(course);
  // Times beyond both ends, further apart than what is kept.
  for (int i = 0; i < 200; ++i) {
    const double time = std::fmod(i * 2.718, 2 * course.duration() + 4) - 2;
    auto there = course.at(time).position;
    there[0] += 0.3;
    const auto place = places.nearest(time, there, 0.1);
    const auto fresh = PlaceFinder(course).nearest(time, there, 0.1);
    EXPECT_EQ(place.off, fresh.off) << "at " << time;
    EXPECT_EQ(place.lag_s, fresh.lag_s) << "at " << time;
  }
}

TEST(PlaceOnPath, IsAsLateAndAsFarOffAsItIsPut) {
  const auto course = with_a_dwell();
  auto there = course.at(0.3).position;
  there[1] += 0.25;
  const auto place = PlaceFinder(course).nearest(0.35, there, 0);
  EXPECT_NEAR(place.off, 0.25, 1e-9);
  EXPECT_NEAR(place.lag_s, 0.05, 1e-9);
}

}  // namespace
}  // namespace tmcl::plan
