#include "api/suggest.hpp"

#include <algorithm>

#include "tmcl/spelling.hpp"

namespace tmcld {

std::string suggest(std::string_view word, std::span<const std::string_view> names,
                    std::string_view otherwise) {
  const auto continues = [&](std::string_view name) {
    return !word.empty() && name.starts_with(word);
  };
  if (std::ranges::count_if(names, continues) == 1) {
    return "Did you mean '" + std::string(*std::ranges::find_if(names, continues)) + "'?";
  }
  const auto near = tmcl::closest_word(word, names);
  if (!near.empty()) return "Did you mean '" + std::string(near) + "'?";
  return std::string(otherwise);
}

}  // namespace tmcld
