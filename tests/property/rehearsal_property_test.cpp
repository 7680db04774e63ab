// What a rehearsal on twins says of a path is what simulated modules make of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/random.hpp"
#include "support/random_path.hpp"
#include "support/rounds.hpp"
#include "support/seed.hpp"
#include "support/stream_bench.hpp"
#include "tmcl/plan/rehearsal.hpp"

namespace tmcl::plan {
namespace {

using std::chrono::microseconds;

// In mm. A module takes a command at another point of its ramp tick than the twin. In 6,000 paths
// the axes got at most 0.006 farther off than foreseen, and 0.009 less far.
constexpr double may_be_farther = 0.008;
constexpr double may_be_nearer = 0.012;

struct Rehearsed {
  StreamMode mode = StreamMode::velocity;
  std::uint16_t model = 6212;
  path_file::Path path{};
  Duration command{};
};

Rehearsed random_rehearsed(tmcl::test::Random<>& random) {
  constexpr std::array<std::uint16_t, 3> models{6212, 3110, 142};
  Rehearsed scene;
  scene.mode = static_cast<StreamMode>(random.between(0, 2));
  if (scene.mode != StreamMode::position)
    scene.model = models.at(static_cast<std::size_t>(random.between(0, 2)));
  scene.path = test::random_path(random, scene.model == 142 ? 1 : 2);
  scene.command = microseconds(random.between(60, 3000));
  return scene;
}

std::string describe(const Rehearsed& scene) {
  return std::string(name_of(scene.mode)) + " on " + std::to_string(scene.model) +
         ", commands of " + std::to_string(scene.command.count() / 1000) +
         " us:" + test::describe(scene.path);
}

TEST(RehearsalProperty, ForeseesHowFarOffThePathAxesGet) {
  tmcl::test::Random<> random(tmcl::test::seed());
  for (int round = 0; round < tmcl::test::rounds(100); ++round) {
    const auto scene = random_rehearsed(random);
    SCOPED_TRACE(describe(scene));
    test::StreamBench bench(scene.model);
    if (scene.model == 6212) bench.limit(20, 400);
    if (scene.model != 6212) bench.limit(5, 50);
    bench.round_trip = scene.command;
    bench.most_deviation = 1000;
    double farthest = 0;
    bench.every_ms = [&] {
      const double y = bench.motors().size() > 1 ? bench.mm(1) : 0;
      farthest = std::max(farthest, test::off(scene.path, bench.mm(0), y));
    };
    const auto foreseen = bench.rehearse(scene.path, scene.mode);
    const auto report = bench.pass(scene.path, scene.mode);
    ASSERT_EQ(foreseen.fault.has_value(), report.fault.has_value());
    if (report.fault) {
      EXPECT_EQ(foreseen.fault->message, report.fault->message);
      continue;
    }
    EXPECT_LT(farthest, foreseen.farthest + may_be_farther);
    EXPECT_GT(farthest, foreseen.farthest - may_be_nearer);
    if (HasFailure()) return;
  }
}

// With a look every millisecond this takes minutes.
TEST(Rehearsal, OfALongPathTakesNoLonger) {
  path_file::Path path{{"X", "Y"}, {}, {}};
  path.axes.resize(2);
  path.elements.push_back(path_file::LineTo{{5, 5}, 10, {}, 1});
  path.elements.push_back(path_file::Dwell{1e6, 2});
  path.elements.push_back(path_file::LineTo{{100, 5}, 0.005, {}, 3});
  test::StreamBench bench;
  bench.limit(20, 400);
  for (const auto mode : {StreamMode::segments, StreamMode::position}) {
    const auto foreseen = bench.rehearse(path, mode);
    EXPECT_FALSE(foreseen.fault) << foreseen.fault->message;
    EXPECT_GT(foreseen.passed_s, 0.4);
  }
}

}  // namespace
}  // namespace tmcl::plan
