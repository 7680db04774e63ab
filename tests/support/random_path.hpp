/// Random paths of lines in mm from (0, 0), for the axes of a StreamBench.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <variant>

#include "support/random.hpp"
#include "tmcl/plan/path_file.hpp"

namespace tmcl::plan::test {

/// Up to eight lines of up to 8 mm, from 1 um on, some with a feed of 1 to 20 mm/s, with dwells
/// between some. `axes`: 1 or 2.
inline path_file::Path random_path(tmcl::test::Random<>& random, std::size_t axes) {
  path_file::Path path{{"X", "Y"}, {}, {}};
  path.axes.resize(axes);
  std::array<double, 2> at{};
  const auto lines = random.between(1, 8);
  for (std::int64_t i = 0; i < lines; ++i) {
    const auto way = [&] {
      return static_cast<double>(random.either_way(random.any_size(8000))) / 1e3;
    };
    const auto line = static_cast<std::size_t>(i + 1);
    if (random.one_in(6)) path.elements.push_back(path_file::Dwell{0.05, line});
    path_file::LineTo to{{at[0] + way(), at[1] + way()}, {}, {}, line};
    if (axes == 1) to.target[1] = 0;
    if (to.target[0] == at[0] && to.target[1] == at[1]) to.target[0] += 1;
    if (random.one_in(2)) to.feed = static_cast<double>(random.between(1, 20));
    at = {to.target[0], to.target[1]};
    path.elements.push_back(to);
  }
  return path;
}

inline std::string describe(const path_file::Path& path) {
  std::string text;
  for (const auto& element : path.elements) {
    if (const auto* to = std::get_if<path_file::LineTo>(&element)) {
      text += " (" + std::to_string(to->target[0]) + ", " + std::to_string(to->target[1]) + ")";
      if (to->feed) text += " F" + std::to_string(*to->feed);
    } else {
      text += " dwell";
    }
  }
  return text;
}

}  // namespace tmcl::plan::test
