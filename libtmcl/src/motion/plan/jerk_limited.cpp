#include "motion/plan/jerk_limited.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "core/root.hpp"
#include "motion/solve/arithmetic.hpp"

namespace tmcl::plan::jerk_limited {
namespace {

constexpr double sixth = 1. / 6;

Motion mirrored(Motion motion) { return {-motion.velocity, -motion.acceleration}; }

// By a peak of the acceleration within its limit, which is not below what it is at the ends.
Change change(double gain, double from, double to, double limit, const Frame& frame) {
  const double ends = (square(from) + square(to)) / 2;
  const double enough = std::sqrt(std::max(0.0, frame.jerk * gain + ends));
  const double peak = std::min(std::max({enough, from, to}), limit);
  const double kept = peak < limit ? 0 : (gain + (ends - square(peak)) * frame.per_jerk) / limit;
  return {std::max(0.0, (peak - from) * frame.per_jerk), std::max(0.0, kept),
          std::max(0.0, (peak - to) * frame.per_jerk), peak};
}

}  // namespace

Change rise(Motion from, Motion to, const Frame& frame) {
  return change(to.velocity - from.velocity, from.acceleration, to.acceleration, frame.up, frame);
}

Change fall(Motion from, Motion to, const Frame& frame) {
  auto fall =
      change(from.velocity - to.velocity, -from.acceleration, -to.acceleration, frame.down, frame);
  fall.peak = -fall.peak;
  return fall;
}

bool rises_first(Motion from, Motion to, double jerk) {
  const double squares = square(to.acceleration) - square(from.acceleration);
  const double straight = (to.acceleration > from.acceleration ? squares : -squares) / (2 * jerk);
  const double excess = to.velocity - from.velocity - straight;
  const double none = unnoticed * (std::abs(to.velocity) + std::abs(from.velocity));
  return excess >= (to.acceleration + from.acceleration >= 0 ? -none : none);
}

namespace {

// Where a stretch of constant jerk leads.
struct Run {
  double distance = 0;
  Motion motion;

  void advance(double t, double jerk) {
    auto& [v, a] = motion;
    distance += t * (v + t * (a / 2 + t * jerk * sixth));
    v += t * (a + t * jerk / 2);
    a += t * jerk;
  }
};

// From one motion to another one that far away. Backwards in time and in a mirror it is a problem
// of the same kind.
struct Problem {
  Motion from;
  Motion to;
  Frame frame;
  double distance;
  bool mirrored = false;
  bool reversed = false;

  void mirror() {
    from = jerk_limited::mirrored(from);
    to = jerk_limited::mirrored(to);
    frame = frame.mirrored();
    distance = -distance;
    mirrored = !mirrored;
  }

  void reverse() {
    std::swap(from, to);
    from.acceleration = -from.acceleration;
    to.acceleration = -to.acceleration;
    frame = frame.mirrored();
    reversed = !reversed;
  }
};

// Movements whose jerk is positive, negative and positive again. The first part, in which the
// acceleration rises and stays at its limit, takes `extra`; then the target velocity is reached by
// a fall. Each solves the problem for another distance.
class Family {
 public:
  explicit Family(const Problem& problem)
      : problem_(&problem),
        rise_(std::max(0.0, (frame().up - problem.from.acceleration) / frame().jerk)) {}

  double distance(double extra) const { return distance_through(run(extra)); }

  // The one that comes to the greatest speed.
  double greatest() const {
    const auto& [v, a] = problem_->from;
    const double eventual = v + a * std::abs(a) / (2 * frame().jerk);
    if (a <= 0 && frame().speed - eventual <= unnoticed * frame().speed) return -a / frame().jerk;
    const auto change = jerk_limited::rise(problem_->from, {frame().speed, 0}, frame());
    return change.first + change.kept;
  }

  // What that one goes at least, without a stretch of constant velocity.
  double distance_at_speed(double greatest) const {
    auto run = this->run(greatest);
    run.advance(std::max(0.0, run.motion.acceleration / frame().jerk), -frame().jerk);
    return distance_through({run.distance, {frame().speed, 0}});
  }

  Route route(double extra) const {
    const auto rest = fall(run(extra).motion, problem_->to, frame());
    return with(extra, {rest.first, 0, 0, rest.kept, rest.last});
  }

  // Of the greatest one, with a stretch of constant velocity.
  Route route_at_speed(double greatest, double distance) const {
    const double first = std::max(0.0, run(greatest).motion.acceleration / frame().jerk);
    const auto rest = fall({frame().speed, 0}, problem_->to, frame());
    return with(greatest, {first, distance / frame().speed, rest.first, rest.kept, rest.last});
  }

 private:
  const Frame& frame() const { return problem_->frame; }

  Run run(double extra) const {
    Run run{0, problem_->from};
    run.advance(std::min(extra, rise_), frame().jerk);
    if (extra > rise_) {
      run.motion.acceleration = frame().up;
      run.advance(extra - rise_, 0);
    }
    return run;
  }

  double distance_through(Run run) const {
    const auto change = fall(run.motion, problem_->to, frame());
    run.advance(change.first, -frame().jerk);
    run.motion.acceleration = change.peak;
    run.advance(change.kept, 0);
    const auto [v, a] = problem_->to;
    const double t = change.last;
    return run.distance + t * (v - t * (a / 2 - t * frame().jerk * sixth));
  }

  Route with(double extra, const std::array<double, 5>& rest) const {
    const double kept = std::max(0.0, extra - rise_);
    return {{std::min(extra, rise_), kept, rest[0], rest[1], rest[2], rest[3], rest[4]},
            problem_->mirrored,
            problem_->reversed};
  }

  const Problem* problem_;
  double rise_;
};

// The member of the family that goes the distance, which lies between those of `low` and `high`;
// they are told by how much they go too far. The first guess is that of a movement from rest.
double extra_for(const Problem& problem, Point low, Point high) {
  constexpr double wider = 4;
  const Family family(problem);
  const auto miss = [&](double extra) { return family.distance(extra) - problem.distance; };
  const double start = low.x;
  double guess = std::cbrt(-low.y / (2 * problem.frame.jerk));
  for (; start + guess < high.x; guess *= wider) {
    const Point point{start + guess, miss(start + guess)};
    if (point.y >= 0) {
      high = point;
      break;
    }
    low = point;
  }
  return root(miss, low, high);
}

Route go_farther(const Problem& problem, Point low) {
  const Family family(problem);
  const double greatest = family.greatest();
  const double rest = problem.distance - family.distance_at_speed(greatest);
  if (rest >= 0) return family.route_at_speed(greatest, rest);
  return family.route(extra_for(problem, low, {greatest, -rest}));
}

bool moving(Motion motion) { return motion.velocity != 0 || motion.acceleration != 0; }

// How far off the target is no detour worth. Where both ends move, the last bits of the velocities
// lead that far.
double blur(const Problem& problem, double slack) {
  if (!moving(problem.from) || !moving(problem.to)) return 0;
  constexpr double most = 100;
  const auto greater = [](double a, double b) { return std::max(std::abs(a), std::abs(b)); };
  const double speed = greater(problem.from.velocity, problem.to.velocity);
  const double acceleration = greater(problem.from.acceleration, problem.to.acceleration);
  const double change =
      std::min(speed / acceleration, most * std::sqrt(speed / problem.frame.jerk));
  return std::max(slack, unnoticed * speed * (Family(problem).route(0).duration() + change));
}

// Turns the problem so that the target lies beyond what a fall alone comes to. Tells by how much
// that falls short.
Point face(Problem& problem) {
  const double least = Family(problem).distance(0);
  if (problem.distance >= least) return {0, least - problem.distance};
  problem.mirror();
  problem.reverse();
  return {0, -least - problem.distance};
}

// If there are movements of the family that never have a positive acceleration and have no rise at
// their end: the rise at the beginning of the last of them.
std::optional<double> longest_fall(const Problem& problem) {
  const double a = problem.from.acceleration;
  const double b = problem.to.acceleration;
  const double gain = problem.to.velocity - problem.from.velocity;
  const double peak = problem.frame.jerk * gain + (square(a) + square(b)) / 2;
  if (a >= 0 || b >= 0 || peak < 0) return std::nullopt;
  return std::max(0.0, (-std::sqrt(peak) - a) / problem.frame.jerk);
}

// Up to where the distance grows if it grows at first but then, while the acceleration is still
// negative, gets less again: speeding up saves time at velocities that lead forward, and then at
// ones that lead backward.
//
// With the negative accelerations -a at the end of the first rise and -b at the end of the fall,
// the derivative of the distance has the sign of 2 a^2 - a b + 2 c; b^2 - a^2 and c are the same
// for the whole family, until b is at its limit.
std::optional<double> first_summit(const Problem& problem) {
  const auto& from = problem.from;
  const auto& to = problem.to;
  const auto& frame = problem.frame;
  const double c = frame.jerk * from.velocity - square(from.acceleration) / 2;
  const double squares = frame.jerk * (from.velocity - to.velocity) +
                         (square(to.acceleration) - square(from.acceleration)) / 2;
  const auto extra = [&](double a) -> std::optional<double> {
    if (a >= -from.acceleration) return std::nullopt;
    return (-from.acceleration - a) / frame.jerk;
  };
  const double limited = (frame.down + std::sqrt(square(frame.down) - 16 * c)) / 4;
  if (squares + square(limited) >= square(frame.down)) return extra(limited);
  const double b = squares - 8 * c;
  const double free = (b + std::sqrt(square(b) - 48 * square(c))) / 6;
  if (free >= 0 && squares + free <= square(frame.down)) return extra(std::sqrt(free));
  return std::nullopt;
}

// From rest to rest, with one limit for both accelerations: the ramp to the greatest speed, or to
// the speed that is reached on half of the way, and the same back.
Route from_rest_to_rest(double distance, const Frame& frame) {
  const double longest_rise = frame.up * frame.per_jerk;
  const auto route = [&](double ramp, double cruise) -> Route {
    const double rise = std::min(ramp, longest_rise);
    const double kept = ramp - rise;
    if (cruise > 0) return {{rise, kept, rise, cruise, rise, kept, rise}};
    return {{rise, kept, 0, 0, 2 * rise, kept, rise}};
  };
  const double quickest = std::sqrt(frame.speed * frame.per_jerk);
  const double to_speed = quickest < longest_rise ? quickest : frame.speed / frame.up;
  const double cruise = distance / frame.speed - to_speed - std::min(to_speed, longest_rise);
  if (cruise >= 0) return route(to_speed, cruise);
  const double without_limit = std::cbrt(distance * frame.per_jerk / 2);
  if (without_limit <= longest_rise) return route(without_limit, 0);
  const double root = std::sqrt(square(longest_rise) + 4 * distance / frame.up);
  return route((root - longest_rise) / 2, 0);
}

}  // namespace

// The fastest change of the velocity alone goes a certain distance. A target beyond that is reached
// by speeding up first, or for longer, one before it by the opposite: one family of movements
// each, whose distance grows with a single number, up to the greatest speed. Of the family the
// member with the least rise is the fastest.
Route fastest_route(Motion from, Motion to, const Frame& frame, double distance, double slack) {
  Problem problem{from, to, frame, distance};
  const bool rests = !moving(problem.from) && !moving(problem.to);
  if (rests && problem.frame.up == problem.frame.down && problem.distance >= 0)
    return from_rest_to_rest(problem.distance, problem.frame);
  if (rises_first(problem.from, problem.to, problem.frame.jerk)) problem.reverse();
  Point low = face(problem);
  slack = blur(problem, slack);
  if (-low.y <= slack) return Family(problem).route(0);
  if (problem.from.acceleration < 0) {
    const auto reached = [&](double extra) {
      return Point{extra, Family(problem).distance(extra) - problem.distance};
    };
    const auto longest = longest_fall(problem);
    const auto last = reached(longest.value_or(-problem.from.acceleration / problem.frame.jerk));
    for (const auto high : {first_summit(problem), std::optional(last.x)}) {
      if (!high || *high > last.x) continue;
      const auto point = reached(*high);
      if (point.y >= 0) return Family(problem).route(extra_for(problem, low, point));
      low = point;
    }
    if (longest) {
      if (low.y >= -slack) return Family(problem).route(low.x);
      problem.reverse();
      low = face(problem);
      if (-low.y <= slack) return Family(problem).route(0);
    }
  }
  return go_farther(problem, low);
}

}  // namespace tmcl::plan::jerk_limited
