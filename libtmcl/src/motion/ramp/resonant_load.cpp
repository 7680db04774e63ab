#include "tmcl/ramp/resonant_load.hpp"

#include <cmath>
#include <numbers>

#include "tmcl/ensure.hpp"

namespace tmcl::ramp {

ResonantLoad::ResonantLoad(Resonance resonance)
    : natural_(2 * std::numbers::pi * resonance.frequency_hz) {
  const auto damping = resonance.damping;
  ensure(natural_ > 0 && damping >= 0 && damping < 1);
  decay_ = damping * natural_;
  swinging_ = natural_ * std::sqrt(1 - damping * damping);
}

void ResonantLoad::advance(double seconds, double acceleration, double jerk) {
  // It swings freely around what would not swing at all: (2 d w jerk - w^2 (a + jerk t)) / w^4.
  const double square = natural_ * natural_;
  const double rest = -acceleration / square + 2 * decay_ * jerk / (square * square);
  const double rest_speed = -jerk / square;
  const double away = offset_ - rest;
  const double faster = speed_ - rest_speed;
  const double shrunk = std::exp(-decay_ * seconds);
  const double cosine = std::cos(swinging_ * seconds);
  const double sine = std::sin(swinging_ * seconds) / swinging_;
  offset_ =
      rest + rest_speed * seconds + shrunk * (away * cosine + (faster + decay_ * away) * sine);
  speed_ = rest_speed + shrunk * (faster * cosine - (decay_ * faster + square * away) * sine);
}

double ResonantLoad::swing() const {
  return std::hypot(offset_, (speed_ + decay_ * offset_) / swinging_);
}

std::optional<double> ResonantLoad::time_to_settle(double tolerance) const {
  const double now = swing();
  if (now <= tolerance) return 0;
  if (decay_ == 0 || tolerance <= 0) return std::nullopt;
  return std::log(now / tolerance) / decay_;
}

}  // namespace tmcl::ramp
