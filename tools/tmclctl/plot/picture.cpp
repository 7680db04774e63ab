#include "plot/picture.hpp"

namespace tmclctl::plot {
namespace {

Curve curve_of(Quantity quantity, const Recording& recording) {
  switch (quantity) {
    case Quantity::position: return position_curve(recording);
    case Quantity::velocity: return velocity_curve(recording);
    case Quantity::acceleration: return acceleration_curve(recording);
    case Quantity::jerk: break;
  }
  return jerk_curve(recording);
}

}  // namespace

Picture picture_of(const Recording& recording, const Shown& shown) {
  Picture picture{summary(recording), recording.time_unit, {}, recording.phases};
  for (const auto quantity : or_usual(shown))
    picture.curves.push_back(curve_of(quantity, recording));
  return picture;
}

}  // namespace tmclctl::plot
