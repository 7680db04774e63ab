/// A load behind a motor that it is not rigidly joined to: it comes later, and swings.
///
///     r'' + 2 d w r' + w^2 r = -a,   w = 2 pi f
///
/// r is where the load is less where the motor is, a the acceleration of the motor, d the damping:
/// the oscillator that every text on vibrations has. Solved exactly while a changes evenly.
#pragma once

#include <optional>

namespace tmcl::ramp {

struct Resonance {
  double frequency_hz = 0;  ///< Without damping; greater than 0.
  double damping = 0;       ///< 0 to less than 1, where nothing would swing.
};
// What users can say of one.
constexpr double least_resonance_hz = 0.01;
constexpr double greatest_resonance_hz = 1e5;
constexpr double greatest_load_damping = 0.999;
constexpr double usual_load_damping = 0.05;

class ResonantLoad {
 public:
  explicit ResonantLoad(Resonance resonance);

  /// Lets time pass in which the motor accelerates so at first, and the acceleration changes by
  /// `jerk` a second. Seconds, and any length.
  void advance(double seconds, double acceleration, double jerk = 0);
  /// The speed of the motor changes by so much at once; that of the load does not.
  void jump(double speed) { speed_ -= speed; }

  /// Where the load is less where the motor is, and how fast it is less how fast the motor is.
  double offset() const { return offset_; }
  double speed() const { return speed_; }

  /// How far the load swings to either side from now on, if the motor does not accelerate.
  double swing() const;
  /// How long until it swings by no more than that; nothing if it never does.
  std::optional<double> time_to_settle(double tolerance) const;

 private:
  double decay_;     ///< d w
  double natural_;   ///< w
  double swinging_;  ///< With which it really swings.
  double offset_ = 0;
  double speed_ = 0;
};

}  // namespace tmcl::ramp
