#include "motion/drive/speed_ramp.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tmcl/seconds.hpp"

namespace tmcl::plan {
namespace {

// A ramp may go on for this part of its segment after the segment's end.
constexpr double longest_ramp = 1.25;
// An axis that is to come to rest does so at the end of its way, even if that takes this part of
// the time.
constexpr double longest_stretch_to_rest = 1.5;
// Where none leads to the end speed, it takes this part: a ramp of the whole time would have
// to make up for each difference by twice as much, and for that in the next segment.
constexpr double usual_ramp = 2. / 3;

// How long the ramp to the end speed takes that makes the way in the time; 0 or less if the way
// takes more than the end speed all the time, infinite if it takes no change at all.
double ramp_for(const SegmentTask& task) {
  const double change = task.end_speed - task.speed;
  // 0: at once; 1/2: the whole time; 1: never.
  const double missing = 1 - (task.way / task.time_s - task.speed) / change;
  if (missing <= 0.5) return 2 * missing * task.time_s;
  return missing < 1 ? task.time_s / (2 * (1 - missing)) : std::numeric_limits<double>::infinity();
}

double speed_with(double ramp_s, const SegmentTask& task) {
  const double even_s = task.time_s - ramp_s / 2;
  return (task.way - task.speed * ramp_s / 2) / even_s;
}

}  // namespace

double SpeedRamp::ramp_s() const {
  return speed == end_speed ? 0 : std::abs(end_speed - speed) / slope;
}

double SpeedRamp::speed_at(TimePoint time) const {
  const double after = std::max(0.0, seconds(time - begin));
  const double ramp = ramp_s();
  return after < ramp ? speed + (end_speed - speed) * after / ramp : end_speed;
}

double SpeedRamp::position_at(TimePoint time) const {
  const double after = seconds(time - begin);
  if (after < 0) return position + speed * after;
  const double changing = std::min(after, ramp_s());
  return position + (speed + speed_at(time)) / 2 * changing + end_speed * (after - changing);
}

SpeedRamp SpeedRamp::from(TimePoint time) const {
  return {time, position_at(time), speed_at(time), end_speed, slope};
}

SpeedRamp SpeedRamp::to_target(double target, double braking, TimePoint time) const {
  const double sense = std::copysign(1.0, target - position);
  const auto brakes = [&](const SpeedRamp& motion) {
    const double along = sense * motion.speed;
    return along > 0 && along * along > 2 * braking * sense * (target - motion.position);
  };
  auto there = from(time);
  if (time <= begin || braking <= 0 || !brakes(there)) return there;
  auto [goes_on, brakes_at] = std::pair(begin, brakes(*this) ? begin : time);
  while (brakes_at - goes_on > std::chrono::microseconds(1)) {
    const auto middle = goes_on + (brakes_at - goes_on) / 2;
    (brakes(from(middle)) ? brakes_at : goes_on) = middle;
  }
  const auto last = from(brakes_at);
  const double braked_s = std::min(seconds(time - brakes_at), std::abs(last.speed) / braking);
  there.speed = last.speed - sense * braking * braked_s;
  there.position = last.position + (last.speed + there.speed) / 2 * braked_s;
  return there;
}

Segment segment_for(const SegmentTask& task) {
  const double usual = usual_ramp * task.time_s;
  if (task.end_speed == task.speed) return {speed_with(usual, task), usual};
  if (task.end_speed == 0 && task.speed * task.way > 0) {
    const double to_rest = 2 * task.way / task.speed;
    if (to_rest < longest_stretch_to_rest * task.time_s) return {0, to_rest};
  }
  const double wanted = ramp_for(task);
  const bool steep = wanted < task.shortest_ramp_s;
  if (!steep && wanted <= longest_ramp * task.time_s) return {task.end_speed, wanted};
  const double ramp = steep ? std::min(task.shortest_ramp_s, usual) : usual;
  return {speed_with(ramp, task), ramp};
}

// The way is missing what the ramp takes: speed * time - change^2 / (2 slope).
std::optional<double> speed_by(double slope, const SegmentTask& task) {
  const double needed = task.way - task.speed * task.time_s;
  const double at_once = slope * task.time_s;
  const double rest = at_once * at_once - 2 * slope * std::abs(needed);
  if (rest < 0) return std::nullopt;
  return task.speed + std::copysign(at_once - std::sqrt(rest), needed);
}

}  // namespace tmcl::plan
