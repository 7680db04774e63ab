/// Two axes on a line, as somebody sees them who reads their positions in turn.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <vector>

namespace tmcl::test {

/// A position, and between which two times the module told it.
struct Reading {
  double before_s;
  double after_s;
  std::int64_t position;
};
using Readings = std::vector<Reading>;

/// Where both axes were at one time.
struct PointOfLine {
  double time_s;
  double x;
  std::int64_t y;
  double doubt;      ///< How far x may be from the truth, for the time that reading takes.
  double off_line;   ///< How far y is off the line, as far as it cannot come from that.
  double y_on_line;  ///< Where the line has y.
};

/// From (0, 0) to the targets; x has the longer way.
struct LineTargets {
  std::int64_t x;
  std::int64_t y;
  double slope() const { return static_cast<double>(y) / static_cast<double>(x); }
};

/// The points at which y was read and x was known before and after. Both start at 0 and do not turn
/// round; neither has been left out.
inline std::vector<PointOfLine> points_of_line(const Readings& x, const Readings& y,
                                               const LineTargets& targets) {
  std::vector<PointOfLine> points;
  for (const auto& reading : y) {
    const auto after = std::ranges::lower_bound(x, reading.after_s, {}, &Reading::before_s);
    const auto beyond = std::ranges::upper_bound(x, reading.before_s, {}, &Reading::after_s);
    if (after == x.end() || beyond == x.begin()) continue;
    const auto low = static_cast<double>(std::prev(beyond)->position);
    const auto high = static_cast<double>(after->position);
    const auto [least, greatest] = std::minmax({low * targets.slope(), high * targets.slope()});
    const auto seen = static_cast<double>(reading.position);
    const double middle = (low + high) / 2;
    points.push_back({(reading.before_s + reading.after_s) / 2, middle, reading.position,
                      std::abs(high - low) / 2, seen - std::clamp(seen, least, greatest),
                      middle * targets.slope()});
  }
  return points;
}

}  // namespace tmcl::test
