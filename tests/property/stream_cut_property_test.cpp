// A stream of velocities that ends after any of its commands: because its sender is gone, or the
// line. The axes come to rest by themselves then, where the path goes.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "support/random.hpp"
#include "support/rounds.hpp"
#include "support/seed.hpp"
#include "support/stream_bench.hpp"

namespace tmcl::plan {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using Bench = test::StreamBench;
using Random = tmcl::test::Random<>;
namespace ap = axis_parameter;

constexpr auto models = std::to_array<std::uint16_t>({3110, 142, 6212});
// The slowest speed of a sixPoint module, one microstep a second, along the longest path.
constexpr auto longest_way_to_rest = std::chrono::hours(400);

/// What goes out before the line is cut, and how the axes behave all the time.
class Cut {
 public:
  Cut(StreamMode mode, std::uint16_t model, const path_file::Path& path, Duration round_trip)
      : mode_(mode), path_(path), bench_(model) {
    bench_.limit(5, 50);  // a TMC429 and a TMC457 keep their own
    bench_.round_trip = round_trip;
    for (const auto& element : path.elements)
      if (const auto* to = std::get_if<path_file::LineTo>(&element)) reach(to->target);
    bench_.every_ms = [this] { look(); };
    bench_.instead = [this](const DriveCommand&) -> std::optional<tmcl::Result<std::int32_t>> {
      if (commands_++ < last_command_) return std::nullopt;
      return test::no_reply();
    };
  }

  /// How many commands it takes if nothing happens.
  std::size_t whole() {
    const auto report = bench_.pass(path_, mode_);
    EXPECT_FALSE(report.fault) << report.fault->message;
    return commands_;
  }
  void expect_rest_after(std::size_t commands) {
    last_command_ = commands;
    bench_.pass(path_, mode_);
    const auto limit = bench_.now() + longest_way_to_rest;
    while (bench_.moving() && bench_.now() < limit) {
      for (int ms = 0; ms < 50; ++ms) bench_.let_pass(milliseconds(1));
      bench_.let_pass(std::chrono::minutes(10));
    }
    // What is slower than its unit reads 0.
    bench_.let_pass(longest_way_to_rest);
    const auto stands_at = positions();
    bench_.let_pass(longest_way_to_rest);
    EXPECT_EQ(positions(), stands_at);
    EXPECT_FALSE(bench_.moving());
    look();
  }

 private:
  struct Range {
    double least = 0;
    double greatest = 0;
  };

  void reach(const path_file::Point& point) {
    for (std::size_t axis = 0; axis < path_.axes.size(); ++axis) {
      auto& [least, greatest] = ranges_[axis];
      least = std::min(least, std::round(point[axis] * test::microsteps_per_mm));
      greatest = std::max(greatest, std::round(point[axis] * test::microsteps_per_mm));
    }
  }
  // By segments an axis has no more acceleration than it needs, and a late command finds it some
  // microsteps farther.
  int spare() const { return mode_ == StreamMode::segments ? 2 : 0; }
  void look() {
    const auto all = positions();
    for (std::size_t axis = 0; axis < all.size(); ++axis) {
      EXPECT_GE(all[axis], ranges_[axis].least - spare());
      EXPECT_LE(all[axis], ranges_[axis].greatest + spare());
    }
  }
  std::vector<std::int32_t> positions() {
    std::vector<std::int32_t> all;
    for (std::uint8_t axis = 0; axis < path_.axes.size(); ++axis)
      all.push_back(bench_.get(axis, ap::actual_position));
    return all;
  }

  StreamMode mode_;
  const path_file::Path& path_;
  Bench bench_;
  std::array<Range, 2> ranges_{};
  std::size_t commands_ = 0;
  std::size_t last_command_ = std::numeric_limits<std::size_t>::max();
};

std::string describe(const path_file::Path& path) {
  std::string text;
  for (const auto& element : path.elements) {
    const auto* to = std::get_if<path_file::LineTo>(&element);
    text += to == nullptr
                ? " dwell"
                : " (" + std::to_string(to->target[0]) + ", " + std::to_string(to->target[1]) + ")";
  }
  return text;
}

path_file::Path random_path(Random& random, StreamMode mode, std::size_t axes) {
  path_file::Path path{{"X", "Y"}, {}, {}};
  path.axes.resize(axes);
  const bool timed = mode == StreamMode::velocity && random.one_in(3);
  path_file::Point at{};
  const auto lines = static_cast<std::size_t>(random.between(1, 8));
  for (std::size_t line = 1; line <= lines; ++line) {
    if (!timed && random.one_in(6)) path.elements.push_back(path_file::Dwell{0.05, line});
    for (std::size_t axis = 0; axis < axes; ++axis)
      at[axis] += static_cast<double>(random.either_way(random.any_size(2000))) / 1e3 + 1e-3;
    path_file::LineTo to{at, {}, {}, line};
    if (timed) to.duration = 2;
    path.elements.push_back(to);
  }
  return path;
}

TEST(StreamCutProperty, AfterAnyCommandTheAxesComeToRestWhereThePathGoes) {
  Random random(tmcl::test::seed());
  for (int round = 0; round < tmcl::test::rounds(40); ++round) {
    const auto model = models[static_cast<std::size_t>(random.between(0, models.size() - 1))];
    const auto mode = random.one_in(2) ? StreamMode::velocity : StreamMode::segments;
    const auto path = random_path(random, mode, model == 142 ? 1 : 2);
    const auto round_trip = microseconds(random.between(60, 3000));
    SCOPED_TRACE("round " + std::to_string(round) + ", " + std::string(name_of(mode)) + ", model " +
                 std::to_string(model) + ", commands of " + std::to_string(round_trip.count()) +
                 " us:" + describe(path));
    const auto count = static_cast<std::int64_t>(Cut(mode, model, path, round_trip).whole());
    for (int cut = 0; cut < 5 && !HasFailure(); ++cut) {
      const auto last = static_cast<std::size_t>(random.between(0, count));
      SCOPED_TRACE(std::to_string(last) + " of " + std::to_string(count) + " commands");
      Cut(mode, model, path, round_trip).expect_rest_after(last);
      if (HasFailure()) return;
    }
  }
}

void expect_rest_after_each_command(StreamMode mode, std::uint16_t model,
                                    const path_file::Path& path) {
  const auto count = Cut(mode, model, path, milliseconds(8)).whole();
  for (std::size_t last = 0; last <= count && !testing::Test::HasFailure(); ++last) {
    SCOPED_TRACE(std::string(name_of(mode)) + ", model " + std::to_string(model) + ", " +
                 std::to_string(last) + " of " + std::to_string(count) + " commands");
    Cut(mode, model, path, milliseconds(8)).expect_rest_after(last);
  }
}

// There, back beyond the start, and a little forth.
TEST(StreamCutProperty, AfterEachCommandOfAWayThatTurnsTheAxesComeToRest) {
  path_file::Path path{{"X"}, {}, {}};
  for (const double x : {0.3, -0.2, -0.1})
    path.elements.push_back(path_file::LineTo{{x}, {}, 0.3, 1});
  auto without_times = path;
  for (auto& element : without_times.elements)
    std::get<path_file::LineTo>(element).duration.reset();
  for (const auto model : models) {
    expect_rest_after_each_command(StreamMode::velocity, model, path);
    expect_rest_after_each_command(StreamMode::segments, model, without_times);
  }
}

}  // namespace
}  // namespace tmcl::plan
