#include "plot/picture.hpp"

#include <utility>

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
  for (auto& curve : also_curves(recording)) picture.curves.push_back(std::move(curve));
  return picture;
}

void add(const Recording& recording, const Shown& shown, Picture& picture) {
  auto more = picture_of(recording, shown);
  name_after(recording.axis, more);
  picture.title += "; " + more.title;
  for (auto& curve : more.curves) picture.curves.push_back(std::move(curve));
}

void name_after(const std::string& axis, Picture& picture) {
  for (auto& curve : picture.curves) {
    if (curve.colour_of.empty()) curve.colour_of = curve.name;
    curve.name = axis + ' ' + curve.name;
  }
}

}  // namespace tmclctl::plot
