#include "motion/path/gcode_arc.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "motion/path/text_cursor.hpp"
#include "tmcl/plain_number.hpp"

namespace tmcl::plan::path_file::gcode {
namespace {

constexpr double turn = 2 * std::numbers::pi;
// An arc's ends may be so differently far from its centre; or so, as a part of the radius, up to a
// hundred times as much. As LinuxCNC has it: centre and ends are rounded to 0.01 mm or 0.001 inch.
constexpr double radius_slack_mm = 2 * 0.01 * std::numbers::sqrt2;
constexpr double radius_slack_inch = 2 * 0.001 * std::numbers::sqrt2;
constexpr double relative_radius_slack = 1e-3;
constexpr double most_radius_slacks = 100;
// An arc that sweeps less is a whole turn, as with grbl, unless its ends are farther apart than
// what a file's last digit says.
constexpr double least_sweep = 5e-7;
constexpr double least_arc_mm = 5e-4;

double distance(const PlaneArc::Place& one, const PlaneArc::Place& other) {
  return std::hypot(other[0] - one[0], other[1] - one[1]);
}

/// How far it turns counter-clockwise, or clockwise; more than 0.
double turned(const PlaneArc& arc, const PlaneArc::Place& centre, double radius) {
  const double from_x = arc.from[0] - centre[0];
  const double from_y = arc.from[1] - centre[1];
  const double to_x = arc.to[0] - centre[0];
  const double to_y = arc.to[1] - centre[1];
  const double angle = std::atan2(from_x * to_y - from_y * to_x, from_x * to_x + from_y * to_y);
  const double sweep = arc.clockwise ? -angle : angle;
  const bool goes_nowhere = std::abs(sweep) <= std::min(least_sweep, least_arc_mm / radius);
  if (goes_nowhere) return turn;
  return sweep < 0 ? sweep + turn : sweep;
}

}  // namespace

tl::expected<PlaneArc::Round, std::string> PlaneArc::around(const Place& centre) const {
  const double begin = distance(from, centre);
  const double end = distance(to, centre);
  if (!(begin > 0) || !std::isfinite(begin))
    return tl::unexpected<std::string>("the centre is where the arc begins");
  if (!(end > 0)) return tl::unexpected<std::string>("the centre is where the arc ends");
  if (!(std::abs(begin - end) <= radius_slack(std::max(begin, end)))) {
    return tl::unexpected(fmt::format("the arc begins {} from its centre and ends {} from it",
                                      in_unit(begin), in_unit(end)));
  }
  const double sweep = turned(*this, centre, begin);
  return Round{centre, clockwise ? -sweep : sweep, sweep * (begin + end) / 2};
}

tl::expected<PlaneArc::Round, std::string> PlaneArc::of_radius(double radius) const {
  const double size = std::abs(radius);
  const double dx = to[0] - from[0];
  const double dy = to[1] - from[1];
  const double chord = std::hypot(dx, dy);
  if (are_equal(to[0], from[0]) && are_equal(to[1], from[1]))
    return tl::unexpected<std::string>("an arc to where it begins needs its centre");
  const double beyond = chord / 2 - size;
  if (!(beyond <= radius_slack(size))) {
    return tl::unexpected(
        fmt::format("the radius is too small: the ends are {} apart", in_unit(chord)));
  }
  // Counter-clockwise, the centre of the shorter arc is on the left.
  const bool left = clockwise != (radius > 0);
  const double height =
      std::sqrt(std::max(0.0, (size - chord / 2) * (size + chord / 2))) * (left ? 1 : -1);
  const Place centre{from[0] + dx / 2 - dy / chord * height,
                     from[1] + dy / 2 + dx / chord * height};
  // From the chord, since the directions of both ends from a far centre are the same.
  const double shorter = 2 * std::asin(std::min(1.0, chord / 2 / size));
  const double sweep = radius > 0 ? shorter : turn - shorter;
  return Round{centre, clockwise ? -sweep : sweep, sweep * std::max(size, chord / 2)};
}

/// How much two radii may differ of which the greater one is this, in mm.
double PlaneArc::radius_slack(double radius) const {
  const double slack = unit == 1 ? radius_slack_mm : radius_slack_inch * unit;
  return std::clamp(relative_radius_slack * radius, slack, most_radius_slacks * slack);
}

std::string PlaneArc::in_unit(double length) const {
  return plain_number(length / unit, 6) + (unit == 1 ? " mm" : " inches");
}

}  // namespace tmcl::plan::path_file::gcode
