#include "tmcl/plan/motor_torque.hpp"

#include <algorithm>
#include <cmath>

namespace tmcl::plan {
namespace {

constexpr double full_torque = 1000;
constexpr double shortest_step_s = 1e-3;
constexpr double most_steps = 5000;

/// The speed of a move, at times that ascend.
class Speedometer {
 public:
  explicit Speedometer(const FollowedMove& move) : move_(move) {}

  double at(double time) {
    const auto& all = move_.stretches;
    while (index_ + 1 < all.size() && time > begin_ + all[index_].seconds) {
      speed_ += gained(all[index_], all[index_].seconds);
      begin_ += all[index_].seconds;
      ++index_;
    }
    if (index_ == all.size()) return 0;
    return speed_ + gained(all[index_], std::clamp(time - begin_, 0.0, all[index_].seconds));
  }

 private:
  static double gained(const MotionStretch& stretch, double seconds) {
    return seconds * (stretch.acceleration + stretch.jerk * seconds / 2);
  }

  const FollowedMove& move_;
  std::size_t index_ = 0;
  double begin_ = 0;
  double speed_ = 0;
};

double duration_of(const FollowedMove& move) {
  double seconds = 0;
  for (const auto& stretch : move.stretches) seconds += stretch.seconds;
  return seconds;
}

}  // namespace

double MotorTorque::asked(double speed, double acceleration) const {
  return std::abs(load + load_per_velocity * speed / 1e3 + inertia * acceleration / 1e6);
}

double MotorTorque::there(double speed) const {
  if (!corner_speed || speed <= *corner_speed) return full_torque;
  return full_torque * *corner_speed / speed;
}

TorqueUse torque_use(const FollowedMove& move, const MotorTorque& motor,
                     double microsteps_per_full_step) {
  const double end = duration_of(move);
  const double step = std::max(shortest_step_s, end / most_steps);
  Speedometer speedometer(move);
  TorqueUse most;
  double before = 0;
  // The last stop does not count: a simulated motor that stands is asked for no inertia.
  for (double time = step; time < end; time += step) {
    const double speed = std::abs(speedometer.at(time)) / microsteps_per_full_step;
    const double share = motor.asked(speed, (speed - before) / step) / motor.there(speed);
    if (share > most.share) most = {share, speed};
    before = speed;
  }
  return most;
}

}  // namespace tmcl::plan
