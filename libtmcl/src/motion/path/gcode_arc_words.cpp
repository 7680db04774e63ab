#include "motion/path/gcode_arc_words.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace tmcl::plan::path_file::gcode {
namespace {

auto wrong_at(std::size_t column) {
  return [column](std::string message) { return Wrong{column, std::move(message)}; };
}

}  // namespace

Part<ArcTo> ArcWords::arc(const Point& from, const Point& target, const Feeds& feeds) const {
  const auto [one, other] = modes_.plane();
  const int motion = *modes_.motion();
  const auto turns = this->turns();
  if (!turns) return tl::unexpected(turns.error());
  const auto round = round_of(
      {{from[one], from[other]}, {target[one], target[other]}, motion == 2, modes_.unit()});
  if (!round) return tl::unexpected(round.error());
  const auto& centre = round->centre;
  const double more = (*turns - 1) * 2 * std::numbers::pi;
  double length = round->length + more * std::hypot(from[one] - centre[0], from[other] - centre[1]);
  for (std::size_t i = 0; i < linear_axes; ++i) {
    if (i != one && i != other) length = std::hypot(length, target[i] - from[i]);
  }
  const auto feed = feeds.of(motion, column(), true, length);
  if (!feed) return tl::unexpected(feed.error());
  const double sweep = round->sweep + (motion == 3 ? more : -more);
  if (!std::isfinite(sweep) || !std::isfinite(centre[0]) || !std::isfinite(centre[1]))
    return wrong(column(), "the arc is beyond all numbers");
  return ArcTo{target, centre, sweep, *feed, 0, modes_.plane()};
}

Part<double> ArcWords::turns() const {
  const auto& turns = block_.find('P');
  if (!turns) return 1;
  if (turns->value == std::round(turns->value) && turns->value >= 1 &&
      turns->value <= most_turns_of_an_arc)
    return turns->value;
  return wrong(turns->column, fmt::format("P of an arc is a whole number of turns, 1 to {}",
                                          most_turns_of_an_arc));
}

/// Its centre by two of the letters I, J, K, or its radius.
Part<PlaneArc::Round> ArcWords::round_of(const PlaneArc& arc) const {
  const auto& radius = block_.find('R');
  if (!radius) return around_centre(arc);
  if (block_.has_any(centre_letters)) return wrong(radius->column, "R excludes I, J and K");
  return arc.of_radius(radius->value * modes_.unit()).map_error(wrong_at(radius->column));
}

Part<PlaneArc::Round> ArcWords::around_centre(const PlaneArc& arc) const {
  const auto& plane = modes_.plane();
  const std::string letters{centre_letters[plane[0]], centre_letters[plane[1]]};
  const char third = centre_letters[3 - plane[0] - plane[1]];
  // Some programs write all three.
  if (block_.has(third) && block_.find(third)->value != 0) {
    return wrong(block_.find(third)->column,
                 fmt::format("{} is no part of the plane of this arc", third));
  }
  const bool absolute = modes_.has_absolute_centres();
  const bool enough = absolute ? block_.has(letters[0]) && block_.has(letters[1])
                               : block_.has_any(letters) || block_.has(third);
  if (!enough) {
    const auto [least, greatest] = std::minmax(letters[0], letters[1]);
    return wrong(column(),
                 fmt::format("G{} needs {} and {}, or R", *modes_.motion(), least, greatest));
  }
  PlaneArc::Place centre{};
  for (std::size_t i = 0; i < 2; ++i) {
    const double from = absolute ? origins_.of(plane[i]) : arc.from[i];
    centre[i] =
        from + (block_.has(letters[i]) ? block_.find(letters[i])->value * modes_.unit() : 0);
  }
  return arc.around(centre).map_error(wrong_at(block_.column_of(centre_letters)));
}

}  // namespace tmcl::plan::path_file::gcode
