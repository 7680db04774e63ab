#include "path/course_rows.hpp"

#include <cmath>

#include <fmt/format.h>

#include "tmcl/plain_number.hpp"

namespace tmclctl::path {
namespace {

using plot::Quantity;
using tmcl::plan::PathMotion;

constexpr int digits = 12;

double value_of(Quantity quantity, const PathMotion& motion, std::size_t axis) {
  switch (quantity) {
    case Quantity::position: return motion.position[axis];
    case Quantity::velocity: return motion.velocity[axis];
    case Quantity::acceleration: return motion.acceleration[axis];
    case Quantity::jerk: break;
  }
  return motion.jerk[axis];
}

std::string heading_of(const std::vector<std::string>& axes, const plot::Shown& shown) {
  std::string text = "t";
  for (const auto& axis : axes)
    for (const auto quantity : shown)
      text += fmt::format(",{}_{}", axis, plot::letter_of(quantity));
  return text + ",off\n";
}

}  // namespace

Result<std::string> to_csv(const tmcl::plan::Course& course, const std::vector<std::string>& axes,
                           DrawnPath drawn, const CourseRows& rows) {
  constexpr double rounding = 1e-9;
  const auto shown = rows.shown.empty() ? plot::all_quantities() : rows.shown;
  const double last = std::ceil(course.duration() / rows.step - rounding);
  if (!(last < plot::most_csv_rows)) {
    return tl::unexpected(usage_error(
        "too_many_rows", fmt::format("--csv with --step {} makes {:.0f} rows; {:.0f} at most",
                                     rows.step, last + 1, plot::most_csv_rows)));
  }
  auto text = heading_of(axes, shown);
  for (double i = 0; i <= last; ++i) {
    const double time = i * rows.step;
    const auto motion = course.motion_at(time);
    text += tmcl::plain_number(time, digits);
    for (std::size_t axis = 0; axis < axes.size(); ++axis) {
      for (const auto quantity : shown)
        text += ',' + tmcl::plain_number(value_of(quantity, motion, axis), digits);
    }
    const double off = drawn.nearest(time, motion.position).distance;
    text += ',' + tmcl::plain_number(off < DrawnPath::rounding ? 0 : off, digits) + '\n';
  }
  return text;
}

}  // namespace tmclctl::path
