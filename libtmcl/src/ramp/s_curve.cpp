#include "ramp/s_curve.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/root.hpp"

namespace tmcl::ramp {
namespace {

using Force = Course::Force;

// Puts stretches one after another and knows where they lead. It may look at things from the other
// side, so that what it has to do is always to go forward.
class Draft {
 public:
  Draft(Moving from, const Forces& forces, Profile& profile)
      : forces_(&forces),
        profile_(&profile),
        per_jerk_(1 / forces.jerk),
        v_(from.velocity),
        a_(std::isinf(forces.jerk) ? 0 : from.acceleration) {}

  // A copy that writes nothing down.
  Draft trial() const {
    auto copy = *this;
    copy.profile_ = nullptr;
    return copy;
  }

  const Forces& forces() const { return *forces_; }
  double distance() const { return x_; }
  double velocity() const { return v_; }
  double acceleration() const { return a_; }
  // The velocity to which it comes if the acceleration is taken back at once.
  double eventual_velocity() const { return v_ + a_ * std::abs(a_) / 2 * per_jerk_; }

  void mirror() {
    x_ = -x_;
    v_ = -v_;
    a_ = -a_;
    mirrored_ = !mirrored_;
  }

  void jerk_to(double acceleration) {
    const double change = acceleration - a_;
    const double t = std::abs(change) * per_jerk_;
    advance({Force::jerk, change < 0}, t, std::copysign(forces_->jerk, change));
    a_ = acceleration;
  }

  void coast(double distance) {
    if (distance > 0) advance({Force::none, false}, distance / v_, 0);
  }

  // To a velocity and no acceleration.
  void change_to(double velocity) {
    const double reached = approach(velocity);
    jerk_to(0);
    v_ = reached;
  }

  // The same up to the last stretch, in which the acceleration is taken back. Tells which velocity
  // that leads to.
  double approach(double velocity) {
    if (velocity >= eventual_velocity()) return rise_to(velocity);
    mirror();
    const double reached = rise_to(-velocity);
    mirror();
    return -reached;
  }

  void finish(bool arrives) {
    profile_->arrives = arrives;
    profile_->end_velocity = mirrored_ ? -v_ : v_;
  }

 private:
  void advance(Course course, double t, double jerk) {
    if (!(t > 0)) return;
    if (profile_ != nullptr) {
      course.negative ^= mirrored_;
      profile_->append(course, t);
    }
    x_ += t * (v_ + t * (a_ / 2 + t * jerk / 6));
    v_ += t * (a_ + t * jerk / 2);
  }

  double rise_to(double velocity) {
    const double eventual = eventual_velocity();
    if (eventual < 0 && forces_->deceleration == 0) {
      velocity = eventual;
    } else if (velocity > 0 && forces_->acceleration == 0) {
      velocity = std::max(eventual, 0.0);
    }
    if (a_ < 0) jerk_to(0);
    if (v_ < 0 && velocity > 0 && turn(velocity)) return velocity;
    rise(v_ < 0 ? Force::deceleration : Force::acceleration, velocity, 0);
    return velocity;
  }

  // To standstill on the way to this velocity, with as much acceleration as may be. True if that
  // needs only to be taken back.
  bool turn(double velocity) {
    const double least = std::sqrt(std::max(0.0, a_ * a_ + 2 * forces_->jerk * v_));
    const double most = std::sqrt(a_ * a_ - 2 * forces_->jerk * v_);
    const double enough = std::sqrt(2 * forces_->jerk * velocity);
    const double limit = std::min(forces_->acceleration, forces_->deceleration);
    const double acceleration = std::max(least, std::min({most, enough, limit}));
    if (acceleration < most) rise(Force::deceleration, 0, acceleration);
    jerk_to(acceleration);
    v_ = 0;
    return acceleration >= enough;
  }

  // To where a last jerk brings it to this velocity and acceleration at once.
  void rise(Force force, double velocity, double acceleration) {
    const double limit =
        force == Force::acceleration ? forces_->acceleration : forces_->deceleration;
    if (acceleration > limit) return;
    const double first = a_ * a_;
    const double last = acceleration * acceleration;
    const double gain = velocity - v_;
    const double peak =
        gain > 0 ? std::sqrt(std::max({first, last, forces_->jerk * gain + (first + last) / 2}))
                 : std::max(a_, acceleration);
    jerk_to(std::min(peak, limit));
    if (peak < limit || limit == 0) return;
    const double last_gain = (limit * limit - last) / 2 * per_jerk_;
    advance({force, false}, (velocity - v_ - last_gain) / limit, 0);
  }

  const Forces* forces_;
  Profile* profile_;
  double per_jerk_;
  bool mirrored_ = false;
  double x_ = 0;
  double v_;
  double a_;
};

// Speeds up to `velocity`, keeps it for `distance`, and stops.
void go_through(Draft& draft, double velocity, double distance) {
  draft.change_to(velocity);
  draft.coast(distance);
  draft.change_to(0);
}

double distance_through(Draft draft, double velocity) {
  go_through(draft, velocity, 0);
  return draft.distance();
}

// Takes the deceleration back to `acceleration` before it stops.
void stop_later(Draft& draft, double acceleration) {
  draft.jerk_to(acceleration);
  draft.change_to(0);
}

double distance_later(Draft draft, double acceleration) {
  stop_later(draft, acceleration);
  return draft.distance();
}

// The velocity at the middle of a movement from rest to rest without constant velocity. Nothing if
// only one of its two sides reaches its limit of acceleration.
std::optional<double> closed_form(double distance, const Forces& forces) {
  const auto [lesser, greater] = std::minmax(forces.acceleration, forces.deceleration);
  const double jerks = (forces.acceleration + forces.deceleration) / forces.jerk;
  const double slopes = 1 / forces.acceleration + 1 / forces.deceleration;
  const double v = 4 * distance / (std::sqrt(jerks * jerks + 8 * slopes * distance) + jerks);
  if (v >= greater * greater / forces.jerk) return v;
  const double slower = std::cbrt(distance * distance * forces.jerk / 4);
  if (slower <= lesser * lesser / forces.jerk) return slower;
  return std::nullopt;
}

// Forward, with a target that lies beyond the place where it would stop at once.
void reach(Draft& draft, double distance, double fastest) {
  const auto trial = draft.trial();
  const auto missed_with = [&](double v) {
    return Point{v, distance_through(trial, v) - distance};
  };
  const auto high = missed_with(fastest);
  if (high.y <= 0) return go_through(draft, fastest, -high.y);

  const double eventual = trial.eventual_velocity();
  if (trial.velocity() == 0 && trial.acceleration() == 0) {
    if (const auto v = closed_form(distance, draft.forces())) return go_through(draft, *v, 0);
  }
  const auto low = missed_with(std::max(eventual, 0.0));
  const double braking = trial.acceleration();
  if (braking < 0 && eventual >= 0 && low.y > 0) {
    const auto miss = [&](double a) { return distance_later(trial, a) - distance; };
    return stop_later(draft, root(miss, {braking, miss(braking)}, {0, low.y}));
  }
  // The distance grows about with the square of the velocity; its root makes that a straight line.
  const double wanted = std::sqrt(-low.y);
  const auto miss = [&](double v) {
    return std::sqrt(std::max(0.0, missed_with(v).y - low.y)) - wanted;
  };
  const Point least{low.x, -wanted};
  const Point most{high.x, std::sqrt(high.y - low.y) - wanted};
  go_through(draft, low.y < 0 ? root(miss, least, most) : low.x, 0);
}

}  // namespace

Profile plan_velocity(Moving from, double velocity, const Forces& forces) {
  Profile profile;
  Draft draft(from, forces, profile);
  draft.change_to(velocity);
  draft.finish(false);
  return profile;
}

Profile plan_move(Moving from, double distance, Speeds limits, const Forces& forces) {
  Profile profile;
  Draft draft(from, forces, profile);
  auto stop = draft.trial();
  stop.change_to(0);
  const double gap = distance - stop.distance();
  const bool stops = stop.velocity() == 0;
  const bool stops_there = stops && std::abs(gap) <= unseen;

  if (gap < 0) draft.mirror();
  const double limit = gap < 0 ? limits.backward : limits.forward;
  const double eventual = draft.eventual_velocity();
  const double fastest = forces.acceleration > 0 ? limit : std::min(limit, eventual);
  if (!stops || stops_there || forces.deceleration <= 0 || fastest <= 0) {
    draft.change_to(0);
    draft.finish(stops_there);
    return profile;
  }
  if (eventual > fastest) draft.approach(fastest);
  reach(draft, gap < 0 ? -distance : distance, std::max(fastest, draft.eventual_velocity()));
  draft.finish(true);
  return profile;
}

}  // namespace tmcl::ramp
