/// What is true of every path that was read from a file, and of what is said if there is none.
#pragma once

#include <algorithm>
#include <cmath>
#include <string_view>
#include <variant>

#include "require.hpp"
#include "tmcl/plan/path_file.hpp"

namespace tmcl::fuzz {

inline void look_at(const plan::path_file::LineTo& line) {
  require(std::ranges::all_of(line.target, [](double value) { return std::isfinite(value); }),
          "a line ends somewhere");
  require(!line.feed || *line.feed > 0, "forwards");
  require(!line.duration || *line.duration > 0, "later");
}
inline void look_at(const plan::path_file::ArcTo& arc) {
  require(std::isfinite(arc.sweep) && arc.sweep != 0, "an arc turns");
  require(std::isfinite(arc.feed) && arc.feed > 0, "forwards");
}
inline void look_at(const plan::path_file::Dwell& dwell) {
  require(dwell.duration >= 0, "a pause passes");
}

inline void look_at(const plan::path_file::Path& path) {
  require(!path.axes.empty() && path.axes.size() <= plan::path_file::most_axes, "there are axes");
  require(path.remarks.size() <= plan::path_file::most_remarks, "not all is told");
  for (const auto& element : path.elements) {
    const auto* arc = std::get_if<plan::path_file::ArcTo>(&element);
    if (arc == nullptr) continue;
    require(arc->plane[0] != arc->plane[1] && arc->plane[0] < path.axes.size() &&
                arc->plane[1] < path.axes.size(),
            "an arc is in a plane of the axes");
  }
  for (const auto& element : path.elements)
    std::visit([](const auto& one) { look_at(one); }, element);
}

inline void look_at(const tl::expected<plan::path_file::Path, TextProblems>& read,
                    std::string_view text) {
  if (!read) {
    // Old systems end lines with \r alone.
    const char end = text.find('\n') == std::string_view::npos ? '\r' : '\n';
    const auto lines = static_cast<std::size_t>(std::ranges::count(text, end)) + 2;
    require(!read.error().empty(), "there is a problem");
    for (const auto& problem : read.error())
      require(problem.line >= 1 && problem.line <= lines, "in a line of the text");
    return;
  }
  look_at(*read);
  const auto flat = plan::path_file::flatten(*read, 0.1);
  if (flat) look_at(*flat);
}

}  // namespace tmcl::fuzz
