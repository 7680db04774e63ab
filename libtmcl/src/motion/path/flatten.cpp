#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "tmcl/plan/path_file.hpp"

namespace tmcl::plan::path_file {
namespace {

double radius_at(const Point& place, const ArcTo& arc) {
  return std::hypot(place[arc.plane[0]] - arc.centre[0], place[arc.plane[1]] - arc.centre[1]);
}

/// Replaces one arc after another.
class Flattener {
 public:
  Flattener(const Path& path, double tolerance)
      : path_(path), tolerance_(tolerance), at_(path.start) {}

  tl::expected<Path, std::string> run() {
    flat_.axes = path_.axes;
    flat_.start = path_.start;
    flat_.length_axes = path_.length_axes;
    flat_.remarks = path_.remarks;
    for (const auto& element : path_.elements) {
      const auto* arc = std::get_if<ArcTo>(&element);
      if (arc == nullptr) {
        flat_.elements.push_back(element);
      } else if (const auto chords = chords_of(*arc)) {
        add_chords(*arc, *chords);
      } else {
        return tl::unexpected(fmt::format("line {}: an arc of so many chords; {} at most",
                                          arc->line, most_chords_of_an_arc));
      }
      if (const auto* line = std::get_if<LineTo>(&element)) at_ = line->target;
      if (arc != nullptr) at_ = arc->target;
      if (flat_.elements.size() > most_elements)
        return tl::unexpected(
            fmt::format("the path is too long; {} elements at most", most_elements));
    }
    return std::move(flat_);
  }

 private:
  // A chord of angle w is r * (1 - cos(w/2)) away from its arc.
  std::optional<std::size_t> chords_of(const ArcTo& arc) const {
    // A circle in fewer chords would be a line.
    constexpr double widest = std::numbers::pi / 2;
    const double radius = std::max(radius_at(at_, arc), radius_at(arc.target, arc));
    // As 1 - cos(x) = 2 sin^2(x/2), which keeps its digits for small tolerances.
    const double sine = std::sqrt(std::min(1.0, tolerance_ / radius / 2));
    const double angle = std::min(widest, 4 * std::asin(sine));
    const double count = std::ceil(std::abs(arc.sweep) / angle - 1e-9);
    if (!(count <= static_cast<double>(most_chords_of_an_arc))) return std::nullopt;
    return std::max<std::size_t>(1, static_cast<std::size_t>(count));
  }

  void add_chords(const ArcTo& arc, std::size_t count) {
    const auto [one, other] = arc.plane;
    const double begin = radius_at(at_, arc);
    const double end = radius_at(arc.target, arc);
    const double first = std::atan2(at_[other] - arc.centre[1], at_[one] - arc.centre[0]);
    for (std::size_t i = 1; i < count; ++i) {
      const double part = static_cast<double>(i) / static_cast<double>(count);
      const double radius = begin + (end - begin) * part;
      const double angle = first + arc.sweep * part;
      LineTo chord{at_, arc.feed, {}, arc.line};
      for (std::size_t axis = 0; axis < most_axes; ++axis)
        chord.target[axis] += (arc.target[axis] - at_[axis]) * part;
      chord.target[one] = arc.centre[0] + radius * std::cos(angle);
      chord.target[other] = arc.centre[1] + radius * std::sin(angle);
      flat_.elements.emplace_back(chord);
    }
    flat_.elements.emplace_back(LineTo{arc.target, arc.feed, {}, arc.line});
  }

  const Path& path_;
  double tolerance_;
  Point at_;
  Path flat_;
};

}  // namespace

tl::expected<Path, std::string> flatten(const Path& path, double tolerance) {
  if (!(tolerance > 0) || !std::isfinite(tolerance))
    return tl::unexpected(
        fmt::format("the tolerance must be a finite number above 0, not {}", tolerance));
  return Flattener(path, tolerance).run();
}

}  // namespace tmcl::plan::path_file
