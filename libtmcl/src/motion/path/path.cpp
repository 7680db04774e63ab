#include "tmcl/plan/path.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>

#include "motion/path/smooth_speed.hpp"
#include "motion/solve/arithmetic.hpp"
#include "tmcl/ensure.hpp"

namespace tmcl::plan {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// With a jerk, a corner that is slower than this part of the speeds beside it is a stop.
constexpr double slow_as_a_stop = 1e-3;
// A time is found to the last bits in so many halvings.
constexpr int halvings = 60;
// A phase whose acceleration changes is looked at in so many parts.
constexpr int parts_of_a_change = 4;

// The first axis that is not finite.
std::optional<std::size_t> undefined(const AxisValues& values, std::size_t axes) {
  for (std::size_t axis = 0; axis < axes; ++axis) {
    if (!std::isfinite(values[axis])) return axis;
  }
  return std::nullopt;
}

std::optional<PathFault> fault_of(const PathLimits& limits) {
  using Kind = PathFault::Kind;
  if (limits.axes == 0 || limits.axes > most_path_axes) return PathFault{Kind::axes};
  for (std::size_t axis = 0; axis < limits.axes; ++axis) {
    if (!positive(limits.axis[axis].velocity)) return PathFault{Kind::velocity_limit, 0, axis};
    if (!positive(limits.axis[axis].acceleration)) {
      return PathFault{Kind::acceleration_limit, 0, axis};
    }
    if (!(limits.axis[axis].corner_jump > 0)) return PathFault{Kind::corner_jump, 0, axis};
  }
  if (!(limits.jerk > 0)) return PathFault{Kind::jerk};
  const bool tolerable = limits.corner_tolerance >= 0 && std::isfinite(limits.corner_tolerance);
  return tolerable ? std::nullopt : std::optional(PathFault{Kind::tolerance});
}

std::optional<PathFault> fault_of(std::span<const Leg> legs, std::size_t axes) {
  using Kind = PathFault::Kind;
  if (legs.size() > most_legs) return PathFault{Kind::legs};
  for (std::size_t i = 0; i < legs.size(); ++i) {
    if (const auto axis = undefined(legs[i].target, axes)) return PathFault{Kind::target, i, *axis};
    if (!(legs[i].feed > 0)) return PathFault{Kind::feed, i};
  }
  return std::nullopt;
}

// A leg of some length: where it goes and what the axes allow there.
struct Stretch {
  std::size_t index;
  AxisValues direction;
  double length;
  double speed;
  double acceleration;
  double entry = 0;  // the speed at its begin
};

Stretch stretch(std::size_t index, const AxisValues& from, const Leg& leg, double length,
                const PathLimits& limits) {
  Stretch made{index, {}, length, leg.feed, infinity};
  for (std::size_t axis = 0; axis < limits.axes; ++axis) {
    made.direction[axis] = (leg.target[axis] - from[axis]) / length;
    const double share = std::abs(made.direction[axis]);
    if (share == 0) continue;
    made.speed = std::min(made.speed, limits.axis[axis].velocity / share);
    made.acceleration = std::min(made.acceleration, limits.axis[axis].acceleration / share);
  }
  return made;
}

// To where a speed can grow, or from where it can fall, along this stretch.
double reachable(double speed, const Stretch& along) {
  return std::sqrt(square(speed) + 2 * along.acceleration * along.length);
}

// The speeds between the stretches: what the corners allow, then what can be reached from before,
// and what can be left in time for what comes.
void look_ahead(std::vector<Stretch>& stretches, const PathLimits& limits) {
  for (std::size_t i = 1; i < stretches.size(); ++i) {
    const auto& before = stretches[i - 1];
    auto& after = stretches[i];
    const double corner = corner_speed(before.direction, after.direction,
                                       std::min(before.length, after.length), limits);
    after.entry = std::min({corner, before.speed, after.speed, reachable(before.entry, before)});
  }
  double next = 0;
  for (auto stretch = stretches.rbegin(); stretch != stretches.rend(); ++stretch) {
    stretch->entry = std::min(stretch->entry, reachable(next, *stretch));
    next = stretch->entry;
  }
}

LegPlan trapezoid(const Stretch& along, double exit) {
  LegPlan leg;
  const double a = along.acceleration;
  const double entry = along.entry;
  const double peak = std::sqrt((square(entry) + square(exit)) / 2 + a * along.length);
  leg.length = along.length;
  leg.start_speed = entry;
  leg.end_speed = exit;
  leg.peak_speed = std::max({std::min(peak, along.speed), entry, exit});
  leg.acceleration = a;
  leg.up = (leg.peak_speed - entry) / a;
  leg.down = (leg.peak_speed - exit) / a;
  if (peak > along.speed) {
    const double ramps =
        (leg.peak_speed + entry) / 2 * leg.up + (leg.peak_speed + exit) / 2 * leg.down;
    leg.even = std::max(0.0, along.length - ramps) / leg.peak_speed;
  }
  return leg;
}

// With a jerk: from the first stretch until the path stops.
std::vector<SpeedLimit> until_stop(std::span<const Stretch> stretches, const PathLimits& limits) {
  std::vector<SpeedLimit> all;
  for (const auto& stretch : stretches) {
    SpeedLimit limit{stretch.length, stretch.speed};
    if (!all.empty()) {
      const auto& before = stretches[all.size() - 1];
      limit.corner = corner_speed(before.direction, stretch.direction,
                                  std::min(before.length, stretch.length), limits);
      if (limit.corner < slow_as_a_stop * std::min(before.speed, stretch.speed)) return all;
    }
    all.push_back(limit);
  }
  return all;
}

std::vector<SpeedPhase> smooth_speeds(std::span<const Stretch> stretches,
                                      const PathLimits& limits) {
  std::vector<SpeedPhase> phases{{}};
  while (!stretches.empty()) {
    const auto part = until_stop(stretches, limits);
    const auto begin = phases.back();
    double end = begin.way, acceleration = infinity;
    for (const auto& stretch : stretches.first(part.size())) {
      end += stretch.length;
      acceleration = std::min(acceleration, stretch.acceleration);
    }
    phases.pop_back();
    for (auto phase : smooth_speed(part, acceleration, limits.jerk)) {
      phase.begin += begin.begin;
      phase.way += begin.way;
      phases.push_back(phase);
    }
    phases.back().way = end;
    stretches = stretches.subspan(part.size());
  }
  return phases;
}

// The greatest size that cos(t) a + sin(t) b has on the way from t = 0 to where it is `last`, less
// than half a turn later; the derivative is b at first and `slope` at last.
double greatest(double a, double b, double last, double slope) {
  const bool turns = (b < 0) != (slope < 0);
  return turns ? std::hypot(a, b) : std::max(std::abs(a), std::abs(last));
}

}  // namespace

double corner_speed(const AxisValues& from, const AxisValues& to, double room,
                    const PathLimits& limits) {
  AxisValues change{}, sum{};
  for (std::size_t axis = 0; axis < limits.axes; ++axis) {
    change[axis] = to[axis] - from[axis];
    sum[axis] = to[axis] + from[axis];
  }
  const AxisValues none{};
  const double sine = distance_between(none, change, limits.axes) / 2;  // of half the angle
  const double cosine = distance_between(none, sum, limits.axes) / 2;
  if (2 * sine < straight) return infinity;
  if (2 * cosine < straight) return 0;
  // The arc departs from the corner by radius / cosine - radius, and touches the legs radius * sine
  // / cosine away from it.
  const double radius = std::min(limits.corner_tolerance * cosine * (1 + cosine) / square(sine),
                                 room / 2 * cosine / sine);
  double speed = infinity;
  for (std::size_t axis = 0; axis < limits.axes; ++axis) {
    const double first = from[axis], last = to[axis];
    // Towards the centre of the arc, from both of its ends.
    const double inward = (change[axis] / (2 * sine) + sine * first) / cosine;
    const double outward = (change[axis] / (2 * sine) - sine * last) / cosine;
    const auto& [velocity, acceleration, jump] = limits.axis[axis];
    if (change[axis] != 0) speed = std::min(speed, jump / std::abs(change[axis]));
    speed = std::min({speed, velocity / greatest(first, inward, last, outward),
                      std::sqrt(radius * acceleration / greatest(inward, -first, outward, -last))});
  }
  return speed;
}

double LegPlan::speed_after(double t) const {
  if (t < up) return start_speed + acceleration * t;
  return t < up + even ? peak_speed : end_speed + acceleration * (duration() - t);
}

double LegPlan::acceleration_after(double t) const {
  if (t < up) return acceleration;
  return t < up + even ? 0 : -acceleration;
}

double LegPlan::way_after(double t) const {
  if (t < up) return t * (start_speed + acceleration * t / 2);
  const double ramp = (start_speed + peak_speed) / 2 * up;
  if (t < up + even) return ramp + (t - up) * peak_speed;
  const double left = duration() - t;
  return length - left * (end_speed + acceleration * left / 2);
}

double PathPlan::share(std::size_t leg, std::size_t axis) const {
  const double length = legs_[leg].length;
  return length > 0 ? (corners_[leg + 1][axis] - corners_[leg][axis]) / length : 0;
}

AxisRamp PathPlan::ramp(std::size_t leg, std::size_t axis) const {
  ensure(leg < legs_.size() && axis < axes_);
  const auto& plan = legs_[leg];
  const double part = std::abs(share(leg, axis));
  const double acceleration = part * plan.acceleration;
  return {corners_[leg + 1][axis],
          part * plan.start_speed,
          part * plan.peak_speed,
          acceleration,
          acceleration,
          part * plan.end_speed};
}

/// Before the end.
SpeedPhase PathPlan::speed_at(double t) const {
  const auto later = std::ranges::upper_bound(phases_, t, {}, &SpeedPhase::begin);
  const auto& phase = *std::prev(later);
  return phase.after(t - phase.begin);
}

double PathPlan::bend_not_before(double t) const {
  const auto next = std::ranges::lower_bound(phases_, t, {}, &SpeedPhase::begin);
  if (next == phases_.end()) return infinity;
  if (next == phases_.begin() || std::prev(next)->jerk == 0) return next->begin;
  const double begin = std::prev(next)->begin;
  const double part = (next->begin - begin) / parts_of_a_change;
  const double passed = std::ceil((t - begin) / part);
  return passed < parts_of_a_change ? std::max(t, begin + passed * part) : next->begin;
}

/// Finds when each leg begins, and how fast it is passed.
void PathPlan::pass_smoothly(std::vector<SpeedPhase> phases) {
  phases_ = std::move(phases);
  auto phase = phases_.begin();
  auto here = *phase;
  for (auto& leg : legs_) {
    leg.begin = here.begin;
    if (leg.length == 0) continue;
    const auto note = [&leg](const SpeedPhase& passed) {
      leg.peak_speed = std::max(leg.peak_speed, passed.speed);
      leg.acceleration = std::max(leg.acceleration, std::abs(passed.acceleration));
    };
    leg.start_speed = here.speed;
    note(here);
    const double end = leg.way + leg.length;
    const bool is_last = end == legs_.back().way + legs_.back().length;
    for (; std::next(phase) != phases_.end() && (is_last || std::next(phase)->way <= end); ++phase)
      note(*std::next(phase));
    double early = std::max(here.begin - phase->begin, 0.0);
    const bool is_there = is_last || phase->after(early).way >= end;
    double late = is_there ? early : std::next(phase)->begin - phase->begin;
    for (int halving = 0; halving < halvings && early < late; ++halving) {
      const double middle = std::midpoint(early, late);
      (phase->after(middle).way < end ? early : late) = middle;
    }
    here = phase->after(late);
    note(here);
    leg.even = here.begin - leg.begin;
    leg.end_speed = here.speed;
  }
}

/// Of a time before the end.
std::size_t PathPlan::leg_at(double t) const {
  const auto later =
      std::upper_bound(legs_.begin(), legs_.end(), std::max(t, 0.0),
                       [](double time, const LegPlan& leg) { return time < leg.begin; });
  return static_cast<std::size_t>(std::distance(legs_.begin(), later)) - 1;
}

PathState PathPlan::at(double t) const {
  PathState state;
  if (t >= duration() || legs_.empty()) {
    state.position = corners_.empty() ? AxisValues{} : corners_.back();
    return state;
  }
  const auto index = leg_at(t);
  const auto& leg = legs_[index];
  const double since_start = std::max(t, 0.0);
  const double after = since_start - leg.begin;
  double way = leg.way_after(after), speed = leg.speed_after(after);
  if (!phases_.empty()) {
    const auto along = speed_at(since_start);
    way = std::clamp(along.way - leg.way, 0.0, leg.length);
    speed = along.speed;
  }
  for (std::size_t axis = 0; axis < axes_; ++axis) {
    const double part = share(index, axis);
    state.position[axis] = corners_[index][axis] + part * way;
    state.velocity[axis] = part * speed;
  }
  return state;
}

PathMotion PathPlan::motion_at(double t) const {
  PathMotion motion{at(t)};
  if (t < 0 || t >= duration()) return motion;
  const auto index = leg_at(t);
  SpeedPhase along;
  along.acceleration = legs_[index].acceleration_after(t - legs_[index].begin);
  if (!phases_.empty()) along = speed_at(t);
  for (std::size_t axis = 0; axis < axes_; ++axis) {
    motion.acceleration[axis] = share(index, axis) * along.acceleration;
    motion.jerk[axis] = share(index, axis) * along.jerk;
  }
  return motion;
}

tl::expected<PathPlan, PathFault> plan_path(const AxisValues& start, std::span<const Leg> legs,
                                            const PathLimits& limits) {
  if (const auto fault = fault_of(limits)) return tl::unexpected(*fault);
  if (const auto axis = undefined(start, limits.axes)) {
    return tl::unexpected(PathFault{PathFault::Kind::start, 0, *axis});
  }
  if (const auto fault = fault_of(legs, limits.axes)) return tl::unexpected(*fault);

  PathPlan plan;
  plan.axes_ = limits.axes;
  plan.corners_ = {start};
  plan.legs_.resize(legs.size());
  std::vector<Stretch> stretches;
  for (std::size_t i = 0; i < legs.size(); ++i) {
    const double length = distance_between(plan.corners_.back(), legs[i].target, limits.axes);
    if (length > 0) stretches.push_back(stretch(i, plan.corners_.back(), legs[i], length, limits));
    plan.corners_.push_back(legs[i].target);
  }
  const bool is_smooth = std::isfinite(limits.jerk) && !stretches.empty();
  if (!is_smooth) look_ahead(stretches, limits);
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    auto& leg = plan.legs_[stretches[i].index];
    const double exit = i + 1 < stretches.size() ? stretches[i + 1].entry : 0;
    if (!is_smooth) leg = trapezoid(stretches[i], exit);
    leg.length = stretches[i].length;
  }
  for (std::size_t i = 1; i < legs.size(); ++i) {
    const auto& before = plan.legs_[i - 1];
    plan.legs_[i].begin = before.end();
    plan.legs_[i].way = before.way + before.length;
  }
  if (is_smooth) plan.pass_smoothly(smooth_speeds(stretches, limits));
  if (!std::isfinite(plan.duration())) return tl::unexpected(PathFault{PathFault::Kind::magnitude});
  return plan;
}

std::string describe(const PathFault& fault) {
  using Kind = PathFault::Kind;
  switch (fault.kind) {
    case Kind::axes: return fmt::format("a path has 1 to {} axes", most_path_axes);
    case Kind::legs: return fmt::format("a path has at most {} legs", most_legs);
    case Kind::tolerance: return "the tolerance of corners must be 0 or greater, and finite";
    case Kind::velocity_limit:
      return fmt::format("axis {}: the limit of velocity must be greater than zero, and finite",
                         fault.axis);
    case Kind::acceleration_limit:
      return fmt::format("axis {}: the limit of acceleration must be greater than zero, and finite",
                         fault.axis);
    case Kind::corner_jump:
      return fmt::format("axis {}: the jump in corners must be greater than zero", fault.axis);
    case Kind::start: return fmt::format("axis {}: the start must be finite", fault.axis);
    case Kind::target:
      return fmt::format("leg {}: the target of axis {} must be finite", fault.leg, fault.axis);
    case Kind::feed: return fmt::format("leg {}: the feed must be greater than zero", fault.leg);
    case Kind::jerk: return "the jerk must be greater than zero";
    case Kind::magnitude: return "the path is too long for a double";
  }
  return "unknown";
}

}  // namespace tmcl::plan
