#include "sim/stage/swing.hpp"

#include <chrono>

namespace tmcl::sim {
namespace {

// A curve of the speed is taken for a chord over so much of a swing: less than 1 % off.
constexpr double pieces_of_a_swing = 24;

}  // namespace

Swing::Swing(ramp::Resonance resonance)
    : piece_(std::chrono::ceil<Duration>(
          std::chrono::duration<double>(1 / (pieces_of_a_swing * resonance.frequency_hz)))),
      kept_(resonance) {}

void Swing::keep(double speed) {
  kept_ = present();
  kept_.jump(speed - speed_);
  kept_at_ = now_;
  kept_speed_ = speed_ = speed;
}

ramp::ResonantLoad Swing::present() const {
  const double seconds = std::chrono::duration<double>(now_ - kept_at_).count();
  auto load = kept_;
  if (seconds > 0) load.advance(seconds, (speed_ - kept_speed_) / seconds);
  return load;
}

}  // namespace tmcl::sim
