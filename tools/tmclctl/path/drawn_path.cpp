#include "path/drawn_path.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace tmclctl::path {

using tmcl::plan::AxisValues;
using tmcl::plan::path_file::ArcTo;
using tmcl::plan::path_file::LineTo;

namespace {

/// Axes that are not counted are the same in both.
double distance(const tmcl::plan::path_file::Point& one,
                const tmcl::plan::path_file::Point& other) {
  double distance = 0;
  for (std::size_t axis = 0; axis < one.size(); ++axis)
    distance = std::hypot(distance, one[axis] - other[axis]);
  return distance;
}

bool is_nearer(const DrawnPath::Nearest& one, const DrawnPath::Nearest& other) {
  return one.distance < other.distance;
}

}  // namespace

DrawnPath::DrawnPath(tmcl::plan::path_file::Path path, const tmcl::plan::Course& course)
    : course_(course), axes_(std::min(path.axes.size(), path.length_axes)) {
  Point here = path.start;
  double time = 0;
  for (auto& element : path.elements) {
    const auto* line = std::get_if<LineTo>(&element);
    const auto* arc = std::get_if<ArcTo>(&element);
    if (line == nullptr && arc == nullptr) continue;
    if (line != nullptr) time += line->duration.value_or(0);
    const auto target = line != nullptr ? line->target : arc->target;
    const auto number = line != nullptr ? line->line : arc->line;
    part_of_line_.emplace(number, parts_.size());
    parts_.push_back({here, std::move(element), time, number});
    here = target;
  }
}

DrawnPath::Nearest DrawnPath::nearest(double time, const AxisValues& position) {
  if (parts_.empty()) return {position, 0};
  find_part(time);
  auto nearest = on_part(parts_[part_], position);
  // G28 makes two lines of one in the file.
  for (auto next = part_ + 1; next < parts_.size() && parts_[next].line == parts_[part_].line;
       ++next)
    nearest = std::min(nearest, on_part(parts_[next], position), is_nearer);
  return nearest;
}

DrawnPath::Nearest DrawnPath::on_part(const Part& part, const Point& position) const {
  if (const auto* arc = std::get_if<ArcTo>(&part.element)) return on_arc(part, *arc, position);
  return on_line(part, std::get<LineTo>(part.element).target, position);
}

void DrawnPath::find_part(double time) {
  time -= tmcl::plan::mean_delay(course_.impulses());
  if (!course_.has_legs()) {
    while (part_ + 1 < parts_.size() && time >= parts_[part_].end) ++part_;
    return;
  }
  while (leg_ + 1 < course_.legs() && course_.leg(leg_ + 1).begin <= time) ++leg_;
  if (leg_ < course_.legs()) part_ = part_of_line_.at(course_.leg(leg_).line);
}

DrawnPath::Nearest DrawnPath::on_line(const Part& part, const Point& target,
                                      const Point& position) const {
  double squares = 0;
  double along = 0;
  for (std::size_t axis = 0; axis < axes_; ++axis) {
    const double way = target[axis] - part.from[axis];
    squares += way * way;
    along += (position[axis] - part.from[axis]) * way;
  }
  const double share = squares > 0 ? std::clamp(along / squares, 0.0, 1.0) : 0;
  Point point = position;
  for (std::size_t axis = 0; axis < axes_; ++axis)
    point[axis] = std::lerp(part.from[axis], target[axis], share);
  return {point, distance(point, position)};
}

DrawnPath::Nearest DrawnPath::on_arc(const Part& part, const ArcTo& arc,
                                     const Point& position) const {
  constexpr double turn = 2 * std::numbers::pi;
  const auto angle_of = [&](const Point& point) {
    return std::atan2(point[arc.plane[1]] - arc.centre[1], point[arc.plane[0]] - arc.centre[0]);
  };
  const auto radius_of = [&](const Point& point) {
    return std::hypot(point[arc.plane[0]] - arc.centre[0], point[arc.plane[1]] - arc.centre[1]);
  };
  const double angle = angle_of(position) - angle_of(part.from);
  Nearest nearest{position, std::numeric_limits<double>::infinity()};
  // Which of its turns it is: one that begins where it ends has two at that place.
  const double turns = std::ceil(std::abs(arc.sweep) / turn) + 1;
  for (double turned = -turns; turned <= turns; ++turned) {
    const double share = std::clamp((angle + turned * turn) / arc.sweep, 0.0, 1.0);
    const double radius = std::lerp(radius_of(part.from), radius_of(arc.target), share);
    const double place = angle_of(part.from) + arc.sweep * share;
    Point point = position;
    for (std::size_t axis = 0; axis < axes_; ++axis)
      point[axis] = std::lerp(part.from[axis], arc.target[axis], share);
    point[arc.plane[0]] = arc.centre[0] + radius * std::cos(place);
    point[arc.plane[1]] = arc.centre[1] + radius * std::sin(place);
    nearest = std::min(nearest, {point, distance(point, position)}, is_nearer);
  }
  return nearest;
}

}  // namespace tmclctl::path
