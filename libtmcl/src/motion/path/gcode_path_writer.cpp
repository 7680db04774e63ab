#include "motion/path/gcode_path_writer.hpp"

#include <algorithm>
#include <utility>
#include <variant>
#include <vector>

#include "motion/path/gcode_block.hpp"

namespace tmcl::plan::path_file::gcode {
namespace {

bool moves(const Element& element) { return !std::holds_alternative<Dwell>(element); }

/// Whether a line from `at` goes on as one from `before` to it did.
bool goes_straight_on(const Point& before, const Point& at, const Point& target) {
  double one = 0;
  double other = 0;
  double both = 0;
  for (std::size_t i = 0; i < most_axes; ++i) {
    const double came = at[i] - before[i];
    const double goes = target[i] - at[i];
    one += came * came;
    other += goes * goes;
    both += came * goes;
  }
  constexpr double rounding = 1e-12;
  return both > 0 && both * both >= (1 - rounding) * one * other;
}

}  // namespace

void PathWriter::dwell(double seconds, std::optional<std::uint8_t> word) {
  add(Dwell{seconds, line_, word});
}

void PathWriter::line_to(const Point& target, std::optional<double> feed) {
  if (target == at_) return;
  const LineTo line{target, feed, {}, line_};
  if (corners_ == 610 && line_from_ && goes_straight_on(*line_from_, at_, target)) {
    path_.elements.emplace_back(line);
  } else {
    add(line);
  }
  line_from_ = std::exchange(at_, target);
}

void PathWriter::arc_to(ArcTo arc) {
  arc.line = line_;
  at_ = arc.target;
  for (const auto axis : arc.plane) use(axis);
  add(std::move(arc));
}

void PathWriter::add(Element element) {
  line_from_.reset();
  if (corners_ != 640 && moves(element) && !path_.elements.empty() && moves(path_.elements.back()))
    path_.elements.emplace_back(Dwell{0, line_});
  path_.elements.push_back(std::move(element));
}

Path PathWriter::finish() {
  if (std::ranges::none_of(used_, [](bool used) { return used; })) used_[0] = true;
  std::array<std::size_t, most_axes> place{};
  for (std::size_t i = 0; i < gcode_axes.size(); ++i) {
    if (i == linear_axes && !path_.axes.empty()) path_.length_axes = path_.axes.size();
    place[i] = path_.axes.size();
    if (used_[i]) path_.axes.emplace_back(1, gcode_axes[i]);
  }
  path_.start = packed(path_.start);
  auto at = path_.start;
  std::erase_if(path_.elements, [&](Element& element) {
    const auto before = at;
    auto* arc = std::get_if<ArcTo>(&element);
    if (auto* line = std::get_if<LineTo>(&element)) {
      at = line->target = packed(line->target);
      // Axes that only G28 would have moved are left out.
      return at == before;
    }
    if (arc == nullptr) return false;
    at = arc->target = packed(arc->target);
    for (auto& axis : arc->plane) axis = place[axis];
    return false;
  });
  return std::move(path_);
}

Point PathWriter::packed(const Point& all) const {
  Point point{};
  std::size_t count = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (used_[i]) point[count++] = all[i];
  }
  return point;
}

}  // namespace tmcl::plan::path_file::gcode
