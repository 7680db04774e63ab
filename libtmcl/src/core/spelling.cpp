#include "tmcl/spelling.hpp"

#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "core/text.hpp"

namespace tmcl {
namespace {

bool equal(char a, char b) { return text::lower(a) == text::lower(b); }

/// Two neighbours in the wrong order are one edit.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  auto before = row;
  for (std::size_t i = 0; i < a.size(); ++i) {
    auto next = row;
    next[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t exchanged = row[j] + (equal(a[i], b[j]) ? 0U : 1U);
      next[j + 1] = std::min({exchanged, next[j] + 1, row[j + 1] + 1});
      const bool swapped = i > 0 && j > 0 && equal(a[i], b[j - 1]) && equal(a[i - 1], b[j]);
      if (swapped) next[j + 1] = std::min(next[j + 1], before[j - 1] + 1);
    }
    before = std::exchange(row, std::move(next));
  }
  return row.back();
}

bool begins(std::string_view whole, std::string_view part) {
  return whole.size() > part.size() &&
         text::equal_ignoring_case(whole.substr(0, part.size()), part);
}

/// Whether these are its last words: "baud_rate" of "serial_baud_rate".
bool ends(std::string_view whole, std::string_view part) {
  if (whole.size() <= part.size()) return false;
  const auto from = whole.size() - part.size();
  return whole[from - 1] == '_' && text::equal_ignoring_case(whole.substr(from), part);
}

/// Whether it is one or more of the parts that underscores separate.
bool has_part(std::string_view whole, std::string_view part) {
  for (std::size_t at = 0; at + part.size() <= whole.size() && !part.empty(); ++at) {
    const auto end = at + part.size();
    const bool begins_there = at == 0 || whole[at - 1] == '_';
    const bool ends_there = end == whole.size() || whole[end] == '_';
    if (begins_there && ends_there &&
        text::equal_ignoring_case(whole.substr(at, part.size()), part))
      return true;
  }
  return false;
}

// What only lacks its end is near, however long that is.
std::size_t distance_between(std::string_view word, std::string_view candidate) {
  return begins(candidate, word) ? 1 : edit_distance(word, candidate);
}

// Longer words are not what a person mistyped, and cost time.
constexpr std::size_t longest_word = 64;
// Of shorter words the first letter is right; of all words two thirds are.
constexpr std::size_t short_word = 6;
constexpr std::size_t wrong_part = 3;

std::string_view without_dashes(std::string_view word) {
  return word.substr(std::min(word.find_first_not_of('-'), word.size()));
}

/// The edits between them; nothing if that is another word, not this one mistyped.
std::optional<std::size_t> edits_between(std::string_view word, std::string_view candidate) {
  const auto typed = without_dashes(word);
  const auto meant = without_dashes(candidate);
  if (typed.empty() || meant.empty()) return std::nullopt;
  const bool other_word = typed.size() < short_word && !equal(typed[0], meant[0]);
  const auto most = std::max<std::size_t>(1, typed.size() / wrong_part);
  const auto edits = distance_between(word, candidate);
  if (other_word || edits > most) return std::nullopt;
  return edits;
}

}  // namespace

std::vector<std::string_view> words_in(std::string_view line) {
  constexpr auto blank = " \t\r\n";
  std::vector<std::string_view> words;
  for (auto begin = line.find_first_not_of(blank); begin != std::string_view::npos;
       begin = line.find_first_not_of(blank, begin)) {
    const auto end = std::min(line.find_first_of(blank, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = end;
  }
  return words;
}

std::string_view closest_word(std::string_view word, std::span<const std::string_view> candidates) {
  if (word.size() > longest_word) return {};
  std::string_view best;
  std::optional<std::size_t> fewest;
  for (const auto candidate : candidates) {
    const auto edits = edits_between(word, candidate);
    if (!edits || (fewest && *edits >= *fewest)) continue;
    best = candidate;
    fewest = edits;
  }
  if (!best.empty()) return best;
  const auto has_it = [&](std::string_view candidate) { return ends(candidate, word); };
  const auto only = std::ranges::find_if(candidates, has_it);
  return std::ranges::count_if(candidates, has_it) == 1 ? *only : std::string_view{};
}

std::vector<std::string_view> words_with(std::string_view word,
                                         std::span<const std::string_view> candidates) {
  std::vector<std::string_view> found;
  for (const auto candidate : candidates)
    if (has_part(candidate, word)) found.push_back(candidate);
  return found;
}

std::string did_you_mean(std::string_view word, std::span<const std::string_view> candidates) {
  const auto best = closest_word(word, candidates);
  return best.empty() ? std::string{} : " Did you mean '" + std::string(best) + "'?";
}

}  // namespace tmcl
