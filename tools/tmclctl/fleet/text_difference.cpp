#include "fleet/text_difference.hpp"

#include <algorithm>
#include <cstddef>

namespace tmclctl {
namespace {

using Lines = std::vector<std::string_view>;

// The table of the common lines has the product of both.
constexpr std::size_t most_lines = 4000;

Lines lines_in(std::string_view text) {
  Lines lines;
  while (!text.empty()) {
    const auto end = std::min(text.find('\n'), text.size());
    lines.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

/// How many lines both have in common from each pair of places on, in order.
class CommonLines {
 public:
  CommonLines(const Lines& before, const Lines& after)
      : width_(after.size() + 1), counts_((before.size() + 1) * width_) {
    for (auto i = before.size(); i-- > 0;)
      for (auto j = after.size(); j-- > 0;)
        counts_[i * width_ + j] = before[i] == after[j] ? from(i + 1, j + 1) + 1
                                                        : std::max(from(i + 1, j), from(i, j + 1));
  }
  unsigned from(std::size_t i, std::size_t j) const { return counts_[i * width_ + j]; }

 private:
  std::size_t width_;
  std::vector<unsigned> counts_;
};

}  // namespace

std::vector<std::string> difference_of(std::string_view before, std::string_view after) {
  auto old_lines = lines_in(before);
  auto new_lines = lines_in(after);
  std::vector<std::string> difference;
  const auto add = [&](char sign, std::string_view line) {
    difference.push_back(sign + std::string(line));
  };
  const bool is_short = old_lines.size() <= most_lines && new_lines.size() <= most_lines;
  const CommonLines common(is_short ? old_lines : Lines(), is_short ? new_lines : Lines());
  std::size_t i = 0;
  std::size_t j = 0;
  while (is_short && i < old_lines.size() && j < new_lines.size()) {
    if (old_lines[i] == new_lines[j]) {
      ++i;
      ++j;
    } else if (common.from(i + 1, j) >= common.from(i, j + 1)) {
      add('-', old_lines[i++]);
    } else {
      add('+', new_lines[j++]);
    }
  }
  while (i < old_lines.size()) add('-', old_lines[i++]);
  while (j < new_lines.size()) add('+', new_lines[j++]);
  if (before == after) difference.clear();
  return difference;
}

}  // namespace tmclctl
