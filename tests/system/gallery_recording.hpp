/// Two axes, as somebody sees them who reads their positions in turn.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <map>
#include <vector>

#include "unit/daemon_fixture.hpp"

namespace tmcl::test {

struct Motor {
  int address;
  int number;
};

/// A position, and between which two times the module told it.
struct Reading {
  double before_s;
  double after_s;
  double position;
};
using Readings = std::vector<Reading>;

/// Where both axes were at one time, in microsteps.
struct PointSeen {
  double time_s;
  double x;
  double y;
  double doubt;  ///< How far x may be from the truth, for the time that reading takes.
};
using PointsSeen = std::vector<PointSeen>;

/// The points at which y was read and x was known before and after.
inline PointsSeen points_of(const Readings& x, const Readings& y) {
  PointsSeen points;
  for (const auto& reading : y) {
    const auto after = std::ranges::lower_bound(x, reading.after_s, {}, &Reading::before_s);
    const auto beyond = std::ranges::upper_bound(x, reading.before_s, {}, &Reading::after_s);
    if (after == x.end() || beyond == x.begin()) continue;
    const double before = std::prev(beyond)->position;
    points.push_back({(reading.before_s + reading.after_s) / 2, (before + after->position) / 2,
                      reading.position, std::abs(after->position - before) / 2});
  }
  return points;
}

/// Reads the positions of two motors of `bench` in turn until told to stop, `pause` after each two.
inline PointsSeen observe(tmcld::test::TestDaemon& daemon, const std::array<Motor, 2>& motors,
                          const std::function<bool()>& is_over, Duration pause) {
  RpcClient client(daemon.socket());
  const auto begin = daemon.now();
  const auto now = [&] { return std::chrono::duration<double>(daemon.now() - begin).count(); };
  std::array<Readings, 2> readings;
  // Once more when it is over: the end is seen, too.
  for (bool over = false; !over;) {
    over = is_over();
    for (std::size_t i = 0; i < 2; ++i) {
      const double before = now();
      const auto answer = client.result("module.execute", {{"bus", "bench"},
                                                           {"address", motors[i].address},
                                                           {"command", "GAP"},
                                                           {"type", 1},
                                                           {"motor", motors[i].number}});
      readings[i].push_back({before, now(), answer.at("value").to_number<double>()});
    }
    daemon.run_for(pause);
  }
  return points_of(readings[0], readings[1]);
}

/// From the last point before the start, where times begin, to the first at the end; in between, of
/// points that are near each other in time, the one that is known best.
inline PointsSeen thinned(const PointsSeen& points, double apart_s) {
  const auto differs = [](const PointSeen& point, const PointSeen& next) {
    return point.x != next.x || point.y != next.y;
  };
  const auto first = std::ranges::adjacent_find(points, differs);
  const auto last = std::adjacent_find(points.rbegin(), points.rend(), differs);
  if (first == points.end()) return {};
  std::map<int, PointSeen> best;
  for (auto point = first; point != last.base(); ++point) {
    const auto [known, is_first] =
        best.try_emplace(static_cast<int>((point->time_s - first->time_s) / apart_s), *point);
    if (!is_first && point->doubt < known->second.doubt) known->second = *point;
  }
  PointsSeen kept;
  for (const auto& [_, point] : best) kept.push_back(point);
  kept.push_back(*std::prev(last.base()));
  for (auto& point : kept) point.time_s -= first->time_s;
  return kept;
}

/// Whether nothing was seen for so long that a picture would lie.
inline bool has_gap(const PointsSeen& points) {
  constexpr double longest_gap_s = 0.1;
  return std::ranges::adjacent_find(points, [](const PointSeen& point, const PointSeen& next) {
           return next.time_s > point.time_s + longest_gap_s;
         }) != points.end();
}

}  // namespace tmcl::test
