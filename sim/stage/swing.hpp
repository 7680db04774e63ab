/// A load that swings behind its motor, whenever it is looked at. Between two times at which it is
/// kept the speed of the motor changes evenly.
#pragma once

#include "tmcl/clock.hpp"
#include "tmcl/ramp/resonant_load.hpp"

namespace tmcl::sim {

class Swing {
 public:
  explicit Swing(ramp::Resonance resonance);

  /// By now the motor has come to this speed. Looking changes nothing that is kept.
  void look(TimePoint now, double speed) {
    now_ = now;
    speed_ = speed;
  }
  /// How far the load is from where the motor is.
  double offset() const { return present().offset(); }
  /// From here on the speed may change otherwise; to `speed` at once.
  void keep(double speed);
  /// How soon it is to be kept again while the speed may change in a curve.
  Duration piece() const { return piece_; }

 private:
  ramp::ResonantLoad present() const;

  Duration piece_;
  ramp::ResonantLoad kept_;
  TimePoint kept_at_{};
  double kept_speed_ = 0;  ///< Of the motor, then.
  TimePoint now_{};
  double speed_ = 0;
};

}  // namespace tmcl::sim
