#include "tmcl/plan/path_correction.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace tmcl::plan {
namespace {

using path_file::LineTo;
using path_file::Point;

/// Parts of a line that are nearer to each other are one.
constexpr double same_part = 1e-9;

class Counting {
 public:
  Counting(const path_file::Path& path, Corrections corrections)
      : corrections_(corrections), here_(path.start) {}

  Point counted(Point point) const {
    for (std::size_t axis = 0; axis < corrections_.size(); ++axis)
      if (corrections_[axis]) point[axis] = corrections_[axis]->counted(point[axis]);
    return point;
  }

  /// Where the line passes a row of a table, in parts of it; the last is its end.
  std::vector<double> parts_of(const LineTo& line) const {
    std::vector<double> parts{1};
    if (line.duration) return parts;
    for (std::size_t axis = 0; axis < corrections_.size(); ++axis)
      if (corrections_[axis]) pass(*corrections_[axis], here_[axis], line.target[axis], parts);
    std::ranges::sort(parts);
    const auto same = [](double one, double other) { return other - one < same_part; };
    parts.erase(std::ranges::unique(parts, same).begin(), parts.end());
    parts.back() = 1;
    return parts;
  }

  LineTo line_to(const LineTo& line, double part) const {
    auto counted_line = line;
    // Its end exactly.
    for (std::size_t axis = 0; axis < corrections_.size() && part < 1; ++axis)
      counted_line.target[axis] = here_[axis] + part * (line.target[axis] - here_[axis]);
    counted_line.target = counted(counted_line.target);
    return counted_line;
  }

  void stand_at(const Point& point) { here_ = point; }

 private:
  static void pass(const Correction& correction, double from, double to,
                   std::vector<double>& parts) {
    const auto [least, greatest] = std::minmax(from, to);
    const auto& rows = correction.rows();
    const auto first = std::ranges::upper_bound(rows, least, {}, &Correction::Row::actual);
    for (auto row = first; row != rows.end() && row->actual < greatest; ++row)
      parts.push_back((row->actual - from) / (to - from));
  }

  Corrections corrections_;
  Point here_;
};

}  // namespace

tl::expected<path_file::Path, std::string> as_counted(path_file::Path path,
                                                      Corrections corrections) {
  const bool has_some =
      std::ranges::any_of(corrections, [](const auto& one) { return one != nullptr; });
  if (!has_some) return path;
  Counting counting(path, corrections);
  auto elements = std::exchange(path.elements, {});
  for (const auto& element : elements) {
    const auto* line = std::get_if<LineTo>(&element);
    if (line == nullptr) {
      path.elements.push_back(element);
      continue;
    }
    for (const double part : counting.parts_of(*line))
      path.elements.emplace_back(counting.line_to(*line, part));
    counting.stand_at(line->target);
    if (path.elements.size() > path_file::most_elements)
      return tl::unexpected(
          fmt::format("line {}: divided by the corrections of its axes, the path is too long; {} "
                      "elements at most",
                      line->line, path_file::most_elements));
  }
  path.start = counting.counted(path.start);
  return path;
}

}  // namespace tmcl::plan
