#include "tmcl/plan/trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <optional>

#include "motion/plan/jerk_limited.hpp"
#include "motion/solve/arithmetic.hpp"
#include "tmcl/ensure.hpp"

namespace tmcl::plan {
namespace {

using jerk_limited::Frame;
using jerk_limited::Motion;
using jerk_limited::unnoticed;

constexpr double last_bits = 0x1p-48;

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

  void add(const jerk_limited::Route& route) {
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
  const auto change = above ? jerk_limited::fall(draft.motion(), {frame.speed, 0}, frame)
                            : jerk_limited::rise(draft.motion(), {-frame.speed, 0}, frame);
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
  draft.add(jerk_limited::fastest_route(draft.motion(), to, draft.frame(),
                                        distance - draft.distance(), slack));
}

void change_speed_with_jerk(Draft& draft, double velocity) {
  enter_limits(draft);
  const Motion to{velocity, 0};
  const bool rises = jerk_limited::rises_first(draft.motion(), to, draft.frame().jerk);
  const auto change = rises ? jerk_limited::rise(draft.motion(), to, draft.frame())
                            : jerk_limited::fall(draft.motion(), to, draft.frame());
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
