/// A load that is joined to its motor by something that gives: it comes later, and swings.
///
///     r'' + 2 d w r' + w^2 r = -a,   w = 2 pi f
///
/// r is where the load is more than the motor, a the acceleration of the motor. Between two times
/// at which it is kept the speed of the motor changes evenly, and that is solved exactly.
#pragma once

#include "tmcl/clock.hpp"

namespace tmcl::sim {

struct Resonance {
  double frequency_hz = 1;  ///< Without damping; greater than 0.
  double damping = 0.05;    ///< 0 to less than 1, where nothing would swing.
};

class Swing {
 public:
  explicit Swing(Resonance resonance);

  /// By now the motor has come to this speed. Looking changes nothing that is kept.
  void look(TimePoint now, double speed) {
    now_ = now;
    speed_ = speed;
  }
  /// How far the load is from where the motor is.
  double offset() const { return present().offset; }
  /// From here on the speed may change otherwise; to `speed` at once.
  void keep(double speed);
  /// How soon it is to be kept again while the speed may change in a curve.
  Duration piece() const { return piece_; }

 private:
  struct State {
    double offset = 0;
    double speed = 0;
  };
  State present() const;

  double decay_;     ///< d w
  double natural_;   ///< w
  double swinging_;  ///< With which it really swings.
  Duration piece_;
  State kept_;
  TimePoint kept_at_{};
  double kept_speed_ = 0;  ///< Of the motor, then.
  TimePoint now_{};
  double speed_ = 0;
};

}  // namespace tmcl::sim
