#include "sim/module/coupling.hpp"

#include <utility>

namespace tmcl::sim {

double Coupling::stage_speed() const {
  if (is_held()) return 0;
  return static_cast<double>(on_stage(motor_->heading()) * motor_->speed()) *
         static_cast<double>(Place{1} << (finest - exponent_));
}

Duration Coupling::keep_swing() {
  auto* swing = stage_->swing();
  swing->keep(stage_speed());
  return swing->piece();
}

void Coupling::follow(TimePoint now) {
  if (stage_->is_bare()) return;
  if (auto* swing = stage_->swing()) swing->look(now, stage_speed());
  const auto position = motor_->position();
  const auto way = way_between(seen_, position, motor_->position_bits());
  seen_ = position;
  if (way == 0 || slips_) return;
  stage_->move((reversed_ ? -way : way) * (Place{1} << (finest - exponent_)));
}

Reach Coupling::in_microsteps(Reach reach) const {
  const auto shorten = [this](Place way) {
    return way == Reach::unlimited ? way : way >> (finest - exponent_);
  };
  const Reach shortened{shorten(reach.back), shorten(reach.ahead)};
  return reversed_ ? Reach{shortened.ahead, shortened.back} : shortened;
}

Reach Coupling::reach() const {
  auto reach = in_microsteps(stage_->reach());
  // What it does not move does not come nearer.
  if (!is_held()) return reach;
  (motor_->heading() < 0 ? reach.back : reach.ahead) = Reach::unlimited;
  return reach;
}

std::int64_t Coupling::counts() const {
  const auto& encoder = stage_->settings().encoder;
  if (!encoder || is_held()) return 0;
  return encoder->backwards == reversed_ ? encoder->counts_per_turn : -encoder->counts_per_turn;
}

std::int64_t Coupling::microsteps() const {
  return std::int64_t{stage_->settings().full_steps_per_turn} << exponent_;
}

}  // namespace tmcl::sim
