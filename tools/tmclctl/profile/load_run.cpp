#include "profile/load_run.hpp"

#include <algorithm>
#include <cmath>

namespace tmclctl::profile {
namespace {

constexpr double usual_tolerance = 1e-3;  // of the way
constexpr double swings_after_rest = 4;
constexpr int points_of_a_swing = 32;

/// The way that was gone farthest from where it began, and by how much a velocity is to be
/// multiplied to be that of the positions: a chip counts both in units of its own.
struct Way {
  double length = 0;
  double per_velocity = 1;
};
Way way_of(const std::vector<double>& times, const std::vector<double>& positions,
           const std::vector<double>& velocities) {
  Way way;
  double sum = 0;
  for (std::size_t i = 1; i < times.size(); ++i) {
    sum += (velocities[i] + velocities[i - 1]) / 2 * (times[i] - times[i - 1]);
    const double gone = positions[i] - positions.front();
    if (std::abs(gone) <= way.length || sum == 0) continue;
    way = {std::abs(gone), gone / sum};
  }
  return way;
}

}  // namespace

LoadRun follow_load(const plot::Recording& recording, const LoadWish& wish) {
  const auto motor = plot::position_curve(recording);
  const auto velocities = plot::velocity_curve(recording).values;
  const auto way = way_of(motor.times, motor.values, velocities);
  tmcl::ramp::ResonantLoad load(wish.resonance);
  LoadRun run;
  const auto add = [&](double time, double position, double velocity) {
    run.times.push_back(time);
    run.positions.push_back(position + load.offset());
    run.velocities.push_back(velocity + load.speed() / way.per_velocity);
  };
  // A velocity that is taken at once is there at the first point.
  load.jump(way.per_velocity * velocities.front());
  for (std::size_t i = 0; i < motor.times.size(); ++i) {
    if (i > 0) {
      const double seconds = motor.times[i] - motor.times[i - 1];
      load.advance(seconds, way.per_velocity * (velocities[i] - velocities[i - 1]) / seconds);
    }
    add(motor.times[i], motor.values[i], velocities[i]);
  }
  run.swing = load.swing();
  const double end = motor.times.back();
  const auto tolerance = wish.tolerance.value_or(usual_tolerance * way.length);
  const auto wait = load.time_to_settle(tolerance);
  if (wait) run.settled = end + *wait;
  if (velocities.back() != 0) return run;
  const double step = 1 / wish.resonance.frequency_hz / points_of_a_swing;
  for (int i = 1; i <= swings_after_rest * points_of_a_swing; ++i) {
    load.advance(step, 0);
    add(end + i * step, motor.values.back(), 0);
  }
  return run;
}

}  // namespace tmclctl::profile
