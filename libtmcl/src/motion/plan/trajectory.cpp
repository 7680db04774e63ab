#include "tmcl/plan/trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numeric>
#include <optional>
#include <utility>

#include "core/root.hpp"
#include "motion/solve/arithmetic.hpp"

namespace tmcl::plan {
namespace {

// In relation to the numbers that it comes from, a difference as small as that is none. A movement
// may be planned again on its way, from a state that is off by its last bits; where the target
// moves that must not make a detour of it.
constexpr double unnoticed = 1e-12;
constexpr double sixth = 1. / 6;
constexpr double last_bits = 0x1p-48;

struct Motion {
  double velocity;
  double acceleration;
};

// Seen from one side: `up` limits the acceleration, `down` its opposite.
struct Frame {
  double speed;
  double up;
  double down;
  double jerk;
  double per_jerk = 1 / jerk;

  Frame mirrored() const { return {speed, down, up, jerk, per_jerk}; }
};

Motion mirrored(Motion motion) { return {-motion.velocity, -motion.acceleration}; }

// How one velocity is left and another one reached: the acceleration rises (or falls), is kept at
// its limit, and falls (or rises).
struct Change {
  double first;
  double kept;
  double last;
  double peak;
};

// By a peak of the acceleration within its limit, which is not below what it is at the ends.
Change change(double gain, double from, double to, double limit, const Frame& frame) {
  const double ends = (square(from) + square(to)) / 2;
  const double enough = std::sqrt(std::max(0.0, frame.jerk * gain + ends));
  const double peak = std::min(std::max({enough, from, to}), limit);
  const double kept = peak < limit ? 0 : (gain + (ends - square(peak)) * frame.per_jerk) / limit;
  return {std::max(0.0, (peak - from) * frame.per_jerk), std::max(0.0, kept),
          std::max(0.0, (peak - to) * frame.per_jerk), peak};
}

Change rise(Motion from, Motion to, const Frame& frame) {
  return change(to.velocity - from.velocity, from.acceleration, to.acceleration, frame.up, frame);
}

Change fall(Motion from, Motion to, const Frame& frame) {
  auto fall =
      change(from.velocity - to.velocity, -from.acceleration, -to.acceleration, frame.down, frame);
  fall.peak = -fall.peak;
  return fall;
}

// Whether the acceleration must rise first, rather than fall, on the fastest way to `to`. If it
// only must go straight to that of `to`, it does not pass zero for nothing.
bool rises_first(Motion from, Motion to, double jerk) {
  const double squares = square(to.acceleration) - square(from.acceleration);
  const double straight = (to.acceleration > from.acceleration ? squares : -squares) / (2 * jerk);
  const double excess = to.velocity - from.velocity - straight;
  const double none = unnoticed * (std::abs(to.velocity) + std::abs(from.velocity));
  return excess >= (to.acceleration + from.acceleration >= 0 ? -none : none);
}

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
    from = plan::mirrored(from);
    to = plan::mirrored(to);
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

// An S-curve with the parts of most of them: jerk, acceleration, jerk, constant velocity, jerk,
// deceleration, jerk.
struct Route {
  std::array<double, 7> times{};
  bool mirrored = false;
  bool reversed = false;

  double duration() const { return std::accumulate(times.begin(), times.end(), 0.0); }
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
    const auto change = plan::rise(problem_->from, {frame().speed, 0}, frame());
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

// Within the limits, from a motion that can be kept in them. To be off by `slack` is to be there.
//
// The fastest change of the velocity alone goes a certain distance. A target beyond that is reached
// by speeding up first, or for longer, one before it by the opposite: one family of movements
// each, whose distance grows with a single number, up to the greatest speed. Of the family the
// member with the least rise is the fastest.
Route s_curve(Problem problem, double slack) {
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

// Puts phases one after another, seen from the side on which the target is in front.
class Draft {
 public:
  Draft(Trajectory& trajectory, double acceleration, const Frame& frame, bool mirrored)
      : trajectory_(&trajectory),
        frame_(frame),
        sign_(mirrored ? -1 : 1),
        acceleration_(acceleration) {}

  const Frame& frame() const { return frame_; }
  Motion motion() const { return {sign_ * trajectory_->reached().velocity, acceleration_}; }
  double distance() const { return sign_ * trajectory_->reached().position; }

  void jerk(double t, double jerk) {
    trajectory_->append(t, sign_ * acceleration_, sign_ * jerk);
    acceleration_ += std::max(0.0, t) * jerk;
  }

  void keep(double t, double acceleration) {
    acceleration_ = acceleration;
    trajectory_->append(t, sign_ * acceleration, 0);
  }

  void add(const Route& route) {
    const double sign = route.mirrored ? -1 : 1;
    const bool swapped = route.mirrored != route.reversed;
    const double kept[] = {swapped ? -frame_.down : frame_.up, 0,
                           swapped ? frame_.up : -frame_.down};
    const double jerks[] = {sign * frame_.jerk,  0, -sign * frame_.jerk, 0,
                            -sign * frame_.jerk, 0, sign * frame_.jerk};
    for (std::size_t i = 0; i < route.times.size(); ++i) {
      const auto part = route.reversed ? route.times.size() - 1 - i : i;
      if (part % 2 == 0) jerk(route.times[part], jerks[part]);
      if (part % 2 != 0 && route.times[part] > 0) keep(route.times[part], kept[part / 2]);
    }
  }

 private:
  Trajectory* trajectory_;
  Frame frame_;
  double sign_;
  double acceleration_;
};

bool exceeds(double speed, double limit) { return speed > limit * (1 + unnoticed); }

void slow_down(Draft& draft) {
  const auto [v, a] = draft.motion();
  const auto& frame = draft.frame();
  const double eventual = v + a * std::abs(a) / (2 * frame.jerk);
  if (!exceeds(std::abs(eventual), frame.speed)) return;
  const bool above = eventual > 0;
  const auto change = above ? fall(draft.motion(), {frame.speed, 0}, frame)
                            : rise(draft.motion(), {-frame.speed, 0}, frame);
  draft.jerk(change.first, above ? -frame.jerk : frame.jerk);
  if (change.kept > 0) draft.keep(change.kept, change.peak);
}

void enter_limits(Draft& draft) {
  const double a = draft.motion().acceleration;
  const auto& frame = draft.frame();
  if (a > frame.up) draft.jerk((a - frame.up) / frame.jerk, -frame.jerk);
  if (a < -frame.down) draft.jerk((-frame.down - a) / frame.jerk, frame.jerk);
  slow_down(draft);
}

void change_speed(Draft& draft, double change) {
  const double limit = change > 0 ? draft.frame().up : -draft.frame().down;
  if (change != 0) draft.keep(change / limit, limit);
}

// By how much a speed must be exceeded to go so far more, with this much time for each unit of
// velocity.
double excess(double speed, double gap, double time) {
  const double area = 2 * gap / time;
  const double reached = std::sqrt(square(speed) + area);
  return speed > 0 ? area / (speed + reached) : reached - speed;
}

// The same without jerk. To be off by `slack` is to be there.
void trapezoid(Draft& draft, double velocity, double distance, double slack) {
  const auto& frame = draft.frame();
  const double start = draft.motion().velocity;
  if (std::abs(start) > frame.speed) {
    change_speed(draft, std::copysign(frame.speed, start) - start);
  }
  distance -= draft.distance();
  const double from = std::clamp(start, -frame.speed, frame.speed);
  const double direct =
      (velocity - from) / (velocity > from ? frame.up : -frame.down) * ((velocity + from) / 2);
  const double gap = distance - direct;
  const double way = std::max(square(from), square(velocity)) / std::min(frame.up, frame.down);
  slack = std::max({slack, unnoticed * std::abs(direct), last_bits * way});
  if (velocity != 0 && std::abs(gap) <= slack) return change_speed(draft, velocity - from);
  const double sign = gap < 0 ? -1 : 1;
  const double time = 1 / frame.up + 1 / frame.down;
  const double speed = std::max(sign * from, sign * velocity);
  const double wanted = excess(speed, sign * gap, time);
  const double more = std::min(wanted, frame.speed - speed);
  change_speed(draft, sign * (speed - sign * from + more));
  if (wanted > more) {
    const double covered = time * more * (speed + more / 2);
    draft.keep((sign * gap - covered) / frame.speed, 0);
  }
  change_speed(draft, sign * (sign * velocity - speed - more));
}

void move_with_jerk(Draft& draft, Motion to, double distance, double slack) {
  enter_limits(draft);
  draft.add(s_curve({draft.motion(), to, draft.frame(), distance - draft.distance()}, slack));
}

void change_speed_with_jerk(Draft& draft, double velocity) {
  enter_limits(draft);
  const Motion to{velocity, 0};
  const bool rises = rises_first(draft.motion(), to, draft.frame().jerk);
  const auto change =
      rises ? rise(draft.motion(), to, draft.frame()) : fall(draft.motion(), to, draft.frame());
  const double jerk = rises ? draft.frame().jerk : -draft.frame().jerk;
  draft.jerk(change.first, jerk);
  if (change.kept > 0) draft.keep(change.kept, change.peak);
  draft.jerk(change.last, -jerk);
}

bool finite(const State& state) {
  return std::isfinite(state.position) && std::isfinite(state.velocity) &&
         std::isfinite(state.acceleration);
}

std::optional<Fault> fault_of(const Limits& limits) {
  if (!positive(limits.velocity)) return Fault::velocity_limit;
  if (!positive(limits.acceleration)) return Fault::acceleration_limit;
  if (!positive(limits.deceleration)) return Fault::deceleration_limit;
  if (!(limits.jerk > 0)) return Fault::jerk_limit;
  return std::nullopt;
}

std::optional<Fault> fault_of(const State& target, const Frame& frame, double sign) {
  const double v = target.velocity;
  const double a = sign * target.acceleration;
  if (exceeds(std::abs(v), frame.speed)) return Fault::target_velocity;
  if (std::isinf(frame.jerk)) return std::nullopt;
  if (exceeds(a, frame.up) || exceeds(-a, frame.down)) return Fault::target_acceleration;
  if (exceeds(std::abs(sign * v - a * std::abs(a) / (2 * frame.jerk)), frame.speed)) {
    return Fault::target_not_entered;
  }
  return std::nullopt;
}

// Whether the first of these that is not zero is negative.
bool negative(std::initializer_list<double> values) {
  for (const double value : values) {
    if (value != 0) return value < 0;
  }
  return false;
}

Motion seen(const State& state, double sign, double jerk) {
  return {sign * state.velocity, std::isinf(jerk) ? 0 : sign * state.acceleration};
}

void finish(tl::expected<Trajectory, Fault>& plan, const State& end) {
  plan->finish(end);
  if (!std::isfinite(plan->duration()) || !finite(end)) plan = tl::unexpected(Fault::magnitude);
}

}  // namespace

State Trajectory::at(double t) const {
  if (t < 0) return start_;
  if (!(t < duration_)) return end_;
  std::size_t i = 0;
  while (i + 1 < count_ && t >= phases_[i + 1].begin) ++i;
  auto state = phases_[i].after(t - phases_[i].begin);
  state.position += start_.position;
  return state;
}

void Trajectory::append(double duration, double acceleration, double jerk) {
  if (!(duration > 0)) return;
  ensure(count_ < most_phases);
  auto state = reached();
  state.acceleration = acceleration;
  phases_[count_++] = {duration_, duration, state, jerk};
  duration_ += duration;
}

State Trajectory::reached() const {
  if (count_ == 0) return {0, start_.velocity, start_.acceleration};
  const auto& last = phases_[count_ - 1];
  return last.after(last.duration);
}

tl::expected<Trajectory, Fault> plan_move(const State& start, const State& target,
                                          const Limits& limits) {
  if (const auto fault = fault_of(limits)) return tl::unexpected(*fault);
  if (!finite(start)) return tl::unexpected(Fault::start);
  if (!finite(target)) return tl::unexpected(Fault::target);
  const double distance = target.position - start.position;
  const bool mirrored = negative({distance, target.velocity, start.velocity, start.acceleration});
  const double sign = mirrored ? -1 : 1;
  const Frame frame{limits.velocity, limits.acceleration, limits.deceleration, limits.jerk};
  if (const auto fault = fault_of(target, frame, sign)) return tl::unexpected(*fault);

  tl::expected<Trajectory, Fault> plan(tl::in_place, start);
  Draft draft(*plan, seen(start, sign, limits.jerk).acceleration, frame, mirrored);
  const auto to = seen(target, sign, limits.jerk);
  const double slack = unnoticed * (std::abs(start.position) + std::abs(target.position));
  if (std::isinf(limits.jerk)) {
    trapezoid(draft, to.velocity, sign * distance, slack);
  } else {
    move_with_jerk(draft, to, sign * distance, slack);
  }
  finish(plan, target);
  return plan;
}

tl::expected<Trajectory, Fault> plan_velocity(const State& start, double velocity,
                                              const Limits& limits) {
  if (const auto fault = fault_of(limits)) return tl::unexpected(*fault);
  if (!finite(start)) return tl::unexpected(Fault::start);
  if (!std::isfinite(velocity)) return tl::unexpected(Fault::target);
  const bool mirrored = negative({start.velocity, velocity, start.acceleration});
  const double sign = mirrored ? -1 : 1;
  const Frame frame{limits.velocity, limits.acceleration, limits.deceleration, limits.jerk};
  if (exceeds(std::abs(velocity), limits.velocity)) return tl::unexpected(Fault::target_velocity);

  tl::expected<Trajectory, Fault> plan(tl::in_place, start);
  Draft draft(*plan, seen(start, sign, limits.jerk).acceleration, frame, mirrored);
  if (std::isinf(limits.jerk)) {
    change_speed(draft, sign * (velocity - start.velocity));
  } else {
    change_speed_with_jerk(draft, sign * velocity);
  }
  finish(plan, {start.position + plan->reached().position, velocity, 0});
  return plan;
}

std::string_view describe(Fault fault) {
  switch (fault) {
    case Fault::velocity_limit:
      return "the limit of velocity must be greater than zero, and finite";
    case Fault::acceleration_limit:
      return "the limit of acceleration must be greater than zero, and finite";
    case Fault::deceleration_limit:
      return "the limit of deceleration must be greater than zero, and finite";
    case Fault::jerk_limit:
      return "the limit of jerk must be greater than zero; infinite makes trapezoids";
    case Fault::start: return "the start must have a finite position, velocity and acceleration";
    case Fault::target: return "the target must have a finite position, velocity and acceleration";
    case Fault::target_velocity: return "the velocity of the target is beyond its limit";
    case Fault::target_acceleration:
      return "the acceleration of the target is beyond its limit: that of acceleration in the "
             "direction of the movement, that of deceleration against it";
    case Fault::target_not_entered:
      return "the target cannot be entered: at the greatest jerk its acceleration is built up from "
             "a velocity beyond the limit";
    case Fault::magnitude: return "the movement is too long for a double";
  }
  return "unknown";
}

}  // namespace tmcl::plan
