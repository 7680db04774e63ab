#include "motion/drive/place_on_path.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace tmcl::plan {
namespace {

constexpr double chords_near = 20;
constexpr double chords_far = 200;
constexpr double chord_s = 0.005;
// More than one search looks at.
constexpr std::size_t most_kept = 512;
// Distances that differ by less are the same, in units.
constexpr double same_distance = 1e-9;

}  // namespace

PlaceFinder::PlaceFinder(const Course& course) : course_(course), kept_(most_kept) {}

const AxisValues& PlaceFinder::end_of_chord(double number) {
  auto& kept = kept_[static_cast<std::size_t>(static_cast<std::int64_t>(number)) % most_kept];
  if (kept.number != number) kept = {number, course_.unshaped_at(number * chord_s).position};
  return kept.position;
}

PlaceOnPath PlaceFinder::nearest_within(double chords, double time, const AxisValues& place) {
  const auto axes = course_.axes();
  const auto distance = [&](const auto& point) {
    double squares = 0;
    for (std::size_t axis = 0; axis < axes; ++axis) {
      const double off = place[axis] - point(axis);
      squares += off * off;
    }
    return std::sqrt(squares);
  };
  const auto planned = course_.unshaped_at(time).position;
  PlaceOnPath nearest{distance([&](std::size_t axis) { return planned[axis]; }), 0};
  const double now = std::floor(time / chord_s);
  for (double number = now - chords; number <= now + chords; ++number) {
    const auto& begin = end_of_chord(number);
    const auto& end = end_of_chord(number + 1);
    double squares = 0, along = 0;
    for (std::size_t axis = 0; axis < axes; ++axis) {
      const double way = end[axis] - begin[axis];
      squares += way * way;
      along += (place[axis] - begin[axis]) * way;
    }
    const double part = squares > 0 ? std::clamp(along / squares, 0.0, 1.0) : 0;
    const double off =
        distance([&](std::size_t axis) { return std::lerp(begin[axis], end[axis], part); });
    // Where the path stands, all times are as near: the one that was planned is meant.
    const double lag = time - (number + part) * chord_s;
    const bool sooner = std::abs(lag) < std::abs(nearest.lag_s);
    if (off < nearest.off - same_distance || (off < nearest.off + same_distance && sooner))
      nearest.lag_s = lag;
    nearest.off = std::min(nearest.off, off);
  }
  return nearest;
}

PlaceOnPath PlaceFinder::nearest(double time, const AxisValues& place, double known) {
  const auto near = nearest_within(chords_near, time, place);
  return near.off <= known ? near : nearest_within(chords_far, time, place);
}

}  // namespace tmcl::plan
