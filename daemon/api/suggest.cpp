#include "api/suggest.hpp"

#include <algorithm>

#include "tmcl/spelling.hpp"

namespace tmcld {

namespace {

constexpr std::size_t most_suggested = 8;

/// "Did you mean 'x', 'y' or 'z'?"
std::string one_of(std::span<const std::string_view> names) {
  std::string text = "Did you mean ";
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += i + 1 < names.size() ? ", " : " or ";
    text += tmcl::quoted(names[i]);
  }
  return text + '?';
}

}  // namespace

std::string suggest(std::string_view word, std::span<const std::string_view> names,
                    std::string_view otherwise) {
  const auto continues = [&](std::string_view name) {
    return !word.empty() && name.starts_with(word);
  };
  if (std::ranges::count_if(names, continues) == 1) {
    return one_of({{*std::ranges::find_if(names, continues)}});
  }
  const auto with_it = tmcl::words_with(word, names);
  if (!with_it.empty() && with_it.size() <= most_suggested) return one_of(with_it);
  const auto near = tmcl::closest_word(word, names);
  if (!near.empty()) return one_of({{near}});
  return std::string(otherwise);
}

}  // namespace tmcld
