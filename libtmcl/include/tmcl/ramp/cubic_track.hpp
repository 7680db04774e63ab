/// Movements with piecewise constant jerk, sampled at the ticks of a generator; what the
/// generators with S-shaped ramps share.
///
/// A Profile says for how long which force acts; its boundaries may lie between two ticks. A
/// CubicTrack runs through it in integers: within a stretch every tick is a few exact additions,
/// and any number of ticks at once is the same in closed form.
#pragma once

#include <array>
#include <cstdint>

#include "tmcl/ensure.hpp"
#include "tmcl/ramp/generator.hpp"

namespace tmcl::ramp {

/// Microsteps with 96 bits of fraction, in two's complement; they wrap as a 32-bit position does.
/// A jerk that lasts k ticks is off by at most 2^-97 k^3 microsteps: 2^-14 after the longest that
/// there is, 2^27.5 ticks. What it does to the velocity lasts until the end of the movement; within
/// 2^32 microsteps that makes less than 2^-10. A movement that ends on its target makes up for it
/// with its last tick.
__extension__ typedef unsigned __int128 Fixed;
__extension__ typedef __int128 SignedFixed;
constexpr int fixed_fraction_bits = 96;

/// The nearest one; the value is less than 2^31.
Fixed to_fixed(double microsteps);
double to_double(Fixed value);
/// In units of 2^-fraction_bits; a half is rounded up.
constexpr std::int64_t rounded(Fixed value, int fraction_bits) {
  const int shift = fixed_fraction_bits - fraction_bits;
  const Fixed half = Fixed{1} << (shift - 1);
  return static_cast<std::int64_t>(static_cast<SignedFixed>(value + half) >> shift);
}

/// A state of motion. With x += v + h + i, v += 2h + 3i, h += 3i at every tick it samples the cubic
/// x + v t + h t^2 + i t^3, so the acceleration is 2h and the jerk 6i.
struct Cubic {
  Fixed x = 0;
  Fixed v = 0;
  Fixed h = 0;
  Fixed i = 0;

  Cubic after(Tick ticks) const {
    const Fixed k = ticks;
    if ((h | i) == 0) return {x + k * v, v, 0, 0};  // the most frequent case, a little faster
    return {x + k * (v + k * (h + k * i)), v + k * (2 * h + 3 * k * i), h + 3 * k * i, i};
  }
  bool operator==(const Cubic&) const = default;
};

/// What acts during a stretch.
struct Course {
  enum class Force : std::uint8_t {
    none,          ///< Constant velocity.
    bow1,          ///< The speed grows, and so does the acceleration...
    bow2,          ///< ... or that falls.
    bow3,          ///< The speed falls, and the deceleration grows...
    bow4,          ///< ... or falls, too.
    acceleration,  ///< The greatest acceleration...
    deceleration,  ///< ... and the greatest deceleration are kept.
  };
  constexpr Course() = default;
  constexpr Course(Force what, bool is_negative) : force(what), negative(is_negative) {}
  bool operator==(const Course&) const = default;

  // One byte: a generator carries a dozen of them.
  Force force : 7 = Force::none;
  bool negative : 1 = false;
};

/// How fast the acceleration may change. Most chips have one jerk for all four.
struct Bows {
  double first;
  double second = first;
  double third = first;
  double fourth = first;

  double of(Course::Force bow) const {
    switch (bow) {
      case Course::Force::bow1: return first;
      case Course::Force::bow2: return second;
      case Course::Force::bow3: return third;
      case Course::Force::bow4: return fourth;
      default: return 0;
    }
  }
  bool operator==(const Bows&) const = default;
};

/// The forces, in microsteps and ticks; none is negative. Infinite bows make trapezoids.
struct Forces {
  double acceleration;  ///< While the speed grows.
  double deceleration;  ///< While it falls.
  Bows bows;
};

/// A movement: one stretch after another, and the velocity at its end.
struct Profile {
  /// Through zero twice takes the most: two until an acceleration is taken back that turns the
  /// motor round, three until it stands, three until its velocity is constant, that stretch, and
  /// three to stop.
  static constexpr std::size_t most = 12;

  std::array<double, most> ticks{};
  std::array<Course, most> courses{};
  std::uint8_t count = 0;
  bool arrives = false;  ///< It ends on its target, at rest.
  double end_velocity = 0;

  void append(Course course, double duration) {
    ensure(count < most);
    ticks[count] = duration;
    courses[count++] = course;
  }
  double duration() const;
  bool operator==(const Profile&) const = default;
};

/// The parts of an S-shaped movement as the data sheets number them, and rest.
enum class Part : std::uint8_t { i, ii, iii, iv, v, vi, vii, rest };

/// A Profile on its way. The caller keeps the time: asks for ticks before until(), and calls next()
/// when that tick has come. A track that is over goes on at constant velocity.
class CubicTrack {
 public:
  /// Lets `profile` begin at this tick, with the position and the velocity that it has then.
  void begin(const Profile& profile, double acceleration, const Forces& forces, Tick now,
             std::int32_t target);
  /// Proceeds to the stretch in which the tick until() lies. The forces and the target are those
  /// of begin().
  void next(const Forces& forces, std::int32_t target);
  /// Stays at this velocity from now on.
  void coast(Tick now, Fixed velocity);
  /// Shifts the whole track so that it is there now.
  void place(std::int32_t position, Tick now);
  /// Lets so many ticks pass, after which it is in the same stretch again but `distance` farther.
  void skip(Tick ticks, Fixed distance);

  Cubic at(Tick tick) const { return start_.after(tick - from_); }
  /// The tick from which the present stretch is counted, the state then, and the first tick that
  /// does not belong to it.
  Tick from() const { return from_; }
  const Cubic& start() const { return start_; }
  Tick until() const { return until_; }
  bool ends_by(Tick tick) const { return until_ <= tick && until_ != forever; }

  bool over() const { return index_ == profile_.count; }
  bool arrived() const { return over() && profile_.arrives; }
  Part part() const;

  bool operator==(const CubicTrack&) const = default;

 private:
  void enter(double left, const Forces& forces, std::int32_t target);
  void move_within_tick(double fraction);
  void apply(Course course, const Forces& forces);
  void finish(double left, std::int32_t target);

  Cubic start_;
  Tick from_ = 0;
  Tick until_ = forever;
  Profile profile_;         // what is left of the present stretch is written into its duration
  std::uint8_t index_ = 0;  // of the present stretch
};

}  // namespace tmcl::ramp
