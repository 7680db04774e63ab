/// What couples a motor to its stage: microsteps become a way, and ways become microsteps.
#pragma once

#include <cstdint>

#include "sim/module/motor.hpp"
#include "sim/stage/stage.hpp"

namespace tmcl::sim {

class Coupling {
 public:
  /// Both outlive the coupling.
  Coupling(Motor& motor, Stage& stage) : motor_(&motor), stage_(&stage), seen_(motor.position()) {}

  const Stage& stage() const { return *stage_; }

  /// Time has passed: the stage goes where the motor went.
  void follow(TimePoint now);
  /// The motor's position was only called another one.
  void rebase() { seen_ = motor_->position(); }
  /// The motor may speed up or slow down otherwise from here on, and a load that swings with it.
  /// Gives back how soon that has to be done again while the motor moves.
  Duration keep_swing();
  bool swings() const { return stage_->swing() != nullptr; }

  /// So many microsteps of the motor are a full step, as an exponent of two.
  void set_resolution(std::int32_t exponent) { exponent_ = exponent; }
  void reverse(bool reversed) { reversed_ = reversed; }

  /// The rotor does not follow the motor's field, and the stage not either.
  void let_slip(bool slips) { slips_ = slips; }
  /// What pulls at a rotor that slips takes the stage with it.
  void slide(Place way) { stage_->move(way); }

  /// The stage does not follow where the motor turns.
  bool is_held() const { return slips_ || stage_->holds(direction()); }
  /// It would not follow in one direction at least, or not at once: to turn round changes that,
  /// without any way.
  bool is_at_end() const {
    return slips_ || stage_->holds(-1) || stage_->holds(1) || stage_->settings().backlash != 0;
  }
  /// In microsteps of the motor and its directions: how far it can go before something about the
  /// stage changes.
  Reach reach() const;
  Reach reach_of_encoder() const { return in_microsteps(stage_->encoder_reach()); }
  /// How far the encoder counts when the motor makes `microsteps()` microsteps.
  std::int64_t counts() const;
  std::int64_t microsteps() const;
  /// On the stage: 1 up, -1 down, 0 at rest.
  int direction() const { return on_stage(motor_->heading()); }
  /// In full steps per second.
  std::int64_t speed() const { return motor_->speed() >> exponent_; }
  /// In 1/256 of that.
  std::int64_t fine_speed() const { return motor_->speed() << (finest - exponent_); }

 private:
  // Ways on the stage are counted as finely as a microstep can be.
  static constexpr std::int32_t finest = 8;

  int on_stage(int direction) const { return reversed_ ? -direction : direction; }
  Reach in_microsteps(Reach reach) const;
  /// Of the stage, in places a second.
  double stage_speed() const;

  Motor* motor_;
  Stage* stage_;
  std::int32_t seen_;
  std::int32_t exponent_ = finest;
  bool reversed_ = false;
  bool slips_ = false;
};

}  // namespace tmcl::sim
