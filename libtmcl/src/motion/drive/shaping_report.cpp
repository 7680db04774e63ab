#include "tmcl/plan/shaping_report.hpp"

#include <algorithm>

#include "motion/drive/place_on_path.hpp"
#include "tmcl/ramp/resonant_load.hpp"

namespace tmcl::plan {
namespace {

// A speed is taken for a chord over so much of a swing.
constexpr double chords_of_a_swing = 100;
// Of a long course the end alone is followed: what swung before has died away, or may be undone.
constexpr double most_chords = 200'000;
constexpr double least_look_s = 0.005;
// Rounding of what is computed; in units.
constexpr double on_the_path = 1e-9;
constexpr double most_places = 20'000;

template <class StateAt>
AxisValues swings_after(const Course& course, const ramp::Resonance& resonance,
                        const StateAt& state_at) {
  std::vector<ramp::ResonantLoad> loads(course.axes(), ramp::ResonantLoad(resonance));
  const double step = 1 / (chords_of_a_swing * resonance.frequency_hz);
  const double end = course.duration();
  double time = std::max(end - most_chords * step, 0.0);
  auto before = state_at(time).velocity;
  while (time < end) {
    const auto velocity = state_at(time + step).velocity;
    for (std::size_t axis = 0; axis < loads.size(); ++axis)
      loads[axis].advance(step, (velocity[axis] - before[axis]) / step);
    before = velocity;
    time += step;
  }
  AxisValues swings{};
  for (std::size_t axis = 0; axis < loads.size(); ++axis) swings[axis] = loads[axis].swing();
  return swings;
}

AxisValues swings_after(const Course& course, const ramp::Resonance& resonance) {
  return swings_after(course, resonance, [&](double time) { return course.at(time); });
}

}  // namespace

ShapingReport report_on_shaping(const Course& course, const ramp::Resonance& resonance) {
  ShapingReport report;
  report.longer_s = longest_delay(course.impulses());
  report.swing = swings_after(course, resonance);
  report.unshaped =
      swings_after(course, resonance, [&](double time) { return course.unshaped_at(time); });
  PlaceFinder places(course);
  const double look = std::max(least_look_s, course.duration() / most_places);
  for (double time = 0; time < course.duration(); time += look) {
    const double off = places.nearest(time, course.at(time).position, report.farthest).off;
    if (off <= std::max(report.farthest, on_the_path)) continue;
    report.farthest = off;
    report.at_s = time;
  }
  return report;
}

JerkReport report_on_jerk(const Course& course, const Course& unlimited,
                          const std::optional<ramp::Resonance>& resonance) {
  JerkReport report;
  report.longer_s = course.duration() - unlimited.duration();
  if (!resonance) return report;
  report.swing = swings_after(course, *resonance);
  report.unlimited = swings_after(unlimited, *resonance);
  return report;
}

}  // namespace tmcl::plan
