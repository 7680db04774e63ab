#include "motion/ramp/s_curve.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/root.hpp"

namespace tmcl::ramp {
namespace {

using Force = Course::Force;
constexpr double unlimited = std::numeric_limits<double>::infinity();

// 1 / (2 bow): the velocity that it takes to build up an acceleration is that times its square.
double half_inverse(double bow) { return 1 / (2 * bow); }

// Puts stretches one after another and knows where they lead. It may look at things from the other
// side, so that what it has to do is always to go forward.
class Draft {
 public:
  Draft(Moving from, const Forces& forces, Profile& profile)
      : forces_(&forces),
        profile_(&profile),
        half1_(half_inverse(forces.bows.first)),
        half2_(half_inverse(forces.bows.second)),
        half3_(half_inverse(forces.bows.third)),
        half4_(half_inverse(forces.bows.fourth)),
        v_(from.velocity),
        a_(forces.bows == Bows{unlimited} ? 0 : from.acceleration) {}

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

  // The velocity to which it comes if the acceleration is taken back at once. Where the speed
  // passes zero meanwhile, it falls before and grows after that.
  double eventual_velocity() const {
    const double along = a_ < 0 ? -v_ : v_;
    const double squared = a_ * a_;
    double eventual = along + squared * (along < 0 ? half4_ : half2_);
    if (along < 0 && eventual > 0 && !goes_through_zero()) {
      eventual = (squared + along / half4_) * half2_;
    }
    return a_ < 0 ? -eventual : eventual;
  }

  void mirror() {
    x_ = -x_;
    v_ = -v_;
    a_ = -a_;
    mirrored_ = !mirrored_;
  }

  void jerk_to(Force bow, double acceleration) {
    const double change = acceleration - a_;
    const double jerk = forces_->bows.of(bow);
    advance({bow, change < 0}, std::abs(change) / jerk, std::copysign(jerk, change));
    a_ = acceleration;
  }

  void coast(double distance) {
    if (distance > 0) advance({Force::none, false}, distance / v_, 0);
  }

  // To a velocity and no acceleration.
  void change_to(double velocity) {
    const double reached = approach(velocity);
    jerk_to(last_bow_, 0);
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
  // Of a movement that turns round: it does not stand meanwhile.
  bool goes_through_zero() const { return forces_->bows.second == forces_->bows.fourth; }

  void advance(Course course, double t, double jerk) {
    if (!(t > 0)) return;
    if (profile_ != nullptr) {
      course.negative = course.negative != mirrored_;
      profile_->append(course, t);
    }
    x_ += t * (v_ + t * (a_ / 2 + t * jerk / 6));
    v_ += t * (a_ + t * jerk / 2);
  }

  // Takes an acceleration back.
  void relax() {
    if (v_ * a_ < 0 && !goes_through_zero()) relax_to_standstill();
    jerk_to(v_ * a_ < 0 ? Force::bow4 : Force::bow2, 0);
  }

  // As far as it comes to that.
  void relax_to_standstill() {
    constexpr double imprecision = 1e-12;
    const double squared = a_ * a_;
    const double left = squared - std::abs(v_) / half4_;
    if (left <= imprecision * squared) return;
    jerk_to(Force::bow4, std::copysign(std::sqrt(left), a_));
    v_ = 0;
  }

  double rise_to(double velocity) {
    const double eventual = eventual_velocity();
    if (eventual < 0 && forces_->deceleration == 0) {
      velocity = eventual;
    } else if (velocity > 0 && forces_->acceleration == 0) {
      velocity = std::max(eventual, 0.0);
    }
    if (a_ < 0) relax();
    if (v_ < 0 && velocity > 0) {
      if (!goes_through_zero()) {
        stop();
      } else if (turn(velocity)) {
        return velocity;
      }
    }
    rise(v_ < 0 ? Force::deceleration : Force::acceleration, velocity, 0);
    return velocity;
  }

  // Comes to stand, with as much acceleration as cannot be taken back until then.
  void stop() {
    relax_to_standstill();
    if (v_ < 0) {
      rise(Force::deceleration, 0, 0);
      jerk_to(Force::bow4, 0);
    }
    v_ = 0;
  }

  // To standstill on the way to this velocity, with as much acceleration as may be. True if that
  // needs only to be taken back.
  bool turn(double velocity) {
    const double least = std::sqrt(std::max(0.0, a_ * a_ + v_ / half4_));
    const double most = std::sqrt(a_ * a_ - v_ / half3_);
    const double enough = std::sqrt(velocity / half2_);
    const double limit = std::min(forces_->acceleration, forces_->deceleration);
    const double acceleration = std::max(least, std::min({most, enough, limit}));
    if (acceleration < most) rise(Force::deceleration, 0, acceleration);
    jerk_to(acceleration < a_ ? Force::bow4 : Force::bow3, acceleration);
    v_ = 0;
    last_bow_ = Force::bow2;
    return acceleration >= enough;
  }

  // To where a last jerk brings it to this velocity and acceleration at once.
  void rise(Force force, double velocity, double acceleration) {
    const bool grows = force == Force::acceleration;
    const double limit = grows ? forces_->acceleration : forces_->deceleration;
    last_bow_ = grows ? Force::bow2 : Force::bow4;
    if (acceleration > limit) return;
    const double up = grows ? half1_ : half3_;
    const double down = grows ? half2_ : half4_;
    const double first = a_ * a_;
    const double last = acceleration * acceleration;
    const double gain = velocity - v_;
    const double peak =
        gain > 0
            ? std::sqrt(std::max({first, last, (gain + first * up + last * down) / (up + down)}))
            : std::max(a_, acceleration);
    const double highest = std::min(peak, limit);
    jerk_to(highest < a_ ? last_bow_ : grows ? Force::bow1 : Force::bow3, highest);
    if (peak < limit || limit == 0) return;
    const double last_gain = (limit * limit - last) * down;
    advance({force, false}, (velocity - v_ - last_gain) / limit, 0);
  }

  const Forces* forces_;
  Profile* profile_;
  double half1_;
  double half2_;
  double half3_;
  double half4_;
  bool mirrored_ = false;
  Force last_bow_ = Force::bow2;  // that takes the acceleration back at last
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
  draft.jerk_to(Force::bow4, acceleration);
  draft.change_to(0);
}

double distance_later(Draft draft, double acceleration) {
  stop_later(draft, acceleration);
  return draft.distance();
}

// The velocity at the middle of a movement from rest to rest without constant velocity. Nothing if
// only one of its two sides reaches its limit of acceleration, or if the bows differ.
std::optional<double> closed_form(double distance, const Forces& forces) {
  const double jerk = forces.bows.first;
  if (!(forces.bows == Bows{jerk})) return std::nullopt;
  const auto [lesser, greater] = std::minmax(forces.acceleration, forces.deceleration);
  const double jerks = (forces.acceleration + forces.deceleration) / jerk;
  const double slopes = 1 / forces.acceleration + 1 / forces.deceleration;
  const double v = 4 * distance / (std::sqrt(jerks * jerks + 8 * slopes * distance) + jerks);
  if (v >= greater * greater / jerk) return v;
  const double slower = std::cbrt(distance * distance * jerk / 4);
  if (slower <= lesser * lesser / jerk) return slower;
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

double eventual_velocity(Moving from, const Forces& forces) {
  Profile nowhere;
  return Draft(from, forces, nowhere).eventual_velocity();
}

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
