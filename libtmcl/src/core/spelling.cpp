#include "tmcl/spelling.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

#include "core/text.hpp"

namespace tmcl {
namespace {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t exchanged = diagonal + (text::lower(a[i]) == text::lower(b[j]) ? 0U : 1U);
      diagonal = row[j + 1];
      row[j + 1] = std::min({exchanged, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

bool begins(std::string_view whole, std::string_view part) {
  return whole.size() > part.size() &&
         text::equal_ignoring_case(whole.substr(0, part.size()), part);
}

// What only lacks its end is near, however long that is.
std::size_t distance_between(std::string_view word, std::string_view candidate) {
  return begins(candidate, word) ? 1 : edit_distance(word, candidate);
}

// Longer words are not what a person mistyped, and cost time.
constexpr std::size_t longest_word = 64;

}  // namespace

std::string quoted(std::string_view word) { return "'" + std::string(word) + "'"; }

std::string_view closest_word(std::string_view word, std::span<const std::string_view> candidates) {
  if (word.size() > longest_word) return {};
  std::string_view best;
  std::size_t best_distance = word.size() / 2 + 1;
  for (const auto candidate : candidates) {
    const auto distance = distance_between(word, candidate);
    if (distance < best_distance) {
      best = candidate;
      best_distance = distance;
    }
  }
  return best;
}

std::string did_you_mean(std::string_view word, std::span<const std::string_view> candidates) {
  const auto best = closest_word(word, candidates);
  return best.empty() ? std::string{} : " Did you mean '" + std::string(best) + "'?";
}

}  // namespace tmcl
