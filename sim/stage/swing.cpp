#include "sim/stage/swing.hpp"

#include <chrono>
#include <cmath>
#include <numbers>

namespace tmcl::sim {
namespace {

// A curve of the speed is taken for a chord over so much of a swing: less than 1 % off.
constexpr double pieces_of_a_swing = 24;

}  // namespace

Swing::Swing(Resonance resonance)
    : decay_(2 * std::numbers::pi * resonance.frequency_hz * resonance.damping),
      natural_(2 * std::numbers::pi * resonance.frequency_hz),
      swinging_(natural_ * std::sqrt(1 - resonance.damping * resonance.damping)),
      piece_(std::chrono::ceil<Duration>(
          std::chrono::duration<double>(1 / (pieces_of_a_swing * resonance.frequency_hz)))) {}

void Swing::keep(double speed) {
  kept_ = present();
  kept_.speed -= speed - speed_;
  kept_at_ = now_;
  kept_speed_ = speed_ = speed;
}

// Around the place where it would hang back for good under this acceleration.
Swing::State Swing::present() const {
  const double seconds = std::chrono::duration<double>(now_ - kept_at_).count();
  if (seconds <= 0) return kept_;
  const double acceleration = (speed_ - kept_speed_) / seconds;
  const double rest = -acceleration / (natural_ * natural_);
  const double away = kept_.offset - rest;
  const double shrunk = std::exp(-decay_ * seconds);
  const double cosine = shrunk * std::cos(swinging_ * seconds);
  const double sine = shrunk * std::sin(swinging_ * seconds) / swinging_;
  return {rest + away * cosine + (kept_.speed + decay_ * away) * sine,
          kept_.speed * cosine - (natural_ * natural_ * away + decay_ * kept_.speed) * sine};
}

}  // namespace tmcl::sim
