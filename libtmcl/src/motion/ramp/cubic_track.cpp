#include "tmcl/ramp/cubic_track.hpp"

#include <cmath>
#include <numeric>

namespace tmcl::ramp {
namespace {

int sign(Fixed value) {
  const auto number = static_cast<SignedFixed>(value);
  return (number > 0) - (number < 0);
}

// A number of ticks that may be anything from 0 to infinity.
Tick later(Tick now, double ticks) {
  constexpr double too_far = 0x1p63;
  if (ticks >= too_far || now >= forever / 2) return forever;
  return now + static_cast<Tick>(ticks);
}

}  // namespace

Fixed to_fixed(double microsteps) {
  return static_cast<Fixed>(static_cast<SignedFixed>(std::rint(microsteps * 0x1p96)));
}

double to_double(Fixed value) {
  return static_cast<double>(static_cast<SignedFixed>(value)) * 0x1p-96;
}

double Profile::duration() const {
  return std::accumulate(ticks.begin(), ticks.begin() + count, 0.0);
}

void CubicTrack::begin(const Profile& profile, double acceleration, const Forces& forces, Tick now,
                       std::int32_t target) {
  start_ = at(now);
  start_.h = to_fixed(acceleration / 2);
  from_ = until_ = now;
  profile_ = profile;
  index_ = 0;
  enter(0, forces, target);
}

// Within the tick in which one stretch ends and another begins, floating point is exact enough: it
// is no long way.
void CubicTrack::next(const Forces& forces, std::int32_t target) {
  const double ticks = profile_.ticks[index_];
  const double left = std::ceil(ticks) - ticks;
  start_ = at(until_ - 1);
  from_ = until_;
  move_within_tick(1 - left);
  ++index_;
  enter(left, forces, target);
}

// Runs through what remains of the tick before from_, and begins the stretch that goes beyond it.
void CubicTrack::enter(double left, const Forces& forces, std::int32_t target) {
  for (; index_ < profile_.count; ++index_) {
    auto& ticks = profile_.ticks[index_];
    apply(profile_.courses[index_], forces);
    if (ticks > left) {
      move_within_tick(left);
      ticks -= left;
      until_ = later(from_, std::ceil(ticks));
      return;
    }
    move_within_tick(ticks);
    left -= ticks;
  }
  finish(left, target);
}

void CubicTrack::finish(double left, std::int32_t target) {
  until_ = forever;
  if (profile_.arrives) {
    start_ = {.x = to_fixed(target)};
  } else {
    start_ = {.x = start_.x, .v = to_fixed(profile_.end_velocity)};
    move_within_tick(left);
  }
}

void CubicTrack::move_within_tick(double fraction) {
  const double v = to_double(start_.v);
  const double h = to_double(start_.h);
  const double i = to_double(start_.i);
  start_.x += to_fixed(fraction * (v + fraction * (h + fraction * i)));
  start_.v += to_fixed(fraction * (2 * h + 3 * fraction * i));
  start_.h += to_fixed(3 * fraction * i);
}

void CubicTrack::apply(Course course, const Forces& forces) {
  const double direction = course.negative ? -1 : 1;
  start_.i = 0;
  switch (course.force) {
    case Course::Force::none: start_.h = 0; break;
    case Course::Force::acceleration:
      start_.h = to_fixed(direction * forces.acceleration / 2);
      break;
    case Course::Force::deceleration:
      start_.h = to_fixed(direction * forces.deceleration / 2);
      break;
    default: start_.i = to_fixed(direction * forces.bows.of(course.force) / 6); break;
  }
}

void CubicTrack::coast(Tick now, Fixed velocity) {
  start_ = {.x = at(now).x, .v = velocity};
  from_ = now;
  until_ = forever;
  profile_ = {};
  index_ = 0;
}

void CubicTrack::place(std::int32_t position, Tick now) {
  start_.x += to_fixed(position) - at(now).x;
}

void CubicTrack::skip(Tick ticks, Fixed distance) {
  start_.x += distance;
  from_ += ticks;
  if (until_ != forever) until_ += ticks;
}

Part CubicTrack::part() const {
  if (over() && start_.v == 0) return Part::rest;
  // In the middle of what is left of the stretch, which may end before the next tick.
  const double half = until_ == forever ? 0 : profile_.ticks[index_] / 2;
  const double h = to_double(start_.h) + 3 * half * to_double(start_.i);
  const double v = to_double(start_.v) + half * (to_double(start_.h) + h);
  const int direction = v < 0 ? -1 : 1;
  const int acceleration = direction * ((h > 0) - (h < 0));
  const int jerk = direction * sign(start_.i);
  if (acceleration > 0) return jerk > 0 ? Part::i : jerk < 0 ? Part::iii : Part::ii;
  if (acceleration < 0) return jerk > 0 ? Part::vii : jerk < 0 ? Part::v : Part::vi;
  return Part::iv;
}

}  // namespace tmcl::ramp
