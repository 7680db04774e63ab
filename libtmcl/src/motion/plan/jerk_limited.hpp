/// The fastest movement with a limited jerk from one motion to another that far away.
#pragma once

#include <array>
#include <numeric>

namespace tmcl::plan::jerk_limited {

/// In relation to the numbers that it comes from, a difference as small as that is none. A movement
/// may be planned again on its way, from a state that is off by its last bits; where the target
/// moves that must not make a detour of it.
constexpr double unnoticed = 1e-12;

struct Motion {
  double velocity;
  double acceleration;
};

/// Seen from one side: `up` limits the acceleration, `down` its opposite.
struct Frame {
  double speed;
  double up;
  double down;
  double jerk;
  double per_jerk = 1 / jerk;

  Frame mirrored() const { return {speed, down, up, jerk, per_jerk}; }
};

/// How one velocity is left and another one reached: the acceleration rises (or falls), is kept at
/// its limit, and falls (or rises).
struct Change {
  double first;
  double kept;
  double last;
  double peak;
};

/// `from` and `to` are not beyond the limits of `frame`.
Change rise(Motion from, Motion to, const Frame& frame);
Change fall(Motion from, Motion to, const Frame& frame);
/// Whether the acceleration must rise first, rather than fall, on the fastest way to `to`. If it
/// only must go straight to that of `to`, it does not pass zero for nothing.
bool rises_first(Motion from, Motion to, double jerk);

/// An S-curve with the parts of most of them: jerk, acceleration, jerk, constant velocity, jerk,
/// deceleration, jerk.
struct Route {
  std::array<double, 7> times{};
  bool mirrored = false;
  bool reversed = false;

  double duration() const { return std::accumulate(times.begin(), times.end(), 0.0); }
};

/// Within the limits, from a motion that can be kept in them. To be off by `slack` is to be there.
Route fastest_route(Motion from, Motion to, const Frame& frame, double distance, double slack);

}  // namespace tmcl::plan::jerk_limited
