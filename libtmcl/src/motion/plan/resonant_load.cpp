#include "tmcl/plan/resonant_load.hpp"

#include <cmath>
#include <numbers>

#include "tmcl/ensure.hpp"

namespace tmcl::plan {

ResonantLoad::ResonantLoad(Resonance resonance)
    : natural_(2 * std::numbers::pi * resonance.frequency_hz) {
  const auto damping = resonance.damping;
  ensure(natural_ > 0 && damping >= 0 && damping < 1);
  decay_ = damping * natural_;
  swinging_ = natural_ * std::sqrt(1 - damping * damping);
}

void ResonantLoad::advance(double seconds, double acceleration) {
  // Around the place where it would come to rest it swings freely.
  const double rest = -acceleration / (natural_ * natural_);
  const double away = offset_ - rest;
  const double shrunk = std::exp(-decay_ * seconds);
  const double cosine = std::cos(swinging_ * seconds);
  const double sine = std::sin(swinging_ * seconds) / swinging_;
  offset_ = rest + shrunk * (away * cosine + (speed_ + decay_ * away) * sine);
  speed_ = shrunk * (speed_ * cosine - (decay_ * speed_ + natural_ * natural_ * away) * sine);
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

}  // namespace tmcl::plan
